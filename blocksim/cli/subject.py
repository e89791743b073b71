"""What is asked about: a file, a shipped name, a kind, or the circular arch by its options."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from blocksim.blocks.problem import Problem
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.options import require_given
from blocksim.cli.question import arch_asked
from blocksim.common.checks import require
from blocksim.common.errors import InputError

STREAM = "-"
"""What stands for JSON lines on standard input."""


IN_PLANE = "x and y: in space there are check, bracket, simulate, render and report"
"""What is accepted where blocks have to lie in the plane."""


def is_many(scene: str) -> bool:
    """Tell a stream or a folder of structures from one."""
    try:
        return scene == STREAM or Path(scene).is_dir()
    except (OSError, ValueError):
        # No name of a file: whatever reads it says so.
        return False


def problem_asked(scene: str | None, given: Given, loading: Loading, **needed: Any) -> Problem:
    """Return what is asked about in the plane; see `anything_asked`."""
    found = anything_asked(scene, given, loading, thick=True, **needed)
    if found.in_space:
        raise InputError("blocks", "three coordinates", IN_PLANE, where=scene)
    return found


def anything_asked(
    scene: str | None,
    given: Given,
    loading: Loading,
    *,
    spatial: bool = False,
    tilts: bool = False,
    thick: bool = False,
    sought: bool = False,
    **needed: object,
) -> Problem[Any]:
    """Return what is asked about, in the plane or in space, and what the options put on it.

    `scene`: A file, a shipped name or a kind; None for the circular arch by its options.
    `given`, `thick`, `sought`, `needed`: As of `arch_asked`.
    `spatial`: Whether blocks of the plane are asked as prisms.
    `tilts`: Whether the question tilts them.
    """
    # Prisms tilt in space, towards any side; what is of the plane tilts in it.
    late = spatial and loading.azimuth is not None
    acting = replace(loading, tilt=None) if late else loading
    if scene is None:
        found = arch_asked(given, thick=thick, sought=sought, **needed)
        if acting.given or given.lean is not None:
            from blocksim.cli.road import loaded

            found = loaded(found, Given(lean=given.lean), acting)
    else:
        # An arch by its options is answered sooner than readers of files are loaded.
        from blocksim.cli.structures import structure

        require_given(**needed)
        found = structure(scene, given, acting)
    in_space = found.in_space or spatial
    turned = in_space and (tilts or loading.tilt is not None)
    allowed = (
        "left out, or --tilt beside it" if in_space else "left out: it is of blocks in space"
    )
    require(turned or loading.azimuth is None, "--azimuth", loading.azimuth, allowed)
    if not spatial:
        return found
    from blocksim.blocks.road import require_upright
    from blocksim.blocks.space.extruded import extruded

    if late or tilts:
        # Prisms do not know what of their loads lies on a road.
        name, turn = (
            ("--over", "tilt") if tilts else ("--tilt", math.radians(loading.tilt or 0.0))
        )
        require_upright(found, name, turn)
    made = found if found.in_space else extruded(found)
    made = replace(made, azimuth=math.radians(loading.azimuth or 0.0))
    return made.tilted(math.radians(loading.tilt)) if late and loading.tilt else made
