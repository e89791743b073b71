"""Things of one kind, each made when it is looked at, and all they consist of known before.

A generator knows its blocks and joints as arrays, and so does whoever solves for their
motion. Between them nobody needs the single ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import Any, TypeVar, cast, overload

import numpy as np
from numpy.typing import NDArray

Thing = TypeVar("Thing")
Column = Sequence[Any] | NDArray[np.float64]


class Rows(Sequence[Thing]):
    """A table, a row of which makes a thing.

    `kind`: A dataclass.
    `columns`: Its parameters, each for all things; those that are left out have their defaults.
    """

    def __init__(self, kind: Callable[..., Thing], **columns: Column) -> None:
        self._kind = kind
        self._columns = {name: _read_only(each) for name, each in columns.items()}
        self._made: dict[int, Thing] = {}

    @overload
    def __getitem__(self, index: int) -> Thing: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Thing, ...]: ...
    def __getitem__(self, index: int | slice) -> Thing | tuple[Thing, ...]:
        """Return one or several, made now if they have not been."""
        if isinstance(index, slice):
            return tuple(self[each] for each in range(len(self))[index])
        at = range(len(self))[index]
        if at not in self._made:
            given = {name: column[at] for name, column in self._columns.items()}
            self._made[at] = self._kind(**given)
        return self._made[at]

    def __len__(self) -> int:
        """Count them."""
        return len(next(iter(self._columns.values())))

    def __repr__(self) -> str:
        """Show them as a tuple does."""
        return repr(tuple(self))

    def column(self, name: str) -> Column:
        """Return one of the parameters for all things."""
        if name in self._columns:
            return self._columns[name]
        defaults = {each.name: each.default for each in fields(cast("Any", self._kind))}
        return [defaults[name]] * len(self)


def _read_only(values: Column) -> Column:
    """Return a view of an array that cannot be written to; anything else as it is."""
    if isinstance(values, np.ndarray):
        values = values.view()
        values.setflags(write=False)
    return values


def column(things: Sequence[Thing], name: str) -> Column:
    """Return what each of some things has by a name."""
    if isinstance(things, Rows):
        return things.column(name)
    return [getattr(each, name) for each in things]
