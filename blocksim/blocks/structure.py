"""The structure file as data: blocks, joints, friction and loads.

Lengths in m, forces in N, y upwards. Its keys are those of `entries.StructureFile`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any, cast

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Assembly
from blocksim.blocks.entries import Around, StructureFile, entries_of
from blocksim.blocks.given import GivenJoint
from blocksim.blocks.loads import LoadsOf, Names, acting_of, name_of, sides_of
from blocksim.blocks.outlines import signed_area
from blocksim.blocks.polygons import Body, assembly_of_bodies
from blocksim.blocks.problem import DOWN, STANDARD_GRAVITY, Load, Move, Problem
from blocksim.blocks.shaking import shaking_of, shaking_record
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError


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
    table = cast(dict[str, Any], data)
    written = entries_of(table)
    bodies = _bodies(written)
    joints = _joints(written, bodies)
    allowed = "left out: joints are given, none is found"
    require(
        joints is None or written.tolerance is None, "tolerance", written.tolerance, allowed
    )
    found = assembly_of_bodies(
        bodies,
        joints=joints,
        density=written.unit_weight,
        size=written.size,
        tolerance=written.tolerance,
        rounding=written.rounding,
    )
    return problem_of(written, bodies, *found)


def _bodies(written: StructureFile) -> list[Body]:
    index = set[str]()
    bodies: list[Body] = []
    for at, block in enumerate(written.blocks):
        name = name_of(block, f"blocks[{at}]", index, block.polygons, "polygons")
        bodies.append(
            Body(
                polygons=tuple(block.polygons or [block.vertices or []]),
                name=name,
                fixed=block.fixed,
                weight=block.weight,
                centre=block.centre,
                inertia=block.inertia,
                depth=block.depth,
            )
        )
    return bodies


def _joints(written: StructureFile, bodies: Sequence[Body]) -> list[GivenJoint] | None:
    if written.joints is None:
        return None
    body_of = Names(bodies)
    joints: list[GivenJoint] = []
    for at, joint in enumerate(written.joints):
        a, b = sides_of(joint, f"joints[{at}]", bodies, body_of)
        joints.append(
            GivenJoint(
                a=a,
                b=b,
                ends=np.array(joint.ends, dtype=float),
                normal=None if joint.normal is None else np.array(joint.normal, dtype=float),
                friction=joint.friction,
                faces=None if joint.faces is None else np.array(joint.faces, dtype=float),
            )
        )
    return joints


def problem_of(
    written: Around, bodies: Sequence[Body], assembly: Assembly, found: Sequence[str]
) -> Problem:
    """Make a problem of an assembly and of what a file says besides.

    Parameters
    ----------
    written : Around
    bodies : sequence of Body
        Of which the assembly was made, each with a name of its own.
    assembly : Assembly
    found : sequence of str
        Notes on how it was made.

    Raises
    ------
    InputError
        In one line: a load on no block.
    """
    fixed = [body.fixed for body in bodies]
    body_of, loads_of = Names(bodies), LoadsOf(bodies)
    # Fixed blocks are numbered without those that move.
    bed = np.cumsum(fixed) - 1
    acts = acting_of(written, loads_of, DOWN)
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
    mu = written.friction
    own = {joint.friction for joint in assembly.joints}
    if len(own) == 1 and own != {None}:
        # All joints have the same friction of their own: it is that of the structure.
        mu = own.pop() or 0.0
        joined = tuple(replace(joint, friction=None) for joint in assembly.joints)
        assembly = replace(assembly, joints=joined)
    return Problem(
        assembly=assembly,
        mu=mu,
        gravity=acts.gravity,
        dead=acts.dead,
        live=acts.live,
        load=float(written.load),
        moves=tuple(moves),
        shaking=None if written.shake is None else shaking_of(**asdict(written.shake)),
        title=written.title,
        source=written.source,
        weighed=written.density is not None or all(map(_has_weight, bodies)),
        notes=(*written.notes, *acts.notes, *found),
    )


def _has_weight(body: Body) -> bool:
    return body.fixed or body.weight is not None


def _friction_text(value: float) -> float | str:
    """Return a number that JSON can write."""
    return "inf" if math.isinf(value) else value


def _load_record(load: Load, names: Sequence[str]) -> list[dict[str, Any]]:
    blocks = [names[index] for index in load.blocks]
    if load.per_weight:
        return [{"body": load.force.tolist(), "blocks": blocks}]
    at = {} if load.point is None else {"point": load.point.tolist()}
    return [{"block": name, "force": load.force.tolist(), **at} for name in blocks]


def structure_record(problem: Problem) -> dict[str, Any]:
    """Write a problem as a structure file does; `structure_of` reads it back.

    A support that is not known as a body gets one: a flat triangle behind its joint.
    """
    assembly = problem.assembly
    names = [f"b{index}" for index in range(len(assembly.blocks))]
    beds = [f"s{index}" for index in range(len(assembly.supports))]
    given = [block.name for block in assembly.blocks] + [
        each.name for each in assembly.supports
    ]
    if all(given) and len(set(given)) == len(given):
        names, beds = given[: len(names)], given[len(names) :]
    fixed: list[dict[str, Any]] = [
        {"id": name, "polygons": [part.tolist() for part in support.polygons], "fixed": True}
        for name, support in zip(beds, assembly.supports, strict=True)
    ]
    joints: list[dict[str, Any]] = []
    for index, joint in enumerate(assembly.joints):
        ground = "" if joint.support is None else beds[joint.support]
        if joint.support is None and SUPPORT in (joint.before, joint.after):
            ground = f"ground {index}"
            out = joint.normal * (-1 if joint.before == SUPPORT else 1) * joint.length / 10
            far = (joint.inner + joint.outer) / 2 + out
            corners = np.stack([joint.inner, joint.outer, far])
            if signed_area(corners) < 0:
                corners = corners[::-1]
            corners = corners.tolist()
            fixed.append({"id": ground, "vertices": corners, "fixed": True})
        entry: dict[str, Any] = {
            "a": ground if joint.before == SUPPORT else names[joint.before],
            "b": ground if joint.after == SUPPORT else names[joint.after],
            "ends": [joint.inner.tolist(), joint.outer.tolist()],
        }
        if joint.across is not None:
            entry |= {"ends": [joint.inner.tolist()], "normal": joint.across.tolist()}
        if joint.faces is not None:
            entry["faces"] = joint.faces.tolist()
        if joint.friction is not None:
            entry["friction"] = _friction_text(joint.friction)
        joints.append(entry)
    return {
        "title": problem.title,
        "source": problem.source,
        "friction": _friction_text(problem.mu),
        "size": assembly.size,
        "load": problem.load,
        "blocks": fixed
        + [
            {
                "id": name,
                "weight": block.mass * STANDARD_GRAVITY,
                "centre": block.centre.tolist(),
                "inertia": block.inertia,
                "depth": block.depth,
                "polygons": [part.tolist() for part in block.polygons],
            }
            for name, block in zip(names, assembly.blocks, strict=True)
        ],
        "joints": joints,
        "dead": [
            {"body": problem.gravity.tolist()},
            *(each for load in problem.dead for each in _load_record(load, names)),
        ],
        "live": [each for load in problem.live for each in _load_record(load, names)],
        "move": [
            {
                "block": beds[move.support],
                "direction": move.direction.tolist(),
                "turn_deg": math.degrees(move.turn),
                "about": move.about.tolist(),
            }
            for move in problem.moves
        ],
        **({} if problem.shaking is None else {"shake": shaking_record(problem.shaking)}),
    }
