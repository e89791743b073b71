"""The tables of the page on one structure: forces on supports, and at joints."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.joints import joint_names
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.words import percent
from blocksim.limit import Resultants, in_world, reactions
from blocksim.view.dimensions import ForceUnit
from blocksim.view.sheet import Sheet

MOST = 60
"""Joints in the table; of more, those that are used most."""
MANY_SUPPORTS = 12
"""Supports in the table of reactions."""
HINGE = "hinge"
"""Said in place of a share of width where blocks meet at a corner."""


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


def joint_table(
    problem: Problem[Any], found: Resultants | None, unit: ForceUnit
) -> tuple[list[tuple[str, str]], list[tuple[bool, tuple[str, ...]]]]:
    """Tell what joints carry, in their order.

    Returns: Headings with their units, without those of the names; and cells of each joint, its
        name first, with whether it is the one that is used most.
    """
    if found is None:
        return [], []
    names, worst = joint_names(problem.assembly), int(found.used.argmax())
    chosen: list[int] = np.sort(np.argsort(-found.used, kind="stable")[:MOST]).tolist()
    known = problem.weighed and problem.has_size
    if problem.in_space:
        middles = [each.points.mean(axis=0) for each in problem.assembly.joints]
        off = np.linalg.norm(found.point - middles, axis=1)
        hinges = np.zeros(len(off), dtype=np.bool_)
    else:
        joints = problem.assembly.joint_arrays
        middle = joints.ends.mean(axis=1) * problem.assembly.size
        off = ((found.point - middle) * joints.tangent).sum(axis=1)
        hinges = joints.is_corner
    off = np.where(hinges, np.nan, off)
    columns: list[tuple[str, str, list[str]]] = [
        ("normal", unit.name, [unit.number(float(found.normal[k])) for k in chosen]),
        ("friction", unit.name, [unit.number(float(found.friction[k])) for k in chosen]),
        ("ecc.", "mm", ["-" if np.isnan(off[k]) else f"{round(1e3 * off[k]) + 0:d}"
                        for k in chosen]),
        ("width", "used", [HINGE if hinges[k] else percent(float(found.width_used[k]), ".1f")
                           for k in chosen]),
        ("friction", "used", [percent(float(found.friction_used[k]), ".1f") for k in chosen]),
        ("stress", "MPa", [_stress(float(found.stress[k])) if known else "-" for k in chosen]),
    ]  # fmt: skip
    if problem.in_space:
        del columns[5], columns[3]
    cells = zip([names[k] for k in chosen], *(each for *_, each in columns), strict=True)
    rows = [(k == worst, row) for k, row in zip(chosen, cells, strict=True)]
    return [(name, of) for name, of, _ in columns], rows


def _stress(pascal: float) -> str:
    return "-" if math.isnan(pascal) else f"{pascal / 1e6:#.3g}".rstrip(".")


def solid_reactions(
    problem: Problem[SpatialAssembly], found: Resultants, unit: ForceUnit
) -> list[list[str]]:
    """Return rows of reactions along x, y and z, by support."""
    borne: dict[int | None, Array] = {}
    for joint, force in zip(problem.assembly.joints, found.force, strict=True):
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
