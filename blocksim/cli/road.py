"""What acts besides weight, as given on the command line: the road, loads, tilt, shaking."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Any

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import (
    fill_density,
    remade,
    road_of,
    takes_fill,
    with_dispersal,
    with_fill,
    with_road,
    with_soil,
)
from blocksim.blocks.shaking import SHAPES, Shaking, read_table
from blocksim.blocks.soil import Soil, coefficients, resistance
from blocksim.cli.given import SOIL, Given, Loading, given_of
from blocksim.cli.options import named_options, option_of, refuse, require_given
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.kinds.circular import LEAST_DENSITY, CircularArch
from blocksim.limit.crushing import require_sizes

IN_SPACE = {"parameters", "mu", "friction_angle", "unit_weight", "tolerance", "unit", "layer",
            "up", "load", "push", "tilt", "azimuth", "gravity", "shake", "amplitude",
            "duration"}  # fmt: skip
"""Options that mean something in space."""


def loaded(problem: Problem[Any], given: Given, loading: Loading) -> Problem[Any]:
    """Put on a problem what the options say: friction, load, tilt, lean."""
    if problem.in_space:
        refuse({**asdict(given), **asdict(loading)}, IN_SPACE | given.sizes.keys())
        if loading.azimuth is not None:
            problem = replace(problem, azimuth=math.radians(loading.azimuth))
    with named_options():
        if given.friction is not None:
            problem = problem.with_friction(given.friction)
        if loading.on_road:
            problem = under_road(problem, loading)
        if loading.strength is not None:
            problem = replace(problem, strength=1e6 * loading.strength)
            require_sizes(problem)
        if loading.load is not None:
            require(bool(problem.live), "--load", loading.load, "left out: no live loads")
            problem = problem.with_load(loading.load)
        if loading.tilt is not None:
            problem = problem.tilted(math.radians(loading.tilt))
        if given.lean is not None:
            problem = problem.leaning(math.radians(given.lean))
        if loading.gravity is not None:
            problem = problem.under(loading.gravity)
        problem = replace(problem, shaking=_shaking(problem.shaking, loading))
        if loading.spread is not None:
            from blocksim.ask.moved import spread_by

            problem = spread_by(problem, loading.spread)
        if loading.push is not None:
            from blocksim.ask.push import pushed

            problem = pushed(problem, loading.push)
        return problem


def _shaking(shaking: Shaking | None, loading: Loading) -> Shaking | None:
    """Shake the ground as the options say, which change what a file says."""
    shape, given = loading.shake, given_of(loading, "amplitude", "duration")
    if shape is not None and shape.endswith(".csv"):
        shaking = read_table(shape)
    elif shape is not None:
        shapes = ", ".join(SHAPES)
        require(shape in SHAPES, "--shake", shape, f"one of {shapes}, or a .csv file")
        large, long = loading.amplitude, loading.duration
        require_given(amplitude=large, duration=long)
        return Shaking(shape=shape, amplitude=large or 0.0, duration=long or 0.0)
    if shaking is None:
        refuse(given, why="left out, or --shake beside it: the ground is at rest")
        return None
    return replace(shaking, **given)


def _filled(problem: Problem, loading: Loading, density: float) -> Problem:
    """Put fill on a structure: by its maker, where that knows it, else on what is uppermost."""
    height, heavy = loading.fill, loading.fill_unit_weight
    if heavy is not None and height is not None:
        require_unit_weight("--fill-unit-weight", heavy)
    if height is None:
        names = SOIL if road_of(problem) is None else ["fill_unit_weight"]
        refuse(given_of(loading, *names), why="left out, or --fill beside it")
    usual = density if problem.maker is None else problem.maker.unit_weight
    weight = usual if heavy is None else 1000 * heavy
    own = takes_fill(problem)
    if own:
        if height is not None:
            problem = with_fill(problem, height, weight / usual)
        weight = usual * fill_density(problem)
    soil = _soil(loading, weight, None if own else height)
    return problem if soil == Soil(unit_weight=weight) else with_soil(problem, soil)


def _soil(loading: Loading, weight: float, height: float | None) -> Soil:
    """Return what the options say the fill is made of."""
    pressure, passive = loading.fill_pressure, loading.fill_passive
    angle, backing = loading.fill_friction_angle, loading.backing
    if pressure is None and passive is None:
        why = "left out, or --fill-pressure or --fill-passive beside it"
        refuse({"fill_friction_angle": angle}, why=why)
    turn = None if angle is None else math.radians(angle)
    return Soil(
        unit_weight=weight,
        height=height,
        regions=tuple(
            (low, high, 1000 * heavy) for low, high, heavy in loading.fill_region or ()
        ),
        layers=tuple((thick, 1000 * heavy) for thick, heavy in loading.fill_layer or ()),
        backing=None if backing is None else (backing[0], 1000 * backing[1]),
        pressure=(0.0, 0.0) if pressure is None else coefficients(pressure, turn),
        passive=(0.0, 0.0) if passive is None else resistance(passive, turn),
    )


def under_road(problem: Problem, loading: Loading) -> Problem:
    """Put fill and loads on a structure; live loads act as they are, with a factor of 1."""
    if isinstance(problem.maker, CircularArch) and problem.maker.in_radii:
        # They are borne by supports that are drawn.
        maker = problem.maker.but(on_supports=True)
        problem = replace(remade(problem, maker), title=problem.title or maker.name)
    density = float(problem.assembly.weights.sum() / problem.assembly.volumes.sum())
    weights = ("fill_unit_weight", "fill_region", "fill_layer", "backing", "point_load",
               "patch_load")  # fmt: skip
    in_kilonewtons = [name for name in loading.on_road if name in weights]
    if in_kilonewtons and density < LEAST_DENSITY:
        allowed = f"given beside {option_of(in_kilonewtons[0])}: blocks weigh {density:g} N/m3"
        raise InputError("--unit-weight", MISSING, allowed)
    problem = _filled(problem, loading, density)
    if loading.dispersal is not None:
        problem = with_dispersal(problem, loading.dispersal)
    placed = [("--point-load", (x, x, weight)) for x, weight in loading.point_load or ()]
    placed += [("--patch-load", load) for load in loading.patch_load or ()]
    for option, (low, high, weight) in placed:
        allowed = "left out: the file has live loads of its own"
        require(not problem.live, option, f"{low:g} {weight:g}", allowed)
        ok = all(math.isfinite(each) for each in (low, high, weight)) and weight > 0
        require(ok, option, f"{weight:g} kN", "a weight above 0, in kN")
        spread = option == "--point-load" or low < high
        require(spread, option, f"{low:g} {high:g}", "two places, the left one first")
    if not placed:
        return problem
    loads = [(low, high, 1000 * weight) for _, (low, high, weight) in placed]
    return with_road(problem, loads, [option for option, _ in placed]).with_load(1.0)
