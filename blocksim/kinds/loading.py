"""What is known by a name: a file, a drawing, a recording, what is shipped, a kind."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from blocksim.arch.circular import Arch
from blocksim.blocks.entries import ExpectEntry
from blocksim.blocks.kindtable import kind_of
from blocksim.blocks.maker import Kind
from blocksim.blocks.problem import Problem
from blocksim.blocks.record import to_record
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath
from blocksim.kinds import KINDS
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import around_said, load_structure, named_file, structure_of
from blocksim.simulation.recording import FORMAT, Recording, read_recording


def load(name: AnyPath, *, friction: float | None = None) -> Problem[Any]:
    """Return what is known by a name.

    Parameters
    ----------
    name : str or path
        A structure file, a drawing, an assembly of compas, the name of one that is shipped, or
        that of a kind.
    friction : float, optional
        Friction coefficient where the name says none, as of drawings and kinds; inf allowed.

    Raises
    ------
    InputError
        In one line: what is wrong with the file, or that friction is missing.

    Examples
    --------
    >>> load("oppenheim_7").assembly.joints[0].before
    -1
    >>> load("wall", friction=0.7).maker.courses
    6
    """
    said = os.fspath(name)
    if said in KINDS:
        return KINDS[said](friction=friction).problem()
    return load_structure(name, friction=friction)


@dataclass(frozen=True, kw_only=True, eq=False)
class Known:
    """A structure, and what its source says of it.

    `quick`: Whether `validate --quick` takes it.
    """

    name: str
    problem: Problem
    expect: tuple[ExpectEntry, ...]
    quick: bool


def load_known(name: str) -> Known:
    """Read a shipped structure with what is expected of it."""
    with named_file(name) as data:
        problem = structure_of(data)
        table = cast("dict[str, Any]", data)
        around = around_said(table)
        for at, each in enumerate(around.expect):
            valued = each.over is not None and each.value is not None
            asked = valued, each.verdict is not None, each.modes is not None
            allowed = "over and value, verdict or modes"
            require(sum(asked) == 1, f"expect[{at}]", each.over, allowed)
        return Known(name=name, problem=problem, expect=around.expect, quick=around.quick)


def load_recording(path: AnyPath) -> Recording[Any]:
    """Read a recording; those of format 1, which knew arches only, are read, too.

    Raises
    ------
    InputError
        If the file is missing, too large, or no recording.

    Examples
    --------
    >>> from blocksim import Column, simulate
    >>> leaning = Column(drums=1, drum_height=1, width=0.2, friction=1).problem().tilted(0.3)
    >>> simulate(leaning, method="direct", duration=1.0).save("fall.npz")
    >>> load_recording("fall.npz").poses.shape[1:]
    (1, 3)
    """
    return read_recording(path, _renewed, maker_of)


def maker_of(origin: Mapping[str, object]) -> Kind[Any] | None:
    """Return the maker that a recording tells of; None of blocks that were given.

    `origin`: What `Kind.origin` returned.
    """
    table: dict[str, Any] = dict(origin)
    if table.get("kind") == CircularArch.name and "half_angle" in table:
        del table["kind"]
        return CircularArch.of(Arch(**table))
    density = table.pop("density", None)
    try:
        made = kind_of(table, KINDS)
    except InputError:
        return None
    return replace(made, density=density)


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
