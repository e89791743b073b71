"""A problem in space in an engine: onset test, moving run, and what they show together.

The criteria are those of the plane (`onset`, `motion`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, cast

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.parting import (
    displacement_in_space,
    overlap_in_space,
    slip_in_space,
)
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.files import AnyPath
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import renderer
from blocksim.engines.base import FRICTION_CAP, Engine, Settings, World, trusted
from blocksim.limit.space import can_rest
from blocksim.simulation.motion import (
    FRAME,
    LONGEST,
    MOVED,
    QUIET,
    SPARSE,
    Motion,
    distrust,
    hardly_move,
    is_early,
    verdict_of,
    words_of,
)
from blocksim.simulation.observation import Observation
from blocksim.simulation.onset import FIRST_SWEEPS, GROWTH, PROBE, STICKS, WORK, Onset
from blocksim.simulation.recorded import Recorded
from blocksim.simulation.simulated import BY_RULE, Overrides, given_words, setting_of
from blocksim.simulation.verdict import Evidence, Verdict, aside

SURE = 1e-4
"""Residual over the accelerations at which blocks surely move."""


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
class HeldInSpace:
    """Blocks in space in an engine after the onset test; see `observation.Held`.

    Parameters
    ----------
    problem : SpatialProblem
    engine : Engine
    settings : Settings
    given : mapping of str to float
        Settings that do not follow the engine's rule.
    world : World
    onset : Onset
    rates : (blocks, 6) float
        Accelerations the onset test found [g], rotations in [g/size].
    """

    problem: SpatialProblem
    engine: Engine
    settings: Settings
    given: Overrides
    world: World
    onset: Onset
    rates: Array
    splits: ClassVar[int] = 0

    @property
    def blocks(self) -> int:
        """How many blocks the engine was given: all."""
        return len(self.problem.assembly.blocks)

    def release(self, until: float | None = None, progress: Progress = silent) -> Motion:
        """Let the blocks go, until a time or until all lie still; see `motion.moving_run`."""
        stands = self.onset.verdict is Verdict.STANDS
        end = (QUIET if stands else LONGEST) if until is None else until
        return _released(self, end, whole=until is not None, progress=progress)

    def concluded(self, *, moving: bool, progress: Progress = silent) -> Observation:
        """Do the moving run if it is asked for, and tell what all of it shows."""
        verdict, motion = self.onset.verdict, None
        evidence = (Evidence("onset test", self.onset.reason),)
        if moving and verdict is not Verdict.UNDECIDED:
            motion = self.release(progress=progress)
            evidence += (Evidence("moving run", motion.reason),)
            if motion.verdict is not verdict:
                verdict = Verdict.UNDECIDED
        return Observation(
            verdict=verdict,
            evidence=evidence + aside("settings", given_words(self.given)),
            onset=self.onset,
            motion=motion,
            joints=(),
            joints_in_motion=(),
            rates=self.rates if verdict is Verdict.COLLAPSES else None,
            blocks=self.blocks,
            splits=0,
        )


def hold_in_space(
    problem: SpatialProblem,
    engine: Engine,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> HeldInSpace:
    """Put a problem into an engine, and do the onset test.

    Parameters
    ----------
    problem : SpatialProblem
    engine : Engine
        One that moves blocks in space.
    settings : mapping of str to float
        Given instead of what the engine's rule says.
    progress : Progress, optional
    """
    chosen, world = _begun(problem, engine, settings)
    first, rates = _onset(problem, world, engine, chosen, progress)
    return HeldInSpace(
        problem=problem,
        engine=engine,
        settings=chosen,
        given=settings,
        world=world,
        onset=first,
        rates=rates,
    )


def observe_in_space(
    problem: SpatialProblem,
    engine: Engine,
    *,
    moving: bool = True,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Observation:
    """Do the onset test, then, if asked for, the moving run; see `hold_in_space`."""
    held = hold_in_space(problem, engine, settings, progress)
    return held.concluded(moving=moving, progress=progress)


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


def _released(held: HeldInSpace, until: float, *, whole: bool, progress: Progress) -> Motion:
    """Let blocks go; until they are seen to stand or fall, or as long as something moves."""
    problem, world, settings = held.problem, held.world, held.settings
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
    words = words_of(verdict, times, moved, 0.0, problem.length_name)
    if not trusted(world, settings):
        verdict = Verdict.UNDECIDED
        words = "released, " + distrust(quality, settings, problem.length_name)
    recording = SpatialRecording(
        problem=problem,
        engine=held.engine.name,
        engine_version=held.engine.version,
        settings=settings,
        times=np.array(times),
        poses=np.array(poses),
        quality=quality,
    )
    # What is asked of the motion of a collapse in the plane is not asked in space.
    own = cast("Any", recording)
    return Motion(verdict=verdict, reason=words, overlap=0.0, recording=own)
