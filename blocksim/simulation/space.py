"""A problem in space in an engine: onset test, moving run, and what they show together.

The criteria are those of the plane (`onset`, `motion`).
"""

from __future__ import annotations

from dataclasses import dataclass

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.engines import ENGINES, get_engine
from blocksim.engines.base import Engine, World
from blocksim.simulation.motion import Motion, moving_run
from blocksim.simulation.onset import Onset, onset
from blocksim.simulation.simulated import BY_RULE, Overrides, given_words
from blocksim.simulation.spatial import SpatialRecording, SpatialSimulation
from blocksim.simulation.verdict import Evidence, Verdict, aside


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialObservation:
    """What an engine showed of one problem in space.

    Parameters
    ----------
    verdict : Verdict
        Undecided unless onset test and moving run agree, or only the first was asked for.
    evidence : tuple of Evidence
    rates : (blocks, 6) float or None
        Velocities in proportion to those with which a collapse starts; None otherwise.
    recording : SpatialRecording or None
        None where the blocks were not let go.
    """

    verdict: Verdict
    evidence: tuple[Evidence, ...]
    rates: Array | None
    recording: SpatialRecording | None


def engine_in_space(name: str | Engine) -> Engine:
    """Return an engine that moves blocks in space.

    Raises
    ------
    InputError
        If it does not.
    """
    found = get_engine(name)
    if found.build_in_space is None:
        able = [each for each in ENGINES if ENGINES[each].build_in_space is not None]
        allowed = f"one of auto, limit, {', '.join(able)}: {found.name} moves none in space"
        raise InputError("method", found.name, allowed)
    return found


def observe_in_space(
    problem: SpatialProblem,
    engine: Engine,
    *,
    moving: bool = True,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> SpatialObservation:
    """Put a problem into an engine: onset test, then, if asked for, the moving run.

    Parameters
    ----------
    problem : SpatialProblem
    engine : Engine
        One that moves blocks in space; see `engine_in_space`.
    moving : bool
        Let the blocks go after the onset test, unless that is undecided.
    settings : mapping of str to float
        Given instead of what the engine's rule says.
    progress : Progress, optional
    """
    simulation, world, first = _held(problem, engine, settings, progress)
    verdict, recording, mechanism = first.verdict, None, first.mechanism
    evidence = (Evidence("onset test", first.reason),)
    if moving and verdict is not Verdict.UNDECIDED:
        motion = _released(simulation, world, first, None, progress)
        recording = motion.recording
        evidence += (Evidence("moving run", motion.reason),)
        verdict = verdict if motion.verdict is verdict else Verdict.UNDECIDED
    evidence += aside("settings", given_words(settings))
    return SpatialObservation(
        verdict=verdict,
        evidence=evidence,
        rates=mechanism - simulation.built if verdict is Verdict.COLLAPSES else None,
        recording=recording,
    )


def simulate_in_space(
    problem: SpatialProblem,
    engine: Engine,
    *,
    until: float,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> SpatialRecording:
    """Let blocks in space go and record them until a time, or until all lie still.

    Parameters
    ----------
    problem : SpatialProblem
    engine : Engine
    until : float
        [sqrt(size/g)]
    settings : mapping of str to float
    progress : Progress, optional
    """
    simulation, world, first = _held(problem, engine, settings, progress)
    return _released(simulation, world, first, until, progress).recording


def _held(
    problem: SpatialProblem, engine: Engine, settings: Overrides, progress: Progress
) -> tuple[SpatialSimulation, World, Onset]:
    """Put blocks into an engine, and do the onset test."""
    simulation = SpatialSimulation.of(problem, engine, settings)
    world = simulation.world()
    found = onset(
        world,
        engine,
        problem,
        simulation.settings,
        progress,
        # What an engine does not take of friction may hold blocks.
        rougher=None if simulation.look.is_bounded(engine) else problem,
    )
    return simulation, world, found


def _released(
    simulation: SpatialSimulation,
    world: World,
    first: Onset,
    until: float | None,
    progress: Progress,
) -> Motion[SpatialRecording]:
    """Let blocks go; see `moving_run`."""
    rests = first.verdict is Verdict.STANDS and not first.may_slide
    return moving_run(
        simulation, world, first.repeat, rests=rests, until=until, progress=progress
    )
