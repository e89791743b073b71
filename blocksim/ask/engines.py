"""What an engine shows of a problem in the plane or in space: onset test, moving run."""

from __future__ import annotations

from blocksim.ask.methods import reduces
from blocksim.ask.options import Taken
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.progress import Progress
from blocksim.engines.base import Engine, Method
from blocksim.simulation.merging import Merging
from blocksim.simulation.observation import Held, Observation, conclude, hold
from blocksim.simulation.simulated import Reduced
from blocksim.simulation.space import HeldInSpace, hold_in_space


def held(
    problem: Problem | SpatialProblem,
    engine: Engine,
    given: Taken,
    reduction: Reduced | None = None,
) -> Held | HeldInSpace:
    """Put a problem into an engine, and do the onset test."""
    if isinstance(problem, SpatialProblem):
        return hold_in_space(problem, engine, given.settings, given.progress)
    return hold(
        problem,
        engine,
        settings=given.settings,
        reduction=reduction,
        progress=given.progress,
    )


def concluded(at_rest: Held | HeldInSpace, *, moving: bool, progress: Progress) -> Observation:
    """Let blocks go if that is asked for, and tell what all of it shows."""
    if isinstance(at_rest, HeldInSpace):
        return at_rest.concluded(moving=moving, progress=progress)
    return conclude(at_rest, moving=moving, progress=progress)


def merged(chosen: Method, given: Taken, problem: Problem | SpatialProblem) -> Merging | None:
    """Return the blocks that move as one, where fewer than all are simulated."""
    if isinstance(problem, SpatialProblem) or not reduces(chosen, given.reduce, problem):
        return None
    return Merging.of(problem)
