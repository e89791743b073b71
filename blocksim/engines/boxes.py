"""Where blocks lie in a three-dimensional engine, and the boxes on their faces."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import Array, Block, Joint
from blocksim.engines.faces import crowding, ledge, side

PLATE = 0.15
"""Thickness of the box on a face, in units of the block's extent normal to it."""
THINNEST = 2e-4
"""Least thickness of the box on a face [size]."""


class Frame:
    """Where the plane of the assembly lies in the engine's space.

    Parameters
    ----------
    turn : float, optional
        About the vertical [rad].
    origin : tuple of float, optional
        Place of the assembly's origin [size].
    """

    def __init__(
        self, turn: float = 0.0, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> None:
        self._turned = Rotation.from_rotvec([0.0, turn, 0.0])
        self._origin = np.array(origin)

    def vector(self, x: float, y: float, z: float) -> list[float]:
        """Turn a vector of the plane, z out of it, into the engine's space."""
        turned: list[float] = self._turned.apply([x, y, z]).tolist()
        return turned

    def place(self, centre: Array) -> list[float]:
        """Where a point of the plane lies, x, y, z."""
        x, y, z = self.vector(centre[0], centre[1], 0.0)
        return [x + self._origin[0], y + self._origin[1], z + self._origin[2]]

    @property
    def quaternion(self) -> list[float]:
        """How a block at rest is turned."""
        turned: list[float] = self._turned.as_quat().tolist()
        return turned

    def motions(self, linear: Array, angular: Array) -> Array:
        """Return velocities in the assembly's columns, shape (blocks, 6).

        Parameters
        ----------
        linear, angular : (blocks, 3) float
            In the engine's space.
        """
        back = self._turned.inv()
        shift, turn = back.apply(linear), back.apply(angular)
        return np.column_stack([shift[:, :2], turn[:, 2], shift[:, 2], turn[:, :2]])

    def wrench(self, place: Array, force: Array) -> Array:
        """Return a force (3,) at a place (3,) as x, y and moment in the plane, (3,)."""
        back = self._turned.inv()
        (x, y, _), (right, up, _) = back.apply([place - self._origin, force])
        return np.array([right, up, x * up - y * right])

    def poses(self, places: Array, quaternions: Array) -> Array:
        """Return places (blocks, 3) and orientations x, y, z, w (blocks, 4) likewise."""
        since = Rotation.from_quat(quaternions) * self._turned.inv()
        return self.motions(places - self._origin, since.as_rotvec())


@dataclass(frozen=True)
class Box:
    """A box in the frame of its body: half extents, centre, orientation."""

    half: list[float]
    centre: list[float]
    quaternion: list[float]

    @classmethod
    def along(cls, joint: Joint, half: list[float], centre: Array) -> Box:
        """Return one whose first axis is the joint's tangent and whose last is the depth."""
        angle = math.atan2(joint.tangent[1], joint.tangent[0])
        quaternion = [0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)]
        return cls(half=half, centre=[*centre.tolist(), 0.0], quaternion=quaternion)


def plate(
    block: Block, index: int, joint: Joint, faces: list[Joint], size: float, overlap: float
) -> Box:
    """Return the box on one face of a block.

    Parameters
    ----------
    block : Block
    index : int
        Of the block.
    joint : Joint
        Its joint there.
    faces : list of Joint
        All its joints.
    size : float
        Of the assembly [m].
    overlap : float
        Of two closed faces [size].

    Returns
    -------
    Box
        Lengths in units of the size. Where the block narrows to nothing (eta near 2), the
        box is thin and the face cut short, so that it stays within the block.
    """
    inward = side(joint, index) * joint.normal
    extent = float(((block.vertices - joint.inner) @ inward).max()) / size
    ends = ((joint.inner, joint.tangent), (joint.outer, -joint.tangent))
    narrowest = min(
        (
            float(np.hypot(*(corner - end))) / size
            for end, _ in ends
            for other in faces
            if other is not joint
            for corner in (other.inner, other.outer)
        ),
        default=extent,
    )
    thickness = min(PLATE * extent, max(narrowest / 2, THINNEST))
    beyond = ledge(joint, index, size)
    cuts = [max(-beyond, crowding(*end, faces, size, thickness)) for end in ends]
    inner, outer = (
        end / size + along * cut for (end, along), cut in zip(ends, cuts, strict=True)
    )
    half = [
        float(np.hypot(*(outer - inner))) / 2,
        thickness / 2,
        block.depth / size / 2 + beyond,
    ]
    centre = (inner + outer) / 2 + inward * (thickness - overlap) / 2 - block.centre / size
    return Box.along(joint, half, centre)


def footing(block: Block, joint: Joint, size: float, overlap: float) -> tuple[Box, Array]:
    """Return a slab under a springing, wider than the joint on all sides, and its centre.

    Parameters
    ----------
    block : Block
        The one that stands on it.
    joint : Joint
        The springing.
    size : float
        Of the assembly [m].
    overlap : float
        Of two closed faces [size].

    Returns
    -------
    box : Box
        About its own centre, lengths in units of the size.
    centre : (2,) float
        In the plane.
    """
    length = joint.length / size
    into = side(joint, joint.bears) * joint.normal
    centre = (joint.inner + joint.outer) / 2 / size - into * (length - overlap) / 2
    half = [1.5 * length, length / 2, block.depth / size]
    return Box.along(joint, half, np.zeros(2)), centre
