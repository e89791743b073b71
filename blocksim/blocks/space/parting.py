"""Poses in space to motions: how far the sides of joints part."""

from __future__ import annotations

from itertools import chain

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.joints import BESIDE
from blocksim.blocks.space.assembly import FaceJoint, SpatialAssembly
from blocksim.common.later import transform

FACE = 3
"""Points of a joint from which on it has an area."""
NEAR = 1e-6
"""Distance from the plane of a joint up to which a face lies in it [size]."""
LEVEL = 0.98
"""Cosine of the angle between two faces from which they no longer form a joint."""


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


def joined(assembly: SpatialAssembly, poses: Array, apart: float) -> NDArray[np.bool_]:
    """Tell which joints still are joints, (joints,), however far their blocks have gone.

    Their faces lie over each other, nearly parallel, and a point is no more than `apart` above
    the other block [size]. What stands on an edge or a corner need only be so near.

    `poses`, (blocks, 6): As for `parted`.
    """
    turns = transform.Rotation.from_rotvec(np.vstack([poses[:, 3:], np.zeros(3)])).as_matrix()
    built = np.vstack([assembly.centres / assembly.size, np.zeros(3)])
    places = np.vstack([poses[:, :3], np.zeros(3)])

    def now(side: int, points: Array) -> Array:
        return places[side] + (points / assembly.size - built[side]) @ turns[side].T

    found = np.ones(len(assembly.joints), dtype=bool)
    for at, joint in enumerate(assembly.joints):
        one, other = joint.before, joint.after
        normal, turned = turns[one] @ joint.normal, turns[other] @ joint.normal
        ours, theirs = now(one, joint.points), now(other, joint.points)
        found[at] = float(((theirs - ours[0]) @ normal).min()) <= apart
        if found[at] and len(joint.points) >= FACE:
            beds = _faces(assembly, joint, one, joint.normal)
            tops = _faces(assembly, joint, other, -joint.normal)
            pairs = ((now(one, bed), now(other, top)) for bed in beds for top in tops)
            found[at] = normal @ turned > LEVEL and any(_over(*pair, normal) for pair in pairs)
    return found


def turned_over(assembly: SpatialAssembly, poses: Array) -> NDArray[np.bool_]:
    """Tell at which joints faces have ever looked away from each other, (joints,).

    `poses`, (frames, blocks, 6): As for `parted`.
    """
    turns = np.pad(poses[:, :, 3:], ((0, 0), (0, 1), (0, 0)))
    frames, blocks, _ = turns.shape
    matrices = transform.Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix()
    matrices = matrices.reshape(frames, blocks, 3, 3)
    normals = np.array([each.normal for each in assembly.joints])
    before, after = (
        np.einsum("fjik,jk->fji", matrices[:, side], normals) for side in assembly.sides
    )
    return ((before * after).sum(axis=2) < 0).any(axis=0)


def _faces(
    assembly: SpatialAssembly, joint: FaceJoint, side: int, outwards: Array
) -> list[Array]:
    """Return the corners of the faces of a block in the plane of a joint; else of the joint."""
    if side == SUPPORT and joint.support is None:
        return [joint.points]
    body = assembly.supports[joint.support or 0] if side == SUPPORT else assembly.blocks[side]
    middle, near = joint.points.mean(axis=0), abs(joint.gap) + NEAR * assembly.size
    return [
        face.corners
        for hull in body.hulls
        for face in hull.faces
        if face.normal @ outwards > LEVEL and abs(face.normal @ middle - face.offset) <= near
    ] or [joint.points]


def _over(one: Array, other: Array, normal: Array) -> bool:
    """Tell whether two convex polygons, (k, 3) and (m, 3), overlap as seen along a normal."""
    edges = chain(np.roll(one, -1, axis=0) - one, np.roll(other, -1, axis=0) - other)
    across = np.cross(normal, np.array(list(edges)))
    first, second = one @ across.T, other @ across.T
    low = np.minimum(first.max(axis=0), second.max(axis=0))
    return bool((low > np.maximum(first.min(axis=0), second.min(axis=0))).all())
