"""What joints carry and what supports bear, from the forces at the ends of joints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.limit.cones import carried_weights, joint_areas, joint_weights

FORCELESS = 1e-9
"""Pressure below which a joint carries nothing, over the weight that its blocks carry."""
UPRIGHT = 1e-9
"""How far gravity may be from as large as weight, and be that of a tilted table."""
SIDES = ("left", "right")
"""Names of two supports that have none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Resultants:
    """What each joint carries, as it acts on the block after it.

    In space width and stress are nan.

    `normal`, `friction`, (joints,): Along normal and tangent; in space all that is across [N].
    `force`, (joints, 2 or 3): x, y and z [N].
    `point`, (joints, 2 or 3): Where the resultant crosses the joint [m]; nan where it carries
        nothing. In space the centre of pressure, or the middle where nothing presses.
    `width_used`, (joints,): Distance of that point from the middle of the joint, over half its
        width; 0 where it carries nothing, and for corners, which have no width.
    `stress`, (joints,): Pressure of a rectangular block of stress about that point [Pa]: even
        from the nearer end of the joint to as far beyond the point. inf at an end, nan of
        corners, 0 where it carries nothing.
    `friction_used`, (joints,): Friction over the most there can be; 0 where it carries nothing.
        In space of all points of the joint together, so that twisting counts.
    """

    normal: Array
    friction: Array
    force: Array
    point: Array
    width_used: Array
    stress: Array
    friction_used: Array

    @property
    def used(self) -> Array:
        """The larger of the shares of width and friction that each joint uses, (joints,)."""
        return np.fmax(self.width_used, self.friction_used)


@dataclass(frozen=True, kw_only=True, eq=False)
class Reaction:
    """What a support bears of one block.

    `name`: Of the support, and of the block where it bears several.
    `force`, (2,): x and y, as it acts on the blocks [N].
    `point`, (2,): Centre of the pressure of its joints [m]: where its line of action crosses
        them, if they lie along one line.
    """

    name: str
    force: Array
    point: Array


def resultants(problem: Problem, forces: Array) -> Resultants:
    """Sum forces at the ends of joints, (joints, 2, 2) in mean weights, to resultants."""
    joints = problem.assembly.joint_arrays
    normal, friction = np.asarray(forces).sum(axis=1).T
    least = FORCELESS * joint_weights(problem, carried_weights(problem))
    loaded = np.abs(normal) > least
    safe = np.where(loaded, normal, 1.0)
    share = forces[:, 1, 0] / safe
    ends = joints.ends * problem.assembly.size
    point = ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0])
    most = problem.friction * np.abs(safe)
    rubs = np.abs(friction) > least
    friction_used = np.divide(
        np.abs(friction), most, out=np.zeros(len(most)), where=loaded & rubs & (most > 0)
    )
    force = normal[:, None] * joints.normal + friction[:, None] * joints.tangent
    unit = problem.unit_force
    off = np.where(loaded & ~joints.is_corner, np.abs(2 * share - 1), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        stress = normal * unit / (joint_areas(problem) * np.maximum(1 - off, 0.0))
    return Resultants(
        normal=normal * unit,
        friction=friction * unit,
        force=force * unit,
        point=np.where(loaded[:, None], point, math.nan),
        width_used=off,
        stress=np.where(joints.is_corner, math.nan, np.where(loaded, stress, 0.0)),
        friction_used=friction_used,
    )


def reactions(problem: Problem, forces: Array) -> tuple[Reaction, ...]:
    """Sum what supports bear, for each block that lies on them."""
    assembly, carried = problem.assembly, resultants(problem, forces)
    joints = assembly.joint_arrays
    bearing: dict[tuple[int | None, int], list[int]] = {}
    for index, joint in enumerate(assembly.joints):
        if SUPPORT in (joint.before, joint.after):
            block = joint.after if joint.before == SUPPORT else joint.before
            bearing.setdefault((joint.support, block), []).append(index)
    order = sorted(bearing, key=lambda key: float(joints.ends[bearing[key], :, 0].mean()))
    names = [_name_of(problem, place, order) for place in range(len(order))]
    return tuple(
        _reaction(problem, carried, bearing[key], name)
        for key, name in zip(order, names, strict=True)
    )


def in_world(problem: Problem, forces: Array) -> Array:
    """Return forces across and up, as the world has it, where blocks lie on a tilted table.

    `problem`: Seen as on the drawing, gravity turned. Where gravity is not as large as weight,
        what is more of it pushes, and the drawing is upright.
    `forces`, (..., 2): As on the drawing.
    """
    x, y, _ = problem.gravity.tolist()
    size = math.hypot(x, y)
    if size == 0 or abs(float(np.linalg.norm(problem.gravity)) - 1) > UPRIGHT:
        return forces
    across = np.array([-y, x]) / size
    return np.stack([forces @ across, forces @ (np.array([-x, -y]) / size)], axis=-1)


def _name_of(problem: Problem, place: int, order: list[tuple[int | None, int]]) -> str:
    """Name a support, and the block it bears where it bears several."""
    support, block = order[place]
    supports = problem.assembly.supports
    name = supports[support].name if support is not None else ""
    if not name:
        return SIDES[place] if len(order) == len(SIDES) else f"support {place + 1}"
    if [each for each, _ in order].count(support) == 1:
        return name
    return f"{name} under {problem.assembly.blocks[block].name or block}"


def _reaction(problem: Problem, carried: Resultants, at: list[int], name: str) -> Reaction:
    joints = problem.assembly.joint_arrays
    on_blocks = np.where(joints.before[at] == SUPPORT, 1.0, -1.0)[:, None]
    pressing = [k for k in at if not math.isnan(carried.point[k, 0])]
    point = joints.ends[at].mean(axis=(0, 1)) * problem.assembly.size
    if pressing:
        point = np.average(carried.point[pressing], axis=0, weights=carried.normal[pressing])
    return Reaction(name=name, force=(on_blocks * carried.force[at]).sum(axis=0), point=point)
