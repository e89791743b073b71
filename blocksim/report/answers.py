"""Answers as JSON objects, the same keys for every subject; see `blocksim.report.schema`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from blocksim.blocks.joints import JointState, joint_names, side_name
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import FaceJoint, SpatialAssembly
from blocksim.common.fields import same
from blocksim.common.version import __version__
from blocksim.report.carried import carried_record
from blocksim.report.problems import measured_line, problem_record, weight_of
from blocksim.report.schema import ArchBracketRecord, ArchRecord, BracketRecord

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchAnswer
    from blocksim.ask.bracket import Bracket
    from blocksim.ask.check import Check
    from blocksim.blocks.assembly import Joint
    from blocksim.limit.carried import Carried
    from blocksim.report.schema import CheckRecord, JointRecord, MovementRecord, ShakenRecord

HINGE = "hinge"
SHAPE = ("eta", "voussoirs", "weight", "radius", "depth")
"""Fields of the shape of an arch that are told besides its half-angle."""


def check_record(answer: Check[Any], carried: Carried | None = None) -> CheckRecord:
    """Return a check as `check --json` prints it.

    Forces of joints are in N, as a file has them; normal forces press where they are above
    0. They are those of the safest state of equilibrium. What is not known in space is null.
    """
    problem: Problem[Any] = answer.problem
    carried = carried or answer.carried
    told = carried_record(carried, joint_names(problem.assembly))
    if carried is None:
        told["weights_given"] = problem.weighed
        told["weight_kN"] = weight_of(problem) / 1000
    seconds = None if answer.simulated is None else answer.simulated * problem.seconds
    return {
        "version": __version__,
        "method": answer.method,
        "verdict": answer.verdict.value,
        "proved": answer.proved,
        "evidence": answer.evidence,
        "reason": answer.reason,
        "problem": problem_record(problem),
        "load_factor": answer.load_factor,
        **told,
        "rest": answer.rest,
        "rest_goes_on": answer.motion and answer.motion.goes_on,
        "joints": _joints(answer, carried),
        "mechanism": _mechanism(answer),
        "shaken": _shaken(answer),
        "simulated_s": seconds,
        "state_hash": answer.state_hash,
        "blocks": answer.blocks,
        "splits": answer.splits,
        "wall_s": answer.wall_s,
        "arch": answer.arch and _arch(answer.arch),
    }


def bracket_record(answer: Bracket[Any]) -> BracketRecord:
    """Return a bracket as `bracket --json` prints it."""
    said = {
        "version": __version__,
        "problem": problem_record(answer.problem, answer.over),
        "arch": _arch_bracket(answer),
    }
    return _record(BracketRecord, answer, said)


def _record(kind: Any, of: object, said: Mapping[str, object]) -> Any:
    """Return a record: what is said, and the rest as an answer has it under the same names."""
    return {key: said[key] if key in said else getattr(of, key) for key in kind.__annotations__}


def state_words(problem: Problem[Any]) -> Callable[[JointState], str]:
    """Return what says a joint's state: only an arch has an intrados and an extrados."""
    if problem.is_arch:
        return lambda state: state.value
    return lambda state: state.value if state.hinge is None else HINGE


def _arch(of: ArchAnswer) -> ArchRecord:
    """Tell ratios and modes of an arch."""
    said = {
        "half_angle_deg": math.degrees(of.shape.half_angle),
        **same(of.shape, *SHAPE),
        "modes_theory": list(of.modes_theory),
    }
    return _record(ArchRecord, of, said)


def _arch_bracket(answer: Bracket[Any]) -> ArchBracketRecord | None:
    """Tell the same of a bracket over its thickness, and both ratios tried."""
    of, line = answer.arch, measured_line(answer.problem)
    if of is None:
        return None
    said = {
        **_arch(of),
        "eta": None,
        "radius": None if line else of.shape.radius,
        "fixed_line": line.at if line else "centreline",
        "beta_r_deg": None if of.beta_r is None else math.degrees(of.beta_r),
        "beta_s_deg": None if of.beta_s is None else math.degrees(of.beta_s),
    }
    return _record(ArchBracketRecord, of, said)


def _joints(answer: Check[Any], carried: Carried | None) -> list[JointRecord]:
    problem: Problem[Any] = answer.problem
    assembly, words = problem.assembly, state_words(problem)
    found = answer.resultants if carried is None else carried.resultants
    flat = None if problem.in_space else found
    known = problem.weighed and problem.has_size
    told: list[JointRecord] = []
    for k, joint in enumerate(assembly.joints):
        ends = _ends(joint)
        seen = answer.joints[k]
        end = None if problem.in_space else seen.state.hinge
        told.append(
            {
                "a": side_name(assembly, k, 0),
                "b": side_name(assembly, k, 1),
                "ends": ends,
                "gap": joint.gap,
                "angle_deg": math.degrees(seen.angle) if problem.is_arch else None,
                "state": words(seen.state),
                "hinge": None if end is None else ends[min(end, len(ends) - 1)],
                "normal_force": None if found is None else float(found.normal[k]),
                "friction_force": None if found is None else float(found.friction[k]),
                "width_used": None if flat is None else float(flat.width_used[k]),
                "stress_MPa": None
                if flat is None or len(ends) == 1 or not known
                else float(flat.stress[k]) / 1e6,
                "friction_used": None if found is None else float(found.friction_used[k]),
            }
        )
    return told


def _ends(joint: Joint | FaceJoint) -> list[list[float]]:
    """Return the ends of a joint, or the one of a corner, or in space its corners."""
    if isinstance(joint, FaceJoint):
        return joint.points.tolist()
    return [joint.inner.tolist(), *([] if joint.is_corner else [joint.outer.tolist()])]


def _shaken(answer: Check[Any]) -> ShakenRecord | None:
    """Tell what became of blocks on ground that shakes. Times are since the release."""
    if answer.shaken is None:
        return None
    rocking, assembly = answer.shaken.rocking, answer.problem.assembly
    off, late, unit = rocking.off, rocking.late, answer.problem.seconds
    return {
        "largest_rotation_deg": math.degrees(rocking.rotation),
        "largest_rotation_error_deg": None if off is None else math.degrees(off),
        "block": assembly.blocks[rocking.block].name or str(rocking.block),
        "first_impact_s": answer.shaken.first_impact_s,
        "first_impact_error_s": None if late is None else late * unit,
        "moved_m": answer.shaken.moved * assembly.size,
    }


def _mechanism(answer: Check[Any]) -> list[MovementRecord] | None:
    """Rates of the blocks: ways in m for each radian of rotation, which has no unit."""
    rates, assembly = answer.mechanism, answer.problem.assembly
    if rates is None:
        return None
    spatial = isinstance(assembly, SpatialAssembly)
    return [
        {
            "block": block.name or str(index),
            "x": float(rate[0]) * assembly.size,
            "y": float(rate[1]) * assembly.size,
            "z": float(rate[2]) * assembly.size if spatial else None,
            "rotation": None if spatial else float(rate[2]),
            "rotations": rate[3:].tolist() if spatial else None,
        }
        for index, (block, rate) in enumerate(zip(assembly.blocks, rates, strict=True))
    ]
