"""What an assembly stands on: a pier below each joint to the support, and level ground.

Theory knows springings only. A collapse needs something to fall past and onto: piers as
wide as their joints, and a floor a little below the lowest of them. Nothing of this touches
a block at rest except through its joint.
"""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Array, Assembly

DEPTH = 0.5
"""Level of the ground below the lowest end of a joint to the support [size]."""


def ground_level(assembly: Assembly) -> float:
    """Height of the ground [m]."""
    ends = [end for face in _faces(assembly) for end in face]
    return float(min(end[1] for end in ends)) - DEPTH * assembly.size


def piers(assembly: Assembly) -> tuple[Array, ...]:
    """Piers from the ground up to each joint to the support.

    Returns
    -------
    tuple of (4, 2) float
        Corners, counter-clockwise [m]; each in the order of the assembly's joints.
    """
    level = ground_level(assembly)
    found: list[Array] = []
    for face in _faces(assembly):
        left, right = sorted(face, key=lambda end: float(end[0]))
        found.append(np.array([(left[0], level), (right[0], level), right, left]))
    return tuple(found)


def _faces(assembly: Assembly) -> list[tuple[Array, Array]]:
    return [(joint.inner, joint.outer) for joint in assembly.springings]
