"""Cases with known answers: what limit analysis and the engines say of each.

Question: are structures of all kinds answered right, with walls, arches, stacks, corners on
faces, smooth joints, and loads at points? The cases are those of `tests/structures/cases`, each
with a value from outside this code: largest load factor, tilt of the table, least friction, or
whether it stands. `limit` is to meet each value to 1e-6. `direct`, held at rest, is to stand
0.1 % inside it and to collapse 0.1 % outside it; with `--moving` it is let go, too. So is any
other engine (`--engine`), 1 % to either side (`--aside`); what it refuses is a row, too. Cases
of more blocks than `MOST` are asked of `limit` only.

    python -m analysis.structure_cases OUT [--engine NAME] [--aside SHARE] [--quick] [--moving]
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any, cast

from scipy.optimize import bisect

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import InputError, Load, Problem, Verdict, collapse, equilibrium
from blocksim.ask.methods import choose
from blocksim.blocks.structure import structure_of
from blocksim.simulation.observation import observe
from tests.structure_cases import case, names, scenes

MOST, OTHERS = 120, 70
"""Blocks of the largest case that `direct` is asked of, and other engines."""
ASIDE, COARSE = 1e-3, 1e-2
"""How far from the value they are asked: relative, or absolute where the value is 0."""
REFUSED = "refused"
"""What stands for the answer to what an engine does not take."""
FINEST = 1e-9
"""To which least friction is found."""
OTHERWISE = {"compas_cra_bridge"}
"""Whose least friction was found of joints read in another way: 0.0696 against 0.755."""
QUICK = (
    "block_slides",
    "box2d_arch",
    "compas_cra_shelf_stable",
    "diamond_5",
    "gable_least_friction",
    "grid_wall_3_smooth_heads",
    "oppenheim_7",
    "plank_on_wall",
    "trilithon",
)


@dataclass(frozen=True, kw_only=True)
class Line:
    """One question.

    Parameters
    ----------
    case : str
    question : str
    expected, limit : float
        The value, and that of limit analysis; 1 and 0 for whether it stands.
    error : float
        Of limit analysis, relative; absolute where the value is 0.
    inside, outside : str
        What the engine says to either side; of `stands` one of them. Empty where it was
        not asked.
    seconds : float
        Processor time of the engine.
    """

    case: str
    question: str
    expected: float
    limit: float
    error: float
    inside: str
    outside: str
    seconds: float

    @property
    def false(self) -> int:
        """Answers of the engine that are wrong."""
        return (self.inside == Verdict.COLLAPSES) + (self.outside == Verdict.STANDS)

    @property
    def undecided(self) -> int:
        """Answers of the engine that are none."""
        return [self.inside, self.outside].count(Verdict.UNDECIDED)


@dataclass(frozen=True)
class Result:
    """All questions to an engine, and headline numbers."""

    lines: tuple[Line, ...]
    engine: str

    @property
    def worst_error(self) -> float:
        """Of limit analysis."""
        return max(line.error for line in self.lines)

    @property
    def asked(self) -> int:
        """Answers of the engine."""
        return sum(bool(line.inside) + bool(line.outside) for line in self.lines)

    @property
    def false(self) -> int:
        """Of them, how many are wrong."""
        return sum(line.false for line in self.lines)

    @property
    def undecided(self) -> int:
        """Of them, how many are none."""
        return sum(line.undecided for line in self.lines)

    @property
    def refused(self) -> int:
        """Of them, how many are of what the engine does not take."""
        return sum([line.inside, line.outside].count(REFUSED) for line in self.lines)


@dataclass(frozen=True, kw_only=True)
class Question:
    """A family of problems over one parameter, which stand up to a value or from it on.

    Parameters
    ----------
    name : str
    expected : float
    exact : callable
        Returns the value by limit analysis.
    at : callable
        Takes a value and returns the problem.
    inside : float
        Sense in which it stands: -1 below the value, 1 above it.
    """

    name: str
    expected: float
    exact: Callable[[], float]
    at: Callable[[float], Problem]
    inside: float = -1.0


def questions(name: str) -> Iterator[Question]:
    """Return what is known of a case, as questions."""
    read = case(name)
    expected = read["expected"]
    for scene, label in zip(scenes(name), labels(name), strict=True):
        problem = structure_of(scene)
        if label is not None:
            yield standing(problem, expected=label)
            continue
        match read["question"]:
            case "load_factor":
                yield loaded(problem, expected["value"])
            case "tilt_deg":
                sense = read.get("direction", 1)
                yield tilted(problem, expected["value"], sense)
                if "other_direction" in expected:
                    yield tilted(problem, expected["other_direction"], -sense)
            case "least_mu":
                yield rubbing(problem, expected["value"])
            case _:
                return
    if read["question"] == "stands" and len(labels(name)) == 1:
        problem = structure_of(scenes(name)[0])
        for sense, value in zip((1, -1), expected.get("tilt_deg") or (), strict=False):
            yield tilted(problem, value, sense)
        if expected.get("least_mu") is not None and name not in OTHERWISE:
            yield rubbing(problem, expected["least_mu"])


def labels(name: str) -> list[bool | None]:
    """Whether each scene of a case is known to stand; None where that is not the question."""
    read = case(name)
    return [each.get("expected") for each in read.get("scenes") or [read["scene"]]]


def standing(problem: Problem, *, expected: bool) -> Question:
    """Ask whether it stands as it is."""
    return Question(
        name="stands",
        expected=float(expected),
        exact=lambda: float(equilibrium(problem).exists),
        at=lambda _: problem,
    )


def loaded(problem: Problem, value: float) -> Question:
    """Ask for the largest factor on the live loads."""

    def exact() -> float:
        found = collapse(problem).load_factor
        return math.nan if found is None else found

    return Question(name="load factor", expected=value, exact=exact, at=problem.with_load)


def tilted(problem: Problem, degrees: float, sense: int) -> Question:
    """Ask for the largest tilt: gravity turned is gravity and a horizontal body force."""

    def exact() -> float:
        blocks = tuple(range(len(problem.assembly.blocks)))
        across = Load(force=(sense, 0.0), blocks=blocks, per_weight=True)
        return math.degrees(math.atan(loaded(replace(problem, live=(across,)), 0.0).exact()))

    return Question(
        name=f"tilt to the {'right' if sense > 0 else 'left'} [deg]",
        expected=degrees,
        exact=exact,
        at=lambda tilt: problem.tilted(sense * math.radians(tilt)),
    )


def rubbing(problem: Problem, value: float) -> Question:
    """Ask for the least friction, of all joints but those that are smooth."""
    assembly = problem.assembly
    joints = tuple(
        joint if joint.friction == 0 else replace(joint, friction=None)
        for joint in assembly.joints
    )
    asked = replace(problem, assembly=replace(assembly, joints=joints))

    def stands(mu: float) -> float:
        return 1.0 if equilibrium(asked.with_friction(mu)).exists else -1.0

    def exact() -> float:
        # Zero is a problem of its own, and no root.
        none = equilibrium(replace(asked, mu=0.0)).exists
        return 0.0 if none else float(bisect(stands, FINEST, 10.0, xtol=FINEST))

    return Question(
        name="least friction",
        expected=value,
        exact=exact,
        at=lambda mu: replace(asked, mu=mu),
        inside=1.0,
    )


def answered(
    name: str,
    question: Question,
    *,
    moving: bool,
    engine: str = "direct",
    aside: float | None = None,
) -> Line:
    """Ask limit analysis and an engine; by default as near as is known of it."""
    value, exact = question.expected, question.exact()
    size = abs(value) or 1.0
    off = (ASIDE if engine == "direct" else COARSE) if aside is None else aside
    inside = value + off * size * question.inside
    outside = value - off * size * question.inside
    begin = time.process_time()

    def say(at: float) -> str:
        problem = question.at(at)
        if len(problem.assembly.blocks) > (MOST if engine == "direct" else OTHERS):
            return ""
        try:
            choose(engine, problem=problem, moving=moving)
        except InputError:
            return REFUSED
        return str(observe(problem, engine, moving=moving).verdict)

    if question.name == "stands":
        said = [say(0.0), ""] if value else ["", say(0.0)]
    elif question.name == "least friction" and value == 0:
        said = [say(0.0), ""]
    else:
        said = [say(inside), say(outside)]
    return Line(
        case=name,
        question=question.name,
        expected=value,
        limit=exact,
        error=abs(exact - value) / size,
        inside=said[0],
        outside=said[1],
        seconds=round(time.process_time() - begin, 3),
    )


def ask(of: tuple[str, int], *, moving: bool, engine: str, aside: float | None) -> Row:
    """Ask a question of a case by its number."""
    name, number = of
    question = list(questions(name))[number]
    return asdict(answered(name, question, moving=moving, engine=engine, aside=aside))


def main(
    out: Path,
    *,
    quick: bool = False,
    moving: bool = False,
    engine: str = "direct",
    aside: float | None = None,
    processes: int = 1,
) -> Result:
    """Ask every case, or in a quick run few; write the table."""
    # The smallest first: of a run that is stopped most cases are there.
    by_size = sorted(
        names(), key=lambda name: sum(len(each["blocks"]) for each in scenes(name))
    )
    asked = [
        (name, number)
        for name in (QUICK if quick else by_size)
        for number, _ in enumerate(questions(name))
    ]
    kept = "structure_cases" if engine == "direct" else f"structure_cases_{engine}"
    say = partial(ask, moving=moving, engine=engine, aside=aside)
    rows = answers(out / f"{kept}.jsonl", asked, say, processes)
    write_rows(out / f"{kept}.csv", rows)
    own = [{field.name: row[field.name] for field in fields(Line)} for row in rows]
    return Result(tuple(Line(**cast("dict[str, Any]", row)) for row in own), engine)


def table(result: Result) -> str:
    """Return the lines, and what they come to."""
    cases = len({line.case for line in result.lines})
    said = (
        f"{cases} cases, {len(result.lines)} questions: limit off by at most "
        f"{result.worst_error:.1e}; {result.engine} asked {result.asked} times, "
        f"{result.false} false, {result.undecided} undecided, {result.refused} refused"
    )
    return "\n".join([*map(str, result.lines), said])


if __name__ == "__main__":
    run(main, table)
