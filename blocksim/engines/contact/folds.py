"""A path from contacts that all press and part at once, followed around its folds.

Forces and velocities of contacts lie in cones, and multiply to tau on the path. For a large tau
there is one such point, which Newton's method finds. As tau falls to 0 a point becomes a
solution. On its way tau need not fall: where blocks jam, paths of falling tau end short of one.
So tau may rise again, as Lemke's pivoting lets what is left rise: the sign of a determinant
says which way leads on (E. L. Allgower and K. Georg, Numerical Continuation Methods, 1990).
What contacts and cones are is told in the plane by `jammed.py`, in space by `solid/path.py`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Generic, NamedTuple, Protocol, TypeVar

from blocksim.blocks.assembly import Array

FIRST = 10.0
"""Product of force and velocity with which it begins."""
NEAR = 0.3
"""How far off the path a point may be up to which steps grow, over how far it may be at all."""
LONGEST, SHORTEST, GROWTH = 1.0, 1e-6, 1.5
"""Of steps along it, over tau's logarithm where that is all that changes."""
INSIDE = 0.9
"""Share of the way to a cone's surface that a step takes at most."""
LEAST = 0.5
"""Least part of a step that is taken."""


class Point(NamedTuple):
    """A point near the path, or a way from one to another.

    `x`: Accelerations of blocks.
    `y`, `v`: Forces and velocities of contacts.
    `log`: Logarithm of tau.
    """

    x: Array
    y: Array
    v: Array
    log: float

    def moved(self, way: Point, share: float) -> Point:
        """Return the point after a share of a way."""
        return Point._make(at + share * part for at, part in zip(self, way, strict=True))


class Look(Protocol):
    """What is seen at a point: `off` is how far it is from the path.

    It is 1 where products are between a half and twice tau.
    """

    @property
    def off(self) -> float: ...  # noqa: D102


Seen = TypeVar("Seen", bound=Look)


class Path(ABC, Generic[Seen]):
    """The path, and where on it one is.

    `wide`: How far off it a point may be. Farther off is another path, which may be a circle.
    """

    wide = 1.0

    def __init__(self, start: Point) -> None:
        self._at = start
        self._look = self._looked(start)
        self._begun = False
        self._length: float = NEAR

    @abstractmethod
    def _looked(self, at: Point) -> Seen | None:
        """Look at a point; None where it is in the cones no more."""

    @abstractmethod
    def _newton(self, look: Seen) -> tuple[Point, Point, float] | None:
        """Return the way back at the same tau, that for a larger one, and a sign.

        The second is for 1 more in tau's logarithm. The sign is that of the determinant.
        None where that is 0.
        """

    @abstractmethod
    def _product(self, look: Seen, one: Point, other: Point) -> float:
        """Return the inner product of two ways."""

    @abstractmethod
    def _room(self, way: Point) -> float:
        """Return how many times a way may be gone within the cones."""

    @property
    def tau(self) -> float:
        """Product of force and velocity by now."""
        return math.exp(self._at.log)

    def go(self) -> bool:
        """Take a step; tell whether that was possible."""
        found = None if self._look is None else self._ways(self._look)
        if found is None:
            return False
        back, along = found
        tried, most = self._length if self._begun else 0.0, 1.0
        while True:
            way = back.moved(along, tried)
            share = min(most, INSIDE * self._room(way))
            there = self._at.moved(way, share)
            look = self._looked(there)
            if not self._begun or (look is not None and self._is_better(look, tried, share)):
                break
            if tried:
                tried = tried / 2 if tried > SHORTEST else 0.0
            elif share > SHORTEST:
                most = share / 2
            else:
                return False
        if look is None:
            return False
        self._at, self._look = there, look
        if not self._begun:
            self._begun = look.off < NEAR * self.wide and share == 1.0
        elif tried:
            grows = tried == self._length and look.off < NEAR * self.wide
            self._length = min(LONGEST, GROWTH * tried) if grows else tried
        return True

    def _is_better(self, look: Seen, tried: float, share: float) -> bool:
        """Tell whether a point is good enough to go on from after a part of a step."""
        if tried:
            return look.off < self.wide and share >= LEAST
        return self._look is not None and look.off < self._look.off

    def _ways(self, look: Seen) -> tuple[Point, Point] | None:
        """Return the way back to the path, across it, and that along it, of length 1."""
        found = self._newton(look)
        if found is None:
            return None
        back, along, sign = found
        size = self._product(look, along, along)
        if not size > 0:
            return None
        back = (
            back.moved(along, -self._product(look, back, along) / size) if self._begun else back
        )
        nothing = Point._make(0.0 * each for each in along)
        return back, nothing.moved(along, -sign / math.sqrt(size))
