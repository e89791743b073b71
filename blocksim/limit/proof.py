"""Proofs that blocks stand or fall, in rational numbers: nothing in them is rounded.

Doubles are taken as the rational numbers they are, so what is proved is proved of the problem
as it is stored: corners, centres, weights, friction, gravity and loads. A joint's tangent is
the vector between its ends, its normal the same turned by a right angle: no root is taken.

- *Stands*: forces of the linear programme lie well within their cones, but balance to 1e-10
  only. What is left on each block is handed on, exactly, through the strongest way of joints
  to a support. The sums still lie within the cones, or it is no proof.
- *Falls*: rates of the linear programme break what joints forbid by 1e-10. Blocks that move as
  one are made one body. Of all motions of these bodies that is taken in which every joint opens
  by as much as the loads do work, at least: rounding cannot close it. Where joints cannot open,
  as with friction without bound, the equations that hold them shut are solved in rationals.

`blocksim.verify` checks them and shares no code with this.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import STANDARD_GRAVITY, Load, Problem
from blocksim.limit.bodies import motion_that_opens
from blocksim.limit.cones import Cones

if TYPE_CHECKING:
    from collections.abc import Sequence

SLACK = Fraction(1, 10**12)
"""Loads that proofs leave aside, over the weight of each block."""
Rational = Fraction
Vector = list[Fraction]
NOTHING = Fraction(0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Proof:
    """A proof that a problem stands or falls.

    Parameters
    ----------
    problem : Problem
    claim : {"stands", "collapses"}
    tolerance : Fraction
        Loads that differ from those given by no more are proved as well (`collapses`) or
        instead (`stands`, where it is 0 but for structures that touch their limit): force over
        the weight of each block, moment over that times its reach.
    forces : list of two pairs of Fraction, for each joint
        At its ends: along normal and tangent, each as long as the joint [N/m]; empty where it
        falls.
    rates : list of three Fraction, for each block
        x, y of its centre and rotation; empty where it stands.
    """

    problem: Problem
    claim: Literal["stands", "collapses"]
    tolerance: Fraction
    forces: list[list[Vector]]
    rates: list[Vector]


class Exact:
    """A problem in rational numbers, in metres and newtons."""

    def __init__(self, problem: Problem) -> None:
        assembly = problem.assembly
        self.problem = problem
        self.centres = [_exact(each) for each in assembly.centres.tolist()]
        self.weights = [Fraction(each.mass * STANDARD_GRAVITY) for each in assembly.blocks]
        self.sides: list[list[int]] = assembly.sides.T.tolist()
        self.ends: list[list[Vector]] = []
        self.axes: list[tuple[Vector, Vector]] = []
        for joint in assembly.joints:
            ends = [_exact(joint.inner.tolist()), _exact(joint.outer.tolist())]
            if joint.across is None:
                t = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]]
                n = [t[1], -t[0]]
            else:
                n = _exact(joint.across.tolist())
                t = [-n[1], n[0]]
            self.ends.append(ends)
            self.axes.append((n, t))
        self.friction = [
            None if each == np.inf else Fraction(each) for each in problem.friction.tolist()
        ]
        self.pull = [[NOTHING] * PLANAR for _ in self.centres]
        gravity = _exact(problem.gravity[:2].tolist())
        for block, weight in enumerate(self.weights):
            self.pull[block] = [weight * gravity[0], weight * gravity[1], NOTHING]
        for factor, loads in (
            (Fraction(1), problem.dead),
            (Fraction(problem.load), problem.live),
        ):
            for load in loads:
                self._load(factor, load)

    def _load(self, factor: Fraction, load: Load) -> None:
        force = _exact(load.force.tolist())
        for block in load.blocks:
            times = factor * (self.weights[block] if load.per_weight else 1)
            x, y, pull = times * force[0], times * force[1], self.pull[block]
            pull[0] += x
            pull[1] += y
            if load.point is not None and not load.per_weight:
                px, py = _exact(load.point.tolist())
                cx, cy = self.centres[block]
                pull[2] += (px - cx) * y - (py - cy) * x

    def reach(self, block: int) -> Fraction:
        """Return the farthest corner of a block from its centre, along x and y added."""
        cx, cy = self.centres[block]
        corners = np.concatenate(self.problem.assembly.blocks[block].polygons).tolist()
        return max(abs(x - cx) + abs(y - cy) for x, y in map(_exact, corners))

    def allowed(self, block: int) -> Vector:
        """Return what may be left on a block."""
        most = SLACK * self.weights[block]
        return [most, most, most * self.reach(block)]


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
    length = np.where(joints.is_corner, 1.0, joints.length * problem.assembly.size)
    unit = problem.unit_force / length
    parts: list[list[Vector]] = []
    for mu, joint in zip(exact.friction, (forces * unit[:, None, None]).tolist(), strict=True):
        ends: list[Vector] = []
        for pressure, friction in joint:
            a, b = max(Fraction(pressure), NOTHING), Fraction(friction)
            if mu is not None and abs(b) > mu * a:
                b = mu * a if b > 0 else -mu * a
            ends.append([a, b])
        parts.append(ends)
    left = _left(exact, parts)
    rough = [[part[:] for part in ends] for ends in parts]
    if _handed_on(exact, parts, left, forces) and _within(exact, parts):
        still = all(not each for wrench in left for each in wrench)
        if still:
            return Proof(
                problem=problem, claim="stands", tolerance=NOTHING, forces=parts, rates=[]
            )
    left = _left(exact, rough)
    for block, wrench in enumerate(left):
        if any(abs(w) > most for w, most in zip(wrench, exact.allowed(block), strict=True)):
            return None
    return Proof(problem=problem, claim="stands", tolerance=SLACK, forces=rough, rates=[])


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
                problem=problem, claim="collapses", tolerance=SLACK, forces=[], rates=found
            )
    return None


def _exact(values: Sequence[float]) -> Vector:
    return [Fraction(each) for each in values]


def _cross(arm: Vector, force: Vector) -> Fraction:
    return arm[0] * force[1] - arm[1] * force[0]


def _left(exact: Exact, parts: list[list[Vector]]) -> list[Vector]:
    """Return what forces leave on each block."""
    left = [wrench[:] for wrench in exact.pull]
    for joint, ends in enumerate(parts):
        for end, (a, b) in enumerate(ends):
            if a or b:
                n, t = exact.axes[joint]
                force = [a * n[0] + b * t[0], a * n[1] + b * t[1]]
                _put(exact, left, joint, exact.ends[joint][end], force, NOTHING)
    return left


def _put(
    exact: Exact, left: list[Vector], joint: int, point: Vector, force: Vector, moment: Fraction
) -> None:
    """Put a force at a point, and a moment, on the block after a joint, and against it before."""
    for block, sign in zip(exact.sides[joint], (-1, 1), strict=True):
        if block != SUPPORT:
            (cx, cy), wrench = exact.centres[block], left[block]
            wrench[0] += sign * force[0]
            wrench[1] += sign * force[1]
            wrench[2] += sign * (_cross([point[0] - cx, point[1] - cy], force) + moment)


def _handed_on(
    exact: Exact, parts: list[list[Vector]], left: list[Vector], forces: Array
) -> bool:
    """Hand on what is left on each block through the strongest joints to a support."""
    for block, joint in reversed(_ways(exact, forces)):
        wrench = left[block]
        if not any(wrench):
            continue
        after = exact.sides[joint][1] == block
        sign = -1 if after else 1
        ends, (n, t) = exact.ends[joint], exact.axes[joint]
        if ends[0] == ends[1]:
            return False
        cx, cy = exact.centres[block]
        force = [sign * wrench[0], sign * wrench[1]]
        arm = [ends[0][0] - cx, ends[0][1] - cy]
        moment = sign * wrench[2] - _cross(arm, force)
        square = n[0] * n[0] + n[1] * n[1]
        second = -moment / square
        normal = (force[0] * n[0] + force[1] * n[1]) / square
        half = (force[0] * t[0] + force[1] * t[1]) / square / 2
        for end, more in enumerate((normal - second, second)):
            part = parts[joint][end]
            part[0] += more
            part[1] += half
        _put(exact, left, joint, ends[0], force, moment)
    return True


def _ways(exact: Exact, forces: Array) -> list[tuple[int, int]]:
    """Return each block and the joint that leads to a support, from there on; the widest ways."""
    mu = exact.problem.friction[:, None]
    finite = np.where(np.isinf(mu), 0.0, mu)
    pressure, friction = forces[..., 0], np.abs(forces[..., 1])
    room = np.where(np.isinf(mu), pressure, np.minimum(finite * pressure - friction, pressure))
    room = room.min(axis=1).tolist()
    at: dict[int, list[int]] = {}
    for joint, sides in enumerate(exact.sides):
        for side in sides:
            at.setdefault(side, []).append(joint)
    seen, ways, heap = {SUPPORT}, list[tuple[int, int]](), list[tuple[float, int, int]]()

    def reach(block: int) -> None:
        for joint in at.get(block, ()):
            one, other = exact.sides[joint]
            far = other if one == block else one
            if far not in seen:
                heapq.heappush(heap, (-room[joint], joint, far))

    reach(SUPPORT)
    while heap:
        _, joint, block = heapq.heappop(heap)
        if block not in seen:
            seen.add(block)
            ways.append((block, joint))
            reach(block)
    return ways


def _within(exact: Exact, parts: list[list[Vector]]) -> bool:
    """Tell whether all forces press and lie within friction."""
    return all(
        a >= 0 and (mu is None or abs(b) <= mu * a)
        for mu, ends in zip(exact.friction, parts, strict=True)
        for a, b in ends
    )


def _rates(
    exact: Exact, owner: list[int], points: Array, motions: list[Vector]
) -> list[Vector]:
    """Return the rates of blocks from those of bodies about points of theirs; -1 is at rest."""
    found: list[Vector] = []
    about = [_exact(each) for each in points.tolist()]
    for (cx, cy), body in zip(exact.centres, owner, strict=True):
        if body == SUPPORT:
            found.append([NOTHING] * PLANAR)
            continue
        (x, y, turn), (px, py) = motions[body], about[body]
        found.append([x - turn * (cy - py), y + turn * (cx - px), turn])
    return found


def _lawful(exact: Exact, rates: list[Vector]) -> bool:
    """Tell whether no joint closes, or slips without opening."""
    for joint, (one, other) in enumerate(exact.sides):
        if all(side == SUPPORT or not any(rates[side]) for side in (one, other)):
            continue
        (n, t), mu = exact.axes[joint], exact.friction[joint]
        for x, y in exact.ends[joint]:
            way = [NOTHING, NOTHING]
            for side, sign in ((one, -1), (other, 1)):
                if side != SUPPORT:
                    (u, v, turn), (cx, cy) = rates[side], exact.centres[side]
                    way[0] += sign * (u - turn * (y - cy))
                    way[1] += sign * (v + turn * (x - cx))
            opens = way[0] * n[0] + way[1] * n[1]
            slips = abs(way[0] * t[0] + way[1] * t[1])
            if opens < 0 or (slips > 0 if mu is None else mu * slips > opens):
                return False
    return True


def _work(exact: Exact, rates: list[Vector]) -> Fraction:
    """Return the work of the loads, less what those that are left aside may do."""
    total = NOTHING
    for block, rate in enumerate(rates):
        if any(rate):
            most = exact.allowed(block)
            for pull, least, way in zip(exact.pull[block], most, rate, strict=True):
                total += pull * way - least * abs(way)
    return total
