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
from blocksim.engines.contact.geometry import Complex, Touch, in_one, rows_at

PREFER = 1e-9
"""By how much a face of the second polygon must be farther off to be taken [size]."""


class Polygons:
    """Polygons that move, followed by polygons that stay.

    `moving`, sequence of (k, 2): Corners, counter-clockwise, from the centre of mass, scaled.
    `fixed`, sequence of (k, 2): Corners where they are.
    """

    def __init__(self, moving: Sequence[Array], fixed: Sequence[Array]) -> None:
        every = [*moving, *fixed]
        most = max(len(corners) for corners in every)
        self.count = len(moving)
        self._corners = in_one(np.array([_filled(corners, most) for corners in every]))
        edges = np.roll(self._corners, -1, axis=1) - self._corners
        self._lengths: Array = np.abs(edges)
        # A corner that is there twice has a face of no length, which takes the one before.
        for index in np.argwhere(self._lengths == 0):
            body, face = int(index[0]), int(index[1])
            edges[body, face] = edges[body, face - 1]
        self._faces = edges / np.abs(edges)
        self._rest = np.zeros((len(fixed), 3))
        self._last: tuple[Array | None, tuple[Complex, Complex]] = (
            None,
            (self._corners, self._faces),
        )

    def near(
        self, poses: Array, first: NDArray[np.int64], second: NDArray[np.int64], margin: float
    ) -> NDArray[np.bool_]:
        """Tell of which pairs the bounding boxes are within a margin, shape (pairs,)."""
        corners, _ = self._placed(poses)
        within: list[NDArray[np.bool_]] = []
        for along in (corners.real, corners.imag):
            low, high = along.min(axis=1) - margin, along.max(axis=1)
            within += [low[first] <= high[second], low[second] <= high[first]]
        return np.logical_and.reduce(within)

    def touch(
        self,
        poses: Array,
        before: NDArray[np.int64],
        after: NDArray[np.int64],
        by: NDArray[np.int64] | None = None,
    ) -> Touch:
        """Find two contacts for each pair, as `Geometry` does for each joint.

        `poses`, (polygons that move, 3).
        `before`, `after`, (pairs,).
        `by`, (3, pairs): Faces to touch with: whether that of `after` gives the normal, which
            one does, and which one of the other polygon looks at it. By default those that do
            so there.
        """
        corners, faces = self._placed(poses)
        if by is None:
            gaps, best = self._apart(poses, before, after)
            swap = gaps[1] > gaps[0] + PREFER
            face = best[swap.astype(np.int64), np.arange(len(swap))]
        else:
            swap, face = by[0].astype(np.bool_), by[1]
        owner, other = np.where(swap, after, before), np.where(swap, before, after)
        start, along = corners[owner, face][:, None], faces[owner, face][:, None]
        length = self._lengths[owner, face][:, None]
        facing: NDArray[np.int64] = (
            (faces[other] * along.conj()).real.argmin(axis=1) if by is None else by[2]
        )
        following = (facing + 1) % corners.shape[1]
        ends = np.stack([corners[other, facing], corners[other, following]], axis=1)
        # Along the face, and into its block; the facing edge, cut to the length of the face.
        ends: Complex = (ends - start) * along.conj()
        where, way = ends.real, ends[:, 1:] - ends[:, :1]
        span = way.real
        slope = np.where(np.abs(span) > 0, span, 1.0)
        share = (np.minimum(np.maximum(where, 0.0), length) - where[:, :1]) / slope
        share = np.where(
            np.abs(span) > 0, np.minimum(np.maximum(share, 0.0), 1.0), [[0.0, 1.0]]
        )
        points: Complex = ends[:, :1] + share * way
        # In the order in which the outward normal, turned by a right angle, meets them.
        sign = np.where(swap, -1.0, 1.0)[:, None]
        order = sign * points.real
        points = np.where(order[:, :1] > order[:, 1:], points[:, ::-1], points)
        centres = in_one(np.concatenate([poses, self._rest]))
        rows = rows_at(
            start + points * along,
            np.repeat(sign * along, 2, axis=1),
            np.stack([centres[before], centres[after]], axis=1),
            # What stays has rows like any other; the ground's entries are dropped later.
            np.array([[-1.0, 1.0]]),
        )
        return Touch(gap=-points.imag, rows=rows, faces=np.stack([swap, face, facing]))

    def apart(self, poses: Array, before: NDArray[np.int64], after: NDArray[np.int64]) -> Array:
        """How far the polygons of each pair are apart, below 0 where they overlap."""
        return self._apart(poses, before, after)[0].max(axis=0)

    def _apart(
        self, poses: Array, before: NDArray[np.int64], after: NDArray[np.int64]
    ) -> tuple[Array, NDArray[np.int64]]:
        """Largest gap that a face of the first, or of the second, leaves, and which face.

        Shape (2, pairs) each.
        """
        corners, faces = self._placed(poses)
        owner = np.concatenate([before, after])
        other = np.concatenate([after, before])
        others = corners[other][:, None] - corners[owner][..., None]
        beyond = (others.conj() * faces[owner][..., None]).imag.min(axis=2)
        # A face of no length is as far off as the one before it, but for round-off.
        beyond[self._lengths[owner] == 0] = -np.inf
        return beyond.max(axis=1).reshape(2, -1), beyond.argmax(axis=1).reshape(2, -1)

    def _placed(self, poses: Array) -> tuple[Complex, Complex]:
        """Corners and faces of all polygons where they are; known of the place asked last."""
        if poses is not self._last[0]:
            every = np.concatenate([poses, self._rest])
            turns = np.exp(1j * every[:, 2:])
            placed = turns * self._corners + in_one(every)[:, None], turns * self._faces
            self._last = poses, placed
        return self._last[1]


def _filled(corners: Array, count: int) -> Array:
    """Repeat the last corner until there are so many."""
    missing = np.repeat(corners[-1:], count - len(corners), axis=0)
    return np.concatenate([corners, missing])
