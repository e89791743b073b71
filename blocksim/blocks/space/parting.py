"""Poses in space to motions: how far the sides of joints part."""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.joints import BESIDE
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.later import transform

FACE = 3
"""Points of a joint from which on it has an area."""


def parted(assembly: SpatialAssembly, poses: Array) -> tuple[Array, Array]:
    """Return how far each point of each joint opens and slips, (points,) each [size].

    `poses`, (blocks, 6): Centres x, y, z in units of the size, and rotation vectors since they
        were built.
    """
    joints, size = assembly.joints, assembly.size
    joint = np.repeat(np.arange(len(joints)), [len(each.points) for each in joints])
    points = assembly.points / size
    normals = np.array([each.normal for each in joints]).reshape(-1, 3)[joint]
    way = np.zeros_like(points)
    for block, sign in zip(assembly.sides[:, joint], (-1.0, 1.0), strict=True):
        on = block != SUPPORT
        own, at = points[on], block[on]
        centre = assembly.centres[at] / size
        turned = transform.Rotation.from_rotvec(poses[at, 3:]).apply(own - centre)
        way[on] += sign * (poses[at, :3] + turned - own)
    gap = np.einsum("pi,pi->p", way, normals)
    slip = np.linalg.norm(way - gap[:, None] * normals, axis=1)
    return gap, slip


def overlap_and_slip_in_space(assembly: SpatialAssembly, poses: Array) -> tuple[float, float]:
    """Deepest overlap at a point of a joint, and largest slip at one that stays closed.

    Both are shares of the largest motion of a point; or of what turns about an edge or a
    corner: its turn times the reach of the smaller block; or `BESIDE` of how far blocks go.
    """
    gap, slip = parted(assembly, poses)
    turns = transform.Rotation.from_rotvec(np.vstack([poses[:, 3:], np.zeros(3)]))
    before, after = assembly.sides
    turned = (turns[before].inv() * turns[after]).magnitude() * assembly.lesser_reach
    turned = turned[[len(each.points) < FACE for each in assembly.joints]]
    gone = BESIDE * assembly.displacement(poses - assembly.built[:-1])
    moves = np.abs(gap), slip, turned, gone
    moved = max(float(each.max(initial=0.0)) for each in moves)
    if not moved > 0:
        return 0.0, 0.0
    slides = float(np.where(gap < slip, slip, 0.0).max(initial=0.0))
    return max(0.0, -float(gap.min(initial=0.0))) / moved, slides / moved
