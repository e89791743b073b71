"""Polygons as regions of the plane: cut into convex parts, near each other, overlapping.

The one file that imports shapely.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import shapely
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import is_convex, joined, outwards
from blocksim.blocks.touching import Faces, Index, Slack
from blocksim.common.checks import require

MOST_NEAR = 100
"""Pairs of faces near each other, for each face: blocks have a handful."""
FINEST = 1e-8
"""Step to which corners are rounded where parts of a body are put together, over its size."""
FIRST_LOOK, LONGEST_LOOK = 4, 16_384
"""Polygons whose neighbours are looked up at once: few at first, for an error is found soon."""


def is_simple(outline: Array) -> bool:
    """Tell whether a polygon does not cross itself."""
    return bool(shapely.Polygon(outline).is_valid)


def convex_parts(outline: Array, tolerance: float) -> list[Array]:
    """Cut a counter-clockwise polygon that does not cross itself into convex ones."""
    if is_convex(outline, 0.0) or is_convex(outline, tolerance):
        return [outline]
    triangles = shapely.constrained_delaunay_triangles(shapely.Polygon(outline))
    pieces = [_corners(piece) for piece in shapely.get_parts(triangles)]
    return list(joined(pieces, 0.0))


def overlap_each_other(parts: Sequence[Array], tolerance: float) -> bool:
    """Tell whether polygons that move as one overlap each other."""
    regions = [shapely.Polygon(part) for part in parts]
    twice = sum(region.area for region in regions) - shapely.union_all(regions).area
    around = sum(region.length for region in regions)
    return twice > tolerance * around


def between(lines: Sequence[Sequence[tuple[float, float]]]) -> list[list[tuple[float, float]]]:
    """Return the outlines of the regions between lines that meet at their ends only."""
    found: Any = shapely.polygonize([shapely.LineString(line) for line in lines])
    return [list(region.exterior.coords)[:-1] for region in found.geoms]


def hull(parts: Sequence[Array]) -> Array:
    """Return the convex hull of polygons, counter-clockwise; of what has no width an end."""
    return _corners(shapely.MultiPoint(np.concatenate(parts)).convex_hull)


def rings(parts: Sequence[Array]) -> list[Array]:
    """Return the rims of what polygons that touch cover, the body to the left, (k, 2) each.

    Sides within `FINEST` of their size lie on each other.
    """
    size = float(np.ptp(np.concatenate(parts), axis=0).max())
    # A power of ten, so that round numbers stay what they are.
    grid = 10.0 ** np.floor(np.log10(FINEST * size))
    whole = shapely.union_all([shapely.Polygon(part) for part in parts], grid_size=grid)
    turned: Any = shapely.orient_polygons(whole)
    found = [
        ring for each in shapely.get_parts(turned) for ring in (each.exterior, *each.interiors)
    ]
    return [shapely.get_coordinates(ring)[:-1] for ring in found]


def _corners(region: Any) -> Array:
    """Return the corners of shapely's polygon, counter-clockwise."""
    return shapely.get_coordinates(shapely.orient_polygons(region))[:-1]


def overlaps(
    parts: Sequence[Sequence[Array]], fixed: NDArray[np.bool_], slack: Slack, most: int
) -> list[tuple[int, int, float]]:
    """Find bodies that overlap by more than `slack.close`, in order; not more than asked for.

    `parts`, sequence of sequences of (k, 2): Convex ones of each body.
    `fixed`, (bodies,): Those may overlap each other.
    `most`: Stop there: the first is enough to refuse a drawing.
    Returns list of (one, other, depth): Twice the common area over its perimeter [m].
    """
    owner = np.repeat(np.arange(len(parts)), [len(each) for each in parts])
    each_one = [part for each in parts for part in each]
    which = np.repeat(np.arange(len(each_one)), [len(part) for part in each_one])
    rings: Any = cast(Any, shapely).linearrings(np.concatenate(each_one), indices=which)
    regions: Any = cast(Any, shapely).polygons(rings)
    boxes: Any = cast(Any, shapely).bounds(regions)
    tree, found = shapely.STRtree(regions), list[tuple[int, int, float]]()
    begin, step = 0, FIRST_LOOK
    while begin < len(regions) and len(found) < most:
        looked: Any = tree.query(regions[begin : begin + step], predicate="intersects")
        one, other = looked[0] + begin, looked[1]
        real = (owner[one] < owner[other]) & ~(fixed[owner[one]] & fixed[owner[other]])
        one, other = one[real], other[real]
        close = slack.at(owner[one], owner[other]).close
        # No overlap is deeper than the box around it is narrow.
        low, high = np.maximum(boxes[one], boxes[other]), np.minimum(boxes[one], boxes[other])
        wide: Any = (high[:, 2:] - low[:, :2]).min(axis=1) > close
        one, other, close = one[wide], other[wide], close[wide]
        common: Any = cast(Any, shapely).intersection(regions[one], regions[other])
        area, around = cast(Any, shapely).area(common), cast(Any, shapely).length(common)
        depth = np.divide(2 * area, around, out=np.zeros_like(area), where=around > 0)
        # Of sides that all but coincide GEOS may say that they have a whole polygon in common.
        deep = [
            k
            for k in np.flatnonzero(depth > close).tolist()
            if _into(each_one[int(one[k])], each_one[int(other[k])]) > close[k]
        ]
        found += [(int(owner[one[k]]), int(owner[other[k]]), float(depth[k])) for k in deep]
        begin, step = begin + step, min(4 * step, LONGEST_LOOK)
    return sorted(found)[:most]


def depths(
    bodies: Sequence[Sequence[Array]], fixed: NDArray[np.bool_]
) -> dict[tuple[int, int], float]:
    """Find how deep bodies that meet are in each other [m], but fixed ones; 0 where they touch.

    `bodies`, sequence of sequences of (k, 2): Convex ones of each body.
    """
    owner = np.repeat(np.arange(len(bodies)), [len(each) for each in bodies])
    parts = [part for each in bodies for part in each]
    regions = [shapely.Polygon(part) for part in parts]
    looked: Any = shapely.STRtree(regions).query(regions, predicate="intersects")
    near: list[tuple[int, int]] = looked.T.tolist()
    found: dict[tuple[int, int], float] = {}
    for one, other in near:
        pair = int(owner[one]), int(owner[other])
        if pair[0] < pair[1] and not (fixed[pair[0]] and fixed[pair[1]]):
            deep = max(found.get(pair, 0.0), _into(parts[one], parts[other]))
            found[pair] = deep
    return found


def _into(one: Array, other: Array) -> float:
    """Return how deep convex polygons are in each other, along the normal where it is least."""
    apart = -math.inf
    for each, beside in ((one, other), (other, one)):
        out = outwards(each)
        real = out.any(axis=1)
        beyond = ((beside[:, None] - each[real]) * out[real]).sum(axis=2)
        apart = max(apart, float(beyond.min(axis=0).max()))
    return -apart


def near_faces(faces: Faces, fixed: NDArray[np.bool_], slack: Slack) -> NDArray[np.int64]:
    """Find pairs of faces of different bodies, not both fixed, that may be within `slack.near`.

    Pairs that are farther apart are left out where a line along one of them tells.

    Returns (pairs, 2): Each pair once.
    """
    along = faces.along
    low, high = np.minimum(faces.start, faces.end), np.maximum(faces.start, faces.end)
    box: Any = shapely.box
    tree, pairs = shapely.STRtree(box(*low.T, *high.T)), list[NDArray[np.int64]]()
    reach = slack.near[faces.body]
    reach = np.where(np.isfinite(reach), reach, reach[np.isfinite(reach)].max(initial=0.0))
    # What is fixed looks for nothing: all it touches looks for it.
    looking = np.flatnonzero(~fixed[faces.body])
    count, allowed = 0, MOST_NEAR * (len(low) + MOST_NEAR)
    begin, step = 0, FIRST_LOOK
    while begin < len(looking):
        here = looking[begin : begin + step]
        way = reach[here, None]
        at, other = tree.query(box(*(low[here] - way).T, *(high[here] + way).T))
        one = here[at]
        a, b = faces.body[one], faces.body[other]
        real = (a != b) & (fixed[b] | (one < other))
        one, other = one[real], other[real]
        real = _beside(faces, along, one, other, reach[one])
        real &= _beside(faces, along, other, one, reach[one])
        pairs.append(np.stack([one[real], other[real]], axis=1).astype(np.int64))
        count += len(pairs[-1])
        require(count <= allowed, "blocks", f"{count} pairs of faces", "apart from each other")
        begin, step = begin + step, min(4 * step, LONGEST_LOOK)
    return np.concatenate(pairs)


def _beside(
    faces: Faces, along: Array, one: Index, other: Index, reach: Array
) -> NDArray[np.bool_]:
    """Tell which other faces come within reach of the lines along faces."""
    (x, y), (u, v) = faces.start[one].T, along[one].T
    begin, end = (u * (at[:, 1] - y) - v * (at[:, 0] - x)
                  for at in (faces.start[other], faces.end[other]))  # fmt: skip
    return (np.minimum(begin, end) <= reach) & (np.maximum(begin, end) >= -reach)
