"""The tables of the page on one structure: forces on supports, and at joints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.joints import joint_names
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.limit import in_world, reactions
from blocksim.view.sheet import Sheet
from blocksim.view.solidscene import pressed
from blocksim.view.units import ForceUnit

MOST = 60
"""Joints in the table; of more, those that are used most."""
MANY_SUPPORTS = 12
"""Supports in the table of reactions."""
HINGE = "hinge"
"""Said in place of a share of width where blocks meet at a corner."""


@dataclass(frozen=True, kw_only=True)
class JointRow:
    """What a joint carries, as the table says it."""

    name: str
    normal: str
    friction: str
    friction_used: str
    worst: bool
    eccentricity: str = ""
    stress: str = ""
    width_used: str = ""


def reaction_table(sheet: Sheet) -> tuple[list[str], list[list[str]]]:
    """Return headings and rows of reactions: by support, in each state, across and up."""
    carried, problem = sheet.carried, sheet.problem
    if carried is None or not carried.stands or carried.forces is None:
        return [], []
    columns = [("greatest margin", carried.forces)]
    if any(line.name != "safest" for line in sheet.lines):
        for name, end in (
            ("greatest thrust", carried.greatest),
            ("least thrust", carried.least),
        ):
            if end is not None and end.forces is not None:
                columns.insert(0, (name, end.forces))
    borne = [reactions(problem, forces) for _, forces in columns]
    if len({len(each) for each in borne}) != 1 or len(borne[0]) > MANY_SUPPORTS:
        return [], []
    rows = [
        [first.name]
        + [
            sheet.unit.number(float(part))
            for each in borne
            for part in in_world(problem, each[place].force)
        ]
        for place, first in enumerate(borne[0])
    ]
    return [name for name, _ in columns], rows


def joint_rows(sheet: Sheet) -> list[JointRow]:
    """Tell what joints carry in the state of greatest margin, in their order."""
    carried, problem, unit = sheet.carried, sheet.problem, sheet.unit
    found = None if carried is None else carried.resultants
    if found is None:
        return []
    joints = problem.assembly.joint_arrays
    middle = joints.ends.mean(axis=1) * problem.assembly.size
    off = ((found.point - middle) * joints.tangent).sum(axis=1)
    chosen = np.sort(np.argsort(-found.used, kind="stable")[:MOST])
    names, worst = joint_names(problem.assembly), int(found.used.argmax())
    known = problem.weighed and problem.has_size
    return [
        JointRow(
            name=names[k],
            normal=unit.number(float(found.normal[k])),
            friction=unit.number(float(found.friction[k])),
            eccentricity="-"
            if joints.is_corner[k] or np.isnan(off[k])
            else f"{round(1e3 * off[k]) + 0:d}",
            stress=_stress(float(found.stress[k])) if known else "-",
            width_used=HINGE if joints.is_corner[k] else percent(float(found.width_used[k])),
            friction_used=percent(float(found.friction_used[k])),
            worst=k == worst,
        )
        for k in map(int, chosen)
    ]


def _stress(pascal: float) -> str:
    return "-" if math.isnan(pascal) else f"{pascal / 1e6:#.3g}".rstrip(".")


def percent(share: float) -> str:
    """Return a share in per cent."""
    return f"{100 * share:.1f}\N{NO-BREAK SPACE}%"


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
