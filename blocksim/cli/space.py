"""Options of structures in space on the command line: what acts, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, replace

from blocksim.blocks.space.problem import SpatialProblem
from blocksim.cli.options import Given, Loading, option_of
from blocksim.common.checks import require

IN_SPACE = {"parameters", "mu", "friction_angle", "unit_weight", "tolerance"}
"""Options on what is built that mean something in space."""
ACTING = {"load", "tilt", "azimuth"}
"""The same of what acts on it."""


def loaded_in_space(problem: SpatialProblem, given: Given, loading: Loading) -> SpatialProblem:
    """Put on a problem in space what the options say.

    Raises
    ------
    InputError
        If an option means nothing in space.
    """
    refuse({**asdict(given), **asdict(loading)}, IN_SPACE | ACTING)
    if given.friction is not None:
        problem = problem.with_friction(given.friction)
    if loading.load is not None:
        require(bool(problem.live), "--load", loading.load, "left out: no live loads")
        problem = problem.with_load(loading.load)
    problem = replace(problem, azimuth=math.radians(loading.azimuth or 0.0))
    return problem if loading.tilt is None else problem.tilted(math.radians(loading.tilt))


def refuse(options: Mapping[str, object], known: Collection[str] = ()) -> None:
    """Refuse options that are given and mean nothing in space."""
    for name, value in options.items():
        unset = value is None or value is False or name in known
        require(unset, option_of(name), value, "left out: it is not known in space")
