"""What acts besides weight, as given on the command line: the road, loads, tilt, shaking."""

from __future__ import annotations

import math
from dataclasses import replace

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.outlines import signed_area
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.road import with_dispersal, with_fill, with_road
from blocksim.blocks.shaking import SHAPES, Shaking, read_table
from blocksim.cli.options import Given, Loading, named_options, option_of, require_given
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.kinds.circular import LEAST_DENSITY
from blocksim.limit.crushing import require_sizes


def loaded(problem: Problem, given: Given, loading: Loading) -> Problem:
    """Put on a problem what the options say: friction, load, tilt, lean."""
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
        return replace(problem, shaking=_shaking(problem.shaking, loading))


def _shaking(shaking: Shaking | None, loading: Loading) -> Shaking | None:
    """Shake the ground as the options say, which change what a file says."""
    shape, amplitude, duration = loading.shake, loading.amplitude, loading.duration
    if shape is not None and shape.endswith(".csv"):
        shaking = read_table(shape)
    elif shape is not None:
        shapes = ", ".join(SHAPES)
        require(shape in SHAPES, "--shake", shape, f"one of {shapes}, or a .csv file")
        require_given(amplitude=amplitude, duration=duration)
        shaking = Shaking(shape=shape, amplitude=amplitude or 0.0, duration=duration or 0.0)
    for name, value in (("amplitude", amplitude), ("duration", duration)):
        allowed = "left out, or --shake beside it: the ground is at rest"
        require(value is None or shaking is not None, f"--{name}", value, allowed)
    if shaking is not None and amplitude is not None:
        shaking = shaking.with_amplitude(amplitude)
    if shaking is not None and duration is not None:
        shaking = shaking.with_duration(duration)
    return shaking


def under_road(problem: Problem, loading: Loading) -> Problem:
    """Put fill and loads on a structure; live loads act as they are, with a factor of 1.

    Raises
    ------
    InputError
        If an option is out of range, a load is above no block, or weights are ratios only.
    """
    blocks = problem.assembly.blocks
    volume = sum(abs(signed_area(part)) * b.depth for b in blocks for part in b.polygons)
    density = sum(block.mass for block in blocks) * STANDARD_GRAVITY / volume
    weights = ("fill_unit_weight", "point_load", "patch_load")
    in_kilonewtons = [name for name in loading.on_road if name in weights]
    if in_kilonewtons and density < LEAST_DENSITY:
        allowed = f"given beside {option_of(in_kilonewtons[0])}: blocks weigh {density:g} N/m3"
        raise InputError("--unit-weight", MISSING, allowed)
    height, heavy = loading.fill, loading.fill_unit_weight
    if heavy is not None:
        require_unit_weight("--fill-unit-weight", heavy)
        require(
            height is not None, "--fill-unit-weight", heavy, "left out, or --fill beside it"
        )
    if height is not None:
        maker = problem.maker
        share = 1.0 if heavy is None or maker is None else 1000 * heavy / maker.unit_weight
        problem = with_fill(problem, height, share)
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
