"""The structure file as data: blocks, joints, friction and loads.

Lengths in m, forces in N, y upwards. Its keys are those of `entries.StructureFile`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from blocksim.blocks.acting import shake_record
from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Joint
from blocksim.blocks.entries import Around, ShakeEntry, StructureFile
from blocksim.blocks.given import GivenJoint
from blocksim.blocks.loads import LoadsOf, Names, acting_of, given_joints, named_blocks
from blocksim.blocks.outlines import counter_clockwise
from blocksim.blocks.polygons import Body, assembly_of_bodies
from blocksim.blocks.problem import STANDARD_GRAVITY, Load, Move, Problem
from blocksim.blocks.rows import column
from blocksim.blocks.shaking import Shaking, shaking_of
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.checks import endless_text, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.tables import as_said


def structure_of(data: object) -> Problem:
    """Make a problem of what a structure file says.

    Parameters
    ----------
    data : object
        A dict with the keys of `StructureFile`.

    Raises
    ------
    InputError
        In one line: the first entry that is wrong, its value, and what would be accepted.
    """
    require(isinstance(data, dict), "structure", type(data).__name__, "a table of keys")
    written = as_said(StructureFile, data)
    bodies = _bodies(written)
    found = assembly_of_bodies(
        bodies,
        joints=_joints(written, bodies),
        density=written.unit_weight,
        size=written.size,
        tolerance=written.tolerance,
        rounding=written.rounding,
    )
    return replace(problem_of(written, bodies, *found), velocities=_velocities(written))


def _velocities(written: StructureFile) -> Array:
    """Return how blocks move at the release [m/s, rad/s]; empty where all are at rest."""
    found: list[tuple[float, float, float]] = []
    for at, block in enumerate(written.blocks):
        moves = (*block.velocity, math.radians(block.spin_deg_s))
        if not block.fixed:
            found.append(moves)
            continue
        for name in ("velocity", "spin_deg_s"):
            still = not np.any(getattr(block, name))
            require(
                still, f"blocks[{at}].{name}", getattr(block, name), "left out: it is fixed"
            )
    return np.array(found) if np.any(found) else np.zeros((0, 3))


def _bodies(written: StructureFile) -> list[Body]:
    return [
        Body(
            polygons=parts,
            name=name,
            fixed=block.fixed,
            weight=block.weight,
            centre=block.centre,
            inertia=block.inertia,
            depth=block.depth,
            free=block.free,
        )
        for block, name, parts in named_blocks(written.blocks, "polygons")
    ]


def _joints(written: StructureFile, bodies: Sequence[Body]) -> list[GivenJoint] | None:
    if written.joints is None:
        return None
    return [
        GivenJoint(
            a=a,
            b=b,
            ends=np.array(joint.ends, dtype=float),
            normal=None if joint.normal is None else np.array(joint.normal, dtype=float),
            friction=joint.friction,
            faces=None if joint.faces is None else np.array(joint.faces, dtype=float),
        )
        for joint, a, b in given_joints(written.joints, bodies, written.tolerance)
    ]


def problem_of(
    written: Around, bodies: Sequence[Body], assembly: Assembly, found: Sequence[str]
) -> Problem:
    """Make a problem of an assembly and of what a file says besides.

    `bodies`: Of which the assembly was made, each with a name of its own.
    `found`: Notes on how it was made.
    """
    acts = acting_of(written, LoadsOf(bodies), np.array(Assembly.down))
    mu = written.friction
    own = set(column(assembly.joints, "friction"))
    if len(own) == 1 and own != {None}:
        # All joints have the same friction of their own: it is that of the structure.
        mu = own.pop() or 0.0
        joined = tuple(replace(joint, friction=None) for joint in assembly.joints)
        assembly = replace(assembly, joints=joined)
    return replace(
        acts.on(assembly, mu),
        moves=_moves(written, bodies),
        shaking=_shaking(written.shake),
        weighed=written.density is not None
        or all(body.fixed or body.weight is not None for body in bodies),
        notes=(*written.notes, *acts.notes, *found),
    )


def _shaking(said: ShakeEntry | None) -> Shaking | None:
    """Return how the ground shakes, across in the plane."""
    if said is None:
        return None
    allowed = "left out in the plane"
    require(said.azimuth_deg is None, "shake.azimuth_deg", said.azimuth_deg, allowed)
    return shaking_of(said)


def _moves(written: Around, bodies: Sequence[Body]) -> tuple[Move, ...]:
    """Return how supports move."""
    fixed, body_of = [body.fixed for body in bodies], Names(bodies)
    # Fixed blocks are numbered without those that move.
    bed = np.cumsum(fixed) - 1
    moves: list[Move] = []
    for at, move in enumerate(written.move):
        place = body_of(move.block, f"move[{at}].block")
        require(fixed[place], f"move[{at}].block", move.block, "a fixed block")
        if move.direction is None and move.turn_deg == 0:
            raise InputError(f"move[{at}].direction", MISSING, "given")
        corners = np.concatenate(bodies[place].polygons)
        about = corners.mean(axis=0) if move.about is None else np.array(move.about)
        once = all(each.support != bed[place] for each in moves)
        require(once, f"move[{at}].block", move.block, "named once in move")
        moves.append(
            Move(
                support=int(bed[place]),
                direction=np.array(move.direction or (0.0, 0.0)),
                turn=math.radians(move.turn_deg),
                about=about,
            )
        )
    return tuple(moves)


def load_record(load: Load, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return a load as entries of a structure file."""
    blocks = [names[index] for index in load.blocks]
    if load.per_weight:
        return [{"body": load.force.tolist(), "blocks": blocks}]
    at = {} if load.point is None else {"point": load.point.tolist()}
    return [{"block": name, "force": load.force.tolist(), **at} for name in blocks]


def record_of(
    problem: Problem[Any],
    *,
    block: Callable[[int], dict[str, Any]],
    bed: Callable[[Any], dict[str, Any]],
    ground: Callable[[Any], list[list[float]]],
    joint: Callable[[Any], dict[str, Any]],
) -> dict[str, Any]:
    """Write a problem as a structure file does, in the plane or in space.

    A support that is not known as a body gets one behind its joint.

    `block`: Says what a block is that moves, by its place.
    `bed`, `joint`: Say what a support is, and where a joint.
    `ground`: Returns corners of a body behind a joint.
    """
    assembly: Any = problem.assembly
    names, beds = ids_of(assembly)
    grounds = {at: f"ground {at}" for at, each in enumerate(assembly.joints)
               if each.support is None and SUPPORT in (each.before, each.after)}  # fmt: skip
    fixed = [(name, bed(each)) for name, each in zip(beds, assembly.supports, strict=True)]
    fixed += [(name, {"vertices": ground(assembly.joints[at])}) for at, name in grounds.items()]
    joints: list[dict[str, Any]] = []
    for at, each in enumerate(assembly.joints):
        on = grounds.get(at, "") if each.support is None else beds[int(each.support)]
        sides = int(each.before), int(each.after)
        a, b = (on if side == SUPPORT else names[side] for side in sides)
        own = {} if each.friction is None else {"friction": endless_text(each.friction)}
        joints.append({"a": a, "b": b, **joint(each), **own})
    shake = shake_record(problem)
    return {
        "title": problem.title,
        "source": problem.source,
        "friction": endless_text(problem.mu),
        "load": problem.load,
        "blocks": [
            *({"id": name, **said, "fixed": True} for name, said in fixed),
            *({"id": name, **block(at)} for at, name in enumerate(names)),
        ],
        "joints": joints,
        "dead": [
            {"body": problem.gravity.tolist()},
            *(each for load in problem.dead for each in load_record(load, names)),
        ],
        "live": [each for load in problem.live for each in load_record(load, names)],
        **({} if shake is None else {"shake": shake}),
    }


def structure_record(problem: Problem) -> dict[str, Any]:
    """Write a problem as a structure file does; `structure_of` reads it back."""
    assembly = problem.assembly
    _, beds = ids_of(assembly)
    touched = set(assembly.sides.ravel().tolist())
    moves = [
        {
            "block": beds[move.support],
            "direction": move.direction.tolist(),
            "turn_deg": math.degrees(move.turn),
            "about": move.about.tolist(),
        }
        for move in problem.moves
    ]
    return {
        **record_of(
            problem,
            block=lambda at: _block_record(problem, at, free=at not in touched),
            bed=lambda bed: {"polygons": [each.tolist() for each in bed.polygons]},
            ground=_ground,
            joint=_joint_record,
        ),
        "size": assembly.size,
        "move": moves,
    }


def ids_of(assembly: Assembly | SpatialAssembly) -> tuple[list[str], list[str]]:
    """Return the ids of blocks and of supports: their names, where each has its own."""
    blocks = [block.name for block in assembly.blocks]
    beds = [each.name for each in assembly.supports]
    given = blocks + beds
    if all(given) and len(set(given)) == len(given):
        return blocks, beds
    return [f"b{at}" for at in range(len(blocks))], [f"s{at}" for at in range(len(beds))]


def _ground(joint: Joint) -> list[list[float]]:
    """Return the corners of a flat triangle behind a joint with the ground."""
    out = joint.normal * (-1 if joint.before == SUPPORT else 1) * joint.length / 10
    corners = np.stack([joint.inner, joint.outer, (joint.inner + joint.outer) / 2 + out])
    return counter_clockwise(corners).tolist()


def _block_record(problem: Problem, at: int, *, free: bool) -> dict[str, Any]:
    """Return what a file says of a block; joints are given, so it may be free."""
    block = problem.assembly.blocks[at]
    entry = {
        "weight": block.mass * STANDARD_GRAVITY,
        "centre": block.centre.tolist(),
        "inertia": block.inertia,
        "depth": block.depth,
        "polygons": [part.tolist() for part in block.polygons],
    }
    if free:
        entry["free"] = True
    if len(problem.velocities):
        *velocity, turn = problem.velocities[at].tolist()
        entry |= {"velocity": velocity, "spin_deg_s": math.degrees(turn)}
    return entry


def _joint_record(joint: Joint) -> dict[str, Any]:
    entry: dict[str, Any] = {"ends": [joint.inner.tolist(), joint.outer.tolist()]}
    if joint.across is not None:
        entry = {"ends": [joint.inner.tolist()], "normal": joint.across.tolist()}
    if joint.faces is not None:
        entry["faces"] = joint.faces.tolist()
    return entry
