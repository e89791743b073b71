"""What is asked about: a scenario, the options that override it, or options alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from blocksim.arch.dimensions import require_measured, require_unit_weight
from blocksim.cli.built import Given
from blocksim.cli.options import named_options, option_of, refuse, require_given
from blocksim.common.checks import ETA, is_number, require
from blocksim.common.errors import InputError, perhaps
from blocksim.kinds import KINDS
from blocksim.kinds.scenario import MEASURES, THICK, USUAL, Scenario


def question(
    scene: str | None, given: Given, *, thick: bool = False, **needed: object
) -> Scenario:
    """Merge a scenario, where there is one, with the options that override it.

    `thick`: Whether a thickness has to be given where there is no scenario.
    `needed`: Other options that have to be given, by name.
    """
    if scene is None:
        mu = given.mu if given.friction_angle is None else given.friction_angle
        measured = bool(given.measured)
        sizes, thickness = (("span", "rise"), "thickness") if measured else (("alpha",), "eta")
        thick_by = getattr(given, thickness) if given.ratio is None else given.ratio
        thick_enough = {thickness: thick_by} if thick else {}
        by_angle = not measured and given.alpha is None
        instead = IN_METRES if by_angle else instead_of(mu, **thick_enough)
        shape = {name: getattr(given, name) for name in sizes}
        require_given(instead, **needed, **shape, mu=mu, **thick_enough)
    require_given(**needed)
    no_kind = "left out: it is for kinds of structures"
    no_drawing = "left out: it is of drawings, and this is an arch"
    refuse(given.drawn, why=no_drawing)
    require(given.parameters is None, "--with", " ".join(given.parameters or ()), no_kind)
    _require_ranges(given)
    asked = Scenario(given=USUAL) if scene is None else _scenario(scene)
    table = _measured(asked, given) if given.measured else _by_angle(asked, given)
    own = {
        "voussoirs": given.voussoirs,
        "weight": given.weight,
        "depth": given.depth,
        "friction": given.friction,
        "density": None if given.unit_weight is None else 1000 * given.unit_weight,
    }
    table |= {name: value for name, value in own.items() if value is not None}
    lean = asked.lean if given.lean is None else math.radians(given.lean)
    return replace(asked, given=table, lean=lean)


def _scenario(scene: str) -> Scenario:
    # Files are read with libraries that options do not need.
    from blocksim.kinds.files import shipped_structures
    from blocksim.kinds.scenarios import load_scenario, shipped

    try:
        return load_scenario(scene)
    except InputError as error:
        if error.field != "scenario":
            raise
        near = perhaps(scene, [*shipped(), *shipped_structures(), *KINDS])
        raise InputError(error.field, error.value, error.allowed + near) from None


BY_ANGLE = {"half_angle_deg", "radius", "eta", "ratio"}
"""What an arch in metres is not made by."""
IN_METRES = " (or --span, --rise and --thickness, in m)"


def instead_of(friction: float | None, **thickness: float | None) -> str:
    """Say what may be given in the place of friction or of a thickness that is missing."""
    others = [] if friction is not None else ["--friction-angle"]
    others += ["--ratio" for value in thickness.values() if value is None]
    return f" (or {', '.join(others)})" if others else ""


def _require_ranges(given: Given) -> None:
    """Raise `InputError` where an option is out of range or beside one that says the same."""
    alpha = given.alpha
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
        flat = f"in degrees: {alpha:g} deg is nearly flat, in radians it would be "
        flat += f"{math.degrees(alpha):.4g} deg (a flat arch: --span and --rise)"
        require(alpha > math.pi, "--alpha", alpha, flat)
    if given.unit_weight is not None:
        require_unit_weight("--unit-weight", given.unit_weight)
    both = given.eta is not None and given.ratio is not None
    require(not both, "--ratio", given.ratio, "left out where --eta is given")
    both = given.thickness is not None and given.ratio is not None
    require(not both, "--ratio", given.ratio, "left out where --thickness is given")
    for name in list(given.measured)[:1]:
        beside = f"left out beside {option_of(name)}: give one or the other"
        refuse({"alpha": alpha, "eta": given.eta}, why=beside)


def _measured(asked: Scenario, given: Given) -> dict[str, Any]:
    """Return parameters of the arch, of which some have been measured."""
    table = dict(asked.given)
    if "span" not in table:
        table = {name: table[name] for name in table if name not in BY_ANGLE}
        table["weight"] = "sector"
    if given.ratio is not None:
        table |= {"ratio": given.ratio}
        table.pop("thickness", None)
    table |= given.measured
    require_given(span=table.get("span"), rise=table.get("rise"))
    with named_options():
        require_measured(table)
    return table


def _by_angle(asked: Scenario, given: Given) -> dict[str, Any]:
    """Return parameters of the arch, with another half-angle or thickness over radius."""
    table, alpha = dict(asked.given), given.alpha
    thickness = {"eta": given.eta, "ratio": given.ratio}
    if alpha is not None and "span" in table:
        # The line is no longer the one that was measured; the centreline stays.
        made = asked.maker if asked.has_thickness else asked.of(eta=ETA.low)
        table = {name: table[name] for name in table if name not in MEASURES}
        table["radius"] = made.radius
        if asked.has_thickness:
            table["eta"] = made.thickness / made.radius
    if alpha is not None:
        table["half_angle_deg"] = alpha
    for name, value in thickness.items():
        if value is not None:
            table = {key: table[key] for key in table if key not in THICK}
            table[name] = value
    return table


def joint_of(said: str, names: Sequence[str]) -> int:
    """Return the joint that is named so."""
    require(said in names, "--joint", said, f"one like {names[len(names) // 2]}")
    return names.index(said)
