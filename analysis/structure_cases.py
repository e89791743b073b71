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
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import InputError, Problem, Verdict, equilibrium
from blocksim.ask.families import Family, family_of
from blocksim.ask.methods import choose
from blocksim.blocks.structure import structure_of
from blocksim.simulation.observation import observe
from tests.images import mirrored
from tests.structure_cases import case, names, scenes

MOST, OTHERS = 120, 70
"""Blocks of the largest case that `direct` is asked of, and other engines."""
ASIDE, COARSE = 1e-3, 1e-2
"""How far from the value they are asked: relative, or absolute where the value is 0."""
REFUSED = "refused"
"""What stands for the answer to what an engine does not take."""
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
class Question:
    """What is known of a problem: whether it stands, or up to which value, or from which on.

    Parameters
    ----------
    name : str
    expected : float
        The value; 1 or 0 for whether it stands.
    problem : Problem
    family : Family or None
        Over the parameter; None of whether it stands.
    """

    name: str
    expected: float
    problem: Problem
    family: Family | None = None

    @property
    def inside(self) -> float:
        """Sense in which it stands: -1 below the value, 1 above it."""
        return 1.0 if self.family is not None and self.family.stands == "high" else -1.0

    def at(self, value: float) -> Problem:
        """Return the problem at a value."""
        return self.problem if self.family is None else self.family.at(value)

    def sides(self, off: float) -> dict[str, Problem]:
        """Return what is asked `inside` and `outside` of what stands, by so much of the value.

        Of what has no value it is one of them. No friction is the least there is.
        """
        value = self.expected
        if self.family is None:
            return {"inside" if value else "outside": self.problem}
        by = off * (abs(value) or 1.0) * self.inside
        if self.family.name == "mu" and value == 0:
            return {"inside": self.at(value)}
        return {"inside": self.at(value + by), "outside": self.at(value - by)}

    def exact(self) -> float:
        """Return the value by limit analysis."""
        if self.family is None:
            return float(equilibrium(self.problem).exists)
        found = self.family.exact()
        return math.nan if found is None else found


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
    return Question(name="stands", expected=float(expected), problem=problem)


def loaded(problem: Problem, value: float) -> Question:
    """Ask for the largest factor on the live loads."""
    family = family_of(problem, "load")
    return Question(name="load factor", expected=value, problem=problem, family=family)


def tilted(problem: Problem, degrees: float, sense: int) -> Question:
    """Ask for the largest tilt: to the right, or of its mirror image, which is to the left."""
    asked, way = (problem, "right") if sense > 0 else (mirrored(problem), "left")
    name, family = f"tilt to the {way} [deg]", family_of(asked, "tilt")
    return Question(name=name, expected=degrees, problem=asked, family=family)


def rubbing(problem: Problem, value: float) -> Question:
    """Ask for the least friction, of all joints but those that are smooth."""
    assembly = problem.assembly
    joints = tuple(
        joint if joint.friction == 0 else replace(joint, friction=None)
        for joint in assembly.joints
    )
    asked = replace(problem, assembly=replace(assembly, joints=joints))
    family = family_of(asked, "mu")
    return Question(name="least friction", expected=value, problem=asked, family=family)


def answered(
    name: str,
    question: Question,
    *,
    moving: bool,
    engine: str = "direct",
    aside: float | None = None,
) -> Row:
    """Ask limit analysis and an engine; by default as near as is known of it.

    Returns: The case, its question, the value `expected` and that by `limit`, with its `error`,
        relative or absolute where the value is 0. What the engine says `inside` and `outside`
        of what stands, empty where it was not asked, and its processor time in `seconds`.
    """
    value, exact = question.expected, question.exact()
    off = (ASIDE if engine == "direct" else COARSE) if aside is None else aside
    begin = time.process_time()

    def say(problem: Problem) -> str:
        if len(problem.assembly.blocks) > (MOST if engine == "direct" else OTHERS):
            return ""
        try:
            choose(engine, problem=problem, moving=moving)
        except InputError:
            return REFUSED
        return str(observe(problem, engine, moving=moving).verdict)

    said = {side: say(problem) for side, problem in question.sides(off).items()}
    return {
        "case": name,
        "question": question.name,
        "expected": value,
        "limit": exact,
        "error": abs(exact - value) / (abs(value) or 1.0),
        "inside": said.get("inside", ""),
        "outside": said.get("outside", ""),
        "seconds": round(time.process_time() - begin, 3),
    }


def ask(of: tuple[str, int], *, moving: bool, engine: str, aside: float | None) -> Row:
    """Ask a question of a case by its number."""
    name, number = of
    question = list(questions(name))[number]
    return answered(name, question, moving=moving, engine=engine, aside=aside)


def main(
    out: Path,
    *,
    quick: bool = False,
    moving: bool = False,
    engine: str = "direct",
    aside: float | None = None,
    processes: int = 1,
) -> list[Row]:
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
    return rows


def counted(rows: Sequence[Row]) -> Counter[str]:
    """Count the answers of the engine: right, false, undecided, refused."""
    told = Counter[str]()
    for row in rows:
        for side, right in (("inside", Verdict.STANDS), ("outside", Verdict.COLLAPSES)):
            said = str(row[side] or "")
            known = "right" if said == right else "false"
            told[said if said in {"", Verdict.UNDECIDED, REFUSED} else known] += 1
    del told[""]
    return told


def table(rows: Sequence[Row]) -> str:
    """Return the rows, and what they come to."""
    told, cases = counted(rows), len({row["case"] for row in rows})
    worst = max(float(row["error"] or 0) for row in rows)
    said = (
        f"{cases} cases, {len(rows)} questions: limit off by at most {worst:.1e}; "
        f"{told.total()} answers of the engine, {told['false']} false, "
        f"{told['undecided']} undecided, {told[REFUSED]} refused"
    )
    return "\n".join([*map(str, rows), said])


if __name__ == "__main__":
    run(main, table)
