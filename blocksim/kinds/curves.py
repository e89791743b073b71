"""Centrelines of arches: points, offsets, and where joints meet them."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from blocksim.blocks.assembly import Array

PANELS = 64
"""Parts of a curve in each of which its length is found by one quadrature."""
NODES = 24
HALVINGS = 60
"""Of an interval, until nothing is left of it."""

Function = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A centreline from the left springing to the right, which only ever turns to the right.

    Parameters
    ----------
    start, end : float
        Range of its parameter.
    at, first, second : callable
        x and y at parameters, and their derivatives.
    breaks : tuple of float
        Parameters at which the curvature jumps.
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
        marks = total[1:-1].tolist()
        panel = np.array([bisect(marks, each) for each in wanted.tolist()], dtype=np.int64)
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


@cache
def gauss(count: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss and Legendre on the interval from 0 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (nodes + 1) / 2, weights / 2
