"""Rectangles and piers, of which several kinds consist."""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.given import Body


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
    name: str, foot: tuple[float, float], head: tuple[float, float], low: float, high: float,
    courses: int, depth: float,
) -> list[Body]:  # fmt: skip
    """Make a pier of courses as high, between two x at its foot and two at its head [m]."""
    levels = low + (high - low) * np.arange(courses + 1) / courses
    levels[-1] = high
    share = np.arange(courses + 1)[:, None] / courses
    ends = np.array(foot) * (1 - share) + np.array(head) * share
    return [
        Body(polygons=(_course(ends, levels, index),), name=f"{name} {index + 1}", depth=depth)
        for index in range(courses)
    ]


def _course(ends: Array, levels: Array, index: int) -> Array:
    (left, right), (upper_left, upper_right) = ends[index], ends[index + 1]
    low, high = levels[index], levels[index + 1]
    return np.array([[left, low], [right, low], [upper_right, high], [upper_left, high]])


def floor(left: float, right: float, top: float, thick: float) -> Body:
    """Make a fixed bed below two x [m]."""
    return box("floor", (left, right), (top - thick, top), fixed=True)
