"""Words that several rooms say, and words of strangers made fit to be said."""

from __future__ import annotations

from unicodedata import category


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: 1 block, 2 blocks.

    Parameters
    ----------
    number : int
    noun : str
        In the singular; its plural ends in s.
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def printable(text: str) -> str:
    r"""Return text of a stranger as one line that can be shown, printed or put into a file.

    Titles, names of blocks and names of files may hold what clears a screen, writes the
    clipboard, turns the direction of reading or begins a line of its own.

    Parameters
    ----------
    text : str

    Returns
    -------
    str
        Of printable characters and spaces of any width: other white space is a space, anything
        else a question mark.

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
