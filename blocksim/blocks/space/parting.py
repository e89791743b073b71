"""Poses in space to motions: how far corners go, and how far the sides of joints part."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.space.assembly import SpatialAssembly


def displacement_in_space(moved: Array, assembly: SpatialAssembly) -> Array:
    """Bound of the displacement of any corner, from those of the centres.

    Parameters
    ----------
    moved : (..., blocks, 6) float
        Displacements x, y, z of the centres, in units of the size, and rotation vectors.
    assembly : SpatialAssembly

    Returns
    -------
    (...) float
        Largest over the blocks of the translation or a corner's way by rotation.
    """
    shift = np.linalg.norm(moved[..., :3], axis=-1)
    turn = np.linalg.norm(moved[..., 3:], axis=-1) * assembly.reach / assembly.size
    return np.maximum(shift, turn).max(axis=-1)


def parted(assembly: SpatialAssembly, poses: Array) -> tuple[Array, Array]:
    """Return how far each point of each joint opens and slips, (points,) each [size].

    Parameters
    ----------
    assembly : SpatialAssembly
    poses : (blocks, 6) float
        Centres x, y, z in units of the size, and rotation vectors since they were built.
    """
    joints, size = assembly.joints, assembly.size
    count = [len(each.points) for each in joints]
    points = np.concatenate([each.points for each in joints]) / size
    normals = np.repeat([each.normal for each in joints], count, axis=0)
    way = np.zeros_like(points)
    for side, sign in (("before", -1.0), ("after", 1.0)):
        block = np.repeat([getattr(each, side) for each in joints], count)
        on = block != SUPPORT
        own, at = points[on], block[on]
        centre = assembly.centres[at] / size
        turned = Rotation.from_rotvec(poses[at, 3:]).apply(own - centre)
        way[on] += sign * (poses[at, :3] + turned - own)
    gap = np.einsum("pi,pi->p", way, normals)
    slip = np.linalg.norm(way - gap[:, None] * normals, axis=1)
    return gap, slip


def overlap_in_space(assembly: SpatialAssembly, poses: Array) -> float:
    """Deepest overlap at a point of a joint, as a share of the largest motion of one."""
    gap, slip = parted(assembly, poses)
    moved = max(float(np.abs(gap).max()), float(slip.max()))
    return max(0.0, -float(gap.min())) / moved if moved > 0 else 0.0


def slip_in_space(assembly: SpatialAssembly, poses: Array) -> float:
    """Largest slip at a point of a joint that stays closed, likewise."""
    gap, slip = parted(assembly, poses)
    moved = max(float(np.abs(gap).max()), float(slip.max()))
    return float(np.where(gap < slip, slip, 0.0).max()) / moved if moved > 0 else 0.0
