"""Words that several rooms say, and words of strangers made fit to be said."""

from __future__ import annotations

from collections.abc import Sequence
from unicodedata import category


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: 1 block, 2 blocks.

    `noun`: In the singular; its plural ends in s.
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def few(names: Sequence[str], most: int, between: str = ", ") -> str:
    """List so many names, and say how many more there are."""
    more = len(names) - most
    return between.join(names[:most]) + (f" and {more} more" if more > 0 else "")


def percent(share: float, digits: str = "g") -> str:
    """Say a share; what rounds to nothing has no sign."""
    said = f"{share * 100:{digits}}"
    said = said if float(said) else said.lstrip("+-")
    return f"{said}\N{NO-BREAK SPACE}%"


def lasting(seconds: float) -> str:
    """Return a time as people read it, with two digits or more.

    Examples
    --------
    >>> lasting(0.0214), lasting(134.2)
    ('0.021 s', '134 s')
    """
    return f"{seconds:.2g} s" if seconds < 99.5 else f"{seconds:.0f} s"


def printable(text: str) -> str:
    r"""Return text of a stranger as one line that can be shown, printed or put into a file.

    Titles, names of blocks and names of files may hold what clears a screen, writes the
    clipboard, turns the direction of reading or begins a line of its own.

    Returns: Of printable characters and spaces of any width: other white space is a space,
        anything else a question mark.

    Examples
    --------
    >>> printable("wall\x1b[2J\nSTANDS")
    'wall?[2J STANDS'
    """
    if text.isprintable():
        return text
    return "".join(map(_shown, text))


def _shown(character: str) -> str:
    if character.isprintable() or category(character) == "Zs":
        return character
    return " " if character.isspace() else "?"


def printed(value: object) -> object:
    """Return what a template is given, `printable` where it is text and no markup."""
    # Markup is a class of its own.
    return printable(value) if type(value) is str else value
