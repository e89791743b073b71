"""What can go wrong outside blocksim: wrong input and missing optional parts.

Outcomes (stands, collapses, undecided) are values and never exceptions.
"""

from __future__ import annotations

from reprlib import Repr

_SHORT = Repr()
_SHORT.maxstring = _SHORT.maxother = 200
"""Characters shown of a value."""

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
        place = f"{where}: " if where else ""
        said = {id(MISSING): "is missing", id(ALL_MISSING): "are missing"}
        is_so = said.get(id(value), f"= {_SHORT.repr(value)}")
        super().__init__(f"{place}{field} {is_so}: must be {allowed}")


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
