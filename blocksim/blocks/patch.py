"""Loads at a place or spread evenly over a width: which blocks bear them, and where."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import Array

Share = tuple[int, float, Array]
"""Body, share of the load, and the point at which that acts [m]."""
LEVEL = 1e-9
"""Difference in height that counts as none, over the width of all bodies."""


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


def shares_at(x: float, bodies: Sequence[Sequence[Array]]) -> list[Share] | None:
    """Find what lies uppermost at a place, which bears what is put there.

    Parameters
    ----------
    x : float
        The place [m].
    bodies : sequence of sequences of (k, 2) float
        As of `shares`; where a body and others behind it are as high, as at a joint, they
        share it evenly.

    Returns
    -------
    list of (int, float, (2,) float) or None
        None where there is no body.
    """
    corners = np.concatenate([polygon for body in bodies for polygon in body])[:, 0]
    tops: dict[int, float] = {}
    for index, body in enumerate(bodies):
        over = [each for each in body if each[:, 0].min() <= x <= each[:, 0].max()]
        if over:
            tops[index] = max(_top(polygon, x) for polygon in over)
    if not tops:
        return None
    least = max(tops.values()) - LEVEL * float(np.ptp(corners))
    highest = [index for index, top in tops.items() if top >= least]
    return [(index, 1 / len(highest), np.array([x, tops[index]])) for index in highest]


def _top(polygon: Array, x: float) -> float:
    """Height of a polygon's upper side at a place."""
    following = np.roll(polygon, -1, axis=0)
    start = np.minimum(polygon[:, 0], following[:, 0])
    over = (start <= x) & (np.maximum(polygon[:, 0], following[:, 0]) >= x)
    over &= polygon[:, 0] != following[:, 0]
    one, two = polygon[over], following[over]
    height = one[:, 1] + (x - one[:, 0]) / (two[:, 0] - one[:, 0]) * (two[:, 1] - one[:, 1])
    return float(height.max())
