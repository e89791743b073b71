"""What lies on the road, as given on the command line: fill and live loads."""

from __future__ import annotations

import math

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.outlines import signed_area
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.road import with_fill, with_road
from blocksim.cli.options import Loading, option_of
from blocksim.common.checks import is_number, require
from blocksim.common.errors import MISSING, InputError
from blocksim.kinds.circular import LEAST_DENSITY

HIGHEST_FILL = 1000.0
"""[m]"""


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
    in_kilonewtons = [name for name in loading.on_road if name != "fill"]
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
        ok = height == 0 or is_number(height, 0, HIGHEST_FILL)
        require(ok, "--fill", height, f"0 to {HIGHEST_FILL:g} m")
        maker = problem.maker
        share = 1.0 if heavy is None or maker is None else 1000 * heavy / maker.unit_weight
        problem = with_fill(problem, height, share)
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
