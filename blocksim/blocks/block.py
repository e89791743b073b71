"""A rigid block in the plane, a support and a joint: nothing here knows of arches."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from blocksim.common.checks import COORDINATE, INERTIA, LENGTH, MASS
from blocksim.common.errors import InputError

Array = NDArray[np.float64]

SUPPORT = -1
"""Block index that stands for the fixed ground."""
FEWEST_CORNERS = 3
FLAT = 1e-6
"""How far a polygon may fold inwards and still count as convex, over twice its area."""


def frozen(values: object, shape: tuple[int, ...]) -> Array:
    """Return a read-only float array of the given shape (-1 first: any length)."""
    array = np.array(values, dtype=np.float64)
    if array.shape != shape and (
        array.ndim != len(shape) or shape[0] != -1 or array.shape[1:] != shape[1:]
    ):
        raise ValueError(f"expected an array of shape {shape}, got {array.shape}")
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Block:
    """A rigid block in the plane: a convex polygon, or several that move as one.

    Parameters
    ----------
    vertices : (k, 2) float
        Corners, counter-clockwise, x and y [m]; of several polygons their convex hull.
    centre : (2,) float
        Centre of mass [m]; it follows from the weight model and need not be the
        centroid of the polygon.
    mass : float
        [kg]
    inertia : float
        Moment of inertia about the centre of mass [kg m^2].
    depth : float
        Out of the plane [m].
    name : str
        What it is called where it comes from a file.
    parts : tuple of (k, 2) float
        The convex polygons of a block that is not convex; empty for one polygon.
    """

    vertices: Array
    centre: Array
    mass: float
    inertia: float
    depth: float
    name: str = ""
    parts: tuple[Array, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers, make the arrays read-only and corners counter-clockwise."""
        for field, known in (("mass", MASS), ("inertia", INERTIA), ("depth", LENGTH)):
            if not known.has(value := getattr(self, field)):
                raise InputError(self._called(field), value, known.words)
        vertices = frozen(self.vertices, (-1, 2))
        corners, most = vertices.tolist(), COORDINATE.high
        if not all(-most <= x <= most and -most <= y <= most for x, y in corners):
            raise InputError(self._called("vertices"), corners, COORDINATE.words)
        area, folds = _outline(corners)
        if area == 0 or folds:
            allowed = "three corners or more around a convex area"
            raise InputError(self._called("vertices"), corners, allowed)
        if area < 0:
            vertices = frozen(vertices[::-1], (-1, 2))
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "centre", frozen(self.centre, (2,)))
        if self.parts:
            parts = tuple(frozen(part, (-1, 2)) for part in self.parts)
            object.__setattr__(self, "parts", parts)

    def _called(self, field: str) -> str:
        return f"block {self.name}: {field}" if self.name else field

    @property
    def polygons(self) -> tuple[Array, ...]:
        """The convex polygons it consists of."""
        return self.parts or (self.vertices,)


def _outline(corners: list[list[float]]) -> tuple[float, bool]:
    """Return twice the area of a polygon, and whether it folds inwards or has no numbers."""
    if len(corners) < FEWEST_CORNERS:
        return 0.0, True
    (x0, y0), (x1, y1), (x2, y2) = corners[0], corners[-2], corners[-1]
    turns: list[float] = []
    area = 0.0
    for x3, y3 in corners:
        area += (x2 - x0) * (y3 - y0) - (x3 - x0) * (y2 - y0)
        turns.append((x2 - x1) * (y3 - y2) - (y2 - y1) * (x3 - x2))
        x1, y1, x2, y2 = x2, y2, x3, y3
    if not math.isfinite(area):
        return 0.0, True
    slack = FLAT * abs(area)
    return area, min(turns) < -slack and max(turns) > slack


@dataclass(frozen=True, eq=False)
class Support:
    """A body that stays where it is.

    `polygons`, tuple of (k, 2): Convex, corners counter-clockwise [m].
    `name`: What it is called where it comes from a file.
    """

    polygons: tuple[Array, ...]
    name: str = ""

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        object.__setattr__(
            self, "polygons", tuple(frozen(part, (-1, 2)) for part in self.polygons)
        )


@dataclass(frozen=True, eq=False)
class Joint:
    """A straight dry joint between two blocks, or between a block and the support.

    Parameters
    ----------
    before, after : int
        Indices of the blocks on its two sides, `SUPPORT` for the ground.
    inner, outer : (2,) float
        Its two ends [m]: intrados and extrados for an arch. Seen along the
        direction from `before` to `after`, `inner` lies to the right.
    friction : float or None
        Its own friction coefficient, where it is not that of all others: 0 on a plane of
        symmetry, which is smooth.
    across : (2,) float or None
        Unit normal from `before` to `after`, of a corner that rests on a face: its two
        ends are the same point, and it has no length.
    faces : (2, 2, 2) float or None
        Inner and outer end [m] of the faces of `before` and of `after` that meet in it,
        where a face reaches beyond the joint.
    support : int or None
        Which of the assembly's supports it lies on, where they are known.
    gap : float
        How far apart the faces are drawn that it closes, below 0 where they overlap [m]; 0
        where they lie on each other.
    """

    before: int
    after: int
    inner: Array
    outer: Array
    friction: float | None = None
    across: Array | None = None
    faces: Array | None = None
    support: int | None = None
    gap: float = 0.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        object.__setattr__(self, "inner", frozen(self.inner, (2,)))
        object.__setattr__(self, "outer", frozen(self.outer, (2,)))
        if self.across is not None:
            object.__setattr__(self, "across", frozen(self.across, (2,)))
        if self.faces is not None:
            object.__setattr__(self, "faces", frozen(self.faces, (2, 2, 2)))

    @property
    def is_corner(self) -> bool:
        """Whether it is a corner on a face: a contact without length."""
        return self.across is not None

    @property
    def length(self) -> float:
        """Length of the joint [m]."""
        return float(np.hypot(*(self.outer - self.inner)))

    @property
    def tangent(self) -> Array:
        """Unit vector from the inner to the outer end, shape (2,)."""
        if self.across is not None:
            return np.array([-self.across[1], self.across[0]])
        return (self.outer - self.inner) / self.length

    @property
    def normal(self) -> Array:
        """Unit normal, from `before` to `after`, shape (2,)."""
        along = self.tangent
        return np.array([along[1], -along[0]])

    @property
    def turned(self) -> Joint:
        """The same joint with its ends exchanged, and so its normal the other way."""
        return replace(
            self,
            inner=self.outer,
            outer=self.inner,
            across=None if self.across is None else -self.across,
            faces=None if self.faces is None else self.faces[:, ::-1],
        )
