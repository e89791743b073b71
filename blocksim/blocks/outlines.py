"""Polygons of blocks: mended, measured, and put together to convex parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.block import Array

Index = NDArray[np.int64]
STRAIGHT = 1e-3
"""A corner is straight if it is off its neighbours' line by this share of the tolerance."""
EPS = np.finfo(float).eps
MOST_DECIMALS = 12
"""Of numbers that are taken for rounded ones."""
POWERS = np.array([10.0**decimals for decimals in range(MOST_DECIMALS + 1)])


@dataclass(frozen=True, eq=False)
class Moments:
    """Area and its moments.

    `area`: [m^2]; negative for clockwise corners.
    `centroid`, (2,): [m]
    `polar`: Second moment of area about the centroid [m^4].
    """

    area: float
    centroid: Array
    polar: float


def following(corners: Array) -> Array:
    """Return for each corner the next one around."""
    return np.concatenate([corners[1:], corners[:1]])


def before(corners: Array) -> Array:
    """Return for each corner the one before it."""
    return np.concatenate([corners[-1:], corners[:-1]])


def outwards(corners: Array) -> Array:
    """Return unit normals of the sides of a counter-clockwise polygon; 0 of no length."""
    way = following(corners) - corners
    length = np.hypot(*way.T)[:, None]
    out = np.stack([way[:, 1], -way[:, 0]], axis=1)
    return np.divide(out, length, out=np.zeros_like(out), where=length > 0)


def width(polygon: Array) -> float:
    """Return the least width of a convex polygon."""
    out = outwards(polygon)
    along = polygon @ out[out.any(axis=1)].T
    return float(np.ptp(along, axis=0).min())


def distances(points: Array, ends: Array) -> Array:
    """Return how far points (..., 2) are from straight lines between two ends (..., 2, 2)."""
    start, way = ends[..., 0, :], ends[..., 1, :] - ends[..., 0, :]
    arm, square = points - start, (way * way).sum(axis=-1)
    share = np.clip((way * arm).sum(axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    off = arm - share[..., None] * way
    return np.hypot(off[..., 0], off[..., 1])


def step_of(values: Array) -> float:
    """Return the step to which numbers are rounded, by their decimals; 0 if they have many."""
    if not len(values):
        return 1.0
    one, decimals = values[:1], 0
    with np.errstate(over="ignore", invalid="ignore"):
        while decimals <= MOST_DECIMALS:
            # One number that needs more decimals is enough: how many it needs is asked at once.
            own = np.flatnonzero(_fits(one, POWERS[decimals:]))
            if not len(own):
                return 0.0
            decimals += int(own[0])
            fits = _fits(values, POWERS[decimals])
            if fits.all():
                return 10.0**-decimals
            one, decimals = values[~fits][:1], decimals + 1
    return 0.0


def _fits(values: Array, power: Array) -> NDArray[np.bool_]:
    """Tell which numbers are whole, times a power of ten."""
    scaled = values * power
    # Not to be compared is what overflows.
    return np.abs(scaled - np.round(scaled)) <= 8 * EPS * np.abs(scaled)


def signed_area(vertices: Array) -> float:
    """Return the area of a polygon, negative where its corners are clockwise."""
    x, y = (vertices - vertices[0]).T
    return 0.5 * float(np.dot(x, following(y)) - np.dot(following(x), y))


def counter_clockwise(corners: Array) -> Array:
    """Return the corners of a polygon in that order, whichever way they were."""
    return corners[::-1] if signed_area(corners) < 0 else corners


def moments(polygons: Sequence[Array]) -> Moments:
    """Measure polygons that move as one (Green's theorem, exact).

    `polygons`, sequence of (k, 2): Corners, counter-clockwise; they do not overlap.
    """
    # Plain numbers: blocks have few corners, and drawings many blocks.
    corners = polygons[0].tolist()
    x0, y0 = (sum(each) / len(corners) for each in zip(*corners, strict=True))
    area = first_x = first_y = second = 0.0
    for polygon in polygons:
        near = [(x - x0, y - y0) for x, y in polygon.tolist()]
        x, y = near[-1]
        for u, v in near:
            cross = x * v - u * y
            area += cross / 2
            first_x += cross * (x + u) / 6
            first_y += cross * (y + v) / 6
            second += cross * (x * x + y * y + x * u + y * v + u * u + v * v) / 12
            x, y = u, v
    x, y = first_x / area, first_y / area
    return Moments(area, np.array([x0 + x, y0 + y]), second - area * (x * x + y * y))


def mended(vertices: Array, tolerance: float) -> tuple[Array, list[str]]:
    """Leave out doubled and straight corners, and turn clockwise ones.

    `vertices`, (k, 2).
    `tolerance`: [m]
    Returns (k, 2): May have fewer than three corners, where there were no more.
    Returns: What was mended.
    """
    done: list[str] = []
    apart = np.hypot(*(vertices - before(vertices)).T) > tolerance
    if not apart.all():
        done.append("a doubled corner left out")
        vertices = vertices[apart]
    if len(vertices) < 3:
        return vertices, done
    back, on = vertices - before(vertices), following(vertices) - vertices
    chord = back + on
    cross = np.abs(back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0])
    forward = (back * on).sum(axis=1) > 0
    straight = forward & (cross <= STRAIGHT * tolerance * np.hypot(*chord.T))
    if straight.any():
        done.append("a corner on a straight face left out")
        vertices = vertices[~straight]
    if len(vertices) >= 3 and signed_area(vertices) < 0:
        done.append("clockwise corners turned")
        vertices = vertices[::-1]
    return vertices, done


def is_convex(vertices: Array, tolerance: float) -> bool:
    """Tell whether every corner of a counter-clockwise polygon turns left, or is straight."""
    back, on = vertices - before(vertices), following(vertices) - vertices
    cross = back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0]
    return bool((cross >= -tolerance * np.hypot(*(back + on).T)).all())


@dataclass(frozen=True, eq=False)
class Extents:
    """Measures of many bodies at once, each of one polygon or several.

    `wide`, (bodies,): Larger side of the box around it [m].
    `across`, (bodies,): Diagonal of that box [m].
    `far`, (bodies,): Largest coordinate [m].
    `area`, (bodies,): Of its polygons, whichever way they are drawn [m^2].
    """

    wide: Array
    across: Array
    far: Array
    area: Array


def extents(bodies: Sequence[Sequence[Array]]) -> Extents:
    """Measure many bodies at once."""
    polygons = [polygon for body in bodies for polygon in body]
    points, first, after = _around(polygons)
    of_body = np.cumsum([0, *(len(body) for body in bodies)])[:-1]
    start = first[of_body]
    box = np.maximum.reduceat(points, start) - np.minimum.reduceat(points, start)
    count = np.diff(np.append(first, len(points)))
    near = points - np.repeat(points[first], count, axis=0)
    cross = near[:, 0] * near[after, 1] - near[after, 0] * near[:, 1]
    return Extents(
        box.max(axis=1),
        np.hypot(*box.T),
        np.maximum.reduceat(np.abs(points).max(axis=1), start),
        np.add.reduceat(np.abs(np.add.reduceat(cross, first)) / 2, of_body),
    )


def are_plain(polygons: Sequence[Array], tolerance: Array) -> NDArray[np.bool_]:
    """Tell which of many polygons have nothing to be mended: convex, and counter-clockwise.

    `polygons`, sequence of (k, 2).
    `tolerance`, (polygons,): As of `mended` [m].
    """
    points, first, after = _around(polygons)
    count = np.diff(np.append(first, len(points)))
    on = points[after] - points
    back = np.empty_like(on)
    back[after] = on
    cross = back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0]
    dot = (back * on).sum(axis=1)
    slack = np.repeat(tolerance, count)
    fine = (np.hypot(*on.T) > slack) & (cross > STRAIGHT * slack * np.hypot(*(back + on).T))
    # Stars turn left everywhere, too, but twice around.
    turned = np.add.reduceat(np.arctan2(cross, dot), first)
    return np.logical_and.reduceat(fine, first) & (turned < 3 * np.pi)


def _around(polygons: Sequence[Array]) -> tuple[Array, Index, Index]:
    """All corners in a row, where each polygon begins, and for each corner the next one."""
    count = np.array([len(polygon) for polygon in polygons])
    first = np.cumsum(count) - count
    after = np.arange(1, int(count.sum()) + 1)
    after[first + count - 1] = first
    return np.concatenate(polygons), first, after


def joined(pieces: Sequence[Array], tolerance: float) -> tuple[Array, ...]:
    """Join convex pieces that share a side as long as they stay convex.

    Greedy, after Hertel and Mehlhorn (1983): at most four times as many parts as needed.

    `pieces`, sequence of (k, 2): Convex, counter-clockwise, sides shared whole: a
        triangulation.
    `tolerance`: How far a part may be from convex [m].
    """
    parts = [[(float(x), float(y)) for x, y in piece] for piece in pieces]
    tried = 0
    while tried < len(parts):
        for other in range(tried + 1, len(parts)):
            one = _across_side(parts[tried], parts[other])
            if one is not None and is_convex(np.array(one), tolerance):
                parts[tried] = one
                del parts[other]
                break
        else:
            tried += 1
    return tuple(np.array(part) for part in parts)


def _across_side(
    one: list[tuple[float, float]], other: list[tuple[float, float]]
) -> list[tuple[float, float]] | None:
    """Join two polygons across the side they share; None where they share none."""
    sides = {(other[k - 1], other[k]): k for k in range(len(other))}
    for k in range(len(one)):
        at = sides.get((one[k], one[k - 1]))
        if at is not None:
            # The other's corners from the end of the shared side around to its start.
            around = other[at:] + other[:at]
            return one[k:] + one[:k] + around[1:-1]
    return None
