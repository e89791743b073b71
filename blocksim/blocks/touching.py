"""Where faces lie on each other, and where corners rest on faces."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import distances, following

NEARLY = 100.0
"""A gap up to this many exact tolerances is nearly a joint: said, but none. So is a length."""
ROUGHLY = 4.0
"""The same in units of the distance up to which gaps are closed."""

Index = NDArray[np.int64]


class Faces(NamedTuple):
    """Sides of polygons, the body to their left.

    `start`, `end`, (faces, 2): [m]
    `body`, (faces,).
    """

    start: Array
    end: Array
    body: Index

    @property
    def along(self) -> Array:
        """Unit vectors from start to end, shape (faces, 2)."""
        way = self.end - self.start
        return way / np.hypot(*way.T)[:, None]


class Slack(NamedTuple):
    """How far apart blocks may be drawn and touch nevertheless, one number a body [m].

    At a joint the smaller one of its two bodies counts. Bodies that are fixed have inf.

    `exact`, (bodies,): As drawn: a joint is where its faces are.
    `close`, (bodies,): Up to this gaps and overlaps are closed, at least `exact`.
    """

    exact: Array
    close: Array

    @property
    def near(self) -> Array:
        """Gaps that are said, and lengths that are too short for a joint."""
        return np.maximum(NEARLY * self.exact, ROUGHLY * self.close)

    def at(self, one: Index | int, other: Index | int) -> Slack:
        """Return that of pairs of bodies."""
        return Slack(*(np.minimum(each[one], each[other]) for each in self))


class Touch(NamedTuple):
    """Two bodies that touch: along a stretch, or one with a corner.

    `one`, `other`: Bodies.
    `ends`, (2, 2): Along the face of `one`, the body to the left; both the same for a corner
        [m].
    `faces`, (2, 2, 2): Faces of `one` and of `other`, in the same direction [m].
    `normal`, (2,): From `one` into `other`, for a corner.
    `gap`: How far apart they are drawn, below 0 where they overlap [m]; 0 where it is exact.
    """

    one: int
    other: int
    ends: Array
    faces: Array
    normal: Array | None = None
    gap: float = 0.0

    def turned(self) -> Touch:
        """Return the same as `other` sees it."""
        normal = None if self.normal is None else -self.normal
        ends, faces = self.ends[::-1], self.faces[::-1, ::-1]
        return Touch(self.other, self.one, ends, faces, normal, self.gap)


def faces_of_polygons(polygons: Sequence[Array], bodies: Sequence[int]) -> Faces:
    """Gather the sides of counter-clockwise polygons, each with the body it belongs to."""
    start = np.concatenate(polygons)
    end = np.concatenate([following(polygon) for polygon in polygons])
    body = np.repeat(np.array(bodies, dtype=np.int64), [len(polygon) for polygon in polygons])
    return Faces(start, end, body)


def touches(
    faces: Faces, pairs: Index, slack: Slack
) -> tuple[list[Touch], list[tuple[int, int]]]:
    """Find what touches among pairs of faces that are near each other.

    Faces that lie on each other within `slack.close`, over more than `slack.near`, make
    a joint. A corner that lies on a face within `slack.close`, and farther than that from
    the face's ends, is a contact, unless the same two bodies have a joint there. Corner on
    corner is none.

    `pairs`, (pairs, 2): Faces of different bodies, each pair once.
    Returns list of (int, int): Bodies that nearly touch.
    """
    found, near = _face_on_face(faces, pairs, slack)
    many = len(slack.exact)
    one, other = np.sort([[t.one, t.other] for t in found] or np.empty((0, 2), int), axis=1).T
    keys = one * many + other
    order = np.argsort(keys, kind="stable")
    keys, ends = keys[order], np.array([t.ends for t in found]).reshape(-1, 2, 2)[order]
    corner, face, gap = _corner_on_face(faces, np.concatenate([pairs, pairs[:, ::-1]]), slack)
    bodies = np.sort(np.stack([faces.body[corner], faces.body[face]], axis=1), axis=1)
    close, key = slack.at(*bodies.T).close, bodies @ np.array([many, 1])
    first, last = np.searchsorted(keys, key, "left"), np.searchsorted(keys, key, "right")
    touching = np.abs(gap) <= close
    for later in range(int((last - first).max(initial=0))):
        here = np.flatnonzero(touching & (first + later < last))
        on = ends[first[here] + later]
        touching[here[distances(faces.start[corner[here]], on) <= 2 * close[here]]] = False
    missed = np.concatenate([
        np.sort(faces.body[near], axis=1),
        bodies[(np.abs(gap) > close) & (first == last)],
    ])  # fmt: skip
    exact = slack.at(*bodies.T).exact
    at_corners: dict[tuple[int, int], list[Array]] = defaultdict(list)
    for k in np.flatnonzero(touching).tolist():
        at, others = faces.start[corner[k]], at_corners[int(bodies[k, 0]), int(bodies[k, 1])]
        if all(float(np.hypot(*(at - each))) > 2 * close[k] for each in others):
            others.append(at)
            apart = float(gap[k]) if abs(gap[k]) > exact[k] else 0.0
            found.append(_corner_touch(faces, int(corner[k]), int(face[k]), apart))
    return found, [(int(a), int(b)) for a, b in np.unique(missed, axis=0).tolist()]


def _face_on_face(faces: Faces, pairs: Index, slack: Slack) -> tuple[list[Touch], Index]:
    """Find faces that lie on each other, and pairs that nearly do."""
    along = faces.along
    first, second = pairs.T
    opposite = (along[first] * along[second]).sum(axis=1) < 0
    first, second = first[opposite], second[opposite]
    exact, close = slack.at(faces.body[first], faces.body[second])
    near = Slack(exact, close).near
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

    def heights(at: Array) -> tuple[Array, Array]:
        one = h0 + (h1 - h0) * (at - a0) / (a1 - a0)
        return one, k0 + (k1 - k0) * (at - b0) / (b1 - b0)

    (one_low, other_low), (one_high, other_high) = heights(low), heights(high)
    gaps = np.stack([other_low - one_low, other_high - one_high])
    apart = np.abs(gaps).max(axis=0)
    length = high - low
    joint = (length > near) & (apart <= close)
    # Faces that cross at an angle are no gap: only nearly parallel ones are.
    wide = (length > near) & (apart > close) & (apart <= near)
    wide &= np.abs(gaps[1] - gaps[0]) <= 1e-3 * length
    short = (length > close) & (length <= near) & (apart <= close)
    # The ends are corners of one or the other, taken exactly; midway where a gap is closed.
    begin = np.where((a0 >= b0)[:, None], faces.start[first], faces.end[second])
    finish = np.where((a1 <= b1)[:, None], faces.end[first], faces.start[second])
    closed = (apart > exact)[:, None]

    def midway(at: Array, one: Array, other: Array) -> Array:
        return origin + at[:, None] * tangent + ((one + other) / 2)[:, None] * normal

    begin = np.where(closed, midway(low, one_low, other_low), begin)
    finish = np.where(closed, midway(high, one_high, other_high), finish)
    widest = np.take_along_axis(gaps, np.abs(gaps).argmax(axis=0)[None], axis=0)[0]
    chosen, nearly = np.flatnonzero(joint), np.flatnonzero(wide | short)
    ends = np.stack([begin[chosen], finish[chosen]], axis=1)
    parted = np.where(closed[chosen, 0], widest[chosen], 0.0)
    found = _stretches(faces, first[chosen], second[chosen], ends, parted)
    return found, np.stack([first[nearly], second[nearly]], axis=1)


def _stretches(faces: Faces, one: Index, other: Index, ends: Array, gap: Array) -> list[Touch]:
    """Return where pairs of faces lie on each other."""
    both = [faces.start[one], faces.end[one], faces.end[other], faces.start[other]]
    return list(
        map(
            Touch,
            faces.body[one].tolist(),
            faces.body[other].tolist(),
            ends,
            np.stack(both, axis=1).reshape(-1, 2, 2, 2),
            [None] * len(one),
            gap.tolist(),
        )
    )


def _corner_on_face(faces: Faces, pairs: Index, slack: Slack) -> tuple[Index, Index, Array]:
    """Find starts of the first faces that lie on, or nearly on, the second, not at its ends.

    Returns both faces, and how far the corner is off: below 0 where it lies within the body.
    """
    along = faces.along
    corner, face = pairs.T
    arm = faces.start[corner] - faces.start[face]
    tangent = along[face]
    at = (arm * tangent).sum(axis=1)
    gap = arm[:, 0] * tangent[:, 1] - arm[:, 1] * tangent[:, 0]
    length = np.hypot(*(faces.end[face] - faces.start[face]).T)
    here = slack.at(faces.body[corner], faces.body[face])
    inside = (at > here.close) & (at < length - here.close)
    chosen = np.flatnonzero(inside & (np.abs(gap) <= here.near))
    return corner[chosen], face[chosen], gap[chosen]


def _corner_touch(faces: Faces, corner: int, face: int, gap: float) -> Touch:
    at, start, end = faces.start[corner], faces.start[face], faces.end[face]
    tangent = (end - start) / np.hypot(*(end - start))
    return Touch(
        int(faces.body[face]),
        int(faces.body[corner]),
        np.stack([at, at]),
        np.array([[start, end], [at, at]]),
        np.array([tangent[1], -tangent[0]]),
        gap,
    )


def merged(found: Sequence[Touch], slack: Slack) -> list[Touch]:
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
    for bodies, stretches in by_bodies.items():
        tolerance = float(slack.at(*bodies).close)
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
    ends, gap = span(np.stack([one.ends, other.ends])), max(one.gap, other.gap, key=abs)
    return Touch(one.one, one.other, ends, np.stack(faces), None, gap)
