"""An arch let go, and recorded."""

from __future__ import annotations

from blocksim.arch.circular import Arch
from blocksim.ask.simulate import simulate as simulate_problem
from blocksim.common.progress import Progress, silent
from blocksim.evidence.recording import Recording
from blocksim.evidence.simulation import BY_RULE, Overrides
from blocksim.kinds.circular import arch_problem


def simulate(
    arch: Arch,
    *,
    mu: float,
    method: str,
    duration: float | None = None,
    lean: float = 0.0,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Recording:
    """Let an arch go in an engine, after the onset test, and record it.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, above 0, inf allowed.
    method : str
        An engine, or `auto`.
    duration : float, optional
        Time to record [sqrt(r/g)]; by default until the verdict is certain.
    lean : float
        Angle by which gravity leans out of the plane [rad].
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
        If a value is out of range, or the method moves no blocks.
    MissingPart
        If the engine's library is not installed.
    """
    return simulate_problem(
        arch_problem(arch, mu, lean),
        method=method,
        duration=duration,
        settings=settings,
        progress=progress,
    )
