"""Convex polygons that meet, wherever they are.

Two polygons are apart by the largest gap that the line of any of their faces leaves between
them (separating axes). That face is the one they touch with; the other polygon's face that
looks at it most directly is cut to its length, and its two ends are the contacts.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.geometry import Touch

PREFER = 1e-9
"""By how much a face of the second polygon must be farther off to be taken [size]."""


class Polygons:
    """Polygons that move, followed by polygons that stay.

    Parameters
    ----------
    moving : sequence of (k, 2) float
        Corners, counter-clockwise, from the centre of mass, scaled.
    fixed : sequence of (k, 2) float
        Corners where they are.
    """

    def __init__(self, moving: Sequence[Array], fixed: Sequence[Array]) -> None:
        every = [*moving, *fixed]
        most = max(len(corners) for corners in every)
        self.count = len(moving)
        self._corners = np.array([_filled(corners, most) for corners in every])
        edge = np.roll(self._corners, -1, axis=1) - self._corners
        normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
        length = np.hypot(edge[..., 0], edge[..., 1])
        # A corner that is there twice has a face of no length, which takes the one before.
        for index in np.argwhere(length == 0):
            body, face = int(index[0]), int(index[1])
            normal[body, face] = normal[body, face - 1]
            length[body, face] = length[body, face - 1]
        self._normals = normal / length[..., None]
        self._rest = np.zeros((len(fixed), 3))
        self._last: tuple[Array | None, tuple[Array, Array]] = (
            None,
            (self._corners, self._normals),
        )

    def near(self, poses: Array, margin: float) -> NDArray[np.bool_]:
        """Tell which polygons' bounding boxes are within a margin, shape (moving, all)."""
        corners, _ = self._placed(poses)
        low, high = corners.min(axis=1) - margin, corners.max(axis=1)
        first = slice(0, self.count)
        apart = (low[first, None] > high[None]) | (low[None] > high[first, None])
        met = ~apart.any(axis=-1)
        # Each pair once, the smaller index first.
        return met & (np.arange(len(low))[None] > np.arange(self.count)[:, None])

    def touch(self, poses: Array, before: NDArray[np.int64], after: NDArray[np.int64]) -> Touch:
        """Find two contacts for each pair, as `Geometry` does for each joint."""
        corners, normals = self._placed(poses)
        pairs = np.arange(len(before))
        gaps = [
            _gaps(corners[owner], normals[owner], corners[other])
            for owner, other in ((before, after), (after, before))
        ]
        one: NDArray[np.int64] = gaps[0].argmax(axis=1)
        two: NDArray[np.int64] = gaps[1].argmax(axis=1)
        swap = gaps[1][pairs, two] > gaps[0][pairs, one] + PREFER
        owner, other = np.where(swap, after, before), np.where(swap, before, after)
        face = np.where(swap, two, one)
        normal = normals[owner, face]
        along = np.stack([-normal[:, 1], normal[:, 0]], axis=-1)
        following = (face + 1) % corners.shape[1]
        start, end = corners[owner, face], corners[owner, following]
        length = ((end - start) * along).sum(axis=-1)
        facing = (normals[other] * normal[:, None]).sum(axis=-1).argmin(axis=1)
        ends = np.stack(
            [corners[other, facing], corners[other, (facing + 1) % corners.shape[1]]], axis=1
        )
        # The facing edge, cut to the length of the face.
        where = ((ends - start[:, None]) * along[:, None]).sum(axis=-1)
        span = where[:, 1] - where[:, 0]
        slope = np.where(np.abs(span) > 0, span, 1.0)
        share = (np.clip(where, 0.0, length[:, None]) - where[:, :1]) / slope[:, None]
        share = np.where(np.abs(span)[:, None] > 0, np.clip(share, 0.0, 1.0), [[0.0, 1.0]])
        points = ends[:, :1] + share[..., None] * (ends[:, 1:] - ends[:, :1])
        gap = ((points - start[:, None]) * normal[:, None]).sum(axis=-1)
        outward = np.where(swap, -1.0, 1.0)[:, None] * normal
        order = (points * np.stack([-outward[:, 1], outward[:, 0]], axis=-1)[:, None]).sum(-1)
        turned = order[:, 0] > order[:, 1]
        points[turned], gap[turned] = points[turned, ::-1], gap[turned, ::-1]
        return Touch(gap=gap, rows=self._rows(poses, before, after, points, outward))

    def apart(self, poses: Array, before: NDArray[np.int64], after: NDArray[np.int64]) -> Array:
        """How far the polygons of each pair are apart, below 0 where they overlap."""
        corners, normals = self._placed(poses)
        gaps = [
            _gaps(corners[owner], normals[owner], corners[other]).max(axis=1)
            for owner, other in ((before, after), (after, before))
        ]
        return np.maximum(*gaps)

    def _placed(self, poses: Array) -> tuple[Array, Array]:
        """Corners and normals of all polygons where they are; known of the place asked last."""
        if poses is self._last[0]:
            return self._last[1]
        every = np.vstack([poses, self._rest])
        cos, sin = np.cos(every[:, 2])[:, None], np.sin(every[:, 2])[:, None]

        def turned(vectors: Array) -> Array:
            x, y = vectors[..., 0], vectors[..., 1]
            found = np.empty_like(vectors)
            found[..., 0], found[..., 1] = cos * x - sin * y, sin * x + cos * y
            return found

        placed = turned(self._corners) + every[:, None, :2], turned(self._normals)
        self._last = poses, placed
        return placed

    def _rows(
        self,
        poses: Array,
        before: NDArray[np.int64],
        after: NDArray[np.int64],
        points: Array,
        outward: Array,
    ) -> Array:
        """Velocities of the contacts, normal ones first, from those of both blocks."""
        tangent = np.stack([-outward[:, 1], outward[:, 0]], axis=-1)
        axes = np.stack([outward, outward, tangent, tangent], axis=1)
        points = np.concatenate([points, points], axis=1)
        parts: list[Array] = []
        for body, sign in ((before, -1.0), (after, 1.0)):
            # What stays has rows like any other; the ground's entries are dropped later.
            centre = np.vstack([poses, self._rest])[body, :2]
            arm = points - centre[:, None]
            turn = arm[..., 0] * axes[..., 1] - arm[..., 1] * axes[..., 0]
            parts.append(sign * np.concatenate([axes, turn[..., None]], axis=-1))
        return np.concatenate(parts, axis=-1)


def _filled(corners: Array, count: int) -> Array:
    """Repeat the last corner until there are so many."""
    missing = np.repeat(corners[-1:], count - len(corners), axis=0)
    return np.concatenate([corners, missing])


def _gaps(corners: Array, normals: Array, others: Array) -> Array:
    """Least distance of the other polygon's corners before each face, shape (pairs, k)."""
    reach = np.matmul(normals, others.transpose(0, 2, 1)).min(axis=2)
    return reach - (corners * normals).sum(axis=-1)
