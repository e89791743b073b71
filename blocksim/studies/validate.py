"""What comes with blocksim and has a known answer, held against it: arches and structures.

Arches are asked by simulation, against limit analysis and theory; structures by limit analysis
and by engines, against their sources.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from blocksim.arch import limit
from blocksim.arch.answers import ArchBracket
from blocksim.arch.circular import ETA_MAX
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode, observed_mode
from blocksim.ask.bracket import bracket
from blocksim.ask.methods import choose
from blocksim.blocks.entries import ExpectEntry
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.engines import ENGINES, NAMES, engine_named, get_engine
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import shipped_structures
from blocksim.kinds.loading import Known, load_known
from blocksim.kinds.scenario import Scenario
from blocksim.kinds.scenarios import load_scenario, shipped
from blocksim.simulation.observation import observe
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Unasked, Validation, agree, answered
from blocksim.studies.questions import StructureRow, answer

Case = Scenario | Known
Row = Validation | StructureRow
ERROR_BOUND = 0.002
"""A bracket whose centre is farther than this from `limit` is a miss."""
ASIDE = 0.01
"""How far below and above the bracket arches are let go."""
LIMIT = "limit"


class Question(NamedTuple):
    """One question about a case, put to one method; of an arch it is what its scenario says."""

    case: Case
    expected: ExpectEntry | None
    method: str

    def answer(self) -> Row:
        """Ask it, and compare."""
        if isinstance(self.case, Known):
            assert self.expected is not None  # noqa: S101 - what a structure is asked
            return answer(self.case, self.expected, self.method)
        return validate_one(self.case, self.method)

    @property
    def refused(self) -> str:
        """Why the method is not asked; nothing where it is."""
        case, engine = self.case, None if self.method == LIMIT else engine_named(self.method)
        if engine and engine.missing:
            return f"not here: {engine.missing}"
        if isinstance(case, Scenario):
            if not case.lean or engine is None or engine.is_spatial:
                return ""
            able = " or ".join(each for each in NAMES if ENGINES[each].is_spatial)
            return f"gravity leans out of the plane: {able} sees that"
        if engine is None and case.problem.shaking is None:
            return ""
        spreads = self.expected is not None and self.expected.over == "spread"
        if engine and spreads and not engine.moves_supports:
            return "it moves no supports"
        if engine and len(case.problem.assembly.blocks) > engine.most_blocks:
            return f"more than {engine.most_blocks} blocks"
        try:
            choose(self.method, problem=case.problem)
        except InputError as error:
            return error.allowed
        return ""


def scenarios(*, quick: bool) -> list[Scenario]:
    """Return the shipped scenarios, or those marked quick."""
    every = [load_scenario(name) for name in shipped()]
    return [scenario for scenario in every if scenario.quick or not quick]


def structures(*, quick: bool) -> list[Known]:
    """Return the shipped structures, or those marked quick."""
    every = [load_known(name) for name in shipped_structures()]
    return [known for known in every if known.quick or not quick]


def usual(case: Case) -> tuple[str, ...]:
    """Return the engines that are asked about a case where none is named."""
    part = "structures" if isinstance(case, Known) else "arches"
    return tuple(name for name in NAMES if part in ENGINES[name].validates)


def _questions(case: Case, engines: Iterable[str] | None) -> Iterator[Question]:
    """Go through all that is asked of a case, whether a method is asked it or not."""
    names = usual(case) if engines is None else tuple(dict.fromkeys(engines))
    if isinstance(case, Scenario):
        yield from (Question(case, None, name) for name in names)
        return
    for expected in case.expect:
        yield from (Question(case, expected, name) for name in (LIMIT, *names))


def unasked(chosen: Sequence[Case], engines: Iterable[str] | None = None) -> list[Unasked]:
    """Tell what `validate` does not ask, and why; arguments as there."""
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
    chosen: Sequence[Case],
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


def validate_one(scenario: Scenario, engine: str, tol: float | None = None) -> Validation:
    """Ask one scenario's question of one engine and compare.

    `tol`: Relative width of the bracket; by default what the engine says (`validated_to`).
    """
    if scenario.expected_verdict is not None and scenario.has_thickness:
        return _judged(scenario, engine)
    started = time.perf_counter()
    asked = bracket(
        scenario.of(eta=1.0),
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
        under = found.eta_low if found.centre is None else found.centre * (1 - ASIDE)
        arch = scenario.arch(under)
        seen = observe(CircularArch.of(arch, scenario.mu).problem(), engine)
        in_motion, below = observed_mode(seen.joints_in_motion, arch), seen.verdict
        recording = seen.motion.recording if seen.motion else None
    # Thicker than eta = 2 there is no arch to try.
    if found.centre is not None and found.centre * (1 + ASIDE) <= ETA_MAX:
        over = found.centre * (1 + ASIDE)
        above = observe(
            CircularArch.of(scenario.arch(over), scenario.mu).problem(), engine
        ).verdict
    error = None
    # Where the limit is the thickest arch there is, nothing above it can be tried.
    middle = found.centre or (None if asked.undecided else found.eta_low)
    if middle is not None and found.eta_limit:
        error = middle / found.eta_limit - 1
    miss = "; ".join(_misses(found, error, below, above))
    return replace(
        _asked(scenario, engine),
        eta_limit=found.eta_limit,
        mode_limit=found.mode_limit,
        eta_low=found.eta_low,
        eta_high=found.eta_high,
        error=error,
        mode_observed=found.mode,
        mode_in_motion=in_motion,
        below=below,
        above=above,
        miss=miss,
        note=_note(scenario, found, engine, in_motion),
        wall_s=time.perf_counter() - started,
        modes_theory=found.modes_theory,
        recording=recording,
    )


def _judged(scenario: Scenario, engine: str) -> Validation:
    """Compare the verdict on an arch as it is with the one its scenario claims."""
    started = time.perf_counter()
    seen, arch = observe(scenario.problem(), engine), scenario.arch(scenario.maker.eta or 1.0)
    right = seen.verdict is scenario.expected_verdict
    return replace(
        _asked(scenario, engine),
        mode_observed=observed_mode(seen.joints, arch),
        mode_in_motion=observed_mode(seen.joints_in_motion, arch),
        verdict_expected=scenario.expected_verdict,
        verdict=seen.verdict,
        miss="" if right else f"{seen.verdict}, expected is {scenario.expected_verdict}",
        note="" if right else seen.reason,
        wall_s=time.perf_counter() - started,
    )


def _asked(scenario: Scenario, engine: str) -> Validation:
    """Return the row of a scenario that is still to be answered."""
    arch = scenario.arch(1.0)
    return Validation(
        scenario=scenario.name,
        engine=engine,
        half_angle=arch.half_angle,
        mu=scenario.mu,
        voussoirs=arch.voussoirs,
        weight=arch.weight,
        modes_published=scenario.expected_modes,
        eta_published=scenario.expected_eta,
        title=scenario.title,
        source=scenario.source,
    )


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


def _note(scenario: Scenario, found: ArchBracket, engine: str, in_motion: Mode | None) -> str:
    """Say why modes differ, where that is known, and what else to keep in mind."""
    notes: list[str] = []
    if found.mode is not found.mode_limit:
        if agree(found.mode, found.mode_limit, found.modes_theory):
            notes.append("on a line of the map, where both modes coincide")
        elif found.eta_low is not None:
            there = mechanism(scenario.arch(found.eta_low), scenario.mu).mode
            said = there or "unnamed"
            notes.append(f"at the bracket's lower end limit analysis says {said}")
    if in_motion and in_motion is not found.mode:
        notes.append(f"in motion, 1 % below, the mode is {in_motion}")
    most = get_engine(engine).most_friction
    if scenario.mu > most:
        arch = scenario.arch(1.0)
        there = limit.least_thickness(arch.half_angle, most, arch.voussoirs, arch.weight)
        least = "nothing stands" if there.eta is None else f"{there.eta:.6g}, {there.mode}"
        notes.append(f"friction is {most:g} in the engine, where limit analysis says {least}")
    return "; ".join(notes)
