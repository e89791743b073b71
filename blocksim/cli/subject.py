"""What is asked about: a file, a shipped name, a kind, or the circular arch by its options."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from blocksim.blocks.problem import Problem
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.options import named_options, require_given
from blocksim.cli.question import question
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


def is_structure(scene: str | None) -> bool:
    """Tell a structure from an arch by its options, or a scenario of one."""
    if scene is None:
        return False
    # An arch by its options is answered sooner than readers of files are loaded.
    from blocksim.cli.structures import is_structure

    return is_structure(scene)


def problem_asked(
    scene: str | None,
    given: Given,
    loading: Loading,
    *,
    thick: bool = False,
    **needed: object,
) -> Problem:
    """Return what is asked about in the plane; see `anything_asked`."""
    found = anything_asked(
        scene, given, loading, spatial=False, thick=thick, sought=False, **needed
    )
    if found.in_space:
        raise InputError("blocks", "three coordinates", IN_PLANE, where=scene)
    return found


def anything_asked(
    scene: str | None,
    given: Given,
    loading: Loading,
    *,
    spatial: bool = False,
    thick: bool = False,
    sought: bool = False,
    **needed: object,
) -> Problem[Any]:
    """Return what is asked about, in the plane or in space, and what the options put on it.

    `scene`, `given`, `thick`, `needed`: As of `question`.
    `spatial`: Whether blocks of the plane are asked as prisms.
    `sought`: Whether the thickness of an arch is what is sought.
    """
    if scene is not None and is_structure(scene):
        from blocksim.cli.structures import structure

        require_given(**needed)
        found = structure(scene, given, loading)
    else:
        found = _arch(scene, given, loading, thick=thick, sought=sought, **needed)
    if found.in_space:
        return found
    if not spatial:
        allowed = "left out: it is of blocks in space"
        require(loading.azimuth is None, "--azimuth", loading.azimuth, allowed)
        return found
    from blocksim.blocks.space.extruded import extruded

    return replace(extruded(found), azimuth=math.radians(loading.azimuth or 0.0))


def _arch(
    scene: str | None,
    given: Given,
    loading: Loading,
    *,
    thick: bool,
    sought: bool,
    **needed: object,
) -> Problem:
    """Return the circular arch that is asked about, by its options or a scenario."""
    asked = question(scene, given, thick=thick, **needed)
    with named_options():
        if sought and not asked.has_thickness:
            asked = replace(asked, given={**asked.given, "eta": 1.0})
        # Fill and loads on the road are borne by supports that are drawn.
        problem = asked.problem(supports=bool(loading.on_road))
    if not loading.given:
        return problem
    from blocksim.cli.road import loaded

    return loaded(problem, Given(), loading)
