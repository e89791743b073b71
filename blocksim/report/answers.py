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
    from blocksim.arch.dimensions import At
    from blocksim.arch.modes import Mode
    from blocksim.ask.archbracket import Bracket
    from blocksim.ask.archcheck import ArchCheck
    from blocksim.limit.carried import Carried

SIX = 6
"""Digits of ratios, where no more are known."""


def check_record(answer: ArchCheck, carried: Carried | None = None) -> dict[str, object]:
    """Return a check as `check --json` prints it."""
    arch, carried = answer.arch, carried or answer.carried
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
        "mu": answer.mu,
        "half_angle_deg": math.degrees(arch.half_angle),
        "voussoirs": arch.voussoirs,
        "weight": arch.weight,
        "radius": arch.radius,
        "depth": arch.depth,
        **size_record(arch, answer.mu),
        "lean_deg": math.degrees(answer.lean),
        "eta_limit": answer.eta_limit,
        "eta_theory": answer.eta_theory,
        "factor_of_safety": carried and carried.geometrical_factor,
        **carried_record(carried, joint_names_of(arch)),
        "rest": answer.rest,
        "rest_goes_on": answer.motion and answer.motion.goes_on,
        "mode": answer.mode,
        "mode_in_motion": answer.mode_in_motion,
        "mode_limit": answer.mode_limit,
        "mode_theory": answer.mode_theory,
        "modes_theory": list(answer.modes_theory),
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
    return {
        "version": __version__,
        "method": answer.method,
        "half_angle_deg": math.degrees(answer.half_angle),
        "mu": answer.mu,
        "voussoirs": answer.voussoirs,
        "weight": answer.weight,
        "radius": radius,
        "depth": answer.depth * radius,
        "lean_deg": math.degrees(answer.lean),
        "tol": answer.tol,
        "eta_low": answer.eta_low,
        "eta_high": answer.eta_high,
        "eta_limit": answer.eta_limit,
        "eta_theory": answer.eta_theory,
        "mode": answer.mode,
        "mode_in_motion": answer.mode_in_motion,
        "mode_limit": answer.mode_limit,
        "mode_theory": answer.mode_theory,
        "modes_theory": list(answer.modes_theory),
        "thrust": answer.thrust,
        "beta_r_deg": _degrees(answer.beta_r),
        "beta_s_deg": _degrees(answer.beta_s),
        "confirmed": answer.confirmed,
        "runs": answer.runs,
        "undecided": answer.undecided,
        "blocks": answer.blocks,
        "splits": answer.splits,
        "reason": answer.reason,
        "wall_s": answer.wall_s,
    }


def joint_names_of(arch: Arch) -> list[str]:
    """Name joints by the voussoirs on their two sides, numbered from 1 at the left.

    As `joint_names` does, but without blocks, which take longer to make than an answer.
    """
    sides = ["support", *map(str, range(1, arch.voussoirs + 1)), "support"]
    return [f"{before}-{after}" for before, after in pairwise(sides)]


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else math.degrees(angle)


def check_lines(
    answer: ArchCheck, at: At | None = None, carried: Carried | None = None
) -> list[str]:
    """Return a check in words; `at` is the line that was measured, if one was."""
    arch, carried = answer.arch, carried or answer.carried
    lines = [
        f"{answer.verdict.value.upper()}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  arch    alpha {math.degrees(arch.half_angle):g} deg, eta {arch.eta:g}, "
        f"mu {answer.mu:g}, {arch.voussoirs} voussoirs, weight {arch.weight}, "
        f"depth {arch.depth / arch.radius:g} r{lean_words(answer.lean)}",
        *size_lines(arch, answer.mu, at),
        f"  because {answer.reason}",
        _exact("least  ", answer),
        *carried_lines(carried, joint_names_of(arch)),
        *(unit_lines(arch, at) if carried else []),
    ]
    if answer.method == "theory":
        of = "of the continuous arch at its least thickness"
        if answer.eta_theory is None:
            of = "of the continuous arch, of any thickness"
    else:
        of = f"of the voussoirs as built, at eta {arch.eta:g}"
    if answer.method == "limit":
        lines.append(f"  proof   {proof_words(answer)}")
    if rest := rest_words(answer.rest, answer.motion, asked=answer.asked_rest):
        lines.append(f"  rest    {rest}")
    lines += _modes(answer, of)
    active = [joint for joint in answer.joints if joint.state is not JointState.CLOSED]
    if active:
        told = ", ".join(
            f"{signed(math.degrees(j.angle), 1)} deg {j.state.value}" for j in active
        )
        lines.append(f"  joints  {told}")
    return lines


def bracket_lines(answer: Bracket) -> list[str]:
    """Return a bracket in words."""
    digits = _digits(answer)
    if answer.eta_high is None:
        head = "NOTHING STANDS up to eta = 2"
    elif answer.eta_high == 0:
        head = "ANY THICKNESS STANDS"
    elif answer.eta_low == answer.eta_high:
        head = f"LEAST ETA {answer.eta_high:.12g}"
    else:
        low, high = answer.eta_low or 0.0, answer.eta_high
        head = f"LEAST ETA between {low:.{digits}g} and {high:.{digits}g}"
    lines = [
        f"{head}  ({answer.method}, {answer.wall_s:.2g} s)",
        f"  arch    alpha {math.degrees(answer.half_angle):g} deg, mu {answer.mu:g}, "
        f"{answer.voussoirs} voussoirs, weight {answer.weight}, "
        f"depth {answer.depth:g} r{lean_words(answer.lean)}",
        f"  because {answer.reason}",
        _exact("exact  ", answer, digits),
    ]
    whose = "continuous arch" if answer.method == "theory" else "voussoirs as built"
    lines += _modes(answer, f"of the {whose}, at eta {ratio(answer.eta_low, digits)}")
    if answer.thrust is not None:
        lines.append(f"  thrust  h = {answer.thrust:.9g}, in units of gamma t d r")
    if answer.beta_r is not None:
        lines.append(f"  hinge   {math.degrees(answer.beta_r):.4f} deg from the crown")
    if answer.beta_s is not None:
        lines.append(f"  slides  {math.degrees(answer.beta_s):.4f} deg from the crown")
    if answer.undecided:
        lines.append(f"  unsure  {answer.undecided} of {answer.runs} ratios undecided")
    return lines


def _exact(label: str, answer: ArchCheck | Bracket, digits: int = SIX) -> str:
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


def _digits(answer: Bracket) -> int:
    """Digits that tell both ends of a bracket apart, and one or two more; six at least."""
    low, high = answer.eta_low or 0.0, answer.eta_high or 0.0
    return SIX if low >= high else max(SIX, 2 - math.floor(math.log10(1 - low / high)))


def _modes(answer: ArchCheck | Bracket, of: str) -> list[str]:
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
