"""Rectangles and piers, of which several kinds consist."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

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


def floor(left: float, right: float, top: float, thick: float) -> Body:
    """Make a fixed bed below two x [m]."""
    return box("floor", (left, right), (top - thick, top), fixed=True)
