"""Proofs that blocks stand or fall, in rational numbers: nothing in them is rounded.

Doubles are taken as the rational numbers they are, so what is proved is proved of the problem
as it is stored: corners, centres, weights, friction, gravity and loads. A joint's tangent is
the vector between its ends, its normal the same turned by a right angle: no root is taken. In
space `space.proof` does the same.

- *Stands*: forces of the linear programme lie well within their cones, but balance to 1e-10
  only. What is left on each block is handed on, exactly, through the strongest way of joints
  to a support. The sums still lie within the cones, or it is no proof.
- *Falls*: a little of a motion that opens all joints is added to the rates of the linear
  programme: rounding can close none of them. Of a stack, what one joint carries turns or slides
  off it, in whole numbers.
- Where joints cannot take more, or cannot open, as with friction without bound, the programme
  is solved in rational numbers (`rational`).

`blocksim.verify` checks them and shares no code with this.
"""

from __future__ import annotations

import math
from collections.abc import Sequence, Set
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.common.version import __version__
from blocksim.limit.exact import (
    NOTHING,
    SLACK,
    Exact,
    Number,
    along_and_across,
    apart,
    spun,
    whole_numbers,
)
from blocksim.limit.handing import handed_on
from blocksim.limit.rational import Bodies, as_bodies
from blocksim.verify import FORMAT, seal

ROUNDED = 1e-15
"""By how much friction is taken less, so that rounding does not exceed it."""
WEDGED = 1e7
"""Force, over the most that a block carries, beyond which rest would hang on rounding alone."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Proof:
    """A proof that a problem stands or falls.

    `exact`: The problem.
    `claim`, {"stands", "collapses"}.
    `tolerance`: Loads that differ from those given by no more are proved as well (`collapses`)
        or instead (`stands`, where it is 0 but for structures that touch their limit): force
        over the weight of each block, moment over that times its reach.
    `forces`: On the block after each joint; empty where it falls. In the plane a, b at both
        ends of each joint: the force a n + b t, where n is its normal and t that turned
        counter-clockwise by a right angle. In space a vector at each point of each joint.
    `unit`: Of the forces [N].
    `rates`: Velocity of the centre of each block, and its rotation, in any unit; empty where it
        stands.
    """

    exact: Exact
    claim: Literal["stands", "collapses"]
    tolerance: Fraction = NOTHING
    forces: Sequence[Any] = ()
    unit: Fraction = NOTHING
    rates: list[list[int]] = field(default_factory=list[list[int]])


def proof_record(proof: Proof) -> dict[str, Any]:
    """Return a proof as the file that `blocksim.verify` checks."""
    # Imported here: few ask for the file, and reading files takes long to load.
    from blocksim.blocks.space.files import solids_record
    from blocksim.blocks.structure import structure_record

    exact = proof.exact
    in_space = exact.problem.in_space
    written = solids_record(exact.problem) if in_space else structure_record(exact.problem)
    table: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "claim": proof.claim,
        "tolerance": str(proof.tolerance),
        "problem": written,
    }
    if proof.claim == "stands":
        forces = proof.forces if in_space else _vectors(exact, proof.forces)
        table["forces"] = [[[str(part * proof.unit) for part in force] for force in joint]
                           for joint in forces]  # fmt: skip
    else:
        names = [each["id"] for each in table["problem"]["blocks"] if not each.get("fixed")]
        common = math.gcd(*(each for rate in proof.rates for each in rate))
        grains = exact.grain.denominator
        table["rates"] = {
            name: _halves([each // common for each in rate], exact.axes, grains)
            for name, rate in zip(names, proof.rates, strict=True)
        }
    return {**table, "sha256": seal(table)}


def _halves(rate: Sequence[int], axes: int, grains: int) -> list[list[str]]:
    """Write a velocity and a rotation as two vectors; in the plane it is about z."""
    turn = [str(each * grains) for each in rate[axes:]]
    return [[str(each) for each in rate[:axes]], turn if len(turn) > 1 else ["0", "0", *turn]]


def proof_of_rest(exact: Exact, forces: Array) -> Proof | None:
    """Prove that a problem stands.

    `forces`, (joints, 2, 2): As of `Equilibrium`, which hardly balance.
    Returns: None where these forces prove nothing.
    """
    problem = exact.problem
    joints = problem.assembly.joint_arrays
    # Along vectors of so many grains.
    length = np.where(joints.is_corner, 1.0, joints.length * problem.assembly.size)
    inside = forces * (problem.unit_force / length)[:, None, None] * float(exact.grain)
    mu = problem.friction[:, None]
    inside[..., 0] = np.maximum(inside[..., 0], 0.0)
    with np.errstate(invalid="ignore"):
        most = np.where(np.isinf(mu), math.inf, mu * inside[..., 0] * (1 - ROUNDED))
    inside[..., 1] = np.clip(inside[..., 1], -most, most)
    grain, whole = whole_numbers(inside.ravel().tolist())
    unit = min(grain, exact.force)
    times, each = int(grain / unit), int(exact.force / unit)
    whole = [times * part for part in whole]
    left = _left(exact, whole, each)
    handed = handed_on(exact, whole, left, forces)
    if handed is not None and _within(exact, handed):
        return Proof(exact=exact, claim="stands", forces=handed, unit=unit)
    for wrench, allowed in zip(left, exact.allowed, strict=True):
        # Less than is allowed: how far a block reaches is rounded here.
        if any(2 * abs(w) > each * most for w, most in zip(wrench, allowed, strict=True)):
            return None
    return Proof(exact=exact, claim="stands", tolerance=SLACK, forces=whole, unit=unit)


def proof_of_fall(
    exact: Exact, rates: Array, owner: Sequence[int] | None = None
) -> Proof | None:
    """Prove that a problem falls.

    `rates`, (3 blocks,) or (6 blocks,), or a row a block: As of `Equilibrium`, of a mechanism
        that opens joints by more than round-off.
    `owner`, (blocks,) sequence of int: Body of each block, of those that move as one, `SUPPORT`
        at rest; by default each moves by itself.
    Returns: None where these rates prove nothing.
    """
    scaled = rates.reshape(len(exact.centres), -1).copy()
    scaled[:, : exact.axes] *= exact.problem.assembly.size / float(exact.grain)
    _, whole = whole_numbers(scaled.ravel().tolist())
    count = scaled.shape[1]
    each = [whole[at : at + count] for at in range(0, len(whole), count)]
    return _of_motion(exact, each if owner is None else as_bodies(exact, each, owner))


def proof_of_parting(exact: Exact, joint: int, above: Set[int], way: int) -> Proof | None:
    """Prove that what a joint alone carries parts from what is below, as one.

    `above`, `way`: As of `determinate.Stacked`.
    Returns: None where that proves nothing.
    """
    (p, q), mu = exact.normals[joint], exact.friction[joint] or NOTHING
    sense = 1 if exact.sides[joint][1] in above else -1
    # Along the normal and the tangent: as little lift as friction allows.
    lift, slip = mu.numerator * sense, mu.denominator * (sense if way == 2 else -sense)
    x, y = exact.ends[joint][way % 2]
    turn = -sense if way == 0 else sense
    rates = [[0, 0, 0] for _ in exact.centres]
    for block in above:
        cx, cy = exact.centres[block]
        if way < 2:
            rates[block] = [turn * (y - cy), turn * (cx - x), turn]
        else:
            rates[block] = [lift * p - slip * q, lift * q + slip * p, 0]
    return _of_motion(exact, rates)


def proof_in_rationals(exact: Exact, weights: Array, owner: Sequence[int]) -> Proof | None:
    """Prove that blocks stand or fall by a programme in rational numbers.

    `weights`, (blocks,): What each block carries [mean weights].
    `owner`, (blocks,) sequence of int: Body of each block; `SUPPORT` where it stays at rest.
        Blocks of one body move as one: of such only that they fall is proved.
    Returns: None where it is too large, or only wedging by rounding would hold the blocks.
    """
    bodies, unit = Bodies(exact, owner), exact.problem.unit_force
    vertex = bodies.solved(weights * unit)
    if vertex is None or not vertex.improved():
        return None
    if vertex.cost:
        return _of_motion(exact, bodies.motion(vertex))
    if len(set(owner)) < len(owner) or SUPPORT in owner:
        return None
    forces = bodies.forces(vertex)
    most = WEDGED * float(weights.max()) * unit / float(exact.force)
    sizes = [abs(p) + abs(q) for p, q in exact.normals for _ in range(4)]
    if any(abs(each) * size > most for each, size in zip(forces, sizes, strict=True)):
        return None
    return Proof(exact=exact, claim="stands", forces=forces, unit=exact.force)


def _of_motion(exact: Exact, rates: list[list[int]]) -> Proof | None:
    """Prove that blocks fall by a motion; None where joints forbid it, or loads do no work."""
    lawful = _lawful_in_space if exact.axes == 3 else _lawful
    return _by_work(exact, rates) if lawful(exact, rates) else None


def _by_work(exact: Exact, rates: list[list[int]]) -> Proof | None:
    """Prove that blocks fall by the work of the loads, of as many loads besides as it can.

    `rates`, (blocks,): A motion that no joint forbids: velocities and rotations.
    Returns: None where the loads do no work.
    """
    for tolerance in (SLACK, NOTHING):
        if _work(exact, rates, 2 if tolerance else 0) > 0:
            return Proof(exact=exact, claim="collapses", tolerance=tolerance, rates=rates)
    return None


def _left(exact: Exact, whole: list[int], each: int) -> list[list[int]]:
    """Return what forces leave on each block, which is pulled by so many times its pull."""
    sums = [[each * one for one in pull] for pull in exact.pull]
    for joint, sides in enumerate(exact.sides):
        p, q = exact.normals[joint]
        for end, (x, y) in enumerate(exact.ends[joint]):
            at = 4 * joint + 2 * end
            a, b = whole[at : at + 2]
            u, v = a * p - b * q, a * q + b * p
            for block, sign in zip(sides, (-1, 1), strict=True):
                if block != SUPPORT:
                    (cx, cy), wrench = exact.centres[block], sums[block]
                    wrench[0] += sign * u
                    wrench[1] += sign * v
                    wrench[2] += sign * ((x - cx) * v - (y - cy) * u)
    return sums


def _vectors(exact: Exact, parts: Sequence[Number]) -> list[list[list[Number]]]:
    """Return forces at the points of joints in the plane, of their parts as of `Proof`."""
    found: list[list[list[Number]]] = []
    for at, ((p, q), ends) in enumerate(zip(exact.normals, exact.ends, strict=True)):
        a, b, c, d = parts[4 * at : 4 * at + 4]
        if ends[0] == ends[1]:
            a, b = a + c, b + d
        force: list[Number] = [a * p - b * q, a * q + b * p]
        other: list[Number] = [c * p - d * q, c * q + d * p]
        found.append([force] if ends[0] == ends[1] else [force, other])
    return found


def _within(exact: Exact, parts: Sequence[Number]) -> bool:
    """Tell whether all forces press and lie within friction."""
    for at, (a, b) in enumerate(zip(parts[::2], parts[1::2], strict=True)):
        mu = exact.friction[at // 2]
        if a < 0:
            return False
        if b and mu is not None:
            # |b| > mu a, in whole numbers.
            most = mu.numerator * a.numerator * b.denominator
            if abs(b.numerator) * a.denominator * mu.denominator > most:
                return False
    return True


def _lawful(exact: Exact, rates: list[list[int]]) -> bool:
    """Tell whether no joint closes, or slips without opening."""
    for joint in range(len(exact.sides)):
        moved = exact.moving(joint, rates)
        if not moved:
            continue
        (p, q), mu = exact.normals[joint], exact.friction[joint]
        for x, y in exact.ends[joint]:
            u = v = 0
            for (dx, dy, turn), (cx, cy), sign in moved:
                u += sign * (dx - turn * (y - cy))
                v += sign * (dy + turn * (x - cx))
            opens, slips = u * p + v * q, abs(v * p - u * q)
            if opens < 0 or (slips and (mu is None or mu * slips > opens)):
                return False
    return True


def _lawful_in_space(exact: Exact, rates: list[list[int]]) -> bool:
    """Tell whether no point closes, or slips without opening."""
    for joint in range(len(exact.sides)):
        moved = exact.moving(joint, rates)
        n, mu = exact.normals[joint], exact.friction[joint]
        for point in exact.ends[joint] if moved else ():
            way: list[int] = [0, 0, 0]
            for rate, centre, sign in moved:
                turned = zip(rate[:3], spun(rate[3:], apart(point, centre)), strict=True)
                way = [w + sign * (v + u) for w, (v, u) in zip(way, turned, strict=True)]
            opens, slips = along_and_across(way, n)
            if opens < 0 or (slips and (mu is None or mu * mu * slips > opens * opens)):
                return False
    return True


def _work(exact: Exact, rates: list[list[int]], times: int) -> int:
    """Return the work of the loads, less so many times what those left aside may do."""
    total = 0
    for pulls, allowed, rate in zip(exact.pull, exact.allowed, rates, strict=True):
        for pull, least, way in zip(pulls, allowed, rate, strict=True):
            total += pull * way - times * (least + 1) * abs(way)
    return total
