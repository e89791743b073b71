"""Proofs that blocks stand or fall, in rational numbers: nothing in them is rounded.

Doubles are taken as the rational numbers they are, so what is proved is proved of the problem
as it is stored: corners, centres, weights, friction, gravity and loads. A joint's tangent is
the vector between its ends, its normal the same turned by a right angle: no root is taken.

- *Stands*: forces of the linear programme lie well within their cones, but balance to 1e-10
  only. What is left on each block is handed on, exactly, through the strongest way of joints
  to a support. The sums still lie within the cones, or it is no proof.
- *Falls*: rates of the linear programme break what joints forbid by 1e-10. Of all motions that
  one is taken in which every joint opens by as much as the loads do work: rounding cannot close
  it. Where joints cannot open, as with friction without bound, the equations that hold them
  shut are solved in rationals (`bodies`).

`blocksim.verify` checks them and shares no code with this.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.common.version import __version__
from blocksim.limit.bodies import motion_that_opens
from blocksim.limit.cones import Cones
from blocksim.limit.exact import NOTHING, SLACK, Exact, Vector, whole_numbers
from blocksim.limit.handing import handed_on
from blocksim.verify import FORMAT, seal

ROUNDED = 1e-15
"""By how much friction is taken less, so that rounding does not exceed it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Proof:
    """A proof that a problem stands or falls.

    Parameters
    ----------
    exact : Exact
        The problem.
    claim : {"stands", "collapses"}
    tolerance : Fraction
        Loads that differ from those given by no more are proved as well (`collapses`) or
        instead (`stands`, where it is 0 but for structures that touch their limit): force over
        the weight of each block, moment over that times its reach.
    forces : list of Fraction
        a, b at both ends of each joint: the force a n + b t, where t leads from its first end
        to the second [grains] and n is t turned clockwise; empty where it falls.
    rates : list of three int, for each block
        x, y of its centre and rotation, in any unit; empty where it stands.
    """

    exact: Exact
    claim: Literal["stands", "collapses"]
    tolerance: Fraction
    forces: Vector
    rates: list[list[int]]


def proof_record(proof: Proof) -> dict[str, Any]:
    """Return a proof as the file that `blocksim.verify` checks."""
    # Imported here: few ask for the file, and reading files takes long to load.
    from blocksim.blocks.structure import structure_record

    exact = proof.exact
    table: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "claim": proof.claim,
        "tolerance": str(proof.tolerance),
        "problem": structure_record(exact.problem),
    }
    if proof.claim == "stands":
        # In newtons over metres, as joints are vectors of metres.
        parts = [str(each / exact.grain) for each in proof.forces]
        table["forces"] = [
            [parts[at : at + 2], parts[at + 2 : at + 4]] for at in range(0, len(parts), 4)
        ]
    else:
        names = [each["id"] for each in table["problem"]["blocks"] if not each.get("fixed")]
        common = math.gcd(*(each for rate in proof.rates for each in rate))
        grains = exact.grain.denominator
        table["rates"] = {
            name: [str(x // common), str(y // common), str(turn // common * grains)]
            for name, (x, y, turn) in zip(names, proof.rates, strict=True)
        }
    return {**table, "sha256": seal(table)}


def proof_of_rest(problem: Problem, forces: Array) -> Proof | None:
    """Prove that a problem stands.

    Parameters
    ----------
    problem : Problem
        In its plane.
    forces : (joints, 2, 2) float
        As of `Equilibrium`, which hardly balance.

    Returns
    -------
    Proof or None
        None where these forces prove nothing.
    """
    exact = Exact(problem)
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
    left = _left(exact, whole, grain)
    parts = [Fraction(each) * grain for each in whole]
    handed = handed_on(exact, parts, left, forces)
    if handed is not None and _within(exact, handed):
        return Proof(exact=exact, claim="stands", tolerance=NOTHING, forces=handed, rates=[])
    for block, wrench in enumerate(left):
        # Less than is allowed: how far a block reaches is rounded here.
        if any(2 * abs(w) > most for w, most in zip(wrench, exact.allowed[block], strict=True)):
            return None
    return Proof(exact=exact, claim="stands", tolerance=SLACK, forces=parts, rates=[])


def proof_of_fall(problem: Problem, cones: Cones, rates: Array | None) -> Proof | None:
    """Prove that a problem falls.

    Parameters
    ----------
    problem : Problem
        In its plane.
    cones : Cones
    rates : (blocks, 3) float or None
        As of `Equilibrium`, of a mechanism that joints hardly allow.

    Returns
    -------
    Proof or None
        None where these rates prove nothing.
    """
    exact = Exact(problem)
    for bodies in motion_that_opens(problem, cones, rates):
        found = _rates(exact, *bodies)
        if _lawful(exact, found) and _work(exact, found) > 0:
            return Proof(
                exact=exact, claim="collapses", tolerance=SLACK, forces=[], rates=found
            )
    return None


def _left(exact: Exact, whole: list[int], grain: Fraction) -> list[Vector]:
    """Return what forces leave on each block."""
    sums = [[0] * PLANAR for _ in exact.centres]
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
    return [
        [one + each * grain for one, each in zip(pull, wrench, strict=True)]
        for pull, wrench in zip(exact.pull, sums, strict=True)
    ]


def _within(exact: Exact, parts: Vector) -> bool:
    """Tell whether all forces press and lie within friction."""
    for at, (a, b) in enumerate(zip(parts[::2], parts[1::2], strict=True)):
        mu = exact.friction[at // 2]
        if a < 0 or (b and mu is not None and abs(b) > mu * a):
            return False
    return True


def _rates(
    exact: Exact, owner: list[int], points: Array, motions: list[Vector]
) -> list[list[int]]:
    """Return rates of blocks from those of bodies about points of theirs; -1 is at rest.

    As whole numbers of any unit: grains, and grains times turns over the grain.
    """
    below = math.lcm(*(each.denominator for motion in motions for each in motion))
    scale = below * exact.grain.denominator, below
    about = [[Fraction(each) / exact.grain for each in point] for point in points.tolist()]
    below = math.lcm(*(each.denominator for point in about for each in point))
    found: list[list[int]] = []
    for (cx, cy), body in zip(exact.centres, owner, strict=True):
        if body == SUPPORT:
            found.append([0] * PLANAR)
            continue
        (x, y, turn), (px, py) = motions[body], about[body]
        x, y, turn = x * scale[0], y * scale[0], turn * scale[1]
        rates = (x - turn * (cy - py), y + turn * (cx - px), turn)
        found.append([int(each * below) for each in rates])
    return found


def _lawful(exact: Exact, rates: list[list[int]]) -> bool:
    """Tell whether no joint closes, or slips without opening."""
    for joint, sides in enumerate(exact.sides):
        moved = [(rates[side], exact.centres[side], sign)
                 for side, sign in zip(sides, (-1, 1), strict=True)
                 if side != SUPPORT and any(rates[side])]  # fmt: skip
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


def _work(exact: Exact, rates: list[list[int]]) -> Fraction:
    """Return the work of the loads, less what those that are left aside may do."""
    total = NOTHING
    for block, rate in enumerate(rates):
        if any(rate):
            most = exact.allowed[block]
            for pull, least, way in zip(exact.pull[block], most, rate, strict=True):
                total += pull * way - 2 * least * abs(way)
    return total
