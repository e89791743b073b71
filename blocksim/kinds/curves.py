"""Centrelines of arches, where joints meet them, and the voussoirs between two offsets.

A voussoir is swept by straight lines from its intrados to its extrados, from one joint to the
other. Along a line the integrands are polynomials; across the lines they are smooth, and
quadrature by Gauss is exact to round-off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.common.series import gauss

PANELS = 64
"""Parts of a curve in each of which its length is found by one quadrature."""
NODES = 24
HALVINGS = 60
"""Of an interval, until nothing is left of it."""

Function = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A centreline from the left springing to the right, which only ever turns to the right.

    `start`, `end`: Range of its parameter.
    `at`, `first`, `second`: x and y at parameters, and their derivatives.
    `breaks`: Parameters at which the curvature jumps.
    """

    start: float
    end: float
    at: Function
    first: Function
    second: Function
    breaks: tuple[float, ...] = ()

    def point(self, s: Array, offset: float = 0.0) -> Array:
        """Return points at a distance to its outer side, shape (..., 2)."""
        x, y = self.at(s)
        dx, dy = self.first(s)
        speed = np.hypot(dx, dy)
        return np.stack([x - offset * dy / speed, y + offset * dx / speed], axis=-1)

    def slope(self, s: Array, offset: float = 0.0) -> Array:
        """Return the derivative of `point`, shape (..., 2)."""
        (dx, dy), (ddx, ddy) = self.first(s), self.second(s)
        curvature = (dx * ddy - dy * ddx) / np.hypot(dx, dy) ** 3
        return (1 - offset * curvature)[..., None] * np.stack([dx, dy], axis=-1)

    def equal_lengths(self, count: int) -> Array:
        """Parameters that cut it into parts of equal length, shape (count + 1,)."""
        nodes, weights = gauss(NODES)
        edges = np.unique([*np.linspace(self.start, self.end, PANELS + 1), *self.breaks])
        low, wide = edges[:-1], np.diff(edges)

        def lengths(start: Array, width: Array) -> Array:
            s = start[:, None] + width[:, None] * nodes
            return width * (np.hypot(*self.first(s)) @ weights)

        total = np.concatenate([[0.0], np.cumsum(lengths(low, wide))])
        wanted = total[-1] * np.arange(1, count) / count
        panel = np.asarray(np.searchsorted(total[1:-1], wanted, "right"), dtype=np.int64)
        rest, base = wanted - total[panel], low[panel]
        way = rest / (total[panel + 1] - total[panel]) * wide[panel]
        for _ in range(8):
            way -= (lengths(base, way) - rest) / np.hypot(*self.first(base + way))
        return np.concatenate([[self.start], base + way, [self.end]])


def where(rises: Callable[[Array], Array], levels: Array, low: float, high: float) -> Array:
    """Find parameters at which a function that rises from low to high has given values."""
    left, right = np.full(len(levels), low), np.full(len(levels), high)
    for _ in range(HALVINGS):
        middle = (left + right) / 2
        below = rises(middle) < levels
        left, right = np.where(below, middle, left), np.where(below, right, middle)
    return (left + right) / 2


def circle(shift: float, radius: float, start: float, end: float) -> Curve:
    """Return an arc about a centre at a height of 0, by the angle from the vertical."""
    return ellipse(radius, radius, start, end, shift)


def ellipse(across: float, up: float, start: float, end: float, shift: float = 0.0) -> Curve:
    """Return a part of an ellipse of two radii about such a centre, by its own angle."""
    return Curve(
        start=start,
        end=end,
        at=lambda s: (shift + across * np.sin(s), up * np.cos(s)),
        first=lambda s: (across * np.cos(s), -up * np.sin(s)),
        second=lambda s: (-across * np.sin(s), -up * np.cos(s)),
    )


Indices = NDArray[np.int64]

ACROSS = 40
"""Lines in a voussoir."""
ALONG = 3
"""Points on a line: exact up to the fifth power."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Voussoirs:
    """Voussoirs from left to right.

    `corners`, (n, 4, 2): Chord polygons: both ends of the intrados, then of the extrados from
        right to left [m].
    `area`, (n,): [m^2]
    `centre`, (n, 2): Centroids [m].
    `polar`, (n,): Second moments of area about the centroids [m^4].
    `cover`, (n, 4): Over the extrados the integrals of dx, y dx, x dx and x y dx, for the
        weight of fill.
    """

    corners: Array
    area: Array
    centre: Array
    polar: Array
    cover: Array

    @property
    def faces(self) -> Array:
        """Joints from left to right, inner and outer end, shape (n + 1, 2, 2) [m]."""
        left, right = self.corners[:, [0, 3]], self.corners[-1:, [1, 2]]
        return np.concatenate([left, right])

    def mirrored(self) -> Voussoirs:
        """Return those on the other side of x = 0, again from left to right."""
        flip = np.array([-1.0, 1.0])
        return Voussoirs(
            corners=self.corners[::-1, [1, 0, 3, 2]] * flip,
            area=self.area[::-1],
            centre=self.centre[::-1] * flip,
            polar=self.polar[::-1],
            cover=self.cover[::-1] * np.array([1.0, 1.0, -1.0, -1.0]),
        )

    def and_then(self, other: Voussoirs) -> Voussoirs:
        """Return these, and others to the right of them."""
        mine, others = vars(self), vars(other)
        return Voussoirs(**{name: np.concatenate([mine[name], others[name]]) for name in mine})


def strips(curve: Curve, thickness: float, inner: Array, outer: Array) -> Voussoirs:
    """Measure voussoirs between the two offsets of a centreline.

    `thickness`: [m]
    `inner`, `outer`, (n + 1,): Parameters at which joints meet intrados and extrados.
    """
    half = thickness / 2
    owner, low, high = _parts(curve, inner, outer)
    nodes, weights = gauss(ACROSS)
    u = low[:, None] + (high - low)[:, None] * nodes
    weight = (high - low)[:, None] * weights
    ends: list[tuple[Array, Array]] = []
    for at, offset in ((inner, -half), (outer, half)):
        wide = np.diff(at)[owner][:, None]
        s = at[:-1][owner][:, None] + wide * u
        ends.append((curve.point(s, offset), curve.slope(s, offset) * wide[..., None]))
    (below, along_below), (above, along_above) = ends
    count = len(inner) - 1
    base = curve.point(inner[:-1], -half)
    origin = base[owner][:, None]
    area, first, second = np.zeros(count), np.zeros((count, 2)), np.zeros(count)
    up = above - below
    for v, share in zip(*gauss(ALONG), strict=True):
        arm = below + v * up - origin
        along = along_below + v * (along_above - along_below)
        part = share * weight * (along[..., 0] * up[..., 1] - along[..., 1] * up[..., 0])
        np.add.at(area, owner, part.sum(axis=1))
        np.add.at(first, owner, (part[..., None] * arm).sum(axis=1))
        np.add.at(second, owner, (part * (arm * arm).sum(axis=-1)).sum(axis=1))
    shift = first / area[:, None]
    cover = np.zeros((count, 4))
    (x, y), dx = np.moveaxis(above, -1, 0), weight * along_above[..., 0]
    for column, each in enumerate((dx, y * dx, x * dx, x * y * dx)):
        np.add.at(cover[:, column], owner, each.sum(axis=1))
    under, over = curve.point(inner, -half), curve.point(outer, half)
    return Voussoirs(
        corners=np.stack([under[:-1], under[1:], over[1:], over[:-1]], axis=1),
        area=area,
        centre=base + shift,
        polar=second - area * (shift * shift).sum(axis=1),
        cover=cover,
    )


def _parts(curve: Curve, inner: Array, outer: Array) -> tuple[Indices, Array, Array]:
    """Cut voussoirs where the curvature jumps: whose part, and from where to where."""
    owner: list[int] = []
    low: list[float] = []
    high: list[float] = []
    for index in range(len(inner) - 1):
        cuts = {0.0, 1.0}
        for at in (inner, outer):
            start, end = at[index], at[index + 1]
            cuts |= {(jump - start) / (end - start) for jump in curve.breaks}
        inside = sorted(cut for cut in cuts if 0 <= cut <= 1)
        owner += [index] * (len(inside) - 1)
        low += inside[:-1]
        high += inside[1:]
    return np.array(owner, dtype=np.int64), np.array(low), np.array(high)


def chords(corners: Array) -> Voussoirs:
    """Measure voussoirs with straight faces.

    `corners`, (n, 4, 2): As of `Voussoirs`.
    """
    base = corners[:, :1]
    arm = corners - base
    ahead = np.roll(arm, -1, axis=1)
    turn = arm[..., 0] * ahead[..., 1] - arm[..., 1] * ahead[..., 0]
    area = turn.sum(axis=1) / 2
    shift = (turn[..., None] * (arm + ahead)).sum(axis=1) / (6 * area[:, None])
    square = (arm * arm + arm * ahead + ahead * ahead).sum(axis=-1)
    right, left = corners[:, 2], corners[:, 3]
    dx = right[:, 0] - left[:, 0]
    x, y = ((right + left) / 2).T
    bow = dx * (right[:, 0] - left[:, 0]) * (right[:, 1] - left[:, 1]) / 12
    return Voussoirs(
        corners=corners,
        area=area,
        centre=corners[:, 0] + shift,
        polar=(turn * square).sum(axis=1) / 12 - area * (shift * shift).sum(axis=1),
        cover=np.stack([dx, y * dx, x * dx, x * y * dx + bow], axis=1),
    )
