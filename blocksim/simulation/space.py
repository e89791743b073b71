"""A problem in space in an engine: onset test, moving run, and what they show together.

The criteria are those of the plane (`onset`, `motion`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, cast

from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.progress import Progress, silent
from blocksim.engines.base import Engine, World
from blocksim.simulation.motion import Motion, both_tests, released
from blocksim.simulation.observation import Observation
from blocksim.simulation.onset import Onset, onset
from blocksim.simulation.simulated import BY_RULE, Overrides, given_words
from blocksim.simulation.spatial import SpatialRecording, SpatialSimulation
from blocksim.simulation.verdict import Verdict, aside


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldInSpace:
    """Blocks in space in an engine after the onset test; see `observation.Held`.

    Parameters
    ----------
    simulation : SpatialSimulation
    world : World
    onset : Onset
    """

    simulation: SpatialSimulation
    world: World
    onset: Onset
    splits: ClassVar[int] = 0

    @property
    def blocks(self) -> int:
        """How many blocks the engine was given: all."""
        return len(self.simulation.problem.assembly.blocks)

    def release(
        self, until: float | None = None, progress: Progress = silent
    ) -> Motion[SpatialRecording]:
        """Let the blocks go; see `released`."""
        return released(self.simulation, self.world, self.onset, until, progress)

    def record(
        self, until: float | None = None, progress: Progress = silent
    ) -> SpatialRecording:
        """Let the blocks go, and return what was recorded."""
        return self.release(until, progress).recording

    def concluded(self, *, moving: bool, progress: Progress = silent) -> Observation:
        """Do the moving run if it is asked for, and tell what all of it shows."""
        verdict, motion, evidence = both_tests(
            self.onset, lambda: self.release(progress=progress), moving=moving
        )
        falls = verdict is Verdict.COLLAPSES
        return Observation(
            verdict=verdict,
            evidence=evidence + aside("settings", given_words(self.simulation.given)),
            onset=self.onset,
            # Of a recording in space nothing is asked that is of the plane.
            motion=cast("Any", motion),
            joints=(),
            joints_in_motion=(),
            rates=self.onset.mechanism - self.simulation.built if falls else None,
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
    return HeldInSpace(simulation=simulation, world=world, onset=found)


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
