"""Answers as text for people."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from blocksim.arch.dimensions import friction_angle
from blocksim.ask.answer import SOUGHT, UNPROVED
from blocksim.ask.rest import rest_words
from blocksim.blocks.joints import JointState, joint_names
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.words import few, lasting
from blocksim.report.answers import state_words
from blocksim.report.carried import carried_lines
from blocksim.report.problems import (
    described,
    is_metric,
    length_lines,
    measured_line,
    size_lines,
    unit_lines,
)
from blocksim.simulation.verdict import SEEN

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchAnswer, ArchBracket
    from blocksim.arch.modes import Mode
    from blocksim.ask.bracket import Bracket
    from blocksim.ask.check import Check
    from blocksim.ask.ends import End
    from blocksim.blocks.assembly import Array, Assembly
    from blocksim.limit.carried import Carried
    from blocksim.simulation.verdict import Evidence

SIX = 6
"""Digits of ratios, where no more are known."""
NONE_IN_SPACE = "none was found: forces and motion are checked in floating-point numbers"
ASIDE = {"method": "method", "settings": "method", "reduction": "method", "note": "note"}
"""Evidence that is told at the end, and what its line is called."""
SHOWN = 8
"""Joints and blocks told in a line of text."""


def check_lines(answer: Check[Any], carried: Carried | None = None) -> list[str]:
    """Return a check in words."""
    problem, carried, of = answer.problem, carried or answer.carried, answer.arch
    lines = [
        f"{answer.verdict.value.upper()}  ({answer.method}, {lasting(answer.wall_s)})",
        f"  what    {described(problem)}"
        if of is None
        else _arch_line(of, problem, tried=True),
        *size_lines(problem),
        *because_lines(answer.evidence),
        *(length_lines(problem) if of is None and answer.simulated is not None else ()),
    ]
    if answer.load_factor is not None:
        at = f", asked at {problem.load:g}" if problem.load else ""
        lines.append(f"  load    factor at collapse {_number(answer.load_factor)}{at}")
        if not answer.load_factor:
            lines[-1] += ": it bears none of the live loads"
        elif answer.load_factor < 0:
            does = "falls" if problem.strength is None else "crushes"
            lines[-1] += f": it {does} under its dead load, without live loads"
    elif problem.live and problem.strength is not None:
        lines.append("  load    no factor at collapse: at none joints bear what they carry")
    if of is not None:
        lines.append(_exact("least  ", of))
    lines += carried_lines(carried, joint_names(problem.assembly))
    lines += unit_lines(problem) if carried else []
    slow = len(problem.assembly.joints) > SOUGHT and not problem.in_space
    if of is None and carried is None and slow:
        lines.append(f"  safety  not asked: it takes long with more than {SOUGHT} joints")
    if answer.method == "limit":
        lines.append(f"  proof   {proof_words(answer)}")
    if rest := rest_words(answer.rest, answer.motion, asked=answer.asked_rest):
        lines.append(f"  rest    {rest}")
    if of is not None:
        lines += _modes(of, _whose(answer, of))
    if told := _active(answer):
        lines.append(f"  joints  {told}")
    if of is None and answer.mechanism is not None:
        movers = few(_movers(answer.mechanism, problem.assembly), SHOWN)
        lines.append(f"  moves   {movers} (the fastest first)")
    return [*lines, *aside_lines(answer.evidence)]


def proof_words(answer: Check[Any]) -> str:
    """Say whether a verdict by limit analysis is proved, and by what."""
    proof = answer.proof
    if answer.needed is not None:
        return UNPROVED
    if proof is None:
        return NONE_IN_SPACE if answer.problem.in_space else "none was found"
    if proof.claim == "collapses":
        return "a motion that no joint forbids gains work, in rational arithmetic"
    if proof.tolerance:
        return "forces within friction balance to 1e-12 of each weight, in rational arithmetic"
    return "forces within friction balance exactly, in rational arithmetic"


def bracket_lines(answer: Bracket[Any]) -> list[str]:
    """Return a bracket in words."""
    of = answer.arch
    head = values_tried(answer) if of is None else _head_of_arch(of)
    lines = [f"{head}  ({answer.method}, {lasting(answer.wall_s)})"]
    if of is not None:
        lines.append(_arch_line(of, answer.problem, tried=False))
    lines += because_lines(answer.evidence)
    if of is not None:
        lines += _arch_lines(answer, of)
    elif answer.limit is not None and None not in {answer.low, answer.high}:
        unit = f" {answer.unit}" if answer.unit else ""
        lines.append(f"  exact   {answer.limit:.9g}{unit} by limit analysis")
    if (many := interval_words(answer)) is not None:
        lines.append(f"  stands  {many}")
    if answer.method == "limit" and of is None:
        lines.append(f"  proof   {ends_proved_words(answer)}")
    if answer.undecided:
        what = "values" if of is None else "ratios"
        lines.append(f"  unsure  {answer.undecided} of {answer.runs} {what} undecided")
    lines += [] if of is None else _thickness_lines(answer, of)
    return [*lines, *aside_lines(answer.evidence)]


def because_lines(evidence: Sequence[Evidence]) -> list[str]:
    """Return why an answer is what it is, a line a thought."""
    seen = [each for each in evidence if each.test not in ASIDE]
    named = {each.test for each in seen} >= SEEN
    said = [
        f"{each.test}: {each.found}" if named and each.test in SEEN else each.found
        for each in seen
    ]
    return [f"  {'and' if k else 'because':<7} {each}" for k, each in enumerate(said)]


def aside_lines(evidence: Sequence[Evidence]) -> list[str]:
    """Return how it was asked, and how the file was read, a line a thought."""
    return [f"  {ASIDE[each.test]:<7} {each.found}" for each in evidence if each.test in ASIDE]


def ends_proved_words(answer: Bracket[Any]) -> str:
    """Say whether it is proved that it falls to one side of each change, and stands beyond."""
    if answer.problem.strength is not None:
        return UNPROVED
    if not answer.changes:
        return "none: there is no change to prove"
    if not answer.proved:
        return "no proof was found for both sides of each change"
    return (
        "in rational arithmetic: it falls on one side of each change, and stands on the other"
    )


def values_tried(answer: Bracket[Any]) -> str:
    """Say the two values tried, or what holds at all values where there is no change."""
    if answer.low is None and answer.high is None:
        words = {0: "falls at all values", 1: "stands at all values"}
        known = -1 if answer.intervals is None else len(answer.intervals)
        return f"{answer.over.upper()}: {words.get(known, 'no value tried was decided')}"
    unit = f" {answer.unit}" if answer.unit else ""
    ends = (("low", answer.low), ("high", answer.high))
    if answer.low is not None and answer.low == answer.high:
        # Both are the end of what may be asked: whatever is more stands, or falls.
        sides = "any above it stands" if answer.stands == "high" else "any below it stands"
        return f"{answer.over.upper()}: {answer.low:.9g}{unit} is the limit, {sides}"
    parts = [
        f"{'stands' if answer.stands == end else 'falls'} at {value:.9g}{unit}"
        for end, value in ends
        if value is not None
    ]
    return f"{answer.over.upper()}: {', '.join(parts)}"


def _head_of_arch(of: ArchBracket) -> str:
    """Say the least thickness of an arch, over its radius."""
    if of.eta_high is None:
        return "NOTHING STANDS up to eta = 2"
    if of.eta_high == 0:
        return "ANY THICKNESS STANDS"
    if of.eta_low == of.eta_high:
        return f"LEAST ETA {of.eta_high:.12g}"
    digits = _digits(of)
    return f"LEAST ETA between {of.eta_low or 0.0:.{digits}g} and {of.eta_high:.{digits}g}"


def _arch_line(of: ArchAnswer, problem: Problem, *, tried: bool) -> str:
    """Say which arch it is, its thickness where one was asked about."""
    arch, line = of.shape, measured_line(problem)
    # Where a line stays, depth is told over its radius.
    radius = arch.radius if line is None or tried else line.radius
    eta = f"eta {arch.eta:g}, " if tried else ""
    return (
        f"  arch    alpha {math.degrees(arch.half_angle):g} deg, {eta}mu {problem.mu:g}, "
        f"{arch.voussoirs} voussoirs, weight {arch.weight}, "
        f"depth {arch.depth / radius:g} r"
    )


def _arch_lines(answer: Bracket[Any], of: ArchBracket) -> list[str]:
    """Tell the exact thickness, modes, thrust and joints at the least thickness."""
    digits = _digits(of)
    whose = "continuous arch" if answer.method == "theory" else "voussoirs as built"
    lines = [_exact("exact  ", of, digits)]
    lines += _modes(of, f"of the {whose}, at eta {ratio(of.eta_low, digits)}")
    if of.thrust is not None:
        lines.append(f"  thrust  h = {of.thrust:.9g}, in units of gamma t d r")
    if of.beta_r is not None:
        lines.append(f"  hinge   {math.degrees(of.beta_r):.4f} deg from the crown")
    if of.beta_s is not None:
        lines.append(f"  slides  {math.degrees(of.beta_s):.4f} deg from the crown")
    return lines


def _thickness_lines(answer: Bracket[Any], of: ArchBracket) -> list[str]:
    """Tell a least thickness in metres where a length was given."""
    line, low, high = measured_line(answer.problem), answer.low, answer.high
    at = None if line is None else line.at
    if not is_metric(of.shape, at) or high is None or math.isinf(high):
        return []
    least = f"{high:.6g} m" if low == high else f"{low or 0:.6g} to {high:.6g} m"
    said = [f"least thickness {least}, the {at or 'centreline'} staying where it is"]
    if line is not None:
        said.append(f"span {line.span:.6g} m, rise {line.rise:.6g} m ({at})")
    said.append(f"friction angle {friction_angle(answer.problem.mu):.6g} deg")
    return [f"  size    {', '.join(said)}"]


def interval_words(answer: Bracket[Any]) -> str | None:
    """Say between which values it stands, or return None where there is but one end."""
    found = answer.intervals or ()
    if sum(end is not None for each in found for end in (each.low, each.high)) < 2:
        return None
    said: list[str] = []
    for each in found:
        low = f"from {_end_words(each.low, answer)}" if each.low else ""
        high = f"up to {_end_words(each.high, answer)}" if each.high else "on"
        said.append(f"{low} {high}".strip())
    return ", and ".join(said)


def _end_words(end: End, answer: Bracket[Any]) -> str:
    """Tell an end: the value of limit analysis, and those that an engine tried."""
    said = [] if end.confirmed else ["not confirmed"]
    if answer.method != "limit":
        tried = (("stands", end.stands), ("falls", end.falls))
        said = [f"{word} at {value:.9g}" for word, value in tried if value is not None] + said
    unit = f" {answer.unit}" if answer.unit else ""
    return f"{end.limit:.9g}{unit}" + (f" ({', '.join(said)})" if said else "")


def _exact(label: str, of: ArchAnswer, digits: int = SIX) -> str:
    """Tell the least thickness as built and of the continuous arch, each with its mode."""

    def least(eta: float | None, mode: Mode | None) -> str:
        if eta == 0:
            return "any"
        told = "none up to 2" if eta is None else ratio(eta, digits)
        return f"{told} ({mode or 'mode unnamed'})"

    return (
        f"  {label} eta {least(of.eta_limit, of.mode_limit)} as built, "
        f"{least(of.eta_theory, of.mode_theory)} continuous"
    )


def _digits(of: ArchBracket) -> int:
    """Return digits that tell the ends of a bracket apart and one more, six at least."""
    low, high = of.eta_low or 0.0, of.eta_high or 0.0
    return SIX if low >= high else max(SIX, 2 - math.floor(math.log10(1 - low / high)))


def _whose(answer: Check[Any], of: ArchAnswer) -> str:
    """Say of which arch a mode is."""
    if answer.method != "theory":
        return f"of the voussoirs as built, at eta {of.shape.eta:g}"
    if of.eta_theory is None:
        return "of the continuous arch, of any thickness"
    return "of the continuous arch at its least thickness"


def _modes(of: ArchAnswer, whose: str) -> list[str]:
    """Tell the mode an arch starts with and, if it is another, that in motion."""
    lines: list[str] = []
    if of.mode:
        lines.append(f"  mode    {of.mode.value}, {of.mode.description}, {whose}")
    if of.mode_in_motion and of.mode_in_motion is not of.mode:
        from blocksim.simulation.motion import EARLY

        later = of.mode_in_motion
        lines.append(
            f"  moving  {later.value}, {later.description}, once it has moved {EARLY:g} r"
        )
    return lines


def _active(answer: Check[Any]) -> str:
    """Tell the joints that take part: of an arch by their angles, else by their names."""
    words = state_words(answer.problem)
    active = [
        (k, each) for k, each in enumerate(answer.joints) if each.state is not JointState.CLOSED
    ]
    if not active:
        return ""
    if answer.arch is not None:
        return ", ".join(
            f"{signed(math.degrees(each.angle), 1)} deg {words(each.state)}"
            for _, each in active
        )
    names = joint_names(answer.problem.assembly)
    return few([f"{names[k]} {words(each.state)}" for k, each in active], SHOWN)


def _movers(rates: Array, assembly: Assembly | SpatialAssembly) -> list[str]:
    """Blocks that move by more than a hundredth of the fastest, the fastest first."""
    reach = assembly.reach / assembly.size
    axes, last = (3, 6) if isinstance(assembly, SpatialAssembly) else (2, 3)
    turns = abs(rates[:, axes:last]).max(axis=1)
    speed = abs(rates[:, :axes]).max(axis=1) + turns * reach
    order = [int(k) for k in (-speed).argsort() if speed[k] > speed.max() / 100]
    return [assembly.blocks[k].name or str(k) for k in order]


def _number(value: float) -> str:
    return "none: it stands at any" if math.isinf(value) else f"{value:.9g}"


def signed(value: float, digits: int) -> str:
    """Return a number with its sign. A rounded 0 has none."""
    said = f"{value:+.{digits}f}"
    return said if float(said) else said[1:]


def ratio(eta: float | None, digits: int = SIX) -> str:
    """Return a ratio in so many digits, "any" where every one stands, or a dash."""
    if eta == 0:
        return "any"
    return "-" if eta is None else f"{eta:.{digits}g}"
