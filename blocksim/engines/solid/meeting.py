"""Where moving polyhedra meet: points of one on a plane of the other, with the gap there.

Two convex polyhedra are looked at along the direction in which they are farthest apart, or
overlap least: a normal of a face, or one across an edge of each. At a face what lies over it of
the other's nearest face is cut out. Its corners are the points of contact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.solid.facing import Facing, frames
from blocksim.engines.solid.hulls import Hulls, Places

Flags = NDArray[np.bool_]
DEEP = 1e-2
"""Share of the thinner hull by which faces overlap where edges are looked at."""
KEPT = 1e-9
"""By which another direction has to be better than the last one."""
KINDS = 4
"""Corner of the other, corner of the face, crossing of two edges of faces; edge on edge."""


class Points(NamedTuple):
    """Points of contact. A point moves with `after`, its plane with `before`.

    `before`, `after`, (points,): Hulls.
    `places`, (points, 3): Where they are [size].
    `normals`, (points, 3): From `before` into `after`.
    `gaps`, (points,): Below 0 where they overlap.
    `keys`, (points,): The same for the same point from step to step.
    """

    before: Places
    after: Places
    places: Array
    normals: Array
    gaps: Array
    keys: Places

    def at(self, which: Flags) -> Points:
        """Return some of them."""
        return Points._make(each[which] for each in self)

    @property
    def axes(self) -> Array:
        """The normal of each and two ways across, (points, 3, 3)."""
        return np.concatenate([self.normals[:, None], frames(self.normals)], axis=1)


class _Axis(NamedTuple):
    """Best direction of each pair: its gap, and the face of `pairs[:, side]` it is of."""

    gap: Array
    side: Places
    face: Places

    def at(self, which: Flags) -> _Axis:
        """Return those of some pairs."""
        return _Axis._make(each[which] for each in self)


def near(hulls: Hulls, margin: Array) -> Places:
    """Return pairs of hulls of two owners whose boxes are within a margin, (pairs, 2).

    `hulls`: Where they are.
    `margin`, (hulls,): How far each may come in a step.
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

    `hulls`: Where they are.
    `pairs`, (pairs, 2).
    `margin`, (pairs,): Gaps beyond which nothing is said.
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


def apart(hulls: Hulls, pairs: Places) -> Array:
    """Return how far pairs are apart along the normal of a face, at most, (pairs,)."""
    return _by_faces(hulls, pairs).gap


def _joined(found: list[Points]) -> Points:
    return Points._make(np.concatenate(each) for each in zip(*found, strict=True))


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
        normals = normals[steep] / long[steep, None]
        outwards = hulls.corners[b].mean(axis=0) - hulls.corners[a].mean(axis=0)
        normals *= np.where(normals @ outwards < 0, -1.0, 1.0)[:, None]
        apart = (normals @ hulls.corners[b].T).min(axis=1) - (normals @ hulls.corners[a].T).max(
            axis=1
        )
        best = int(apart.argmax())
        if apart[best] <= gaps[at]:
            continue
        # Edges that are parallel have the same normal: those that meet are outermost along it.
        normal = normals[best]
        k = (ours @ normal).min(axis=1).argmax()
        m = (theirs @ normal).max(axis=1).argmin()
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
                normal[None],
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


def _on_faces(hulls: Hulls, pairs: Places, axis: _Axis) -> Points:
    """Return the corners of what two faces have in common, seen along the first's normal."""
    faces = Facing(hulls, pairs, (axis.side, axis.face))
    count, side, found = len(hulls.owner), faces.ours.shape[1], list[Points]()
    for kind, (places, which, gaps) in enumerate(faces.shared()):
        pair, at = np.nonzero(which)
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
