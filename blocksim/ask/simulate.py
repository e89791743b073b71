"""Blocks let go, and recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING

from blocksim.ask.methods import choose
from blocksim.blocks.problem import Problem
from blocksim.common.progress import Progress, silent
from blocksim.evidence.simulation import BY_RULE, Overrides

if TYPE_CHECKING:
    from blocksim.evidence.recording import Recording


def simulate(
    problem: Problem,
    *,
    method: str = "auto",
    duration: float | None = None,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Recording:
    """Let blocks go in an engine, after the onset test, and record them.

    Parameters
    ----------
    problem : Problem
    method : str
        An engine, or `auto`.
    duration : float, optional
        Time to record [sqrt(size/g)]; by default until the verdict is certain, or, where
        the ground shakes, until the blocks lie still.
    settings : mapping of str to float
        Settings that replace those of the engine's rule;
        `blocksim.evidence.simulation.SETTINGS` has their names.
    progress : Progress, optional

    Returns
    -------
    Recording

    Raises
    ------
    InputError
        If the method moves no blocks, or cannot do what the problem asks for.
    MissingPart
        If the engine's library is not installed.
    """
    # What moves blocks is loaded where it is asked for.
    from blocksim.evidence.observation import hold
    from blocksim.evidence.shaken import shake

    chosen = choose(method, problem=problem, moving=True, settings=settings)
    if problem.shaking is not None:
        seen = shake(
            problem,
            chosen.name,
            until=duration,
            whole=True,
            settings=settings,
            progress=progress,
        )
        return seen.recording
    held = hold(problem, chosen.name, settings=settings, progress=progress)
    return held.release(duration, progress).recording
