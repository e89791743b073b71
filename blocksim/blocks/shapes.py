"""Bodies as they are written down, checked, mended and cut into convex parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.given import Body
from blocksim.blocks.outlines import are_plain, mended
from blocksim.blocks.regions import convex_parts, is_simple, overlap_each_other
from blocksim.common.checks import require
from blocksim.common.errors import InputError

MOST_CORNERS = 1_000
"""Of one block."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A body mended: faces of its outlines, and convex parts."""

    outlines: tuple[Array, ...]
    parts: tuple[Array, ...]


def name_of(bodies: Sequence[Body], index: int) -> str:
    """Return the name of a body, or its number."""
    return bodies[index].name or str(index)


def finite(body: Body, index: int) -> tuple[Array, ...]:
    """Check the numbers of a body; return its polygons."""
    field = f"blocks[{index}].vertices"
    polygons: list[Array] = []
    for corners in body.polygons:
        try:
            polygon = np.array(corners, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(field, corners, "pairs of numbers") from None
        require(polygon.ndim == 2 and polygon.shape[1] == 2, field, corners, "pairs of numbers")
        require(len(polygon) >= 3, field, corners, "at least three corners")
        require(bool(np.isfinite(polygon).all()), field, corners, "finite numbers")
        polygons.append(polygon)
    require(bool(polygons), field, "no polygon", "at least three corners")
    corners = sum(len(polygon) for polygon in polygons)
    require(corners <= MOST_CORNERS, field, f"{corners} corners", f"at most {MOST_CORNERS}")
    return tuple(polygons)


def shapes_of(
    raw: Sequence[tuple[Array, ...]], bodies: Sequence[Body], exact: Array, notes: list[str]
) -> list[Shape]:
    """Mend all bodies; those with nothing to be mended are told all at once."""
    plain = are_plain([polygons[0] for polygons in raw], exact)
    return [
        Shape(polygons, polygons)
        if len(polygons) == 1 and plain[index]
        else _shape(polygons, bodies, index, float(exact[index]), notes)
        for index, polygons in enumerate(raw)
    ]


def _shape(
    polygons: tuple[Array, ...],
    bodies: Sequence[Body],
    index: int,
    tolerance: float,
    notes: list[str],
) -> Shape:
    """Mend the polygons of a body and cut them into convex parts."""
    field = f"blocks[{index}].vertices"
    outlines: list[Array] = []
    parts: list[Array] = []
    for polygon in polygons:
        outline, done = mended(polygon, tolerance)
        notes += [f"block {name_of(bodies, index)}: {what}" for what in done]
        said = polygon.tolist()
        require(len(outline) >= 3, field, said, "at least three corners that differ")
        require(is_simple(outline), field, said, "a polygon that does not cross itself")
        outlines.append(outline)
        parts += convex_parts(outline, tolerance)
    if len(polygons) > 1:
        apart = not overlap_each_other(parts, tolerance)
        require(apart, field, polygons, "polygons that do not overlap each other")
    return Shape(tuple(outlines), tuple(parts))
