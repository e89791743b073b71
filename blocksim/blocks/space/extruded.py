"""Plane problems as prisms in space: x stays, the plane's y points up, depth lies along y."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np

from blocksim.blocks.acting import Load, sideways
from blocksim.blocks.assembly import SPATIAL, SUPPORT, Array, Assembly, Joint
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.space.assembly import FaceJoint, SolidBlock, SpatialAssembly
from blocksim.blocks.space.polyhedron import Polyhedron

UP = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
"""The plane in space."""
ALIKE = 1e-9
"""Distance, over the size, and share of a force that are none."""


def extruded(problem: Problem) -> Problem[SpatialAssembly]:
    """Return a plane problem as prisms in space, with its own joints, weights and loads.

    Parameters
    ----------
    problem : Problem
        Gravity may lean out of its plane.

    Raises
    ------
    InputError
        If it has what is of the plane: ground that shakes, supports or blocks that move, blocks
        that crush, or soil that bears.

    Examples
    --------
    >>> import blocksim
    >>> arch = blocksim.CircularArch(half_angle_deg=90, eta=0.2, friction=0.7, voussoirs=9)
    >>> extruded(arch.problem())
    Problem(9 blocks in space, 10 joints, mu=0.7)
    """
    x, y, out = problem.gravity.tolist()
    # What soil weighs, and presses by, are loads already.
    bears = problem.soil is not None and any(problem.soil.passive)
    return replace(
        cast("Problem[Any]", problem),
        assembly=prisms(problem.assembly),
        # Out of the plane is towards who looks at it: against y.
        gravity=np.array([x, -out, y]),
        dead=tuple(map(_load, problem.dead)),
        live=tuple(map(_load, problem.live)),
        maker=None,
        road=(),
        dispersal=None,
        soil=problem.soil if bears else None,
        notes=(*problem.notes, "blocks of the plane as prisms"),
    )


def prisms(assembly: Assembly) -> SpatialAssembly:
    """Return blocks of the plane as prisms, with their joints and supports."""
    deep = max(block.depth for block in assembly.blocks)
    return SpatialAssembly(
        blocks=tuple(
            SolidBlock(
                hulls=tuple(prism(part, block.depth) for part in block.polygons),
                name=block.name or str(at),
                weight=block.mass * STANDARD_GRAVITY,
                centre=UP @ block.centre,
            )
            for at, block in enumerate(assembly.blocks)
        ),
        supports=tuple(
            SolidBlock(
                hulls=tuple(prism(part, deep) for part in support.polygons),
                name=support.name or f"support {at}",
                weight=0.0,
                centre=np.zeros(3),
            )
            for at, support in enumerate(assembly.supports)
        ),
        joints=tuple(_face(joint, assembly) for joint in assembly.joints),
    )


def prism(polygon: Array, depth: float) -> Polyhedron:
    """Return a convex polygon as a prism of some depth, halved by the plane."""
    return Polyhedron(np.concatenate([_at(polygon, -depth / 2), _at(polygon, depth / 2)]))


def way_of_prisms(problem: Problem[SpatialAssembly]) -> Array | None:
    """Return the direction along which a problem in space is one of the plane, (3,), if any.

    Blocks are prisms as deep as each other, side by side, touch over the whole depth, and
    what acts on them acts across, through the middle. So the depth that way is of no account.
    """
    first = problem.assembly.blocks[0].hulls[0].faces
    ways = (face.normal for face in first)
    return next((way for way in ways if _is_along(problem, way)), None)


def _is_along(problem: Problem[SpatialAssembly], way: Array) -> bool:
    """Tell whether a problem is the same at any depth along a direction, (3,)."""
    assembly = problem.assembly
    near = ALIKE * assembly.size
    loads = (*problem.dead, *problem.live)
    pulls = [problem.gravity, *(each.force for each in loads)]
    pulls += [] if problem.shaking is None else [sideways(problem)]
    if any(abs(each @ way) > ALIKE * np.abs(each).max() for each in pulls):
        return False
    depths = assembly.blocks[0].hulls[0].corners @ way
    low, high = float(depths.min()), float(depths.max())
    middles = [each.centre for each in assembly.blocks]
    middles += [each.point for each in loads if each.point is not None]
    if any(abs(each @ way - (low + high) / 2) > near for each in middles):
        return False
    ends = [each.points @ way for each in assembly.joints]
    ends += [hull.corners @ way for each in assembly.blocks for hull in each.hulls]
    if any(np.minimum(abs(each - low), abs(each - high)).max() > near for each in ends):
        return False
    faces = (face for each in assembly.blocks for hull in each.hulls for face in hull.faces)
    leans = (abs(float(face.normal @ way)) for face in faces)
    return all(min(each, 1 - each) <= ALIKE for each in leans)


def lifted(poses: Array) -> Array:
    """Return poses of the plane, (..., blocks, 3), as those of the prisms, (..., 6).

    In units of the size: centres x, y, z, and rotation vectors.
    """
    found = np.zeros((*poses.shape[:-1], SPATIAL))
    found[..., [0, 2, 4]] = poses * [1.0, 1.0, -1.0]
    return found


def _at(points: Array, y: float) -> Array:
    """Put points of the plane at a distance from it, (k, 3)."""
    return points @ UP.T + np.array([0.0, y, 0.0])


def _face(joint: Joint, assembly: Assembly) -> FaceJoint:
    """Return a joint over the depth that both blocks have."""
    sides = [each for each in (joint.before, joint.after) if each != SUPPORT]
    half = min(assembly.blocks[each].depth for each in sides) / 2
    ends = joint.inner[None] if joint.is_corner else np.stack([joint.inner, joint.outer])
    return FaceJoint(
        before=joint.before,
        after=joint.after,
        points=np.concatenate([_at(ends, -half), _at(ends[::-1], half)]),
        normal=UP @ joint.normal,
        friction=joint.friction,
        support=joint.support,
        gap=joint.gap,
    )


def _load(load: Load) -> Load:
    point = None if load.point is None else UP @ load.point
    return replace(load, force=UP @ load.force, point=point)
