"""Rectangles, piers, their heads and the fill on them, of which several kinds consist."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from blocksim.blocks.given import Body
from blocksim.blocks.made import Fill

Place = tuple[float, float]
"""x and y [m]."""


def box(
    name: str,
    across: tuple[float, float],
    up: tuple[float, float],
    *,
    depth: float = 1.0,
    fixed: bool = False,
) -> Body:
    """Make a rectangle between two x and two y [m]."""
    (left, right), (low, high) = across, up
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    return Body(polygons=(corners,), name=name, fixed=fixed, depth=depth)


def pier(
    name: str, foot: Sequence[float], head: Sequence[float], low: float, high: float,
    courses: int, depth: float,
) -> list[Body]:  # fmt: skip
    """Make a pier of courses as high, between two x at its foot and two at its head [m]."""
    levels = low + (high - low) * np.arange(courses + 1) / courses
    levels[-1] = high
    share = np.arange(courses + 1)[:, None] / courses
    ends = np.array(foot) * (1 - share) + np.array(head) * share
    rows = np.stack([ends, np.repeat(levels[:, None], 2, axis=1)], axis=-1)
    return [
        Body(polygons=(np.concatenate([low, high[::-1]]),), name=f"{name} {at}", depth=depth)
        for at, (low, high) in enumerate(pairwise(rows), 1)
    ]


def head(
    name: str, ends: Sequence[float], low: float, left: Place, right: Place, near: float,
    depth: float,
) -> list[Body]:  # fmt: skip
    """Make the block between the level head of a pier and its own top, where that is higher.

    `ends`, `low`: Two x of the pier's head, and its height [m].
    `left`, `right`: Ends of the top.
    `near`: Height, and width of the top, that is none [m].
    """
    if max(left[1], right[1]) - low <= near:
        return []
    corners = [(ends[0], low), (ends[1], low), right, left]
    if right[0] - left[0] <= near:
        corners = corners[:3]
    return [Body(polygons=(np.array(corners),), name=name, depth=depth)]


def fill_over(body: int, left: Place, right: Place, road: float, heavy: float) -> list[Fill]:
    """Return the weight of fill on a body: up to a road, over a line between two places.

    `road`: Its height [m].
    `heavy`: Weight of an area [N/m^2].
    """
    wide, deep = right[0] - left[0], road - (left[1] + right[1]) / 2
    if wide * deep <= 0:
        return []
    lean = (left[1] - right[1]) / 2
    middle = (left[0] + right[0]) / 2 + wide * lean / (6 * deep)
    place = middle, max(left[1], right[1])
    return [Fill(body=body, weight=heavy * (wide * deep), point=place)]


def floor(left: float, right: float, top: float, thick: float) -> Body:
    """Make a fixed bed below two x [m]."""
    return box("floor", (left, right), (top - thick, top), fixed=True)
