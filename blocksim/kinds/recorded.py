"""Recordings, with what made their blocks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from blocksim.arch.circular import Arch
from blocksim.blocks.maker import Maker, kind_of
from blocksim.blocks.record import to_record
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath
from blocksim.kinds import KINDS
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.recording import FORMAT, Recording, read_recording


def load_recording(path: AnyPath) -> Recording:
    """Read a recording; those of format 1, which knew arches only, are read, too.

    Raises
    ------
    InputError
        If the file is missing, too large, or no recording.
    """
    return read_recording(path, _renewed, maker_of)


def maker_of(origin: Mapping[str, object]) -> Maker | None:
    """Return the maker that a recording tells of; None of blocks that were given.

    Parameters
    ----------
    origin : mapping
        What `Maker.origin` returned.

    Raises
    ------
    InputError, TypeError
        If it is of a symmetric arch, and cannot be.
    """
    table: dict[str, Any] = dict(origin)
    if table.get("kind") == CircularArch.name and "half_angle" in table:
        del table["kind"]
        return CircularArch.of(Arch(**table))
    density = table.pop("density", None)
    try:
        return replace(kind_of(table, tuple(KINDS.values())), density=density)
    except InputError:
        return None


def _renewed(header: dict[str, Any]) -> dict[str, Any]:
    """Make a header of format 1 one of today's: it had an arch in place of a problem."""
    if header.get("format") != 1:
        return header
    settings = dict(header["settings"])
    # Gravity that leans was called a tilt once, and blocks could be kept in their plane.
    settings.pop("plane_lock", None)
    lean = float(settings.pop("lean", settings.pop("tilt", 0.0)))
    mu = math.inf if header["mu"] == "inf" else float(header["mu"])
    problem = CircularArch.of(Arch(**header["arch"]), mu).problem().leaning(lean)
    return {**header, "format": FORMAT, "problem": to_record(problem), "settings": settings}
