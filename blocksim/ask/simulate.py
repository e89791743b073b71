"""Blocks let go, and recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack, cast

from blocksim.ask.methods import asked_as, choose
from blocksim.ask.options import Asked, Options, problem_of, taken
from blocksim.blocks.assembly import Blocks
from blocksim.engines import get_engine

if TYPE_CHECKING:
    from blocksim.blocks.problem import Problem
    from blocksim.simulation.recording import Recording


def simulate(
    asked: Asked[Blocks], *, duration: float | None = None, **options: Unpack[Options]
) -> Recording[Blocks]:
    """Let blocks go in an engine, after the onset test, and record them.

    Parameters
    ----------
    asked : Problem, or a maker of one
    duration : float, optional
        Time to record [sqrt(size/g)]; by default until the verdict is certain, or, where
        the ground shakes, until the blocks lie still.
    **options
        `method`, `settings`, `progress` (`blocksim.ask.options.Options`).

    Returns
    -------
    Recording

    Raises
    ------
    InputError
        If the method moves no blocks, or cannot do what the problem asks for.
    MissingPart
        If the engine's library is not installed.

    Examples
    --------
    >>> from blocksim import CircularArch
    >>> thin = CircularArch(half_angle_deg=90, thickness=0.08, voussoirs=9, friction=0.7)
    >>> fall = simulate(thin, method="direct", duration=1.0)
    >>> fall.poses.shape[1:], bool(fall.displacement[-1] > 0.01)
    ((9, 3), True)
    """
    given = taken(options, "reduce", "tol", "confirm")
    problem = asked_as(cast("Problem[Any]", problem_of(asked)))
    chosen = choose(given.method, problem=problem, moving=True, settings=given.settings)
    engine = get_engine(chosen)
    if problem.is_moving:
        from blocksim.simulation.shaken import shake

        seen = shake(
            problem,
            engine,
            until=duration,
            whole=True,
            settings=given.settings,
            progress=given.progress,
        )
        return cast("Any", seen.recording)
    from blocksim.simulation.observation import hold

    held = hold(problem, engine, settings=given.settings, progress=given.progress)
    return held.record(duration, given.progress)
