"""The first part of `validate`: arches by simulation against limit analysis and theory."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import replace

from blocksim.arch import limit
from blocksim.arch.answers import ArchBracket
from blocksim.arch.circular import ETA_MAX
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode, observed_mode
from blocksim.ask.bracket import bracket
from blocksim.common.progress import Progress, silent
from blocksim.engines import ENGINES, NAMES, engine_named, get_engine
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.scenario import Scenario
from blocksim.kinds.scenarios import load_scenario, shipped
from blocksim.simulation.observation import observe
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Unasked, Validation, agree, answered

ERROR_BOUND = 0.002
"""A bracket whose centre is farther than this from `limit` is a miss."""
ASIDE = 0.01
"""How far below and above the bracket arches are let go."""


def scenarios(*, quick: bool) -> list[Scenario]:
    """Return the shipped scenarios, or those marked quick."""
    every = [load_scenario(name) for name in shipped()]
    return [scenario for scenario in every if scenario.quick or not quick]


def usual(part: str) -> tuple[str, ...]:
    """Return the engines that are asked in a part of `validate` where none is named."""
    return tuple(name for name in NAMES if part in ENGINES[name].validates)


def installed() -> tuple[str, ...]:
    """Return the usual engines for arches that can run here."""
    return tuple(name for name in usual("arches") if ENGINES[name].missing is None)


def unasked(chosen: Sequence[Scenario], engines: Iterable[str] | None = None) -> list[Unasked]:
    """Tell what `validate` does not ask, and why; arguments as there."""
    found: list[Unasked] = []
    for name in usual("arches") if engines is None else engines:
        remedy = engine_named(name).missing
        leaning = tuple(each.name for each in chosen if each.lean)
        if engines is None and remedy:
            every = tuple(each.name for each in chosen)
            found.append(Unasked(engine=name, scenarios=every, why=f"not here: {remedy}"))
        elif leaning and not engine_named(name).is_spatial:
            able = " or ".join(each for each in NAMES if ENGINES[each].is_spatial)
            why = f"gravity leans out of the plane: {able} sees that"
            found.append(Unasked(engine=name, scenarios=leaning, why=why))
    return found


def validate(
    chosen: Sequence[Scenario],
    engines: Iterable[str] | None = None,
    *,
    workers: int = 2,
    progress: Progress = silent,
) -> list[Validation]:
    """Bracket every scenario with every engine and compare.

    `engines`: By default all that are `installed`. Scenarios whose gravity leans out of the
        plane are for those that see that; `unasked` tells what is left out.
    `workers`: Processes; 1 runs in this one.
    Returns: In the order of scenarios, then engines, whatever finishes first.
    """
    names = installed() if engines is None else tuple(dict.fromkeys(engines))
    for name in names:
        engine_named(name, "methods")
        get_engine(name)
    jobs = [
        (scenario.name, (scenario, engine))
        for scenario in chosen
        for engine in names
        if engine_named(engine).is_spatial or not scenario.lean
    ]
    return answered(_asked_of, jobs, workers, progress)


def _asked_of(job: tuple[Scenario, str]) -> Validation:
    return validate_one(*job)


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
