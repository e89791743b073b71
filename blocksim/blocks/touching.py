"""Where faces lie on each other, and where corners rest on faces."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import following

NEARLY = 100.0
"""A gap up to this many tolerances is nearly a joint: said, but no joint. So is a length."""

Index = NDArray[np.int64]


class Faces(NamedTuple):
    """Sides of polygons, the body to their left.

    Parameters
    ----------
    start, end : (faces, 2) float
        [m]
    body : (faces,) int
    """

    start: Array
    end: Array
    body: Index

    @property
    def along(self) -> Array:
        """Unit vectors from start to end, shape (faces, 2)."""
        way = self.end - self.start
        return way / np.hypot(*way.T)[:, None]


class Touch(NamedTuple):
    """Two bodies that touch: along a stretch, or one with a corner.

    Parameters
    ----------
    one, other : int
        Bodies.
    ends : (2, 2) float
        Along the face of `one`, the body to the left; both the same for a corner [m].
    faces : (2, 2, 2) float
        Faces of `one` and of `other`, in the same direction [m].
    normal : (2,) float or None
        From `one` into `other`, for a corner.
    """

    one: int
    other: int
    ends: Array
    faces: Array
    normal: Array | None = None

    def turned(self) -> Touch:
        """Return the same as `other` sees it."""
        normal = None if self.normal is None else -self.normal
        return Touch(self.other, self.one, self.ends[::-1], self.faces[::-1, ::-1], normal)


def faces_of_polygons(polygons: Sequence[Array], bodies: Sequence[int]) -> Faces:
    """Gather the sides of counter-clockwise polygons, each with the body it belongs to."""
    start = np.concatenate(polygons)
    end = np.concatenate([following(polygon) for polygon in polygons])
    body = np.repeat(np.array(bodies, dtype=np.int64), [len(polygon) for polygon in polygons])
    return Faces(start, end, body)


def touches(
    faces: Faces, pairs: Index, tolerance: float
) -> tuple[list[Touch], list[tuple[int, int]]]:
    """Find what touches among pairs of faces that are near each other.

    Faces that lie on each other within the tolerance, over more than `NEARLY` of it, make
    a joint. A corner that lies on a face within the tolerance, and farther than that from
    the face's ends, is a contact, unless the same two bodies have a joint there. Corner on
    corner is none.

    Parameters
    ----------
    faces : Faces
    pairs : (pairs, 2) int
        Faces of different bodies, each pair once.
    tolerance : float
        [m]

    Returns
    -------
    list of Touch
    list of (int, int)
        Bodies that nearly touch.
    """
    found, near = _face_on_face(faces, pairs, tolerance)
    by_bodies: dict[tuple[int, int], list[Touch]] = defaultdict(list)
    for touch in found:
        by_bodies[_key(touch.one, touch.other)].append(touch)
    missed = {_key(*faces.body[pair].tolist()) for pair in near}
    both = np.concatenate([pairs, pairs[:, ::-1]])
    for (corner, face), gap in _corner_on_face(faces, both, tolerance):
        key = _key(int(faces.body[corner]), int(faces.body[face]))
        at = faces.start[corner]
        if gap > tolerance:
            if key not in by_bodies:
                missed.add(key)
        elif not any(_lies_on(at, touch.ends, 2 * tolerance) for touch in by_bodies[key]):
            touch = _corner_touch(faces, corner, face)
            by_bodies[key].append(touch)
            found.append(touch)
    return found, sorted(missed)


def _key(one: int, other: int) -> tuple[int, int]:
    return (one, other) if one < other else (other, one)


def _face_on_face(faces: Faces, pairs: Index, tolerance: float) -> tuple[list[Touch], Index]:
    """Find faces that lie on each other, and pairs that nearly do."""
    along = faces.along
    first, second = pairs.T
    opposite = (along[first] * along[second]).sum(axis=1) < 0
    first, second = first[opposite], second[opposite]
    tangent = along[first] - along[second]
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    origin = faces.start[first]

    def of(points: Array) -> tuple[Array, Array]:
        arm = points - origin
        return (arm * tangent).sum(axis=1), (arm * normal).sum(axis=1)

    # Both faces from their beginning to their end along the first.
    (a0, h0), (a1, h1) = of(faces.start[first]), of(faces.end[first])
    (b0, k0), (b1, k1) = of(faces.end[second]), of(faces.start[second])
    low, high = np.maximum(a0, b0), np.minimum(a1, b1)

    def gap(at: Array) -> Array:
        one = h0 + (h1 - h0) * (at - a0) / (a1 - a0)
        return k0 + (k1 - k0) * (at - b0) / (b1 - b0) - one

    apart = np.maximum(np.abs(gap(low)), np.abs(gap(high)))
    length = high - low
    joint = (length > NEARLY * tolerance) & (apart <= tolerance)
    wide = (length > NEARLY * tolerance) & (apart > tolerance) & (apart <= NEARLY * tolerance)
    short = (length > tolerance) & (length <= NEARLY * tolerance) & (apart <= tolerance)
    # Faces that cross at an angle are no gap: only nearly parallel ones are.
    wide &= np.abs(gap(high) - gap(low)) <= 1e-3 * length
    # The ends are corners of one or the other, taken exactly.
    begin = np.where((a0 >= b0)[:, None], faces.start[first], faces.end[second])
    finish = np.where((a1 <= b1)[:, None], faces.end[first], faces.start[second])
    found = [
        Touch(
            int(faces.body[first[k]]),
            int(faces.body[second[k]]),
            np.stack([begin[k], finish[k]]),
            np.array(
                [
                    [faces.start[first[k]], faces.end[first[k]]],
                    [faces.end[second[k]], faces.start[second[k]]],
                ]
            ),
        )
        for k in np.flatnonzero(joint)
    ]
    near = np.flatnonzero(wide | short)
    return found, np.stack([first[near], second[near]], axis=1)


def _corner_on_face(
    faces: Faces, pairs: Index, tolerance: float
) -> list[tuple[tuple[int, int], float]]:
    """Find starts of the first faces that lie on, or nearly on, the second, not at its ends."""
    along = faces.along
    corner, face = pairs.T
    arm = faces.start[corner] - faces.start[face]
    tangent = along[face]
    at = (arm * tangent).sum(axis=1)
    gap = np.abs(arm[:, 0] * tangent[:, 1] - arm[:, 1] * tangent[:, 0])
    length = np.hypot(*(faces.end[face] - faces.start[face]).T)
    inside = (at > tolerance) & (at < length - tolerance)
    chosen = np.flatnonzero(inside & (gap <= NEARLY * tolerance))
    return [((int(corner[k]), int(face[k])), float(gap[k])) for k in chosen]


def _corner_touch(faces: Faces, corner: int, face: int) -> Touch:
    at, start, end = faces.start[corner], faces.start[face], faces.end[face]
    tangent = (end - start) / np.hypot(*(end - start))
    return Touch(
        int(faces.body[face]),
        int(faces.body[corner]),
        np.stack([at, at]),
        np.array([[start, end], [at, at]]),
        np.array([tangent[1], -tangent[0]]),
    )


def _lies_on(point: Array, ends: Array, tolerance: float) -> bool:
    """Tell whether a point lies on a stretch."""
    way, arm = ends[1] - ends[0], point - ends[0]
    square = float(way @ way)
    share = min(1.0, max(0.0, float(way @ arm) / square)) if square > 0 else 0.0
    return float(np.hypot(*(arm - share * way))) <= tolerance


def merged(found: Sequence[Touch], tolerance: float) -> list[Touch]:
    """Join stretches between two bodies that continue each other straight on.

    So that a face put together from several polygons is one face.
    """
    kept: list[Touch] = []
    by_bodies: dict[tuple[int, int], list[Touch]] = defaultdict(list)
    for touch in found:
        if touch.normal is None:
            stretch = touch if touch.one < touch.other else touch.turned()
            by_bodies[stretch.one, stretch.other].append(stretch)
        else:
            kept.append(touch)
    for stretches in by_bodies.values():
        while stretches:
            whole = stretches.pop()
            while (other := _continues(whole, stretches, tolerance)) is not None:
                whole = _as_one(whole, stretches.pop(other))
            kept.append(whole)
    return kept


def _continues(whole: Touch, stretches: Sequence[Touch], tolerance: float) -> int | None:
    way = whole.ends[1] - whole.ends[0]
    way = way / np.hypot(*way)
    for index, other in enumerate(stretches):
        arms = other.ends - whole.ends[0]
        straight = np.abs(arms[:, 0] * way[1] - arms[:, 1] * way[0]).max() <= tolerance
        onward = float((other.ends[1] - other.ends[0]) @ way) > 0
        meets = min(
            float(np.hypot(*(other.ends[0] - whole.ends[1]))),
            float(np.hypot(*(whole.ends[0] - other.ends[1]))),
        )
        if straight and onward and meets <= tolerance:
            return index
    return None


def _as_one(one: Touch, other: Touch) -> Touch:
    way = one.ends[1] - one.ends[0]

    def span(stretches: Array) -> Array:
        points = stretches.reshape(-1, 2)
        at = points @ way
        return np.stack([points[at.argmin()], points[at.argmax()]])

    faces = [span(np.stack([one.faces[side], other.faces[side]])) for side in (0, 1)]
    return Touch(one.one, one.other, span(np.stack([one.ends, other.ends])), np.stack(faces))
