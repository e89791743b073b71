"""The faces of blocks at their joints, as engines with shapes of their own need them."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Joint

LEDGE = 2e-3
"""Most that one face of each joint reaches beyond the other [size]."""
LEDGE_SHARE = 0.05
"""The same, in units of the joint's length."""


def faces_of(assembly: Assembly) -> list[list[Joint]]:
    """Return the joints of each block, in order."""
    faces: list[list[Joint]] = [[] for _ in assembly.blocks]
    for joint in assembly.joints:
        for index in (joint.before, joint.after):
            if index != SUPPORT:
                faces[index].append(joint)
    return faces


def side(joint: Joint, index: int) -> float:
    """Sign of the direction from the joint into the block."""
    return 1.0 if joint.after == index else -1.0


def ledge(joint: Joint, index: int, size: float) -> float:
    """Return how far the face of a block reaches beyond the joint, in units of the size.

    One face of each joint is the larger; a support is wider than any joint, so that only
    between blocks one has to be.
    """
    larger = joint.after == index and joint.before != SUPPORT
    return min(LEDGE, LEDGE_SHARE * joint.length / size) if larger else 0.0


def crowding(end: Array, along: Array, faces: list[Joint], size: float, width: float) -> float:
    """Return how far a face must end short of a corner, for the block to be wide enough.

    Where the intrados shrinks to a point (eta near 2) neighbouring faces would cross
    there, and voussoirs that do not share a joint would touch.

    Parameters
    ----------
    end, along : (2,) float
        The corner [m] and the direction from it along the face.
    faces : list of Joint
        All joints of the block.
    size : float
        Of the assembly [m].
    width : float
        Least width of the block where the face ends [size].

    Returns
    -------
    float
        In units of the size; negative where there is room.
    """
    cut = -math.inf
    for joint in faces:
        for other, direction in ((joint.inner, joint.tangent), (joint.outer, -joint.tangent)):
            apart = float(np.hypot(*(other - end))) / size
            spread = float(np.hypot(*(direction - along)))
            if 0 < spread < 1:
                cut = max(cut, (width - apart) / spread)
    return cut
