"""What is asked about: a scenario, the options that override it, or options alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from blocksim.arch.asked import Scenario
from blocksim.arch.dimensions import (
    Dimensions,
    Line,
    require_measured,
    require_unit_weight,
)
from blocksim.arch.limit import least_thickness
from blocksim.ask.search import ETA_MAX
from blocksim.cli.options import Given, named_options, option_of, require_given
from blocksim.common.checks import FRICTION, is_number, require
from blocksim.common.errors import MISSING, InputError, perhaps
from blocksim.kinds import KINDS
from blocksim.kinds.circular import CircularArch

NO_SCENARIO = Scenario(
    name="",
    title="",
    source="",
    half_angle=math.pi / 2,
    mu=math.inf,
    voussoirs=27,
    weight="centreline",
    eta=None,
    line=None,
    radius=1.0,
    depth=1.0,
    specific_weight=20_000.0,
    lean=0.0,
    expected_modes=(),
    expected_eta=None,
    expected_verdict=None,
    quick=False,
)
"""Defaults of the options; half-angle and friction have none and are always replaced."""


ASIDE = 0.99
"""Thickness of a scenario that sets none, over its least: it collapses, in one mode."""


def question(
    scene: str | None, given: Given, *, thick: bool = False, **needed: object
) -> Scenario:
    """Merge a scenario, where there is one, with the options that override it.

    Parameters
    ----------
    scene : str or None
    given : Given
    thick : bool
        Whether a thickness has to be given where there is no scenario.
    needed : object
        Other options that have to be given, by name.
    """
    mu = given.friction
    if scene is None:
        given_mu = given.mu if given.friction_angle is None else given.friction_angle
        if given.measured:
            thickness = given.thickness if given.ratio is None else given.ratio
            thick_enough = {"thickness": thickness} if thick else {}
            require_given(
                instead_of(given_mu, **thick_enough),
                **needed,
                span=given.span,
                rise=given.rise,
                mu=given_mu,
                **thick_enough,
            )
        else:
            eta = given.eta if given.ratio is None else given.ratio
            thick_enough = {"eta": eta} if thick else {}
            instead = instead_of(given_mu, **thick_enough)
            if given.alpha is None:
                instead = IN_METRES
            require_given(instead, **needed, alpha=given.alpha, mu=given_mu, **thick_enough)
    require_given(**needed)
    no_kind = "left out: it is for kinds of structures"
    no_gaps = "left out: it closes gaps of a drawing, and this is an arch"
    require(given.tolerance is None, "--tolerance", given.tolerance, no_gaps)
    require(given.parameters is None, "--with", " ".join(given.parameters or ()), no_kind)
    _require_ranges(given)
    asked = NO_SCENARIO if scene is None else _scenario(scene)
    alpha, lean, heavy = given.alpha, given.lean, given.unit_weight
    changes: dict[str, object] = {
        "half_angle": None if alpha is None else math.radians(alpha),
        "mu": mu,
        "voussoirs": given.voussoirs,
        "depth": given.depth,
        "eta": given.eta,
        "specific_weight": None if heavy is None else 1000 * heavy,
        "lean": None if lean is None else math.radians(lean),
        "weight": given.weight,
    }
    found = {key: value for key, value in changes.items() if value is not None}
    return replace(asked, **{**_shape(asked, given), **found})


def _scenario(scene: str) -> Scenario:
    # Files are read with libraries that options do not need.
    from blocksim.arch.scenario import load_scenario, shipped
    from blocksim.kinds.files import shipped_structures

    try:
        return load_scenario(scene)
    except InputError as error:
        if error.field != "scenario":
            raise
        near = perhaps(scene, [*shipped(), *shipped_structures(), *KINDS])
        raise InputError(error.field, error.value, error.allowed + near) from None


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
    for name in ("alpha", "eta") if given.measured else ():
        allowed = (
            f"left out beside {option_of(next(iter(given.measured)))}: give one or the other"
        )
        require(getattr(given, name) is None, f"--{name}", getattr(given, name), allowed)


def _shape(asked: Scenario, given: Given) -> dict[str, object]:
    """Return what a scenario becomes with the shape given, where it has been measured."""
    if not given.measured:
        if asked.line is None or (given.alpha is None and given.eta is None):
            return {}
        if given.alpha is None and given.eta is not None and asked.eta is None:
            return {"radius": asked.line.mean_radius(given.eta)}
        # With another angle the line is no longer the one that was measured.
        return {"line": asked.line if given.alpha is None else None}
    known = {} if asked.line is None else vars(asked.line)
    if asked.line is not None and asked.eta is not None:
        known = {**known, "thickness": asked.eta * asked.radius}
    if given.ratio is not None:
        known.pop("thickness", None)
    merged: dict[str, Any] = {**known, **given.measured}
    thickness = merged.pop("thickness", None)
    require_given(span=merged.get("span"), rise=merged.get("rise"))
    with named_options():
        line = Line(**merged)
        require_measured(line, thickness)
        changes: dict[str, object] = {"line": line, "half_angle": line.half_angle}
        if asked.line is None:
            changes["weight"] = "sector"
        if thickness is None:
            return {**changes, "eta": None, "radius": line.radius}
        found = Dimensions(**merged, thickness=thickness)
        return {**changes, "eta": found.eta, "radius": found.radius}


def maker_of(asked: Scenario, ratio: float | None) -> CircularArch:
    """Return the arch asked about.

    At a share of the least thickness as built where that is given, else at the scenario's
    thickness, else at `ASIDE` of the least.
    """
    with named_options():
        if asked.eta is not None and ratio is None:
            return _made(asked, asked.eta)
        FRICTION.require("mu", asked.mu)
        # Checked by the arch before anything is made of them.
        asked.arch(1.0)
        arch = asked.half_angle, asked.mu, asked.voussoirs, asked.weight
        least = least_thickness(*arch).eta
        if not least:
            why = "no thickness up to 2 stands" if least is None else "any thickness stands"
            field = "--eta" if ratio is None else "--ratio"
            value = MISSING if ratio is None else ratio
            allowed = "given" if ratio is None else "left out for --eta"
            raise InputError(field, value, f"{allowed}: {why} here")
        eta = (ratio or ASIDE) * least
        if ratio is not None:
            require(eta <= ETA_MAX, "--ratio", ratio, f"at most {ETA_MAX / least:.6g}, eta = 2")
        return _made(asked, eta)


def of_any_thickness(asked: Scenario) -> CircularArch:
    """Return the arch asked about, of which the thickness is sought."""
    with named_options():
        return _made(asked, 1.0 if asked.eta is None else asked.eta)


def _made(asked: Scenario, eta: float) -> CircularArch:
    """Make an arch by the line that was measured, else by its half-angle and radius."""
    shape: dict[str, Any] = {"half_angle": asked.half_angle, "radius": asked.radius}
    if asked.line is not None:
        shape = vars(asked.line)
    asked.arch(eta)
    FRICTION.require("mu", asked.mu)
    return CircularArch(
        **shape,
        eta=eta,
        voussoirs=asked.voussoirs,
        weight=asked.weight,
        depth=asked.depth,
        density=asked.specific_weight,
        friction=asked.mu,
    )


def thickness_notes(asked: Scenario, ratio: float | None) -> tuple[str, ...]:
    """Say which thickness was taken where none was given."""
    if asked.eta is not None or ratio is not None:
        return ()
    return (f"no thickness was given, so it is {ASIDE:g} of the least as built",)


def joint_of(said: str, names: Sequence[str]) -> int:
    """Return the joint that is named so."""
    require(said in names, "--joint", said, f"one like {names[len(names) // 2]}")
    return names.index(said)
