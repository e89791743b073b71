"""Where two convex polyhedra touch: a polygon, a segment, a point, or not at all."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import width
from blocksim.blocks.space.polyhedron import SAME, Polyhedron, frame

Spot = tuple[float, float]
"""A point in a plane."""
PARALLEL = 1e-9
"""Sine of the angle below which two edges have one direction."""
RIM = 0.01
"""Share of the slack by which bodies that touch exactly may be apart, or within each other."""
RIMS = 4.0
"""Slacks to the side up to which edges that cross are rims of faces along each other."""
ALONG = 0.999
"""Cosine below which planes cross: what is within two of them is narrower than the slack."""


class Contact(NamedTuple):
    """Where two polyhedra touch.

    `points`, (k, 3): Corners of a polygon, ends of a segment, or a point [m].
    `normal`, (3,): Unit normal, from the first into the second.
    `gap`: How far apart they are drawn, below 0 where they overlap [m].
    """

    points: Array
    normal: Array
    gap: float


class Overlap(NamedTuple):
    """Two polyhedra that lie within each other by a depth [m]."""

    depth: float


def contact(first: Polyhedron, second: Polyhedron, slack: float) -> Contact | Overlap | None:
    """Find where two polyhedra touch.

    Planes that part them are those of their faces, and those along an edge of each
    (separating axes; Gottschalk, Lin and Manocha 1996).

    `slack`: Gaps and overlaps up to this are closed [m].
    Returns: None where they do not touch, or along the rim of their faces only.
    """
    normals, gaps = _by_faces(first, second)
    deepest = float(gaps.max())
    if deepest > slack:
        return None
    if abs(deepest) <= RIM * slack and _at_rim(normals[gaps >= -RIM * slack]):
        return None
    found = _touching(first, second, normals, gaps, slack)
    if not found:
        normals, gaps = _by_edges(first, second)
        widest = float(gaps.max(initial=deepest))
        if widest > slack:
            return None
        if widest < -slack:
            return Overlap(-widest)
        found = _touching(first, second, normals, gaps, slack, deep=deepest < -slack)
    return max(found, key=lambda each: _extent(each.points), default=None)


def _touching(
    first: Polyhedron,
    second: Polyhedron,
    normals: Array,
    gaps: Array,
    slack: float,
    *,
    deep: bool = False,
) -> list[Contact]:
    """Return contacts at planes that part two polyhedra.

    `deep`: Whether no plane of a face parts them. Else edges that lie along each other are rims
        of faces.
    """
    found: list[Contact] = []
    tried: list[Array] = []
    for index in np.argsort(-gaps).tolist():
        if gaps[index] < -slack:
            break
        # A face of each lies in the same plane.
        if any(normals[index] @ other > SAME for other in tried):
            continue
        tried.append(normals[index])
        points = _common(first, second, normals[index], slack, deep=deep)
        if points is not None:
            found.append(Contact(points, normals[index], float(gaps[index])))
    return found


def _at_rim(normals: Array) -> bool:
    """Tell whether planes that part two bodies, which touch at each, have two directions.

    All that is common lies in both then: at most a line along the rim of a face.
    """
    return bool((np.abs(normals @ normals[0]) < ALONG).any())


def _by_faces(first: Polyhedron, second: Polyhedron) -> tuple[Array, Array]:
    """Return the normals of all faces, from the first into the second, and the gaps there."""
    (ours, ends), (theirs, beyond) = first.planes, second.planes
    gaps = np.concatenate(
        [
            (ours @ second.corners.T).min(axis=1) - ends,
            (theirs @ first.corners.T).min(axis=1) - beyond,
        ]
    )
    return np.concatenate([ours, -theirs]), gaps


def _by_edges(first: Polyhedron, second: Polyhedron) -> tuple[Array, Array]:
    """Return the same of planes along an edge of each."""
    ours = first.edges[:, 1] - first.edges[:, 0]
    theirs = second.edges[:, 1] - second.edges[:, 0]
    ours = ours / np.linalg.norm(ours, axis=1)[:, None]
    theirs = theirs / np.linalg.norm(theirs, axis=1)[:, None]
    normals = np.cross(ours[:, None], theirs[None]).reshape(-1, 3)
    sines = np.linalg.norm(normals, axis=1)
    normals = normals[sines > PARALLEL] / sines[sines > PARALLEL, None]
    normals = np.concatenate([normals, -normals])
    if not len(normals):
        return normals, np.zeros(0)
    gaps = (normals @ second.corners.T).min(axis=1) - (normals @ first.corners.T).max(axis=1)
    return normals, gaps


def _common(
    first: Polyhedron, second: Polyhedron, normal: Array, slack: float, *, deep: bool
) -> Array | None:
    """Return what is common to the parts of two polyhedra that lie at a plane between them.

    `deep`: As of `_touching`.
    Returns: None where it has fewer dimensions than both parts: they meet at a rim.
    """
    heights, beyond = first.corners @ normal, second.corners @ normal
    high, low = heights.max(), beyond.min()
    across = frame(normal)
    ours = _outline(first.corners[heights >= high - 2 * slack] @ across.T)
    theirs = _outline(second.corners[beyond <= low + 2 * slack] @ across.T)
    shared = _clipped(ours, theirs, slack, 0.0 if deep else RIMS * slack)
    needed = min(len(ours), len(theirs), 3)
    if len(shared) < needed:
        # Two edges that cross share a point.
        crossing = len(ours) == len(theirs) == 2 and len(shared) == 1
        if not (crossing and _cross(ours, theirs)):
            return None
    elif len(ours) == len(theirs) == 2 and not deep:
        return None
    if needed == 3 and _is_narrow(shared, slack):
        return None
    return np.array(shared).reshape(-1, 2) @ across + (high + low) / 2 * normal


def _spots(points: Array) -> list[Spot]:
    """Return the points of an array, (k, 2)."""
    return [(x, y) for x, y in points.tolist()]


def _outline(points: Array) -> list[Spot]:
    """Return the corners of the hull of points in the plane, counter-clockwise.

    Andrew's monotone chain; points on a line are its two ends.
    """
    order = sorted(_spots(points))
    heights = [y for _, y in order]
    scale = max(order[-1][0] - order[0][0], max(heights) - min(heights), 1e-300)

    def chain(ordered: list[Spot]) -> list[Spot]:
        found: list[Spot] = []
        for point in ordered:
            while len(found) > 1 and _turn(found[-2], found[-1], point) <= 1e-12 * scale**2:
                found.pop()
            if (
                not found
                or max(abs(found[-1][0] - point[0]), abs(found[-1][1] - point[1]))
                > 1e-12 * scale
            ):
                found.append(point)
        return found

    if len(order) == 1:
        return order
    lower, upper = chain(order), chain(order[::-1])
    return [*lower[:-1], *upper[:-1]] if len(lower) > 1 else lower


def _turn(a: Spot, b: Spot, c: Spot) -> float:
    """Return twice the area of a triangle, above 0 counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _clipped(ours: list[Spot], theirs: list[Spot], slack: float, aside: float) -> list[Spot]:
    """Return what a point, segment or convex polygon has in common with another.

    Sutherland and Hodgman 1974. Points nearer than `slack` are one.

    `aside`: How far the shorter of segments that cross has to go to the side of the other [m].
    """
    if len(theirs) < 3 <= len(ours):
        ours, theirs = theirs, ours
    kept = ours
    if len(theirs) >= 3:
        for start, end in zip(theirs, theirs[1:] + theirs[:1], strict=True):
            kept = _inside(kept, start, end, slack)
    elif len(theirs) == 2 and len(kept) == 2:
        kept = _segments(np.array(kept), np.array(theirs), slack, aside)
    else:
        # A corner on a corner, or on an edge, has no plane of its own.
        kept = []
    return _apart(kept, slack)


def _inside(kept: list[Spot], start: Spot, end: Spot, slack: float) -> list[Spot]:
    """Keep what lies to the left of a line; a point or a segment on it, too."""
    long = math.dist(start, end)
    if not (long and kept):
        return kept
    # A polygon is cut at the line; fewer corners have to be well inside.
    least = 0.0 if len(kept) > 2 else slack
    sides = [_turn(start, end, each) / long - least for each in kept]
    if len(kept) == 1:
        return kept if sides[0] > 0 else []
    found: list[Spot] = []
    pairs = range(len(kept)) if len(kept) > 2 else range(1)
    for at in pairs:
        here, there = kept[at], kept[(at + 1) % len(kept)]
        a, b = sides[at], sides[(at + 1) % len(kept)]
        if a >= 0:
            found.append(here)
        if a * b < 0:
            share = a / (a - b)
            x = here[0] + share * (there[0] - here[0])
            found.append((x, here[1] + share * (there[1] - here[1])))
        if len(kept) == 2 and b >= 0:
            found.append(there)
    return found


def _segments(ours: Array, theirs: Array, slack: float, aside: float) -> list[Spot]:
    """Return what two segments have in common: a point where they cross, or a piece."""
    along = ours[1] - ours[0]
    long = float(np.hypot(*along))
    along = along / long
    side = np.array([-along[1], along[0]])
    off = (theirs - ours[0]) @ side
    at = (theirs - ours[0]) @ along
    if np.abs(off).max() <= slack:
        low, high = max(0.0, at.min()), min(long, at.max())
        return _spots(ours[0] + np.outer([low, high], along)) if high > low + slack else []
    if off[0] * off[1] >= 0:
        return []
    place = at[0] + off[0] / (off[0] - off[1]) * (at[1] - at[0])
    far = abs(off[1] - off[0]) * min(1.0, long / math.dist(*_spots(theirs)))
    crosses = far > aside and 0 < place < long
    return _spots((ours[0] + place * along)[None]) if crosses else []


def _cross(ours: list[Spot], theirs: list[Spot]) -> bool:
    """Tell whether two segments have two directions."""
    (a, b), (c, d) = ours, theirs
    turned = (b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0])
    return abs(turned) > PARALLEL * math.dist(a, b) * math.dist(c, d)


def _apart(points: list[Spot], slack: float) -> list[Spot]:
    """Leave out points nearer than `slack` to a neighbour, or to the line between both."""
    found: list[Spot] = []
    for point in points:
        near = (found[-1], found[0]) if found else ()
        if all(math.dist(point, each) > slack for each in near):
            found.append(point)
    at = 0
    while len(found) > 3 and at < len(found):
        before, after = found[at - 1], found[(at + 1) % len(found)]
        if abs(_turn(before, after, found[at])) <= slack * math.dist(before, after):
            del found[at]
        else:
            at += 1
    return found


def _is_narrow(around: list[Spot], slack: float) -> bool:
    """Tell whether the least width of a convex polygon is no more than that."""
    pairs = list(zip(around, around[1:] + around[:1], strict=True))
    area = sum(_turn(around[0], *each) for each in pairs) / 2
    # It is not below the area over half the way around.
    wide = 2 * area > slack * sum(math.dist(*each) for each in pairs)
    return not wide and width(np.array(around)) <= slack


def _extent(points: Array) -> tuple[int, float]:
    """Return dimensions and size of a contact, by which it is chosen."""
    dimensions = min(len(points), 3)
    return dimensions, float(np.linalg.norm(np.ptp(points, axis=0)))
