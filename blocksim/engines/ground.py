"""What an assembly stands on: its supports, and level ground.

Theory knows springings only. A collapse needs something to fall past and onto: where
supports are known they are that, and the floor is level with the lowest of them. Otherwise
there are piers as wide as their joints, and a floor a little below the lowest of them.
Nothing of this touches a block at rest except through its joint.
"""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly

DEPTH = 0.5
"""Level of the ground below the lowest end of a joint to the support [size]."""


def ground_level(assembly: Assembly) -> float:
    """Height of the ground [m]."""
    if assembly.supports:
        bodies = (*standing(assembly), *assembly.corners)
        return min(float(each[:, 1].min()) for each in bodies)
    ends = [end for face in _faces(assembly) for end in face]
    return float(min(end[1] for end in ends)) - DEPTH * assembly.size


def standing(assembly: Assembly) -> tuple[Array, ...]:
    """Polygons [m] of what stays above the ground, those of each support in order."""
    if assembly.supports:
        return tuple(each for support in assembly.supports for each in support.polygons)
    return piers(assembly)


def standing_at(assembly: Assembly) -> list[range]:
    """Tell for each joint which polygons of `standing` it lies on; none between blocks."""
    on_support = [SUPPORT in (joint.before, joint.after) for joint in assembly.joints]
    if not assembly.supports:
        count = np.cumsum(on_support).tolist()
        return [range(n - has, n) for n, has in zip(count, on_support, strict=True)]
    first = np.cumsum([0] + [len(each.polygons) for each in assembly.supports]).tolist()
    found: list[range] = []
    for joint, has in zip(assembly.joints, on_support, strict=True):
        at = joint.support
        every = range(first[-1]) if at is None else range(first[at], first[at + 1])
        found.append(every if has else range(0))
    return found


def piers(assembly: Assembly) -> tuple[Array, ...]:
    """Piers from the ground up to each joint to the support.

    Returns tuple of (4, 2): Corners, counter-clockwise [m]; each in the order of the assembly's
        joints.
    """
    level = ground_level(assembly)
    found: list[Array] = []
    for face in _faces(assembly):
        left, right = sorted(face, key=lambda end: float(end[0]))
        found.append(np.array([(left[0], level), (right[0], level), right, left]))
    return tuple(found)


def _faces(assembly: Assembly) -> list[tuple[Array, Array]]:
    return [(joint.inner, joint.outer) for joint in assembly.springings]
