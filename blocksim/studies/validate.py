"""What comes with blocksim and has a known answer, held against it: arches and structures.

Arches whose modes are known are asked by simulation, against limit analysis and theory; all
else by limit analysis and by engines, against its source.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from blocksim.ask.methods import asked_as, choose
from blocksim.blocks.entries import ExpectEntry
from blocksim.common.errors import InputError
from blocksim.common.processes import done
from blocksim.common.progress import Progress, silent
from blocksim.engines import ENGINES, NAMES, engine_named, get_engine
from blocksim.kinds.files import shipped_structures
from blocksim.kinds.loading import Known, load_known
from blocksim.studies.agreement import Row, Unasked
from blocksim.studies.questions import answer

LIMIT = "limit"


class Question(NamedTuple):
    """One question about a structure, put to one method."""

    case: Known
    expected: ExpectEntry
    method: str

    def answer(self) -> Row:
        """Ask it, and compare."""
        return answer(self.case, self.expected, self.method)

    @property
    def refused(self) -> str:
        """The reason why the method is not asked, empty where it is."""
        problem, engine = self.case.problem, None
        if self.method != LIMIT:
            engine = engine_named(self.method)
            if engine.missing:
                return f"not here: {engine.missing}"
        if self.expected.modes is not None or (engine is None and problem.shaking is None):
            return ""
        if engine and self.expected.over == "spread" and not engine.moves_supports:
            return "it moves no supports"
        if engine and len(problem.assembly.blocks) > engine.most_blocks:
            return f"more than {engine.most_blocks} blocks"
        try:
            choose(self.method, problem=asked_as(problem))
        except InputError as error:
            return error.allowed
        return ""


def structures(*, quick: bool) -> list[Known]:
    """Return the shipped structures, or those marked quick."""
    every = [load_known(name) for name in shipped_structures()]
    return [known for known in every if known.quick or not quick]


def usual(expected: ExpectEntry) -> tuple[str, ...]:
    """Return the methods that are asked about a structure where none is named."""
    part = "structures" if expected.modes is None else "arches"
    return tuple(name for name in NAMES if part in ENGINES[name].validates)


def _questions(case: Known, engines: Iterable[str] | None) -> Iterator[Question]:
    """Go through all that is asked of a structure, whether a method is asked it or not."""
    for expected in case.expect:
        names = usual(expected) if engines is None else tuple(dict.fromkeys(engines))
        if expected.modes is None:
            names = (LIMIT, *names)
        yield from (Question(case, expected, name) for name in names)


def unasked(chosen: Sequence[Known], engines: Iterable[str] | None = None) -> list[Unasked]:
    """Tell what `validate` does not ask with the same arguments, and why."""
    found: dict[str, dict[str, dict[str, None]]] = {}
    names = None if engines is None else tuple(engines)
    for case in chosen:
        for each in _questions(case, names):
            reasons = found.setdefault(each.method, {})
            if why := each.refused:
                reasons.setdefault(why, {})[case.name] = None
    return [
        Unasked(engine=method, scenarios=tuple(cases), why=why)
        for method, reasons in found.items()
        if method != LIMIT
        for why, cases in reasons.items()
    ]


def validate(
    chosen: Sequence[Known],
    engines: Iterable[str] | None = None,
    *,
    workers: int = 2,
    progress: Progress = silent,
) -> list[Row]:
    """Put every question to every engine that can answer it, and compare.

    `engines`: By default those usual for arches or structures, as far as they are installed.
        `unasked` tells what is left out.
    `workers`: Processes; 1 runs in this one.
    Returns: In the order of cases, what is known of each, then methods, whatever finishes
        first.
    Raises `InputError`: If there is no such engine.
    Raises `MissingPart`: If the library of one that is named is not installed.
    """
    names = None if engines is None else tuple(engines)
    for name in names or ():
        engine_named(name, "methods")
        get_engine(name)
    asked = [each for case in chosen for each in _questions(case, names)]
    jobs = [each for each in asked if not each.refused]
    found: dict[int, Row] = {}
    for at, row in done(Question.answer, jobs, workers):
        found[at] = row
        progress(len(found) / len(jobs), row.structure)
    return [found[at] for at in range(len(jobs))]
