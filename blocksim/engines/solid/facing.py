"""Faces that look at each other: what they have in common, seen along a normal."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.solid.hulls import Hulls, Places

Flags = NDArray[np.bool_]
RIM = 1e-9
"""Within which a corner is over a face [size]."""
NARROW = 1e-6
"""Width of what two faces share that is none [size]."""
FLAT = 1e-9
"""Area of a face, seen along a normal, that is none [size^2]."""


def frames(normals: Array) -> Array:
    """Return two unit vectors across each normal, (points, 2, 3)."""
    least = np.abs(normals).argmin(axis=1)
    first = -normals * normals[np.arange(len(normals)), least][:, None]
    first[np.arange(len(normals)), least] += 1.0
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = cast("Array", np.cross(normals, first))
    return np.stack([first, second], axis=1)


class Facing:
    """A face of one hull of each pair, and the face of the other that looks at it.

    `pairs`, (pairs, 2).
    `faces`, tuple of (pairs,): Of which of a pair, 0 or 1, the face is, and which of its faces.
    """

    def __init__(self, hulls: Hulls, pairs: Places, faces: tuple[Places, Places]) -> None:
        rows, (side, face) = np.arange(len(pairs), dtype=np.int64), faces
        self.here, self.there = pairs[rows, side], pairs[rows, 1 - side]
        here, there = self.here, self.there
        self.normals: Array = hulls.normals[here, face]
        self.offsets: Array = hulls.offsets[here, face]
        facing: Array = np.einsum("pfi,pi->pf", hulls.normals[there], self.normals)
        facing = np.where(hulls.many[there] > 0, facing, np.inf)
        opposite = facing.argmin(axis=1)
        # How the other face leans, its plane, and the corners and how many of both.
        self.slope: Array = np.minimum(facing[rows, opposite], -1e-12)
        self.planes: Array = hulls.normals[there, opposite]
        self.beyond: Array = hulls.offsets[there, opposite]
        self.ours: Array = hulls.corners[here[:, None], hulls.around[here, face]]
        self.theirs: Array = hulls.corners[there[:, None], hulls.around[there, opposite]]
        self.count: Places = hulls.many[here, face]
        self.others: Places = hulls.many[there, opposite]
        self._across: Array = frames(self.normals).transpose(0, 2, 1)
        # Seen along the normal.
        self.flat: Array = np.matmul(self.ours, self._across)
        self.other: Array = np.matmul(self.theirs, self._across)

    def shared(self) -> list[tuple[Array, Flags, Array]]:
        """Return corners of theirs, of ours, and crossings, which count, and their heights."""
        theirs = self.corners_of_theirs()
        kinds = [theirs, self.corners_of_ours(theirs[1]), self.crossings()]
        # Faces that share no more than a rim press on nothing.
        flats = np.concatenate([np.matmul(each[0], self._across) for each in kinds], axis=1)
        counts = np.concatenate([each[1] for each in kinds], axis=1)
        wide = _wide(flats, counts, self.flat, self.count)[:, None]
        return [(places, which & wide, heights) for places, which, heights in kinds]

    def corners_of_theirs(self) -> tuple[Array, Flags, Array]:
        """Return their corners, which are over our face, and their heights over it."""
        heights = np.einsum("pki,pi->pk", self.theirs, self.normals) - self.offsets[:, None]
        return self.theirs, _inside(self.other, self.flat, self.count, self.others), heights

    def corners_of_ours(self, inside: Flags) -> tuple[Array, Flags, Array]:
        """Return points of their face over our corners, which are within it, and heights.

        `inside`, (pairs, k): Their corners that are over our face: one of ours at the same
            place is no other.
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


def _real(many: Places, most: int) -> Flags:
    """Tell which of the places up to the most are no padding, (p, most)."""
    return np.arange(most, dtype=np.int64) < many[:, None]


def _sides(polygon: Array, many: Places) -> Array:
    """Return the ways from each corner of polygons to the next, (p, k, 2 or 3)."""
    after = np.roll(polygon, -1, axis=1)
    after[np.arange(len(polygon)), many - 1] = polygon[:, 0]
    return after - polygon


def _off_sides(points: Array, polygon: Array, many: Places) -> Array:
    """Return how far points lie to the left of each side of polygons, (p, points, k)."""
    ways = _sides(polygon, many)
    long = np.maximum(np.linalg.norm(ways, axis=2), 1e-300)
    apart = points[:, :, None] - polygon[:, None]
    left = ways[:, None, :, 0] * apart[..., 1] - ways[:, None, :, 1] * apart[..., 0]
    return left / long[:, None]


def _inside(points: Array, polygon: Array, many: Places, count: Places) -> Flags:
    """Tell which points are within polygons that go around counter-clockwise, (p, k)."""
    real = _real(many, polygon.shape[1])
    within: Flags = (_off_sides(points, polygon, many) >= -RIM) | ~real[:, None]
    return within.all(axis=2) & _real(count, points.shape[1])


def _wide(points: Array, which: Flags, polygon: Array, many: Places) -> Flags:
    """Tell whether of points some lie off every side of their polygon, (p,)."""
    off = _off_sides(points, polygon, many)
    most = np.where(which[..., None], off, -np.inf).max(axis=1)
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
