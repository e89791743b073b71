"""Where the two blocks of a joint touch, wherever they have moved.

Each joint has two contacts, at its inner and its outer end. At either end the two corners
lie side by side once the joint has slipped: the one that lies over the other block's face
touches that face, whose normal it takes. That ends where the faces no longer lie over each
other or have turned far apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array, Assembly

DEEPEST = 0.05
"""Overlap in joint lengths beyond which two faces no longer touch but have passed."""
WIDEST = 0.98
"""Cosine of the angle between two faces from which they no longer form a joint: other faces
of the blocks may then touch first."""


@dataclass(frozen=True, eq=False)
class Touch:
    """Contacts at one instant.

    Parameters
    ----------
    gap : (joints, 2) float
        At the inner and outer end, below 0 where blocks overlap.
    rows : (joints, 4, 6) float
        Velocities of `after` relative to `before` from those of both blocks, along the
        normals of the two contacts, then along their tangents.
    """

    gap: Array
    rows: Array


class Geometry:
    """Corners of the joints of an assembly, carried by their blocks."""

    def __init__(self, assembly: Assembly) -> None:
        size, count = assembly.size, len(assembly.joints)
        joints = assembly.joint_arrays
        self.before, self.after = joints.before, joints.after
        ends = joints.ends
        # The ground is a block at the origin that stays, index -1.
        centres = np.vstack([assembly.centres / size, np.zeros(2)])
        self._sides = np.concatenate([self.before, self.after])
        self._arms = np.concatenate([ends, ends]) - centres[self._sides][:, None]
        self._lengths = joints.length
        self._moves = (self._sides != SUPPORT).astype(np.float64)[:, None, None]
        self._signs = np.repeat([-1.0, 1.0], count)[:, None, None]
        # Friction never sees a slip that is not in the rows.
        self._grips = (joints.friction != 0).astype(np.float64)[:, None, None]

    def touch(self, poses: Array) -> tuple[Touch, NDArray[np.bool_]]:
        """Find the contacts, and which joints still are joints.

        Parameters
        ----------
        poses : (blocks, 3) float
            Centres of mass x, y and rotations, scaled.

        Returns
        -------
        touch : Touch
        holds : (joints,) bool
        """
        count = len(self._lengths)
        placed = np.vstack([poses, np.zeros(3)])[self._sides]
        cos, sin = np.cos(placed[:, 2])[:, None], np.sin(placed[:, 2])[:, None]
        corners = np.empty((2 * count, 2, 2))
        corners[:, :, 0] = cos * self._arms[:, :, 0] - sin * self._arms[:, :, 1]
        corners[:, :, 1] = sin * self._arms[:, :, 0] + cos * self._arms[:, :, 1]
        corners += placed[:, None, :2]
        tangents = (corners[:, 1] - corners[:, 0]) / np.tile(self._lengths, 2)[:, None]
        first, second = corners[:count], corners[count:]
        apart = second - first
        along = np.matmul(apart, tangents[:count, :, None])[:, :, 0]
        # Over the face of `before` lies the corner of `after` that is nearer to its middle.
        after_over = along * np.array([1.0, -1.0]) >= 0
        tangent = np.where(
            after_over[:, :, None], tangents[:count, None], tangents[count:, None]
        )
        normal = np.stack([tangent[:, :, 1], -tangent[:, :, 0]], axis=-1)
        gap = (apart * normal).sum(axis=-1)
        overlapping = self._lengths - np.maximum(along[:, 0], 0) + np.minimum(along[:, 1], 0)
        holds = (overlapping > 0) & (gap.min(axis=1) > -DEEPEST * self._lengths)
        holds &= (tangents[:count] * tangents[count:]).sum(axis=-1) > WIDEST
        point = np.where(after_over[:, :, None], second, first)
        arm = np.concatenate([point, point]) - placed[:, None, :2]

        def rates(axis: Array) -> Array:
            both = np.concatenate([axis, axis])
            turn = arm[:, :, :1] * both[:, :, 1:] - arm[:, :, 1:] * both[:, :, :1]
            parts = np.concatenate([both, turn], axis=-1) * self._signs * self._moves
            return np.concatenate([parts[:count], parts[count:]], axis=-1)

        rows = np.concatenate([rates(normal), rates(tangent) * self._grips], axis=1)
        return Touch(gap=gap, rows=rows), holds
