"""Blocks let go, and recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack, overload

from blocksim.ask.methods import choose
from blocksim.ask.options import Asked, Options, problem_of, taken
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.engines import get_engine

if TYPE_CHECKING:
    from blocksim.ask.space import SpatialRecording
    from blocksim.simulation.recording import Recording


@overload
def simulate(
    asked: Asked, *, duration: float | None = None, **options: Unpack[Options]
) -> Recording: ...


@overload
def simulate(
    asked: SpatialProblem, *, duration: float | None = None, **options: Unpack[Options]
) -> SpatialRecording: ...


def simulate(
    asked: Asked | SpatialProblem,
    *,
    duration: float | None = None,
    **options: Unpack[Options],
) -> Recording | SpatialRecording:
    """Let blocks go in an engine, after the onset test, and record them.

    Parameters
    ----------
    asked : Problem, SpatialProblem or Maker
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
    # What moves blocks is loaded where it is asked for.
    if isinstance(asked, SpatialProblem):
        from blocksim.ask.space import recorded_in_space

        return recorded_in_space(asked, duration, taken(options, "reduce", "tol", "confirm"))
    from blocksim.simulation.observation import hold
    from blocksim.simulation.shaken import shake

    given, problem = taken(options, "reduce", "tol", "confirm"), problem_of(asked)
    chosen = choose(given.method, problem=problem, moving=True, settings=given.settings)
    engine = get_engine(chosen)
    if problem.shaking is not None:
        seen = shake(
            problem,
            engine,
            until=duration,
            whole=True,
            settings=given.settings,
            progress=given.progress,
        )
        return seen.recording
    held = hold(problem, engine, settings=given.settings, progress=given.progress)
    return held.record(duration, given.progress)
