"""What the page on one structure says of forces in space: at joints, and on supports."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.joints import joint_names
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.report.sheetfacts import MOST, JointRow, percent
from blocksim.view.solidscene import pressed
from blocksim.view.units import ForceUnit


def solid_reactions(
    problem: Problem[SpatialAssembly], forces: Array, unit: ForceUnit
) -> list[list[str]]:
    """Return rows of reactions along x, y and z, by support.

    Forces are those at the points of joints, as of `SpatialEquilibrium` [N].
    """
    sums, _ = pressed(problem, forces)
    borne: dict[int | None, Array] = {}
    for joint, force in zip(problem.assembly.joints, sums, strict=True):
        if SUPPORT in (joint.before, joint.after):
            # The force is that on `after`.
            on_block = force if joint.before == SUPPORT else -force
            borne[joint.support] = borne.get(joint.support, np.zeros(3)) + on_block
    names = [each.name for each in problem.assembly.supports]
    return [
        [(names[at] if at is not None else "") or "support"]
        + [unit.number(part) for part in force.tolist()]
        for at, force in borne.items()
    ]


def solid_joints(
    problem: Problem[SpatialAssembly], forces: Array, unit: ForceUnit
) -> list[JointRow]:
    """Tell what joints carry, in their order.

    Friction used is of the points of a joint together, so that twisting counts.
    """
    sums, places = pressed(problem, forces)
    joints, names = problem.assembly.joints, joint_names(problem.assembly)
    ends = np.cumsum([len(each.points) for each in joints])[:-1]
    parts = np.split(forces, ends)
    normal = np.array([part[:, 0].sum() for part in parts])
    across = np.array([np.hypot(part[:, 1], part[:, 2]).sum() for part in parts])
    middles = np.array([each.points.mean(axis=0) for each in joints])
    off = np.linalg.norm(places - middles, axis=1)
    most = problem.friction * normal
    used = np.divide(across, most, out=np.zeros_like(most), where=most > 0)
    chosen = np.sort(np.argsort(-used, kind="stable")[:MOST])
    return [
        JointRow(
            name=names[k],
            normal=unit.number(float(normal[k])),
            friction=unit.number(math.sqrt(max(float(sums[k] @ sums[k]) - normal[k] ** 2, 0))),
            friction_used=percent(float(used[k])),
            worst=k == used.argmax(),
            eccentricity=f"{1e3 * off[k]:.0f}",
        )
        for k in map(int, chosen)
    ]
