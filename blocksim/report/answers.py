"""Answers as JSON objects and as text for people."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from blocksim.arch.circular import GRAVITY, Arch
from blocksim.ask.check import proof_words
from blocksim.ask.rest import rest_words
from blocksim.blocks.joints import JointState
from blocksim.common.version import __version__
from blocksim.report.carried import carried_lines, carried_record
from blocksim.report.sizes import size_lines, size_record, unit_lines

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchAnswer, ArchBracket
    from blocksim.arch.dimensions import At
    from blocksim.arch.modes import Mode
    from blocksim.ask.bracket import Bracket
    from blocksim.ask.check import Check
    from blocksim.blocks.problem import Problem
    from blocksim.limit.carried import Carried

SIX = 6
"""Digits of ratios, where no more are known."""


def check_record(answer: Check, carried: Carried | None = None) -> dict[str, object]:
    """Return a check as `check --json` prints it."""
    of, mu, carried = _of(answer), answer.problem.mu, carried or answer.carried
    arch = of.shape
    seconds = None
    if answer.simulated is not None:
        seconds = answer.simulated * math.sqrt(arch.radius / GRAVITY)
    return {
        "version": __version__,
        "method": answer.method,
        "verdict": answer.verdict.value,
        "proved": answer.proved,
        "reason": answer.reason,
        "eta": arch.eta,
        "mu": mu,
        "half_angle_deg": math.degrees(arch.half_angle),
        "voussoirs": arch.voussoirs,
        "weight": arch.weight,
        "radius": arch.radius,
        "depth": arch.depth,
        **size_record(arch, mu),
        "lean_deg": lean_deg(answer.problem),
        "eta_limit": of.eta_limit,
        "eta_theory": of.eta_theory,
        "factor_of_safety": carried and carried.geometrical_factor,
        **carried_record(carried, joint_names_of(arch)),
        "rest": answer.rest,
        "rest_goes_on": answer.motion and answer.motion.goes_on,
        "mode": of.mode,
        "mode_in_motion": of.mode_in_motion,
        "mode_limit": of.mode_limit,
        "mode_theory": of.mode_theory,
        "modes_theory": list(of.modes_theory),
        "joints": [
            {"angle_deg": math.degrees(joint.angle), "state": joint.state.value}
            for joint in answer.joints
        ],
        "simulated_s": seconds,
        "state_hash": answer.state_hash,
        "blocks": answer.blocks,
        "splits": answer.splits,
        "wall_s": answer.wall_s,
    }


def bracket_record(answer: Bracket, radius: float = 1.0) -> dict[str, object]:
    """Return a bracket as `bracket --json` prints it, its depth in m, as the radius is."""
    of = bracket_of(answer)
    arch = of.shape
    return {
        "version": __version__,
        "method": answer.method,
        "half_angle_deg": math.degrees(arch.half_angle),
        "mu": answer.problem.mu,
        "voussoirs": arch.voussoirs,
        "weight": arch.weight,
        "radius": radius,
        "depth": arch.depth / arch.radius * radius,
        "lean_deg": lean_deg(answer.problem),
        "tol": answer.tol,
        "eta_low": of.eta_low,
        "eta_high": of.eta_high,
        "eta_limit": of.eta_limit,
        "eta_theory": of.eta_theory,
        "mode": of.mode,
        "mode_in_motion": of.mode_in_motion,
        "mode_limit": of.mode_limit,
        "mode_theory": of.mode_theory,
        "modes_theory": list(of.modes_theory),
        "thrust": of.thrust,
        "beta_r_deg": _degrees(of.beta_r),
        "beta_s_deg": _degrees(of.beta_s),
        "confirmed": answer.confirmed,
        "runs": answer.runs,
        "undecided": answer.undecided,
        "blocks": answer.blocks,
        "splits": answer.splits,
        "reason": answer.reason,
        "wall_s": answer.wall_s,
    }


def _of(answer: Check) -> ArchAnswer:
    assert answer.arch is not None  # noqa: S101
    return answer.arch


def bracket_of(answer: Bracket) -> ArchBracket:
    """Return what is known of the arch."""
    assert answer.arch is not None  # noqa: S101
    return answer.arch


def lean_deg(problem: Problem) -> float:
    """Return by how many degrees gravity leans out of the plane."""
    x, y, z = problem.gravity.tolist()
    return math.degrees(math.atan2(z, math.hypot(x, y)))


def joint_names_of(arch: Arch) -> list[str]:
    """Name joints by the voussoirs on their two sides, numbered from 1 at the left.

    As `joint_names` does, but without blocks, which take longer to make than an answer.
    """
    sides = ["support", *map(str, range(1, arch.voussoirs + 1)), "support"]
    return [f"{before}-{after}" for before, after in pairwise(sides)]


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else math.degrees(angle)


def check_lines(
    answer: Check, at: At | None = None, carried: Carried | None = None
) -> list[str]:
    """Return a check in words; `at` is the line that was measured, if one was."""
    of, mu, carried = _of(answer), answer.problem.mu, carried or answer.carried
    arch = of.shape
    lines = [
        f"{answer.verdict.value.upper()}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  arch    alpha {math.degrees(arch.half_angle):g} deg, eta {arch.eta:g}, "
        f"mu {mu:g}, {arch.voussoirs} voussoirs, weight {arch.weight}, "
        f"depth {arch.depth / arch.radius:g} r{lean_words(math.radians(lean_deg(answer.problem)))}",
        *size_lines(arch, mu, at),
        f"  because {answer.reason}",
        _exact("least  ", of),
        *carried_lines(carried, joint_names_of(arch)),
        *(unit_lines(arch, at) if carried else []),
    ]
    if answer.method == "theory":
        whose = "of the continuous arch at its least thickness"
        if of.eta_theory is None:
            whose = "of the continuous arch, of any thickness"
    else:
        whose = f"of the voussoirs as built, at eta {arch.eta:g}"
    if answer.method == "limit":
        lines.append(f"  proof   {proof_words(answer)}")
    if rest := rest_words(answer.rest, answer.motion, asked=answer.asked_rest):
        lines.append(f"  rest    {rest}")
    lines += _modes(of, whose)
    active = [joint for joint in answer.joints if joint.state is not JointState.CLOSED]
    if active:
        told = ", ".join(
            f"{signed(math.degrees(j.angle), 1)} deg {j.state.value}" for j in active
        )
        lines.append(f"  joints  {told}")
    return lines


def bracket_lines(answer: Bracket) -> list[str]:
    """Return a bracket in words."""
    of = bracket_of(answer)
    arch, digits = of.shape, _digits(of)
    if of.eta_high is None:
        head = "NOTHING STANDS up to eta = 2"
    elif of.eta_high == 0:
        head = "ANY THICKNESS STANDS"
    elif of.eta_low == of.eta_high:
        head = f"LEAST ETA {of.eta_high:.12g}"
    else:
        low, high = of.eta_low or 0.0, of.eta_high
        head = f"LEAST ETA between {low:.{digits}g} and {high:.{digits}g}"
    lines = [
        f"{head}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  arch    alpha {math.degrees(arch.half_angle):g} deg, mu {answer.problem.mu:g}, "
        f"{arch.voussoirs} voussoirs, weight {arch.weight}, "
        f"depth {arch.depth / arch.radius:g} r{lean_words(math.radians(lean_deg(answer.problem)))}",
        f"  because {answer.reason}",
        _exact("exact  ", of, digits),
    ]
    whose = "continuous arch" if answer.method == "theory" else "voussoirs as built"
    lines += _modes(of, f"of the {whose}, at eta {ratio(of.eta_low, digits)}")
    if of.thrust is not None:
        lines.append(f"  thrust  h = {of.thrust:.9g}, in units of gamma t d r")
    if of.beta_r is not None:
        lines.append(f"  hinge   {math.degrees(of.beta_r):.4f} deg from the crown")
    if of.beta_s is not None:
        lines.append(f"  slides  {math.degrees(of.beta_s):.4f} deg from the crown")
    if answer.undecided:
        lines.append(f"  unsure  {answer.undecided} of {answer.runs} ratios undecided")
    return lines


def _exact(label: str, answer: ArchAnswer, digits: int = SIX) -> str:
    """Tell the least thickness as built and of the continuous arch, each with its mode."""

    def least(eta: float | None, mode: Mode | None) -> str:
        if eta == 0:
            return "any"
        told = "none up to 2" if eta is None else ratio(eta, digits)
        return f"{told} ({mode or 'mode unnamed'})"

    return (
        f"  {label} eta {least(answer.eta_limit, answer.mode_limit)} as built, "
        f"{least(answer.eta_theory, answer.mode_theory)} continuous"
    )


def _digits(answer: ArchBracket) -> int:
    """Digits that tell both ends of a bracket apart, and one or two more; six at least."""
    low, high = answer.eta_low or 0.0, answer.eta_high or 0.0
    return SIX if low >= high else max(SIX, 2 - math.floor(math.log10(1 - low / high)))


def _modes(answer: ArchAnswer, of: str) -> list[str]:
    """Tell the mode an arch starts with and, if it is another, that in motion."""
    lines: list[str] = []
    if answer.mode:
        lines.append(f"  mode    {answer.mode.value}, {answer.mode.description}, {of}")
    if answer.mode_in_motion and answer.mode_in_motion is not answer.mode:
        from blocksim.evidence.motion import EARLY

        later = answer.mode_in_motion
        lines.append(
            f"  moving  {later.value}, {later.description}, once it has moved {EARLY:g} r"
        )
    return lines


def lean_words(lean: float) -> str:
    """Say how far gravity leans out of the plane, where it does."""
    return f", gravity leans {math.degrees(lean):g} deg out of the plane" if lean else ""


def signed(value: float, digits: int) -> str:
    """Return a number with its sign; what rounds to nothing has none."""
    said = f"{value:+.{digits}f}"
    return said if float(said) else said[1:]


def ratio(eta: float | None, digits: int = SIX) -> str:
    """Return a ratio in so many digits, "any" where every one stands, or a dash."""
    if eta == 0:
        return "any"
    return "-" if eta is None else f"{eta:.{digits}g}"
