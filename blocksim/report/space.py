"""Answers on problems in space, as JSON with the keys of plane ones, and in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

import numpy as np

from blocksim.arch.dimensions import friction_angle
from blocksim.blocks.joints import JointState, joint_names, side_name
from blocksim.common.version import __version__
from blocksim.common.words import counted
from blocksim.report.answers import HINGE, HINGED, evidence_record
from blocksim.report.answerwords import aside_lines, because_lines, few, values_tried
from blocksim.report.schema import (
    BracketRecord,
    CarriedRecord,
    CheckRecord,
    JointRecord,
    MovementRecord,
    ProblemRecord,
)

if TYPE_CHECKING:
    from blocksim.ask.space import SpatialBracket, SpatialCheck
    from blocksim.blocks.space.problem import SpatialProblem

STILL = 1e-6
"""Rate below which a block is told to rest."""


def check_in_space_record(answer: SpatialCheck) -> CheckRecord:
    """Return a check as `check --json` prints it; null what is not known in space."""
    problem = answer.problem
    factor = answer.load_factor
    found: dict[str, object] = {
        **dict.fromkeys(CheckRecord.__annotations__),
        **dict.fromkeys(CarriedRecord.__annotations__),
        "version": __version__,
        "method": answer.method,
        "verdict": answer.verdict.value,
        "proved": False,
        "evidence": evidence_record(answer.evidence),
        "reason": answer.reason,
        "problem": _problem_record(problem),
        "load_factor": factor,
        "weights_given": problem.weighed,
        "weight_kN": float(problem.assembly.weights.sum()) / 1000,
        "joints": _joints(answer),
        "mechanism": _mechanism(answer),
        "wall_s": answer.wall_s,
    }
    return cast("CheckRecord", found)


def bracket_in_space_record(answer: SpatialBracket) -> BracketRecord:
    """Return a bracket as `bracket --json` prints it."""
    problem = _problem_record(answer.problem)
    for key in {"tilt": ("tilt_deg",), "mu": ("mu", "friction_angle_deg")}.get(
        answer.over, ("load",)
    ):
        problem[key] = None  # type: ignore[literal-required]
    found: dict[str, object] = {
        **dict.fromkeys(BracketRecord.__annotations__),
        "version": __version__,
        "method": answer.method,
        "over": answer.over,
        "unit": answer.unit,
        "low": answer.low,
        "high": answer.high,
        "stands": answer.stands,
        "limit": answer.limit,
        "proved": False,
        "runs": answer.runs,
        "undecided": 0,
        "tol": answer.tol,
        "evidence": evidence_record(answer.evidence),
        "reason": answer.reason,
        "problem": problem,
        "wall_s": answer.wall_s,
    }
    return cast("BracketRecord", found)


def _problem_record(problem: SpatialProblem) -> ProblemRecord:
    found: dict[str, object] = {
        **dict.fromkeys(ProblemRecord.__annotations__),
        "title": problem.title,
        "blocks": len(problem.assembly.blocks),
        "joints": len(problem.assembly.joints),
        "mu": problem.mu,
        "friction_angle_deg": friction_angle(problem.mu),
        "tilt_deg": _tilt(problem),
        "azimuth_deg": math.degrees(problem.azimuth),
        "load": problem.load,
        "weight_kN": float(problem.assembly.weights.sum()) / 1000,
        "live_weight_kN": 0.0
        - sum(
            float(load.force[2]) * len(load.blocks) / 1000
            for load in problem.live
            if not load.per_weight
        ),
    }
    return cast("ProblemRecord", found)


def _tilt(problem: SpatialProblem) -> float:
    x, y, z = problem.gravity.tolist()
    return math.degrees(math.atan2(math.hypot(x, y), -z))


def _joints(answer: SpatialCheck) -> list[JointRecord]:
    told: list[JointRecord] = []
    assembly = answer.problem.assembly
    for at, joint in enumerate(assembly.joints):
        force = None if answer.forces is None else answer.forces[at]
        state = answer.joints[at]
        told.append(
            {
                "a": side_name(assembly, at, 0),
                "b": side_name(assembly, at, 1),
                "ends": joint.points.tolist(),
                "gap": joint.gap,
                "angle_deg": None,
                "state": _state(state),
                "hinge": None,
                "normal_force": None if force is None else float(force[0]),
                "friction_force": None if force is None else float(np.hypot(*force[1:])),
                "width_used": None,
                "friction_used": None,
                "stress_MPa": None,
            }
        )
    return told


def _state(state: JointState) -> str:
    return HINGE if state in HINGED else state.value


def _mechanism(answer: SpatialCheck) -> list[MovementRecord] | None:
    """Rates of the blocks: x, y and z in m for each radian, rotations about the axes."""
    rates, assembly = answer.mechanism, answer.problem.assembly
    if rates is None:
        return None
    ways = rates[:, :3] * assembly.size
    return [
        {
            "block": block.name,
            "x": float(way[0]),
            "y": float(way[1]),
            "z": float(way[2]),
            "rotation": None,
            "rotations": rate[3:].tolist(),
        }
        for block, way, rate in zip(assembly.blocks, ways, rates, strict=True)
    ]


def check_in_space_lines(answer: SpatialCheck) -> list[str]:
    """Return a check in words."""
    problem = answer.problem
    lines = [
        f"{answer.verdict.value.upper()}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  what    {described_in_space(problem)}",
        *because_lines(answer.evidence),
    ]
    if answer.load_factor is not None:
        at = f", asked at {problem.load:g}" if problem.load else ""
        lines.append(f"  load    factor at collapse {answer.load_factor:.9g}{at}")
    names = joint_names(problem.assembly)
    active = [
        f"{name} {_state(state)}"
        for name, state in zip(names, answer.joints, strict=True)
        if state is not JointState.CLOSED
    ]
    if active:
        lines.append(f"  joints  {few(active)}")
    if answer.mechanism is not None:
        speeds = np.abs(answer.mechanism).max(axis=1)
        order = [int(at) for at in np.argsort(-speeds, kind="stable") if speeds[at] > STILL]
        movers = [problem.assembly.blocks[at].name for at in order]
        lines.append(f"  moves   {few(movers)} (the fastest first)")
    return [*lines, *aside_lines(answer.evidence)]


def bracket_in_space_lines(answer: SpatialBracket) -> list[str]:
    """Return a bracket in words."""
    unit = f" {answer.unit}" if answer.unit else ""
    lines = [
        f"{values_tried(answer, digits=12)}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  what    {described_in_space(answer.problem)}",
        *because_lines(answer.evidence),
    ]
    if answer.limit is not None and math.isfinite(answer.limit):
        lines.append(f"  exact   {answer.limit:.9g}{unit} by limit analysis")
    return [*lines, *aside_lines(answer.evidence)]


def described_in_space(problem: SpatialProblem) -> str:
    """Say what a problem in space is, in a line."""
    assembly = problem.assembly
    said = [problem.title] if problem.title else []
    said += [counted(len(assembly.blocks), "block"), counted(len(assembly.joints), "joint")]
    said.append(f"in space, mu {problem.mu:g}")
    tilt = _tilt(problem)
    if tilt:
        said.append(f"tilted {tilt:g} deg")
    if problem.azimuth:
        said.append(f"towards {math.degrees(problem.azimuth):g} deg from x")
    if problem.live:
        said.append(
            f"live loads times {problem.load:g}" if problem.load else "no live load on it"
        )
    said.append(f"L = {assembly.size:g} m")
    return ", ".join(said)
