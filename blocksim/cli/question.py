"""The circular arch that options describe."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.problem import Problem
from blocksim.cli.built import Given
from blocksim.cli.options import named_options, refuse, require_given
from blocksim.common.checks import is_number, require
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.ways import ASIDE, DENSITY, THICK

IN_METRES = " (or --span, --rise and --thickness, in m)"


def is_thick(given: Given) -> bool:
    """Tell whether options say how thick an arch is."""
    return any(getattr(given, name) is not None for name in THICK)


def arch_of(given: Given, *, thick: bool = False, **needed: object) -> CircularArch:
    """Return what makes the arch that options describe.

    `thick`: Whether a thickness has to be given; where none is, it is `ASIDE` of the least.
    `needed`: Other options that have to be given, by name.
    """
    measured = given.measured
    sizes, thickness = (("span", "rise"), "thickness") if measured else (("alpha",), "eta")
    shape = {name: getattr(given, name) for name in sizes}
    lacking = {thickness: None} if thick and not is_thick(given) else {}
    mu = given.mu if given.friction_angle is None else given.friction_angle
    others = [*(["--friction-angle"] if mu is None else []), *(["--ratio"] if lacking else [])]
    instead = f" (or {', '.join(others)})" if others else ""
    if not measured and given.alpha is None:
        instead = IN_METRES
    require_given(instead, **needed, **shape, mu=mu, **lacking)
    refuse(given.drawn, why="left out: it is of drawings, and this is an arch")
    refuse({"parameters": given.parameters}, why="left out: it is for kinds of structures")
    _require_degrees(given.alpha)
    if given.unit_weight is not None:
        require_unit_weight("--unit-weight", given.unit_weight)
    table: dict[str, Any] = {
        "weight": "sector" if measured else "centreline",
        "density": DENSITY if given.unit_weight is None else 1000 * given.unit_weight,
        **({} if given.depth is None else {"depth": given.depth}),
        **({} if is_thick(given) else {"ratio": ASIDE}),
        **given.sizes,
    }
    with named_options():
        return CircularArch(**table)


def arch_asked(
    given: Given, *, thick: bool = False, sought: bool = False, **needed: object
) -> Problem:
    """Return the arch that options describe, under its own weight, upright.

    `thick`, `needed`: As of `arch_of`.
    `sought`: Whether its thickness is what is sought.
    """
    if sought and not is_thick(given):
        given = replace(given, eta=1.0)
    problem = arch_of(given, thick=thick, **needed).problem()
    if not is_thick(given):
        note = f"no thickness was given, so it is {ASIDE:g} of the least as built"
        problem = replace(problem, notes=(note,))
    return problem


def _require_degrees(alpha: float | None) -> None:
    """Raise `InputError` for a half-angle that is none in degrees."""
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
        flat = f"in degrees: {alpha:g} deg is nearly flat, in radians it would be "
        flat += f"{math.degrees(alpha):.4g} deg (a flat arch: --span and --rise)"
        require(alpha > math.pi, "--alpha", alpha, flat)
