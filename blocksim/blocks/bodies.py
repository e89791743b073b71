"""Blocks that move as one: a problem of fewer bodies, and where they carry their blocks."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly, Block, Joint
from blocksim.blocks.problem import STANDARD_GRAVITY, Load, Problem
from blocksim.common.later import csgraph, sparse

if TYPE_CHECKING:
    from blocksim.blocks.space.assembly import SpatialAssembly

Owner = NDArray[np.int64]
"""The body each block is part of, (blocks,); bodies are numbered from 0."""


def problem_of_bodies(problem: Problem, owner: Owner) -> Problem:
    """Return the problem of bodies, from that of all blocks.

    Masses, centres and inertias are the sums of those of their blocks, and so are loads. Joints
    are those between different bodies, and those with supports.

    `owner`, (blocks,).
    """
    assembly = problem.assembly
    members = [np.flatnonzero(owner == each).tolist() for each in range(owner.max() + 1)]
    bodies = replace(
        assembly,
        blocks=tuple(_merged([assembly.blocks[k] for k in its]) for its in members),
        joints=tuple(
            _between(assembly, int(index), owner)
            for index in np.flatnonzero(~within_bodies(assembly, owner))
        ),
    )
    dead, live = (
        tuple(moved for load in loads for moved in _loads(load, assembly, owner))
        for loads in (problem.dead, problem.live)
    )
    return replace(problem, assembly=bodies, dead=dead, live=live)


def connected(count: int, one: ArrayLike, other: ArrayLike) -> Owner:
    """Return the group of each of so many things, of which some are connected in pairs.

    `one`, `other`, (pairs,).
    """
    pairs = np.asarray(one), np.asarray(other)
    graph = sparse.coo_array((np.ones(len(pairs[0])), pairs), shape=(count, count))
    return csgraph.connected_components(graph, directed=False)[1].astype(np.int64)


def bodies_of(
    assembly: Assembly | SpatialAssembly, ways: Array, turns: Array, least: float
) -> Owner:
    """Return the body of each block, of those that no joint parts; `SUPPORT` at rest.

    `ways`, `turns`, (joints,): How fast the sides of each joint part, and turn apart.
    `least`: Share of the fastest up to which blocks move as one.
    """
    count, sides = len(assembly.blocks), assembly.sides
    reach = np.append(assembly.reach / assembly.size, math.inf)[sides].min(axis=0)
    apart = np.maximum(ways, turns * reach)
    together = apart <= least * float(apart.max())
    one, other = np.where(sides == SUPPORT, count, sides)[:, together]
    label = connected(count + 1, one, other)
    free = label[:-1] != label[-1]
    owner = np.full(count, SUPPORT, dtype=np.int64)
    owner[free] = np.unique(label[:-1][free], return_inverse=True)[1]
    return owner


def parting(assembly: Assembly, rates: Array) -> tuple[Array, Array]:
    """Return how fast the sides of joints part.

    `rates`, (blocks, 3).
    Returns `ways`, (joints, 2, 2): Of both ends on the block after, less those on the block
        before.
    Returns `turns`, (joints,): Rotations likewise.
    """
    moved, arms = np.vstack([rates, np.zeros(PLANAR)])[assembly.sides], assembly.joint_arms
    across = np.stack([-arms[..., 1], arms[..., 0]], axis=-1)
    before, after = moved[..., None, :2] + moved[..., None, 2:] * across
    return after - before, moved[1, :, 2] - moved[0, :, 2]


def within_bodies(assembly: Assembly, owner: Owner) -> NDArray[np.bool_]:
    """Tell which joints lie within a body, (joints,)."""
    joints, of = assembly.joint_arrays, np.append(owner, SUPPORT)
    return of[joints.before] == of[joints.after]


def _between(assembly: Assembly, index: int, owner: Owner) -> Joint:
    """Return a joint between bodies."""
    joint, of = assembly.joints[index], np.append(owner, SUPPORT)
    faces = joint.faces
    if joint.is_corner:
        # A body has more faces than the block, of which the corner is on one.
        faces = assembly.joint_arrays.faces[index] * assembly.size
    before, after = int(of[joint.before]), int(of[joint.after])
    return replace(joint, before=before, after=after, faces=faces)


def _loads(load: Load, assembly: Assembly, owner: Owner) -> list[Load]:
    """Return the loads on bodies that a load on blocks comes to."""
    found: list[Load] = []
    for body in np.unique(owner[list(load.blocks)]).tolist():
        its = [assembly.blocks[k] for k in load.blocks if owner[k] == body]
        if load.point is not None:
            force, point = len(its) * load.force, load.point
        else:
            share = np.array([each.mass if load.per_weight else 1.0 for each in its])
            force = share.sum() * (STANDARD_GRAVITY if load.per_weight else 1.0) * load.force
            point = share @ np.array([each.centre for each in its]) / share.sum()
        found.append(Load(force=force, blocks=(body,), point=point))
    return found


def _merged(blocks: list[Block]) -> Block:
    """Return one block of all."""
    if len(blocks) == 1:
        return blocks[0]
    # Imported here, as others are: nothing is loaded before it is asked for.
    from blocksim.blocks.regions import hull

    mass = np.array([block.mass for block in blocks])
    centres = np.array([block.centre for block in blocks])
    centre = mass @ centres / mass.sum()
    inertia = sum(block.inertia for block in blocks)
    parts = tuple(part for block in blocks for part in block.polygons)
    return Block(
        vertices=hull(parts),
        centre=centre,
        mass=float(mass.sum()),
        inertia=float(inertia + mass @ ((centres - centre) ** 2).sum(axis=1)),
        depth=max(block.depth for block in blocks),
        parts=parts,
    )


def carried_poses(poses: Array, owner: NDArray[np.int64], offsets: Array) -> Array:
    """Return poses of blocks that bodies carry.

    `poses`, (bodies, 3).
    `owner`, (blocks,): The body of each block.
    `offsets`, (blocks, 2): From the centre of the body to that of the block, as built [size].
    """
    moved, (x, y) = poses[owner], offsets.T
    cos, sin = np.cos(moved[:, 2]), np.sin(moved[:, 2])
    moved[:, 0] += cos * x - sin * y
    moved[:, 1] += sin * x + cos * y
    return moved


def carried_rates(rates: Array, owner: NDArray[np.int64], offsets: Array) -> Array:
    """Return velocities or accelerations at rest of blocks that bodies carry, likewise."""
    moved = rates[owner]
    x, y = offsets.T
    moved[:, 0] -= moved[:, 2] * y
    moved[:, 1] += moved[:, 2] * x
    return moved


def about(forces: Array, points: Array) -> Array:
    """Return forces x, y and moments about the origin (k, 3) with moments about points."""
    turned = forces.copy()
    turned[:, 2] -= points[:, 0] * forces[:, 1] - points[:, 1] * forces[:, 0]
    return turned
