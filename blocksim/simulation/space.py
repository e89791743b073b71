"""A problem in space in an engine: onset test, moving run, and what they show together.

The criteria are those of the plane (`onset`, `motion`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.parting import (
    displacement_in_space,
    overlap_in_space,
    slip_in_space,
)
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import renderer
from blocksim.engines import ENGINES, get_engine
from blocksim.engines.base import FRICTION_CAP, Engine, Settings, World, trusted
from blocksim.limit.space import can_rest
from blocksim.simulation.motion import (
    FRAME,
    LONGEST,
    MOVED,
    QUIET,
    SPARSE,
    distrust,
    hardly_move,
    is_early,
    verdict_of,
    words_of,
)
from blocksim.simulation.onset import FIRST_SWEEPS, GROWTH, PROBE, STICKS, WORK, Onset
from blocksim.simulation.recorded import Recorded
from blocksim.simulation.simulated import BY_RULE, Overrides, setting_of
from blocksim.simulation.verdict import Evidence, Verdict

SURE = 1e-4
"""Residual over the accelerations at which blocks surely move."""
LENGTH = "L"
"""What the unit of length is called."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SpatialRecording(Recorded[SpatialProblem]):
    """The motion of blocks in space in one engine.

    Parameters
    ----------
    problem : SpatialProblem
    engine, engine_version : str
    settings : Settings
    times : (frames,) float
        In units of sqrt(size/g), from the release.
    poses : (frames, blocks, 6) float
        Centres of mass x, y, z in units of the size, and rotation vectors since the release.
    quality : Quality
    """

    def film(self, path: AnyPath, *, slow: float | None = None, height: int = 720) -> None:
        """Write it as a film in perspective.

        Parameters
        ----------
        path : Path
            Ending in .mp4 or .gif.
        slow : float, optional
            How many times slower than it happened.
        height : int
            In pixels; frames are 16:9.

        Raises
        ------
        InputError, MachineError
            If the film is too long or too large, or the file cannot be written.
        """
        renderer().film_of(self, path, slow=slow, height=height)

    @property
    def displacement(self) -> Array:
        """Largest displacement of any corner since the release [size], (frames,)."""
        return displacement_in_space(self.poses - self.poses[0], self.problem.assembly)


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
    chosen, world = _begun(problem, engine, settings)
    first, rates = _onset(problem, world, engine, chosen, progress)
    verdict, recording = first.verdict, None
    evidence = (Evidence("onset test", first.reason),)
    if moving and verdict is not Verdict.UNDECIDED:
        until = QUIET if verdict is Verdict.STANDS else LONGEST
        recording, seen, said = _released(
            problem, world, engine, chosen, until=until, whole=False, progress=progress
        )
        evidence += (Evidence("moving run", said),)
        verdict = verdict if seen is verdict else Verdict.UNDECIDED
    collapses = verdict is Verdict.COLLAPSES
    return SpatialObservation(
        verdict=verdict,
        evidence=evidence,
        rates=rates if collapses else None,
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
    chosen, world = _begun(problem, engine, settings)
    world.hold(chosen.hold_sweeps)
    return _released(
        problem, world, engine, chosen, until=until, whole=True, progress=progress
    )[0]


def _begun(problem: SpatialProblem, engine: Engine, given: Overrides) -> tuple[Settings, World]:
    """Return the settings that are taken, and the blocks in the engine."""
    # Asked of engines in space only.
    assert engine.rule_in_space is not None  # noqa: S101
    assert engine.build_in_space is not None  # noqa: S101
    own = {name: setting_of(name, value) for name, value in given.items()}
    settings = replace(engine.rule_in_space(problem.assembly), **own)
    return settings, engine.build_in_space(problem, settings)


def _onset(
    problem: SpatialProblem,
    world: World,
    engine: Engine,
    settings: Settings,
    progress: Progress,
) -> tuple[Onset, Array]:
    """Return what the onset test tells, and the accelerations."""
    assembly, built = problem.assembly, world.poses()
    allowed, total = settings.hold_sweeps, 0
    sweeps = min(max(FIRST_SWEEPS, len(assembly.blocks) ** 2), allowed)
    while True:
        rates = world.hold(sweeps)
        total += sweeps
        largest = float(displacement_in_space(rates, assembly))
        verdict, mechanism = Verdict.UNDECIDED, built
        residual = world.quality().residual
        if residual is None or residual <= max(SURE * largest, settings.still):
            mechanism = built + rates * (PROBE / largest if largest > 0 else 0.0)
            if largest < settings.still:
                verdict = Verdict.STANDS
            elif overlap_in_space(assembly, mechanism) < settings.closing and (
                residual is not None or _driven(problem, rates)
            ):
                verdict = Verdict.COLLAPSES
        found = Onset(verdict=verdict, acceleration=largest, mechanism=mechanism, sweeps=total)
        if verdict is Verdict.COLLAPSES and _may_hold(problem, engine, mechanism):
            return replace(found, verdict=Verdict.UNDECIDED, may_rest=True), rates
        if verdict is not Verdict.UNDECIDED or total >= allowed:
            return found, rates
        progress(total / allowed, "onset test")
        sweeps = min(int(total * (GROWTH - 1)), allowed - total)


def _may_hold(problem: SpatialProblem, engine: Engine, mechanism: Array) -> bool:
    """Tell whether blocks that start to slide may rest by friction all the same."""
    if slip_in_space(problem.assembly, mechanism) <= STICKS:
        return False
    bounded = float(problem.friction.max(initial=0.0)) <= FRICTION_CAP
    if engine.finds_rest and bounded:
        return False
    return can_rest(problem).exists is not False


def _driven(problem: SpatialProblem, rates: Array) -> bool:
    """Tell whether the loads do the work of the motion, from rest over one step."""
    assembly, size = problem.assembly, problem.assembly.size
    masses = assembly.weights / problem.unit_force
    spin = [
        float(turn @ block.gyration @ turn) / size**2
        for turn, block in zip(rates[:, 3:], assembly.blocks, strict=True)
    ]
    moving = float(masses @ ((rates[:, :3] ** 2).sum(axis=1) + np.array(spin)))
    return float((problem.pull() * rates).sum()) > WORK * moving


def _released(
    problem: SpatialProblem,
    world: World,
    engine: Engine,
    settings: Settings,
    *,
    until: float,
    whole: bool,
    progress: Progress,
) -> tuple[SpatialRecording, Verdict, str]:
    """Let blocks go; until they are seen to stand or fall, or as long as something moves."""
    step = settings.step
    moved_by = partial(displacement_in_space, assembly=problem.assembly)
    stride, taken = max(1, round(FRAME / step)), 0
    times, poses, moved = [0.0], [world.poses()], [0.0]
    while times[-1] < until - step / 2:
        frames = SPARSE if not whole and is_early(times, moved) else 1
        world.advance(frames * stride)
        taken += frames * stride
        times.append(taken * step)
        poses.append(world.poses())
        moved.append(float(moved_by(poses[-1] - poses[0])))
        if not whole and verdict_of(times, moved, settings.rest) is not Verdict.UNDECIDED:
            break
        if whole and moved[-1] > MOVED and hardly_move(poses, moved_by):
            break
        progress(min(1.0, times[-1] / until), "moving run")
    quality = world.quality()
    verdict = verdict_of(times, moved, settings.rest)
    words = words_of(verdict, times, moved, 0.0, LENGTH)
    if not trusted(world, settings):
        verdict = Verdict.UNDECIDED
        words = "released, " + distrust(quality, settings, LENGTH)
    recording = SpatialRecording(
        problem=problem,
        engine=engine.name,
        engine_version=engine.version,
        settings=settings,
        times=np.array(times),
        poses=np.array(poses),
        quality=quality,
    )
    return recording, verdict, words
