"""Answers on structures as JSON objects and as text for people."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict

from blocksim.ask.bracket import Bracket
from blocksim.ask.check import SOUGHT, Check, proof_words
from blocksim.ask.ends import End
from blocksim.ask.rest import rest_words
from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import shaking_record
from blocksim.common.version import __version__
from blocksim.common.words import counted
from blocksim.kinds.circular import plain_arch
from blocksim.limit.carried import Carried
from blocksim.report.carried import carried_lines, carried_record
from blocksim.report.sizes import is_metric, unit_lines
from blocksim.report.structuresizes import problem_size_lines, problem_size_record

SHOWN = 8
"""Joints and blocks told in a line of text."""


def check_record(answer: Check, carried: Carried | None = None) -> dict[str, object]:
    """Return a check of a structure as `check --json` prints it.

    Forces of joints are in N, as the file has them; normal forces press where they are above
    0. They are those of the safest state of equilibrium.
    """
    problem, carried = answer.problem, carried or answer.carried
    assembly = problem.assembly
    seconds = None
    if answer.simulated is not None:
        seconds = answer.simulated * problem.seconds
    return {
        "version": __version__,
        "method": answer.method,
        "verdict": answer.verdict.value,
        "proved": answer.proved,
        "reason": answer.reason,
        "problem": {
            "title": problem.title,
            "blocks": len(assembly.blocks),
            "joints": len(assembly.joints),
            "mu": problem.mu,
            **tilt_and_lean(problem),
            "load": problem.load,
            "shake": None if problem.shaking is None else shaking_record(problem.shaking),
            **problem_size_record(problem),
        },
        "load_factor": answer.load_factor,
        "factor_of_safety": _factor_of_safety(answer, carried),
        **carried_record(carried, joint_names(assembly)),
        "rest": answer.rest,
        "rest_goes_on": answer.motion and answer.motion.goes_on,
        "joints": _joints(answer, carried),
        "mechanism": _mechanism(answer.mechanism, assembly),
        "shaken": _shaken(answer),
        "simulated_s": seconds,
        "state_hash": answer.state_hash,
        "wall_s": answer.wall_s,
    }


def bracket_record(answer: Bracket) -> dict[str, object]:
    """Return a bracket of a structure as `bracket --json` prints it."""
    return {
        "version": __version__,
        "method": answer.method,
        "over": answer.over,
        "unit": answer.unit,
        "low": answer.low,
        "high": answer.high,
        "stands": answer.stands,
        "limit": answer.limit,
        "confirmed": answer.confirmed,
        "runs": answer.runs,
        "undecided": answer.undecided,
        "reason": answer.reason,
        "wall_s": answer.wall_s,
        "events": answer.events and [asdict(each) for each in answer.events],
        "intervals": answer.intervals and [asdict(each) for each in answer.intervals],
    }


def check_lines(answer: Check, carried: Carried | None = None) -> list[str]:
    """Return a check of a structure in words."""
    problem, carried = answer.problem, carried or answer.carried
    lines = [
        f"{answer.verdict.value.upper()}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  what    {described(problem)}",
        *problem_size_lines(problem),
        f"  because {answer.reason}",
    ]
    if answer.load_factor is not None:
        at = f", asked at {problem.load:g}" if problem.load else ""
        lines.append(f"  load    factor at collapse {_number(answer.load_factor)}{at}")
    lines += carried_lines(carried, joint_names(problem.assembly))
    lines += unit_lines(arch) if carried and (arch := plain_arch(problem)) else []
    if carried is None and len(problem.assembly.joints) > SOUGHT:
        lines.append(f"  safety  not sought: there are more than {SOUGHT} joints")
    if answer.method == "limit":
        lines.append(f"  proof   {proof_words(answer)}")
    if rest := rest_words(answer.rest, answer.motion, asked=answer.asked_rest):
        lines.append(f"  rest    {rest}")
    named = joint_names(problem.assembly)
    words = _state_words(problem)
    active = [
        f"{name} {words(joint.state)}"
        for name, joint in zip(named, answer.joints, strict=True)
        if joint.state is not JointState.CLOSED
    ]
    if active:
        lines.append(f"  joints  {_few(active)}")
    if answer.mechanism is not None:
        movers = _few(_movers(answer.mechanism, problem.assembly))
        lines.append(f"  moves   {movers} (the fastest first)")
    return lines


def bracket_lines(answer: Bracket) -> list[str]:
    """Return a bracket of a structure in words."""
    unit = f" {answer.unit}" if answer.unit else ""
    ends = {True: "stands", False: "falls"}
    low, high = ends[answer.stands == "low"], ends[answer.stands == "high"]
    if answer.low is None and answer.high is None:
        head = f"NO LIMIT OVER {answer.over.upper()}"
    else:
        parts = [
            f"{word} at {value:.9g}{unit}"
            for word, value in ((low, answer.low), (high, answer.high))
            if value is not None
        ]
        head = f"{answer.over.upper()}: {', '.join(parts)}"
    lines = [f"{head}  ({answer.method}, {answer.wall_s:.2g} s)"]
    lines.append(f"  because {answer.reason}")
    if answer.limit is not None:
        lines.append(f"  exact   {_number(answer.limit)}{unit} by limit analysis")
    if (many := interval_words(answer)) is not None:
        lines.append(f"  stands  {many}")
    if answer.undecided:
        lines.append(f"  unsure  {answer.undecided} of {answer.runs} values undecided")
    return lines


def interval_words(answer: Bracket) -> str | None:
    """Say between which values it stands; None where there is but one end."""
    found = answer.intervals or ()
    if sum(end is not None for each in found for end in (each.low, each.high)) < 2:
        return None
    said: list[str] = []
    for each in found:
        low = f"from {_end_words(each.low, answer)}" if each.low else ""
        high = f"up to {_end_words(each.high, answer)}" if each.high else "on"
        said.append(f"{low} {high}".strip())
    return ", and ".join(said)


def _end_words(end: End, answer: Bracket) -> str:
    """Tell an end: the value of limit analysis, and those that an engine tried."""
    said = [] if end.confirmed else ["not confirmed"]
    if answer.method != "limit":
        tried = (("stands", end.stands), ("falls", end.falls))
        said = [f"{word} at {value:.9g}" for word, value in tried if value is not None] + said
    unit = f" {answer.unit}" if answer.unit else ""
    return f"{end.limit:.9g}{unit}" + (f" ({', '.join(said)})" if said else "")


def tilt_and_lean(problem: Problem) -> dict[str, float]:
    """Return by how many degrees gravity is turned in the plane, and out of it."""
    x, y, z = problem.gravity.tolist()
    return {
        "tilt_deg": math.degrees(math.atan2(x, -y)),
        "lean_deg": math.degrees(math.atan2(z, math.hypot(x, y))),
    }


def joint_names(assembly: Assembly) -> list[str]:
    """Name each joint by the bodies on its two sides."""
    return [
        f"{_name(assembly, k, 0)}-{_name(assembly, k, 1)}" for k in range(len(assembly.joints))
    ]


def _state_words(problem: Problem) -> Callable[[JointState], str]:
    """Return what says a joint's state: only an arch has an intrados and an extrados."""
    kind = problem.maker
    if kind is not None and kind.is_arch:
        return lambda state: state.value
    return lambda state: HINGE if state in HINGED else state.value


HINGE = "hinge"
HINGED = {JointState.HINGE_INTRADOS: 0, JointState.HINGE_EXTRADOS: 1}
"""Which end of a joint stays closed, in the order of its `ends`."""


def _name(assembly: Assembly, joint: int, side: int) -> str:
    here = assembly.joints[joint]
    index = (here.before, here.after)[side]
    if index != SUPPORT:
        return assembly.blocks[index].name or str(index)
    if here.support is None:
        return "support"
    return assembly.supports[here.support].name or "support"


def _factor_of_safety(answer: Check, carried: Carried | None) -> float | None:
    """Return the factor on live loads where there are any, else the geometrical one."""
    if answer.load_factor is not None and answer.problem.load > 0:
        return answer.load_factor / answer.problem.load
    if answer.problem.live:
        return answer.load_factor
    return carried and carried.geometrical_factor


def _joints(answer: Check, carried: Carried | None) -> list[dict[str, object]]:
    problem = answer.problem
    assembly, words = problem.assembly, _state_words(problem)
    found = None if carried is None else carried.resultants
    told: list[dict[str, object]] = []
    for k, joint in enumerate(assembly.joints):
        ends = (
            [joint.inner.tolist()]
            if joint.is_corner
            else [joint.inner.tolist(), joint.outer.tolist()]
        )
        end = HINGED.get(answer.joints[k].state)
        told.append(
            {
                "a": _name(assembly, k, 0),
                "b": _name(assembly, k, 1),
                "ends": ends[:1] if joint.is_corner else ends,
                "gap": joint.gap,
                "state": words(answer.joints[k].state),
                "hinge": None if end is None else ends[min(end, len(ends) - 1)],
                "normal_force": None if found is None else float(found.normal[k]),
                "friction_force": None if found is None else float(found.friction[k]),
                "width_used": None if found is None else float(found.width_used[k]),
                "friction_used": None if found is None else float(found.friction_used[k]),
            }
        )
    return told


def _shaken(answer: Check) -> dict[str, object] | None:
    """Tell what became of blocks on ground that shakes; times since the release."""
    if answer.shaken is None:
        return None
    rocking, assembly = answer.shaken.rocking, answer.problem.assembly
    return {
        "largest_rotation_deg": math.degrees(rocking.rotation),
        "block": assembly.blocks[rocking.block].name or str(rocking.block),
        "first_impact_s": answer.shaken.first_impact_s,
        "moved_m": answer.shaken.moved * assembly.size,
    }


def _mechanism(rates: Array | None, assembly: Assembly) -> list[dict[str, object]] | None:
    """Rates of the blocks: x and y in m for each radian of rotation, which has no unit."""
    if rates is None:
        return None
    return [
        {
            "block": block.name or str(index),
            "x": float(rate[0]) * assembly.size,
            "y": float(rate[1]) * assembly.size,
            "rotation": float(rate[2]),
        }
        for index, (block, rate) in enumerate(zip(assembly.blocks, rates, strict=True))
    ]


def _movers(rates: Array, assembly: Assembly) -> list[str]:
    """Blocks that move by more than a hundredth of the fastest, the fastest first."""
    reach = assembly.reach / assembly.size
    speed = abs(rates[:, :2]).max(axis=1) + abs(rates[:, 2]) * reach
    order = [int(k) for k in (-speed).argsort() if speed[k] > speed.max() / 100]
    return [assembly.blocks[k].name or str(k) for k in order]


def described(problem: Problem) -> str:
    """Say what a problem is, in a line."""
    turned = tilt_and_lean(problem)
    assembly = problem.assembly
    said = [problem.title] if problem.title else []
    said += [counted(len(assembly.blocks), "block"), counted(len(assembly.joints), "joint")]
    said.append(f"mu {problem.mu:g}")
    if turned["tilt_deg"]:
        said.append(f"tilted {turned['tilt_deg']:g} deg")
    if turned["lean_deg"]:
        said.append(f"gravity leans {turned['lean_deg']:g} deg out of the plane")
    if problem.live:
        said.append(
            f"live loads times {problem.load:g}" if problem.load else "no live load on it"
        )
    if problem.shaking is not None:
        said.append(problem.shaking.words)
    arch = plain_arch(problem)
    said.append(f"L = {assembly.size:g} m" if not arch or is_metric(arch) else "L = r")
    return ", ".join(said)


def _few(names: Sequence[str]) -> str:
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def _number(value: float) -> str:
    return "none: it stands at any" if math.isinf(value) else f"{value:.9g}"
