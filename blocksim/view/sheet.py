"""A structure as an engineer draws it: what is on the sheet, at which scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from blocksim.ask.check import Check
from blocksim.ask.rest import rest_words
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Problem
from blocksim.common.words import counted, printable
from blocksim.limit import Reaction, reactions
from blocksim.limit.carried import Carried
from blocksim.view.dimensions import ForceUnit, common_depth, force_unit, unit_weight
from blocksim.view.drawing import friction_words, loading_words
from blocksim.view.structure import supports_shown
from blocksim.view.thrustlines import is_chained, near_blocks, thrust_lines, thrust_of

STEPS = (1.0, 2.0, 2.5, 5.0)
"""Scales that are drawn to, times powers of ten."""
LARGEST = 1e3
"""Geometrical factor of safety from which on joints need no width to speak of."""
MANY = 6
"""Supports from which on their reactions are not drawn: nobody could read them."""


class Paper(NamedTuple):
    """A size of paper [mm]."""

    name: str
    width: float
    height: float


A4 = (Paper("A4", 297.0, 210.0), Paper("A4", 210.0, 297.0))
"""Across and upright."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ThrustLine:
    """A line of thrust (min, max or safest), or several where they meet, (k, 2) each [m]."""

    name: str
    words: str
    paths: tuple[Array, ...]


@dataclass(frozen=True, kw_only=True)
class Titles:
    """The words of a title block. Empty ones are not drawn."""

    project: str = ""
    part: str = ""
    engineer: str = ""
    date: str = ""

    @property
    def said(self) -> tuple[tuple[str, str], ...]:
        """Each line of it, and what it is called."""
        found = vars(self).items()
        return tuple((name, printable(value)) for name, value in found if value)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sheet:
    """A problem as every writer of drawings draws it.

    `facts`: Lines below the title.
    `forces`, (joints, 2, 2): Of the state of greatest margin; drawn at each joint where there
        are no lines.
    `thrust`, (int, str): The joint at which thrust is told, and its range in words.
    `reactions`: In the state of greatest margin.
    `mechanism`, (blocks, 3).
    `supports`, tuple of tuple of (k, 2): Convex parts of each support near the blocks [m].
    `pressed`: Whether pressures along joints are drawn, in place of dimensions.
    """

    problem: Problem
    title: str
    facts: tuple[str, ...]
    unit: ForceUnit
    lines: tuple[ThrustLine, ...] = ()
    forces: Array | None = None
    thrust: tuple[int, str] | None = None
    reactions: tuple[Reaction, ...] = ()
    mechanism: Array | None = None
    joint_states: tuple[JointState, ...] | None = None
    supports: tuple[tuple[Array, ...], ...] = field(default_factory=tuple)
    carried: Carried | None = None
    titles: Titles = field(default_factory=Titles)
    pressed: bool = False

    @property
    def pressures(self) -> Sheet:
        """The sheet of pressures along joints alone."""
        lines = tuple(line for line in self.lines if line.name == "safest")
        return replace(self, lines=lines, forces=None, thrust=None, reactions=(), pressed=True)


def sheet_of(
    problem: Problem,
    *,
    verdict: str = "",
    mechanism: Array | None = None,
    joint_states: Sequence[JointState] | None = None,
    forces: Array | None = None,
    carried: Carried | None = None,
    facts: Sequence[str] | None = None,
) -> Sheet:
    """Collect what is drawn of a problem, and of an answer to a question about it.

    `verdict`: The answer of a check, in words.
    `mechanism`, (blocks, 3): Rates x, y (in units of the size) and rotation; drawn enlarged.
    `forces`, (joints, 2, 2): Contact forces to draw where nothing is known of what it carries.
    `carried`: What it carries, as of `carried_of`: lines of thrust, reactions.
    `facts`: What is said below the title, instead of what it is built of.
    """
    unit = force_unit(problem)
    found: dict[str, Any] = {"forces": forces}
    if carried is not None:
        found |= _statics(problem, carried, unit)
    said = [verdict, *factor_words(carried)]
    about = [built_words(problem), [unit.note]] if facts is None else [list(facts)]
    return Sheet(
        problem=problem,
        title=title_of(problem),
        facts=tuple(
            printable(", ".join(word for word in words if word))
            for words in (said, *about)
            if any(words)
        ),
        unit=unit,
        mechanism=mechanism,
        joint_states=None if joint_states is None else tuple(joint_states),
        supports=() if problem.in_space else tuple(map(tuple, supports_shown(problem))),
        carried=carried,
        **found,
    )


def answer_sheet(answer: Check[Any], titles: Titles | None = None) -> Sheet:
    """Collect what is drawn of an answer, with what its title block says."""
    mode = answer.arch and answer.arch.mode
    named = f", mode {mode}" if mode else ""
    said = rest_words(answer.rest, answer.motion, asked=True) if answer.asked_rest else None
    besides = f"; {said}" if said else ""
    made = sheet_of(
        answer.problem,
        verdict=f"{answer.verdict.value}{named}, by {answer.method}{besides}",
        mechanism=answer.mechanism,
        joint_states=[joint.state for joint in answer.joints],
        forces=answer.forces,
        carried=answer.carried,
    )
    return made if titles is None else replace(made, titles=titles)


def _statics(problem: Problem, carried: Carried, unit: ForceUnit) -> dict[str, Any]:
    """Lines, thrust and reactions, as far as there are such."""
    forces, joint = carried.forces, carried.joint
    if forces is None:
        return {}
    chained = is_chained(problem)
    drawn: list[ThrustLine] = []
    told = None
    if carried.stands:
        if chained and joint is not None and carried.least and carried.greatest:
            low, high = (
                each.thrust * problem.unit_force for each in (carried.least, carried.greatest)
            )
            told = joint, _range_words(low, high, unit)
            for name, words, found in (
                ("min", "least thrust", carried.least),
                ("max", "greatest thrust", carried.greatest),
            ):
                # Where the thrust has no range, they are the line of greatest margin.
                if found.forces is not None and not _is_one(low, high, unit):
                    drawn.append(_line(problem, name, words, found.forces, joint, unit))
        if chained:
            words = "greatest margin"
            drawn.append(_line(problem, "safest", words, forces, joint, unit))
        borne = reactions(problem, forces)
        return {
            "lines": tuple(each for each in drawn if each.paths),
            "forces": None if any(each.paths for each in drawn) else forces,
            "thrust": told,
            "reactions": borne if len(borne) < MANY else (),
        }
    line = _line(problem, "safest", "that lacks least strength", forces, None, unit)
    shown = bool(line.paths) and near_blocks(problem, line.paths)
    return {"forces": None, "lines": (line,) if shown else ()}


def _line(
    problem: Problem,
    name: str,
    words: str,
    forces: Array,
    joint: int | None,
    unit: ForceUnit,
) -> ThrustLine:
    said = f"line of thrust {words}" if words.startswith("that") else f"line of thrust: {words}"
    if joint is not None:
        said += f", {unit.words(thrust_of(problem, forces, joint))}"
    return ThrustLine(name=name, words=said, paths=tuple(thrust_lines(problem, forces)))


def _is_one(least: float, greatest: float, unit: ForceUnit) -> bool:
    """Tell whether both are the same in the words of a drawing."""
    return math.isfinite(greatest) and unit.number(least) == unit.number(greatest)


def _range_words(least: float, greatest: float, unit: ForceUnit) -> str:
    if math.isinf(greatest):
        return f"thrust {unit.words(least)} or more"
    if _is_one(least, greatest, unit):
        return f"thrust {unit.words(least)}"
    return f"thrust {unit.number(least)} to {unit.words(greatest)}"


def title_of(problem: Problem[Any]) -> str:
    """Return the title of a problem, or say what it is."""
    if problem.title and problem.title != (problem.maker and problem.maker.name):
        return printable(problem.title)
    if problem.title:
        return problem.title.replace("-", " ").capitalize()
    if problem.maker is not None:
        return problem.maker.name.replace("-", " ").capitalize()
    return "Structure of blocks"


def built_words(problem: Problem[Any]) -> list[str]:
    """Say of what it is built, and what acts on it."""
    noun = "voussoir" if problem.is_arch else "block"
    words = [*problem.measures, counted(len(problem.assembly.blocks), noun)]
    words.append(friction_words(problem.mu))
    if 0 < problem.mu < math.inf:
        words[-1] += f" ({math.degrees(math.atan(problem.mu)):.4g}°)"
    heavy = unit_weight(problem)
    if heavy is not None:
        words.append(f"unit weight {heavy / 1e3:.4g} kN/m\N{SUPERSCRIPT THREE}")
    depth = common_depth(problem)
    if depth is not None:
        words.append(f"depth {depth:.4g} m")
    return words + loading_words(problem)


def factor_words(carried: Carried | None) -> list[str]:
    """Say the geometrical factor of safety, where it is known."""
    factor = None if carried is None else carried.geometrical_factor
    # Of a wall or a flat arch it says nothing.
    if factor is None or factor > LARGEST:
        return []
    return [f"geometrical factor of safety {factor:.4g}"]


def scale_for(span: Array, room: Array) -> float:
    """Return the largest of the usual scales at which a span [m] has room on paper [mm]."""
    least = float((1e3 * span / room).max()) * (1 - 1e-9)
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in (*STEPS, 10.0) if step * power >= least)


def scale_words(scale: float) -> str:
    """Return a scale as it is written: 1:50, or 2:1 of what is drawn larger than it is."""
    return f"1:{scale:g}" if scale >= 1 else f"{1 / scale:.3g}:1"
