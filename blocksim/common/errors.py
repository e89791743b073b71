"""What can go wrong outside blocksim: wrong input and missing optional parts.

Outcomes (stands, collapses, undecided) are values and never exceptions.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from reprlib import Repr

from blocksim.common.words import printable

LONGEST = 200
"""Characters shown of a value, a name or a file."""
LONGEST_WORDS = 600
"""The same of what would be accepted, which may list names."""


class _Short(Repr):
    """Values cut at a length; whole numbers may be too long to be written at all."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = LONGEST

    def repr_int(self, x: int, level: int) -> str:  # noqa: ARG002 - as called
        """Return a whole number, or how long one is."""
        if abs(x) >= 10**20:
            return f"a whole number of about {round(x.bit_length() * 0.30103)} digits"
        return str(x)


_SHORT = _Short()
_LINES = re.compile(r"\s*\n\s*")
"""Arrays are shown in several lines."""


def in_line(text: str, most: int = LONGEST) -> str:
    """Return text of a stranger as `printable` does, cut at a length."""
    half = most // 2
    return printable(text if len(text) <= most else f"{text[:half]}...{text[3 - half :]}")


def perhaps(name: str, known: Iterable[str]) -> str:
    """Ask whether a known name was meant, to be added to what is allowed; "" if none is near.

    `name`: As it was given.
    `known`: Of those it may be itself, of which nothing is asked.
    """
    from difflib import get_close_matches

    known = list(known)
    if name in known:
        return ""
    # Longer ones are no slip of the hand, and take long to compare.
    near = get_close_matches(name.lower(), known, 1) if len(name) <= LONGEST else []
    return f"; did you mean {near[0]}?" if near else ""


MISSING = object()
"""Stands for a value that was not given."""
ALL_MISSING = object()
"""The same of several fields, named together."""


class BlocksimError(Exception):
    """Base of everything blocksim raises on purpose."""


class InputError(BlocksimError, ValueError):
    """A value that cannot be used.

    Parameters
    ----------
    field : str
        Name of the field or option, e.g. ``eta``.
    value : object
        What was given; `MISSING` if nothing was.
    allowed : str
        What would have been accepted, as a phrase.
    where : str, optional
        File the value comes from.
    """

    def __init__(
        self, field: str, value: object, allowed: str, *, where: str | None = None
    ) -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        self.where = where
        place = f"{in_line(where)}: " if where else ""
        said = {id(MISSING): "is missing", id(ALL_MISSING): "are missing"}
        is_so = said.get(id(value), f"= {_LINES.sub(' ', _SHORT.repr(value))}")
        must = in_line(allowed, LONGEST_WORDS)
        super().__init__(f"{place}{in_line(field)} {is_so}: must be {must}")


class MachineError(BlocksimError):
    """A failure of the machine, whatever was asked: a full disk, no permission.

    Parameters
    ----------
    field : str
        Name of the option or of what the file is, e.g. ``--out``.
    value : str
        The file.
    why : str
        As the system says it.
    """

    def __init__(self, field: str, value: str, why: str) -> None:
        self.field = field
        self.value = value
        self.why = why
        super().__init__(
            f"{in_line(field)} = {_SHORT.repr(value)}: the system says {in_line(why)!r}"
        )


class Unsolved(BlocksimError):
    """A linear programme of which its solver tells nothing."""

    def __init__(self) -> None:
        super().__init__(
            "limit analysis: undecided, as its forces or motions are too unlike each other in "
            "size for the solver; weights, loads and friction nearer to each other would decide"
        )


class MissingPart(BlocksimError):
    """An optional part that is not installed.

    Parameters
    ----------
    part : str
        What is missing, e.g. ``pybullet``.
    remedy : str
        How to get it.
    """

    def __init__(self, part: str, remedy: str) -> None:
        self.part = part
        self.remedy = remedy
        super().__init__(f"{part} is not available here: {remedy}")
