"""Where the blocks of a recording are in space, at its frames and between them.

Lengths are in units of the assembly's size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.extruded import lifted
from blocksim.simulation.recording import Recording

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""From z upwards to y upwards."""


class Frames:
    """Where blocks are at the frames of a recording, in the plane or in space, and between."""

    def __init__(self, recording: Recording[Any]) -> None:
        self._recording = recording

    def poses(self, earlier: int, later: int, share: float) -> Array:
        """Return centres x, y, z (upwards) and rotation vectors, (blocks, 6)."""
        recording = self._recording
        one, two = (
            each if recording.problem.in_space else lifted(each)
            for each in recording.poses[[earlier, later]]
        )
        if not share:
            return one
        # Turns between frames are even.
        first = Rotation.from_rotvec(one[:, 3:])
        way = (Rotation.from_rotvec(two[:, 3:]) * first.inv()).as_rotvec()
        turned = Rotation.from_rotvec(share * way) * first
        places = one[:, :3] + share * (two[:, :3] - one[:, :3])
        return np.hstack([places, turned.as_rotvec()])

    def placed(self, earlier: int, later: int, share: float) -> tuple[Array, Array]:
        """Return turns since blocks were built, (blocks, 3, 3), and centres, y upwards."""
        return upright(self.poses(earlier, later, share))


def upright(poses: Array) -> tuple[Array, Array]:
    """Return turns, (blocks, 3, 3), and centres, (blocks, 3), y upwards, of poses."""
    turns = Rotation.from_rotvec(poses[:, 3:]).as_matrix()
    return UPRIGHT @ turns @ UPRIGHT.T, poses[:, :3] @ UPRIGHT.T


class Placing:
    """Convex pieces of blocks, and joints, carried by the poses of a recording.

    It has:
    `owner`, (pieces,): The block that each piece belongs to.
    `outlines`, (pieces, sides, 2): Of the pieces, from the centres of their blocks; what has
        fewer corners repeats its last one.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording, assembly = recording, recording.assembly
        pieces = [
            (index, (part - block.centre) / assembly.size)
            for index, block in enumerate(assembly.blocks)
            for part in block.polygons
        ]
        self.owner = np.array([index for index, _ in pieces])
        sides = max(len(each) for _, each in pieces)
        self.outlines = np.array(
            [np.pad(each, ((0, sides - len(each)), (0, 0)), "edge") for _, each in pieces]
        )
        self._half = assembly.depths[self.owner] / 2
        self._frames = Frames(recording)

    def corners(self, earlier: int, later: int, share: float) -> Array:
        """Corners in space between two frames."""
        turns, centres = self._frames.placed(earlier, later, share)
        half = np.broadcast_to(self._half[:, None, None], (*self.outlines.shape[:2], 1))
        near = np.concatenate([self.outlines, half], axis=-1)
        local = np.stack([near, near * [1, 1, -1]], axis=1)
        owner = self.owner
        return centres[owner][:, None, None] + local @ turns[owner][:, None].swapaxes(2, 3)

    def faces(self, earlier: int, later: int, share: float) -> Array:
        """Return the ends of joints in space, as the blocks on both sides carry them."""
        assembly = self._recording.assembly
        turns, centres = self._frames.placed(earlier, later, share)
        # The support comes last, as index -1 says: it stays.
        centres = np.vstack([centres, np.zeros(3)])
        turns = np.concatenate([turns, np.eye(3)[None]])
        sides = assembly.sides.T
        local = np.zeros((*sides.shape, 2, 3))
        local[..., :2] = assembly.joint_arms.swapaxes(0, 1)
        return centres[sides][:, :, None] + local @ turns[sides].swapaxes(2, 3)
