"""Where moving polyhedra meet: points of one on a plane of the other, with the gap there.

Two convex polyhedra are looked at along the direction in which they are farthest apart, or
overlap least: a normal of a face, or one across an edge of each. At a face what lies over it of
the other's nearest face is cut out. Its corners are the points of contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.solid.hulls import Hulls, Places

Flags = NDArray[np.bool_]
RIM = 1e-9
"""Within which a corner is over a face [size]."""
NARROW = 1e-6
"""Width of what two faces share that is none [size]."""
DEEP = 1e-2
"""Share of the thinner hull by which faces overlap where edges are looked at."""
FLAT = 1e-9
"""Area of a face, seen along a normal, that is none [size^2]."""
KEPT = 1e-9
"""By which another direction has to be better than the last one."""
KINDS = 4
"""Corner of the other, corner of the face, crossing of two edges of faces; edge on edge."""


@dataclass(frozen=True, eq=False)
class Points:
    """Points of contact. A point moves with `after`, its plane with `before`.

    Parameters
    ----------
    before, after : (points,) int
        Hulls.
    places : (points, 3) float
        Where they are [size].
    normals : (points, 3) float
        From `before` into `after`.
    gaps : (points,) float
        Below 0 where they overlap.
    keys : (points,) int
        The same for the same point from step to step.
    """

    before: Places
    after: Places
    places: Array
    normals: Array
    gaps: Array
    keys: Places

    def at(self, which: Flags) -> Points:
        """Return some of them."""
        return Points(
            self.before[which],
            self.after[which],
            self.places[which],
            self.normals[which],
            self.gaps[which],
            self.keys[which],
        )


class _Axis(NamedTuple):
    """Best direction of each pair: its gap, and the face of `pairs[:, side]` it is of."""

    gap: Array
    side: Places
    face: Places

    def at(self, which: Flags) -> _Axis:
        """Return those of some pairs."""
        return _Axis(self.gap[which], self.side[which], self.face[which])


def near(hulls: Hulls, margin: Array) -> Places:
    """Return pairs of hulls of two owners whose boxes are within a margin, (pairs, 2).

    Parameters
    ----------
    hulls : Hulls
        Where they are.
    margin : (hulls,) float
        How far each may come in a step.
    """
    low = hulls.corners.min(axis=1) - margin[:, None]
    high = hulls.corners.max(axis=1) + margin[:, None]
    # Along one direction first, so that few pairs are looked at.
    order = np.argsort(low[:, 0], kind="stable")
    count = len(order)
    ends = np.asarray(np.searchsorted(low[order, 0], high[order, 0], "right"), dtype=np.int64)
    counts = ends - np.arange(count, dtype=np.int64) - 1
    first = np.repeat(np.arange(count, dtype=np.int64), counts)
    second = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts) + first + 1
    pairs = np.sort(np.stack([order[first], order[second]], axis=1), axis=1)
    a, b = pairs.T
    meet = (hulls.owner[a] != hulls.owner[b]) & (low[a] <= high[b]).all(axis=1)
    meet &= (high[a] >= low[b]).all(axis=1)
    pairs = pairs[meet]
    return pairs[np.lexsort(pairs.T[::-1])]


def meet(hulls: Hulls, pairs: Places, margin: Array) -> Points:
    """Find the points of contact of pairs that are within a margin.

    Parameters
    ----------
    hulls : Hulls
        Where they are.
    pairs : (pairs, 2) int
    margin : (pairs,) float
        Gaps beyond which nothing is said.
    """
    axis = _by_faces(hulls, pairs)
    close = axis.gap <= margin
    pairs, margin = pairs[close], margin[close]
    axis = axis.at(close)
    deep = -DEEP * hulls.thickness[pairs].min(axis=1)
    looked = np.flatnonzero(axis.gap < deep)
    faces, found = np.ones(len(pairs), dtype=bool), list[Points]()
    if len(looked):
        edges, better = _by_edges(hulls, pairs[looked], axis.gap[looked])
        faces[looked[better]] = False
        found.append(edges.at(edges.gaps <= margin[looked[better]]))
    found.append(_on_faces(hulls, pairs[faces], axis.at(faces)))
    points = _joined(found)
    most = np.zeros(len(points.gaps))
    if len(points.gaps):
        count = len(hulls.owner)
        keys = pairs[:, 0] * count + pairs[:, 1]
        sides = np.sort(np.stack([points.before, points.after], axis=1), axis=1)
        most = margin[np.searchsorted(keys, sides[:, 0] * count + sides[:, 1])]
    return points.at(points.gaps <= most)


def _joined(found: list[Points]) -> Points:
    return Points(
        np.concatenate([each.before for each in found]),
        np.concatenate([each.after for each in found]),
        np.concatenate([each.places for each in found]),
        np.concatenate([each.normals for each in found]),
        np.concatenate([each.gaps for each in found]),
        np.concatenate([each.keys for each in found]),
    )


def _by_faces(hulls: Hulls, pairs: Places) -> _Axis:
    """Return the normal of a face along which each pair is farthest apart."""
    gaps = list[Array]()
    for one, other in ((0, 1), (1, 0)):
        a, b = pairs[:, one], pairs[:, other]
        heights = np.matmul(hulls.normals[a], hulls.corners[b].transpose(0, 2, 1)).min(axis=2)
        gaps.append(np.where(hulls.many[a] > 0, heights - hulls.offsets[a], -np.inf))
    best = np.stack([each.max(axis=1) for each in gaps], axis=1)
    side = (best[:, 1] > best[:, 0] + KEPT).astype(np.int64)
    which = np.stack([each.argmax(axis=1) for each in gaps], axis=1)
    rows = np.arange(len(pairs))
    return _Axis(best[rows, side], side, which[rows, side])


def _by_edges(hulls: Hulls, pairs: Places, gaps: Array) -> tuple[Points, Flags]:
    """Return points where an edge of each meets, where that is nearer to parting."""
    found, better = list[Points](), np.zeros(len(pairs), dtype=bool)
    for at, (a, b) in enumerate(pairs.tolist()):
        ours, theirs = hulls.corners[a][hulls.edges[a]], hulls.corners[b][hulls.edges[b]]
        way, other = ours[:, 1] - ours[:, 0], theirs[:, 1] - theirs[:, 0]
        normals = np.cross(way[:, None], other[None])
        long = np.linalg.norm(normals, axis=2)
        steep = long > 1e-6 * np.outer(
            np.linalg.norm(way, axis=1), np.linalg.norm(other, axis=1)
        )
        if not steep.any():
            continue
        one, two = np.nonzero(steep)
        normals = normals[one, two] / long[one, two, None]
        outwards = hulls.corners[b].mean(axis=0) - hulls.corners[a].mean(axis=0)
        normals *= np.where(normals @ outwards < 0, -1.0, 1.0)[:, None]
        apart = (normals @ hulls.corners[b].T).min(axis=1) - (normals @ hulls.corners[a].T).max(
            axis=1
        )
        best = int(apart.argmax())
        if apart[best] <= gaps[at]:
            continue
        k, m = one[best], two[best]
        place = _crossing(ours[k], theirs[m])
        if place is None:
            continue
        better[at] = True
        count, edges = len(hulls.owner), hulls.edges.shape[1]
        key = ((a * count + b) * KINDS + 3) * edges**2 + k * edges + m
        found.append(
            Points(
                np.array([a]),
                np.array([b]),
                place[None],
                normals[best][None],
                apart[best : best + 1],
                np.array([key * 2]),
            )
        )
    none = np.zeros(0, dtype=np.int64)
    nothing = Points(none, none, np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), none)
    return _joined([nothing, *found]), better


def _crossing(ours: Array, theirs: Array) -> Array | None:
    """Return the point of the second of two edges that is nearest to the first."""
    way, other, between = ours[1] - ours[0], theirs[1] - theirs[0], theirs[0] - ours[0]
    a, b, c = way @ way, way @ other, other @ other
    left = a * c - b * b
    if left <= 0:
        return None
    along = (b * (way @ between) - a * (other @ between)) / left
    share = min(max(float(along), 0.0), 1.0)
    return theirs[0] + share * other


def frames(normals: Array) -> Array:
    """Return two unit vectors across each normal, (points, 2, 3)."""
    least = np.abs(normals).argmin(axis=1)
    first = -normals * normals[np.arange(len(normals)), least][:, None]
    first[np.arange(len(normals)), least] += 1.0
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = cast("Array", np.cross(normals, first))
    return np.stack([first, second], axis=1)


class _Facing:
    """A face of one hull of each pair, and the face of the other that looks at it.

    Parameters
    ----------
    hulls : Hulls
    pairs : (pairs, 2) int
    axis : _Axis
    """

    def __init__(self, hulls: Hulls, pairs: Places, axis: _Axis) -> None:
        rows = np.arange(len(pairs), dtype=np.int64)
        self.here, self.there = pairs[rows, axis.side], pairs[rows, 1 - axis.side]
        here, there = self.here, self.there
        self.normals: Array = hulls.normals[here, axis.face]
        self.offsets: Array = hulls.offsets[here, axis.face]
        facing: Array = np.einsum("pfi,pi->pf", hulls.normals[there], self.normals)
        facing = np.where(hulls.many[there] > 0, facing, np.inf)
        opposite = facing.argmin(axis=1)
        # How the other face leans, its plane, and the corners and how many of both.
        self.slope: Array = np.minimum(facing[rows, opposite], -1e-12)
        self.planes: Array = hulls.normals[there, opposite]
        self.beyond: Array = hulls.offsets[there, opposite]
        self.ours: Array = hulls.corners[here[:, None], hulls.around[here, axis.face]]
        self.theirs: Array = hulls.corners[there[:, None], hulls.around[there, opposite]]
        self.count: Places = hulls.many[here, axis.face]
        self.others: Places = hulls.many[there, opposite]
        across = frames(self.normals).transpose(0, 2, 1)
        # Seen along the normal.
        self.flat: Array = np.matmul(self.ours, across)
        self.other: Array = np.matmul(self.theirs, across)

    def corners_of_theirs(self) -> tuple[Array, Flags, Array]:
        """Return their corners, which are over our face, and their heights over it."""
        heights = np.einsum("pki,pi->pk", self.theirs, self.normals) - self.offsets[:, None]
        return self.theirs, _inside(self.other, self.flat, self.count, self.others), heights

    def corners_of_ours(self, inside: Flags) -> tuple[Array, Flags, Array]:
        """Return points of their face over our corners, which are within it, and heights.

        Parameters
        ----------
        inside : (pairs, k) bool
            Their corners that are over our face: one of ours at the same place is no other.
        """
        # Turned over, so that it goes around the same way.
        within = _inside(self.flat, _reversed(self.other, self.others), self.others, self.count)
        within &= (_area(self.other, self.others) < -FLAT)[:, None]
        apart = np.linalg.norm(self.flat[:, :, None] - self.other[:, None], axis=3)
        within &= ~((apart <= RIM) & inside[:, None]).any(axis=2)
        up = self.beyond[:, None] - np.einsum("pki,pi->pk", self.ours, self.planes)
        up = up / self.slope[:, None]
        return self.ours + up[..., None] * self.normals[:, None], within, up

    def crossings(self) -> tuple[Array, Flags, Array]:
        """Return points of their sides where they cross ours, which do, and heights."""
        crossed, share = _crossings(self.flat, self.other, self.count, self.others)
        ways = _sides(self.theirs, self.others)
        places = self.theirs[:, None] + share[..., None] * ways[:, None]
        many = self.ours.shape[1] * self.theirs.shape[1]
        places = places.reshape(len(share), many, 3)
        heights = np.einsum("pki,pi->pk", places, self.normals) - self.offsets[:, None]
        return places, crossed.reshape(len(share), many), heights


def _on_faces(hulls: Hulls, pairs: Places, axis: _Axis) -> Points:
    """Return the corners of what two faces have in common, seen along the first's normal."""
    faces = _Facing(hulls, pairs, axis)
    theirs = faces.corners_of_theirs()
    kinds = (theirs, faces.corners_of_ours(theirs[1]), faces.crossings())
    # Faces that share no more than a rim press on nothing.
    across = frames(faces.normals).transpose(0, 2, 1)
    flats = np.concatenate([np.matmul(each[0], across) for each in kinds], axis=1)
    shared = np.concatenate([each[1] for each in kinds], axis=1)
    wide = _wide(flats, shared, faces.flat, faces.count)[:, None]
    count, side, found = len(hulls.owner), faces.ours.shape[1], list[Points]()
    for kind, (places, which, gaps) in enumerate(kinds):
        pair, at = np.nonzero(which & wide)
        key = (pairs[pair, 0] * count + pairs[pair, 1]) * KINDS + kind
        key = (key * hulls.normals.shape[1] + axis.face[pair]) * side**2 + at
        found.append(
            Points(
                faces.here[pair],
                faces.there[pair],
                places[pair, at],
                faces.normals[pair],
                gaps[pair, at],
                key * 2 + axis.side[pair],
            )
        )
    return _joined(found)


def _real(many: Places, most: int) -> Flags:
    """Tell which of the places up to the most are no padding, (p, most)."""
    return np.arange(most, dtype=np.int64) < many[:, None]


def _sides(polygon: Array, many: Places) -> Array:
    """Return the ways from each corner of polygons to the next, (p, k, 2 or 3)."""
    after = np.roll(polygon, -1, axis=1)
    after[np.arange(len(polygon)), many - 1] = polygon[:, 0]
    return after - polygon


def _inside(points: Array, polygon: Array, many: Places, count: Places) -> Flags:
    """Tell which points are within polygons that go around counter-clockwise, (p, k)."""
    ways = _sides(polygon, many)
    long = np.maximum(np.linalg.norm(ways, axis=2), 1e-300)
    apart = points[:, :, None] - polygon[:, None]
    left = ways[:, None, :, 0] * apart[..., 1] - ways[:, None, :, 1] * apart[..., 0]
    left = left / long[:, None]
    real = _real(many, polygon.shape[1])
    within: Flags = (left >= -RIM) | ~real[:, None]
    return within.all(axis=2) & _real(count, points.shape[1])


def _wide(points: Array, which: Flags, polygon: Array, many: Places) -> Flags:
    """Tell whether of points some lie off every side of their polygon, (p,)."""
    ways = _sides(polygon, many)
    long = np.maximum(np.linalg.norm(ways, axis=2), 1e-300)
    apart = points[:, :, None] - polygon[:, None]
    left = ways[:, None, :, 0] * apart[..., 1] - ways[:, None, :, 1] * apart[..., 0]
    most = np.where(which[..., None], left / long[:, None], -np.inf).max(axis=1)
    real = _real(many, polygon.shape[1])
    return ((most > NARROW) | ~real).all(axis=1)


def _reversed(polygon: Array, many: Places) -> Array:
    """Return polygons that go around the other way."""
    at = np.arange(polygon.shape[1], dtype=np.int64)
    order: Places = np.where(at < many[:, None], many[:, None] - 1 - at, at)
    return np.take_along_axis(polygon, order[..., None], axis=1)


def _area(polygon: Array, many: Places) -> Array:
    """Return the areas of polygons, below 0 where they go around clockwise."""
    ways = _sides(polygon, many)
    ways[~_real(many, polygon.shape[1])] = 0.0
    arms = polygon - polygon[:, :1]
    return (arms[..., 0] * ways[..., 1] - arms[..., 1] * ways[..., 0]).sum(axis=1) / 2


def _crossings(ours: Array, theirs: Array, many: Places, count: Places) -> tuple[Flags, Array]:
    """Tell which sides of polygons cross within both, and where along the second's."""
    one, two = _sides(ours, many), _sides(theirs, count)
    turn = one[:, :, None, 0] * two[:, None, :, 1] - one[:, :, None, 1] * two[:, None, :, 0]
    apart = theirs[:, None] - ours[:, :, None]
    long, other = (np.linalg.norm(each, axis=2) for each in (one, two))
    ones, twos = _real(many, ours.shape[1]), _real(count, theirs.shape[1])
    real: Flags = ones[:, :, None] & twos[:, None]
    real &= np.abs(turn) > 1e-12 * np.maximum(long[:, :, None] * other[:, None], 1e-300)
    over = np.where(real, turn, 1.0)
    at = (apart[..., 0] * two[:, None, :, 1] - apart[..., 1] * two[:, None, :, 0]) / over
    share = (apart[..., 0] * one[:, :, None, 1] - apart[..., 1] * one[:, :, None, 0]) / over
    ends = RIM / np.maximum(long, 1e-300)[:, :, None], RIM / np.maximum(other, 1e-300)[:, None]
    # A corner of theirs on a side of ours counts as inside; what is strictly between crosses.
    crosses: Flags = real & (at > ends[0]) & (at < 1 - ends[0])
    crosses &= (share > ends[1]) & (share < 1 - ends[1])
    return crosses, np.where(crosses, share, 0.0)
