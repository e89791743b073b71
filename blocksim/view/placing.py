"""Where the blocks of a recording are in space, at its frames and between them.

Lengths are in units of the assembly's size.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from blocksim.blocks.assembly import SPATIAL, SUPPORT, Array, Joint
from blocksim.simulation.recording import Recording
from blocksim.view.drawing import Part


class Placing:
    """Convex pieces of blocks, and joints, carried by the poses of a recording.

    `sides`: Corners that a piece is to have at least.

    It has:
    `owner`, (pieces,): The block that each piece belongs to.
    `sides`: Corners of each piece; what has fewer repeats its last one.
    `outlines`, (pieces, sides, 2): Of the pieces, from the centres of their blocks.
    """

    def __init__(self, recording: Recording, sides: int) -> None:
        self._recording, assembly = recording, recording.assembly
        pieces = [
            (index, (part - block.centre) / assembly.size)
            for index, block in enumerate(assembly.blocks)
            for part in block.polygons
        ]
        self.owner = np.array([index for index, _ in pieces])
        self.sides = max(sides, *(len(each) for _, each in pieces))
        self.outlines = np.array([padded(each, self.sides) for _, each in pieces])
        self._half = assembly.depths[self.owner] / 2
        self._turns = quaternions(recording)

    def corners(self, earlier: int, later: int, share: float) -> Array:
        """Corners in space between two frames."""
        centres, turns = self._placed(earlier, later, share)
        half = np.broadcast_to(self._half[:, None, None], (*self.outlines.shape[:2], 1))
        near = np.concatenate([self.outlines, half], axis=-1)
        local = np.stack([near, near * [1, 1, -1]], axis=1)
        owner = self.owner
        return centres[owner][:, None, None] + _turned(turns[owner][:, None, None], local)

    def faces(self, earlier: int, later: int, share: float) -> Array:
        """Return the ends of joints in space, as the blocks on both sides carry them."""
        assembly = self._recording.assembly
        centres, turns = self._placed(earlier, later, share)
        # The support comes last, as index -1 says: it stays.
        centres = np.vstack([centres, np.zeros(3)])
        turns = np.vstack([turns, [1.0, 0.0, 0.0, 0.0]])
        sides = assembly.sides.T
        local = np.zeros((*sides.shape, 2, 3))
        local[..., :2] = assembly.joint_arms.swapaxes(0, 1)
        return centres[sides][:, :, None] + _turned(turns[sides][:, :, None], local)

    def side(self, joint: Joint, block: int) -> Part | None:
        """Find the side of a piece of a block that a joint lies on."""
        if block == SUPPORT:
            return None
        pieces = np.flatnonzero(self.owner == block)
        size = self._recording.assembly.size
        corners = self.outlines[pieces] + self._recording.assembly.centres[block] / size
        along = np.roll(corners, -1, axis=1) - corners
        square = (along**2).sum(axis=-1)
        ends = np.array([joint.inner, joint.outer]) / size
        arm = ends - corners[..., None, :]
        # Shares of a side at which the ends are nearest to it.
        share = (arm * along[..., None, :]).sum(axis=-1)
        share = np.clip(share / np.where(square > 0, square, 1.0)[..., None], 0.0, 1.0)
        off = np.linalg.norm(arm - share[..., None] * along[..., None, :], axis=-1).sum(axis=-1)
        off = np.where(square > 0, off, np.inf)
        piece, side = np.unravel_index(int(np.argmin(off)), off.shape)
        start, stop = sorted(share[piece, side].tolist())
        return Part(int(pieces[piece]), int(side), start, stop)

    def _placed(self, earlier: int, later: int, share: float) -> tuple[Array, Array]:
        """Centres and rotations of the blocks between two frames."""
        centres = centres_at(self._recording, earlier) * (1 - share)
        centres += centres_at(self._recording, later) * share
        turns = self._turns[earlier] * (1 - share) + self._turns[later] * share
        turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
        return centres, turns


def padded(outline: Array, sides: int) -> Array:
    """Repeat the last corner of an outline until it has as many as asked for."""
    return np.pad(outline, ((0, sides - len(outline)), (0, 0)), "edge")


def centres_at(recording: Recording, frame: int) -> Array:
    """Centres of the blocks in space, (blocks, 3)."""
    poses = recording.poses[frame]
    centres = np.zeros((len(poses), 3))
    centres[:, :2] = poses[:, :2]
    if poses.shape[1] == SPATIAL:
        centres[:, 2] = poses[:, 3]
    return centres


def quaternions(recording: Recording) -> Array:
    """Rotations as unit quaternions w, x, y, z that go on smoothly, (frames, blocks, 4)."""
    poses = recording.poses
    vectors = np.zeros((*poses.shape[:2], 3))
    vectors[..., 2] = poses[..., 2]
    if poses.shape[2] == SPATIAL:
        vectors[..., :2] = poses[..., 4:]
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    # sin(angle/2)/angle, 1/2 where nothing turns.
    turns = np.concatenate([np.cos(angle / 2), vectors * np.sinc(angle / (2 * np.pi)) / 2], -1)
    for earlier, later in pairwise(turns):
        # q and -q are one rotation: take the one nearer to the frame before.
        later[(earlier * later).sum(axis=-1) < 0] *= -1
    return turns


def _turned(turns: Array, points: Array) -> Array:
    """Rotate points by unit quaternions."""
    axis = turns[..., 1:]
    across = 2 * np.cross(axis, points)
    return points + turns[..., :1] * across + np.cross(axis, across)


def depth_of(points: Array, outline: Array) -> Array:
    """How far points (..., 2) are inside convex outlines (..., sides, 2), below 0 outside."""
    along = np.roll(outline, -1, axis=-2) - outline
    length = np.linalg.norm(along, axis=-1)
    inward = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    height = ((points[..., None, :] - outline) * inward).sum(axis=-1)
    # A corner given twice makes a side without length, which bounds nothing.
    bounds = length > 0
    return np.where(bounds, height / np.where(bounds, length, 1.0), np.inf).min(axis=-1)


def distance_of(one: Array, other: Array) -> Array:
    """Distance of sides that do not cross, (sides, 2, 2): that of an end of one."""
    found = np.full(len(one), np.inf)
    for ends, side in ((one, other), (other, one)):
        along = side[:, 1] - side[:, 0]
        square = (along**2).sum(axis=-1)
        arm = ends - side[:, :1]
        share = (arm * along[:, None]).sum(axis=-1) / np.where(square > 0, square, 1.0)[:, None]
        off = arm - np.clip(share, 0.0, 1.0)[..., None] * along[:, None]
        found = np.minimum(found, np.linalg.norm(off, axis=-1).min(axis=-1))
    return found
