"""Loads spread evenly over a width: which blocks bear them, and where."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import Array

Share = tuple[int, float, Array]
"""Body, share of the load, and the point at which that acts [m]."""


def shares(low: float, high: float, bodies: Sequence[Sequence[Array]]) -> list[Share] | None:
    """Find what lies uppermost along a width, which bears what is put there.

    Parameters
    ----------
    low, high : float
        Ends of the width, along x [m].
    bodies : sequence of sequences of (k, 2) float
        Convex polygons of each body [m], which do not overlap.

    Returns
    -------
    list of (int, float, (2,) float) or None
        None where somewhere along the width there is no body.
    """
    corners = np.concatenate([polygon for body in bodies for polygon in body])[:, 0]
    inside = corners[(corners > low) & (corners < high)]
    # Between corners what lies uppermost stays the same, and its top is straight.
    edges = np.unique(np.concatenate([[low, high], inside]))
    found: list[Share] = []
    for left, right in itertools.pairwise(edges):
        middle = (left + right) / 2
        tops = [
            (_top(polygon, middle), index)
            for index, body in enumerate(bodies)
            for polygon in body
            if polygon[:, 0].min() < middle < polygon[:, 0].max()
        ]
        if not tops:
            return None
        top, index = max(tops)
        share = float((right - left) / (high - low))
        found.append((index, share, np.array([middle, top])))
    return found


def _top(polygon: Array, x: float) -> float:
    """Height of a polygon's upper side at a place."""
    following = np.roll(polygon, -1, axis=0)
    start = np.minimum(polygon[:, 0], following[:, 0])
    over = (start <= x) & (np.maximum(polygon[:, 0], following[:, 0]) >= x)
    over &= polygon[:, 0] != following[:, 0]
    one, two = polygon[over], following[over]
    height = one[:, 1] + (x - one[:, 0]) / (two[:, 0] - one[:, 0]) * (two[:, 1] - one[:, 1])
    return float(height.max())
