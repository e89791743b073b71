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
import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import STANDARD_GRAVITY, Load, Problem
from blocksim.blocks.rows import column
from blocksim.blocks.structure import structure_record
from blocksim.common.later import Library
from blocksim.common.version import __version__
from blocksim.limit.bodies import motion_that_opens
from blocksim.limit.cones import Cones
from blocksim.verify import FORMAT, seal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scipy import linalg
else:
    linalg = Library("scipy.linalg")

SLACK = Fraction(1, 10**12)
"""Loads that proofs leave aside, over the weight of each block."""
ROUNDED = 1e-15
"""By how much friction is taken less, so that rounding does not exceed it."""
Vector = list[Fraction]
Point = tuple[int, int]
NOTHING = Fraction(0)


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
        a, b at both ends of each joint: the force a n + b t, where t leads from its first end to
        the second [grains] and n is t turned clockwise; empty where it falls.
    rates : list of three int, for each block
        x, y of its centre and rotation, in any unit; empty where it stands.
    """

    exact: Exact
    claim: Literal["stands", "collapses"]
    tolerance: Fraction
    forces: Vector
    rates: list[list[int]]


class Exact:
    """A problem in whole and rational numbers.

    Lengths are whole numbers of `grain` metres, a power of two of which all coordinates are
    multiples; forces are rational numbers of newtons.
    """

    def __init__(self, problem: Problem) -> None:
        assembly, joints = problem.assembly, problem.assembly.joints
        self.problem = problem
        self.sides: list[list[int]] = assembly.sides.T.tolist()
        is_corner = assembly.joint_arrays.is_corner.tolist()
        ends = np.array([column(joints, "inner"), column(joints, "outer")])
        across = np.array([(0.0, 0.0) if each is None else each.tolist()
                           for each in column(joints, "across")])  # fmt: skip
        values = [assembly.centres.ravel(), ends.ravel(), across.ravel()]
        self.grain, whole = _whole(np.concatenate(values).tolist())
        pairs = list(zip(whole[::2], whole[1::2], strict=True))
        blocks, count = len(assembly.blocks), len(self.sides)
        self.centres = pairs[:blocks]
        first, second = pairs[blocks : blocks + count], pairs[blocks + count :][:count]
        self.ends = list(zip(first, second, strict=True))
        self.normals: list[Point] = []
        for corner, one, other, up in zip(
            is_corner, first, second, pairs[blocks + 2 * count :], strict=True
        ):
            self.normals.append(up if corner else (other[1] - one[1], one[0] - other[0]))
        self.friction = [
            None if each == math.inf else Fraction(each) for each in problem.friction.tolist()
        ]
        self.weights = [
            Fraction(mass * STANDARD_GRAVITY) for mass in column(assembly.blocks, "mass")
        ]
        x, y = (Fraction(each) for each in problem.gravity[:2].tolist())
        self.pull = [[weight * x, weight * y, NOTHING] for weight in self.weights]
        for factor, loads in ((1.0, problem.dead), (problem.load, problem.live)):
            for load in loads:
                self._load(Fraction(factor), load)

    def _load(self, factor: Fraction, load: Load) -> None:
        """Add a load: forces in newtons, moments in newtons times the grain."""
        force = [Fraction(each) for each in load.force.tolist()]
        for block in load.blocks:
            times = factor * (self.weights[block] if load.per_weight else 1)
            x, y, pull = times * force[0], times * force[1], self.pull[block]
            pull[0] += x
            pull[1] += y
            if load.point is not None and not load.per_weight:
                px, py = (Fraction(each) / self.grain for each in load.point.tolist())
                cx, cy = self.centres[block]
                pull[2] += (px - cx) * y - (py - cy) * x

    @cached_property
    def allowed(self) -> list[Vector]:
        """What may be left on each block."""
        assembly = self.problem.assembly
        shapes = [np.concatenate(block.polygons) for block in assembly.blocks]
        reach = [float(np.abs(shape - centre).sum(axis=1).max())
                 for shape, centre in zip(shapes, assembly.centres, strict=True)]  # fmt: skip
        most = [SLACK * weight for weight in self.weights]
        return [[one, one, one * Fraction(far) / self.grain]
                for one, far in zip(most, reach, strict=True)]  # fmt: skip


def proof_record(proof: Proof) -> dict[str, Any]:
    """Return a proof as the file that `blocksim.verify` checks."""
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
    grain, whole = _whole(inside.ravel().tolist())
    left = _left(exact, whole, grain)
    parts = [Fraction(each) * grain for each in whole]
    handed = _handed_on(exact, parts, left, forces)
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


def _whole(values: Sequence[float]) -> tuple[Fraction, list[int]]:
    """Return a power of two, and values as whole multiples of it."""
    ratios = [each.as_integer_ratio() for each in values]
    finest = max((each for _, each in ratios), default=1)
    return Fraction(1, finest), [above * (finest // below) for above, below in ratios]


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


def _handed_on(exact: Exact, parts: Vector, left: list[Vector], forces: Array) -> Vector | None:
    """Hand on what is left on each block through the strongest joints to a support.

    None where the joints on the way cannot take it.
    """
    parts, left = parts[:], [wrench[:] for wrench in left]
    room = _room(exact, forces)
    for block, joints in reversed(_ways(exact, room)):
        if not any(left[block]):
            continue
        (x, y), far = exact.ends[joints[0]]
        if (x, y) == far:
            if not _by_parts(exact, parts, left, room, block, joints):
                return None
            continue
        joint = joints[0]
        u, v, moment = left[block]
        before, after = exact.sides[joint]
        other, sign = (before, -1) if after == block else (after, 1)
        cx, cy = exact.centres[block]
        # On the block after the joint: about the first end.
        about = moment - (x - cx) * v + (y - cy) * u
        p, q = exact.normals[joint]
        square = sign * (p * p + q * q)
        second = -about / square
        first = (u * p + v * q) / square - second
        half = (v * p - u * q) / (2 * square)
        for at, more in enumerate((first, half, second, half), 4 * joint):
            parts[at] += more
        if other != SUPPORT:
            (ox, oy), wrench = exact.centres[other], left[other]
            wrench[0] += u
            wrench[1] += v
            wrench[2] += moment + (cx - ox) * v - (cy - oy) * u
    return parts


def _by_parts(
    exact: Exact,
    parts: Vector,
    left: list[Vector],
    room: Array,
    block: int,
    joints: list[int],
) -> bool:
    """Hand on what is left on a block by those three parts of its joints that have most room."""
    cx, cy = exact.centres[block]
    places: list[tuple[int, int, int]] = []
    columns: list[tuple[int, int, int]] = []
    for joint in joints:
        (p, q), (before, after) = exact.normals[joint], exact.sides[joint]
        sign, other = (1, before) if after == block else (-1, after)
        for end in {exact.ends[joint][0]: 0, exact.ends[joint][1]: 1}.values():
            x, y = exact.ends[joint][end]
            for k, (u, v) in enumerate(((sign * p, sign * q), (-sign * q, sign * p))):
                places.append((4 * joint + 2 * end + k, other, joint))
                columns.append((u, v, (x - cx) * v - (y - cy) * u))
    able = np.array([room[joint] for _, _, joint in places])
    rows = np.array([[float(each) for each in column] for column in columns]).T * able
    rows /= np.maximum(np.abs(rows).max(axis=1, keepdims=True), 1e-300)
    if rows.shape[1] < PLANAR:
        return False
    qr: Any = linalg.qr
    chosen = qr(rows, pivoting=True, mode="economic")[2][:PLANAR].tolist()
    a, b, c = (columns[each] for each in chosen)
    whole = _triple(a, b, c)
    if not whole:
        return False
    goal = tuple(-each for each in left[block])
    found = _triple(goal, b, c), _triple(a, goal, c), _triple(a, b, goal)
    left[block] = [NOTHING] * PLANAR
    for each, above in zip(chosen, found, strict=True):
        (at, other, _), (u, v, moment), more = places[each], columns[each], above / whole
        parts[at] += more
        if other != SUPPORT:
            (ox, oy), wrench = exact.centres[other], left[other]
            wrench[0] -= more * u
            wrench[1] -= more * v
            wrench[2] -= more * (moment + (cx - ox) * v - (cy - oy) * u)
    return True


def _triple(a: Any, b: Any, c: Any) -> Any:
    """Return the determinant of three columns."""
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - b[0] * (a[1] * c[2] - a[2] * c[1])
        + c[0] * (a[1] * b[2] - a[2] * b[1])
    )


def _room(exact: Exact, forces: Array) -> Array:
    """Return by how much forces may change at each joint before they leave their cones."""
    mu = exact.problem.friction[:, None]
    finite = np.where(np.isinf(mu), 0.0, mu)
    pressure, friction = forces[..., 0], np.abs(forces[..., 1])
    room = np.where(np.isinf(mu), pressure, np.minimum(finite * pressure - friction, pressure))
    return np.maximum(room.min(axis=1), 0.0)


def _ways(exact: Exact, room: Array) -> list[tuple[int, list[int]]]:
    """Return each block after those on its widest way to a support, and its joints with them.

    The widest joint is the first; corners come last.
    """
    at: dict[int, list[int]] = {}
    for joint, sides in enumerate(exact.sides):
        for side in sides:
            at.setdefault(side, []).append(joint)
    seen, ways = {SUPPORT}, list[tuple[int, list[int]]]()
    heap = list[tuple[bool, float, int, int]]()

    def reach(block: int) -> None:
        for joint in at.get(block, ()):
            one, other = exact.sides[joint]
            far = other if one == block else one
            if far not in seen:
                corner = exact.ends[joint][0] == exact.ends[joint][1]
                heapq.heappush(heap, (corner, -float(room[joint]), joint, far))

    reach(SUPPORT)
    while heap:
        _, _, joint, block = heapq.heappop(heap)
        if block not in seen:
            others = [each for each in at[block]
                      if each != joint and not {*exact.sides[each]} - {block} - seen]  # fmt: skip
            seen.add(block)
            ways.append((block, [joint, *others]))
            reach(block)
    return ways


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
