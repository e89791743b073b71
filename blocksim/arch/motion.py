"""An arch let go, and recorded."""

from __future__ import annotations

import math
import os
from typing import Any

from blocksim.arch.circular import Arch, arch_of
from blocksim.ask.simulate import simulate as simulate_problem
from blocksim.blocks.record import to_record
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath
from blocksim.common.progress import Progress, silent
from blocksim.evidence.recording import FORMAT, WRITTEN, Recording, read_recording
from blocksim.evidence.simulation import BY_RULE, Overrides


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
        arch.problem(mu, lean),
        method=method,
        duration=duration,
        settings=settings,
        progress=progress,
    )


def load_recording(path: AnyPath) -> Recording:
    """Read a recording; those of format 1, which knew arches only, are read, too.

    Raises
    ------
    InputError
        If the file is missing, too large, or no recording.
    """
    found = read_recording(path, _renewed)
    try:
        arch_of(found.problem)
    except (TypeError, InputError):
        raise InputError("recording", os.fspath(path), WRITTEN) from None
    return found


def _renewed(header: dict[str, Any]) -> dict[str, Any]:
    """Make a header of format 1 one of today's: it had an arch in place of a problem."""
    if header.get("format") != 1:
        return header
    settings = dict(header["settings"])
    # Gravity that leans was called a tilt once, and blocks could be kept in their plane.
    settings.pop("plane_lock", None)
    lean = float(settings.pop("lean", settings.pop("tilt", 0.0)))
    mu = math.inf if header["mu"] == "inf" else float(header["mu"])
    problem = Arch(**header["arch"]).problem(mu, lean)
    return {**header, "format": FORMAT, "problem": to_record(problem), "settings": settings}
