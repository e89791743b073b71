"""Blocks let go, and recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack, overload

from blocksim.ask.methods import choose
from blocksim.ask.options import Asked, AskedInSpace, Options, problem_of, taken
from blocksim.blocks.problem import Problem
from blocksim.engines import get_engine

if TYPE_CHECKING:
    from blocksim.simulation.recorded import Recorded
    from blocksim.simulation.recording import Recording
    from blocksim.simulation.space import SpatialRecording


@overload
def simulate(
    asked: Asked, *, duration: float | None = None, **options: Unpack[Options]
) -> Recording: ...
@overload
def simulate(
    asked: AskedInSpace, *, duration: float | None = None, **options: Unpack[Options]
) -> SpatialRecording: ...
@overload
def simulate(
    asked: Asked | AskedInSpace, *, duration: float | None = None, **options: Unpack[Options]
) -> Recording | SpatialRecording: ...
def simulate(
    asked: Asked | AskedInSpace, *, duration: float | None = None, **options: Unpack[Options]
) -> Recorded[Any]:
    """Let blocks go in an engine, after the onset test, and record them.

    Parameters
    ----------
    asked : Problem, SpatialProblem, or a maker of one
    duration : float, optional
        Time to record [sqrt(size/g)]; by default until the verdict is certain, or, where
        the ground shakes, until the blocks lie still.
    **options
        `method`, `settings`, `progress` (`blocksim.ask.options.Options`).

    Returns
    -------
    Recording or SpatialRecording

    Raises
    ------
    InputError
        If the method moves no blocks, or cannot do what the problem asks for.
    MissingPart
        If the engine's library is not installed.
    """
    given, problem = taken(options, "reduce", "tol", "confirm"), problem_of(asked)
    chosen = choose(given.method, problem=problem, moving=True, settings=given.settings)
    engine = get_engine(chosen)
    # What moves blocks is loaded where it is asked for.
    if isinstance(problem, Problem) and problem.shaking is not None:
        from blocksim.simulation.shaken import shake

        seen = shake(
            problem,
            engine,
            until=duration,
            whole=True,
            settings=given.settings,
            progress=given.progress,
        )
        return seen.recording
    from blocksim.ask.engines import held

    return held(problem, engine, given).record(duration, given.progress)
