"""How motions are written in a three-dimensional engine, and the boxes on their faces."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import SPATIAL, Array, Assembly
from blocksim.common.later import transform
from blocksim.engines.faces import LEDGE, Side

PLATE = 0.15
"""Thickness of the box on a face, in units of the block's extent normal to it."""
THINNEST = 2e-4
"""Least thickness of the box on a face [size]."""
ROD = 1e-4
"""Thickness of the rod in a corner [size]."""
EDGE = 1e-2
"""The same, of one that stands on its edge [size]."""
IN_PLANE = [0, 1, 5]
"""What is of the plane, of x, y, z and a rotation vector."""
UNTURNED = (0.0, 0.0, 0.0, 1.0)
"""Quaternion of a body that is not turned."""
LEAST_TURN = 1e-2
"""Rotation below which that of a block does not tell its axis [rad]."""


class Frame:
    """How motions of bodies are written.

    `columns`: Those that are told, of x, y, z and a rotation vector.
    `built`, (blocks, 4) or (4,): Quaternions with which bodies are built.
    """

    def __init__(
        self, columns: Sequence[int], built: Array | Sequence[float] = UNTURNED
    ) -> None:
        self.columns, self._built = list(columns), transform.Rotation.from_quat(built)

    def motions(self, linear: Array, angular: Array) -> Array:
        """Return velocities (blocks, 3) along and about the engine's axes as columns."""
        return np.hstack([linear, angular])[:, self.columns]

    def told(self, motion: Array) -> tuple[list[float], list[float]]:
        """Return a motion in columns as vectors along and about the engine's axes."""
        found = np.zeros(SPATIAL)
        found[self.columns] = motion
        return found[:3].tolist(), found[3:].tolist()

    def poses(self, places: Array, quaternions: Array) -> Array:
        """Return places (blocks, 3) and orientations x, y, z, w (blocks, 4) likewise."""
        since = transform.Rotation.from_quat(quaternions) * self._built.inv()
        return self.motions(places, since.as_rotvec())


def unwound(turned: Array, before: Array) -> Array:
    """Return the rotation vectors of the same orientations that are nearest to earlier ones.

    An orientation tells of no whole turns: of it alone a block that has turned by half a
    turn is one that rocks from one side to the other.

    `turned`, `before`, (blocks, 3): Rotation vectors [rad].
    """
    far = np.hypot.reduce(turned, axis=1, keepdims=True) > LEAST_TURN
    # Turned as it was built again it has the axis of before.
    along = np.where(far, turned, before)
    length = np.hypot.reduce(along, axis=1, keepdims=True)
    axis = along / np.maximum(length, LEAST_TURN)
    missing: Array = ((before - turned) * axis).sum(axis=1, keepdims=True)
    return turned + 2 * math.pi * np.round(missing / (2 * math.pi)) * axis


@dataclass(frozen=True)
class Box:
    """A box in the frame of its body: half extents, centre, quaternion x, y, z, w."""

    half: list[float]
    centre: list[float]
    quaternion: list[float]


def plate(side: Side, depth: float, origin: Array, overlap: float, turn: float = 0.0) -> Box:
    """Return the box on one side of a joint; a thin rod for a corner.

    `depth`: How deep it is.
    `origin`, (2,): Of its body.
    `overlap`: Of two closed sides.
    `turn`: By which it is turned farther in the plane.
    Returns: Its first axis is the joint's tangent, and its last is the depth.
    """
    along = side.ends[1] - side.ends[0]
    length = float(np.hypot(*along))
    thick = max(PLATE * side.room, THINNEST)
    if side.is_corner:
        length = thick = ROD
        along = np.array([-side.inward[1], side.inward[0]])
    centre = side.ends.mean(axis=0) + side.inward * (thick - overlap) / 2 - origin
    angle = math.atan2(along[1], along[0])
    return _box([length, thick, depth], centre, angle + turn)


def edge(side: Side, depth: float, origin: Array, overlap: float, turn: float = 0.0) -> Box:
    """Return a box in a corner that touches the other side with one edge; see `plate`."""
    centre = side.ends[0] + side.inward * (EDGE / math.sqrt(2) - overlap / 2) - origin
    angle = math.atan2(side.inward[1], side.inward[0]) + math.pi / 4
    return _box([EDGE, EDGE, depth], centre, angle + turn)


def _box(size: list[float], centre: Array, angle: float) -> Box:
    return Box(
        half=[each / 2 for each in size],
        centre=[*centre.tolist(), 0.0],
        quaternion=[0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)],
    )


def uneven_depths(assembly: Assembly) -> Array:
    """Depths of blocks, of two that touch one a little more, shape (blocks,), scaled."""
    joints = assembly.joint_arrays
    rank = np.zeros(len(assembly.blocks))
    near: dict[int, set[int]] = defaultdict(set)
    for one, other in zip(joints.before.tolist(), joints.after.tolist(), strict=True):
        near[one].add(other)
        near[other].add(one)
    for index in range(len(rank)):
        taken = {rank[other] for other in near[index] if 0 <= other < index}
        rank[index] = next(k for k in itertools.count() if k not in taken)
    return assembly.depths + 2 * LEDGE * rank / max(1.0, rank.max())
