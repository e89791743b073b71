"""What comes with blocksim and has a known answer, held against it: arches and structures.

Arches whose modes are known are asked by simulation, against limit analysis and theory; all
else by limit analysis and by engines, against its source.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from blocksim.arch import limit
from blocksim.arch.answers import ArchBracket
from blocksim.arch.circular import ETA_MAX, Arch
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode, observed_mode
from blocksim.ask.bracket import bracket
from blocksim.ask.methods import asked_as, choose
from blocksim.blocks.entries import ExpectEntry
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.engines import ENGINES, NAMES, engine_named, get_engine
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import shipped_structures
from blocksim.kinds.loading import Known, load_known
from blocksim.simulation.observation import observe
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Unasked, Validation, agree, answered
from blocksim.studies.questions import StructureRow, answer

Row = Validation | StructureRow
ERROR_BOUND = 0.002
"""A bracket whose centre is farther than this from `limit` is a miss."""
ASIDE = 0.01
"""How far below and above the bracket arches are let go."""
LIMIT = "limit"


class Question(NamedTuple):
    """One question about a structure, put to one method."""

    case: Known
    expected: ExpectEntry
    method: str

    def answer(self) -> Row:
        """Ask it, and compare."""
        if self.expected.modes is not None:
            return validate_one(self.case, self.expected, self.method)
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
    jobs = [(each.case.name, each) for each in asked if not each.refused]
    return answered(Question.answer, jobs, workers, progress)


def parted(found: Iterable[Row]) -> tuple[list[Validation], list[StructureRow]]:
    """Return rows on arches of which modes are known, and all others."""
    rows = [*found]
    return (
        [row for row in rows if isinstance(row, Validation)],
        [row for row in rows if isinstance(row, StructureRow)],
    )


def validate_one(
    known: Known, expected: ExpectEntry, engine: str, tol: float | None = None
) -> Validation:
    """Ask one engine how thin an arch can be and how it falls, and compare.

    `tol`: Relative width of the bracket; by default what the engine says (`validated_to`).
    """
    started = time.perf_counter()
    maker = known.problem.maker
    assert isinstance(maker, CircularArch)  # noqa: S101 - of which modes are known
    thick = maker.but(eta=1.0)
    asked = bracket(
        thick,
        over="thickness",
        method=engine,
        tol=tol or engine_named(engine).validated_to,
        confirm=False,
        reduce=False,
    )
    found = asked.arch
    assert found is not None  # noqa: S101
    in_motion = below = above = recording = None
    if found.eta_low is not None:
        thin = maker.but(eta=found.centre * (1 - ASIDE) if found.centre else found.eta_low)
        seen = observe(thin.problem(), engine)
        in_motion, below = observed_mode(seen.joints_in_motion, _shape(thin)), seen.verdict
        recording = seen.motion.recording if seen.motion else None
    # Thicker than eta = 2 there is no arch to try.
    if found.centre is not None and found.centre * (1 + ASIDE) <= ETA_MAX:
        above = observe(maker.but(eta=found.centre * (1 + ASIDE)).problem(), engine).verdict
    error = None
    # Where the limit is the thickest arch there is, nothing above it can be tried.
    middle = found.centre or (None if asked.undecided else found.eta_low)
    if middle is not None and found.eta_limit:
        error = middle / found.eta_limit - 1
    shape, problem = _shape(thick), known.problem
    return Validation(
        scenario=known.name,
        engine=engine,
        half_angle=shape.half_angle,
        mu=problem.mu,
        voussoirs=shape.voussoirs,
        weight=shape.weight,
        modes_published=tuple(map(Mode, expected.modes or ())),
        eta_published=expected.eta,
        title=problem.title,
        source=problem.source,
        eta_limit=found.eta_limit,
        mode_limit=found.mode_limit,
        eta_low=found.eta_low,
        eta_high=found.eta_high,
        error=error,
        mode_observed=found.mode,
        mode_in_motion=in_motion,
        below=below,
        above=above,
        miss="; ".join(_misses(found, error, below, above)),
        note=_note(maker, found, engine, in_motion),
        wall_s=time.perf_counter() - started,
        modes_theory=found.modes_theory,
        recording=recording,
    )


def _shape(maker: CircularArch) -> Arch:
    assert maker.shape is not None  # noqa: S101 - of a symmetric arch modes are known
    return maker.shape


def _misses(
    found: ArchBracket,
    error: float | None,
    below: Verdict | None,
    above: Verdict | None,
) -> list[str]:
    """List what disagrees with limit analysis."""
    misses: list[str] = []
    if found.eta_limit is None:
        if found.eta_high is not None:
            misses.append("stands, where nothing does")
    elif error is None:
        fell = (
            "" if found.eta_low is None else f": the thickest that fell is {found.eta_low:.6g}"
        )
        misses.append(f"no bracket{fell}")
    elif abs(error) > ERROR_BOUND:
        misses.append(f"error {error:+.2%}")
    if not agree(found.mode, found.mode_limit, found.modes_theory):
        misses.append(
            f"mode {found.mode or 'unnamed'}, limit says {found.mode_limit or 'unnamed'}"
        )
    if below is not Verdict.COLLAPSES:
        misses.append(f"{below or 'nothing tried'} 1 % below")
    if above not in {Verdict.STANDS, None}:
        misses.append(f"{above} 1 % above")
    return misses


def _note(maker: CircularArch, found: ArchBracket, engine: str, in_motion: Mode | None) -> str:
    """Say why modes differ, where that is known, and what else to keep in mind."""
    notes: list[str] = []
    if found.mode is not found.mode_limit:
        if agree(found.mode, found.mode_limit, found.modes_theory):
            notes.append("on a line of the map, where both modes coincide")
        elif found.eta_low is not None:
            there = mechanism(_shape(maker.but(eta=found.eta_low)), maker.known_friction).mode
            said = there or "unnamed"
            notes.append(f"at the bracket's lower end limit analysis says {said}")
    if in_motion and in_motion is not found.mode:
        notes.append(f"in motion, 1 % below, the mode is {in_motion}")
    most = get_engine(engine).most_friction
    if maker.known_friction > most:
        arch = _shape(maker)
        there = limit.least_thickness(arch.half_angle, most, arch.voussoirs, arch.weight)
        least = "nothing stands" if there.eta is None else f"{there.eta:.6g}, {there.mode}"
        notes.append(f"friction is {most:g} in the engine, where limit analysis says {least}")
    return "; ".join(notes)
