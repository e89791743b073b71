"""What is asked about: a scenario, the options that override it, or options alone."""

from __future__ import annotations

import math
from dataclasses import replace

from blocksim.arch.circular import Arch
from blocksim.arch.limit import least_thickness
from blocksim.arch.scenario import Scenario, load_scenario
from blocksim.ask.search import ETA_MAX
from blocksim.cli.options import Given, named_options, require_given
from blocksim.common.checks import is_number, require, require_friction
from blocksim.common.errors import MISSING, InputError

NO_SCENARIO = Scenario(
    name="",
    title="",
    source="",
    half_angle=math.pi / 2,
    mu=math.inf,
    voussoirs=27,
    weight="centreline",
    eta=None,
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
    if scene is None:
        eta = given.eta if given.ratio is None else given.ratio
        thickness = {"eta": eta} if thick else {}
        require_given(**needed, alpha=given.alpha, mu=given.mu, **thickness)
    require_given(**needed)
    no_kind = "left out: it is for kinds of structures"
    require(given.parameters is None, "--with", " ".join(given.parameters or ()), no_kind)
    alpha, lean, depth = given.alpha, given.lean, given.depth
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
    if lean is not None:
        ok = is_number(lean, -90, math.nextafter(90, 0))
        require(ok, "--lean", lean, "above -90 and below 90 deg")
    both = given.eta is not None and given.ratio is not None
    require(not both, "--ratio", given.ratio, "left out where --eta is given")
    asked = load_scenario(scene) if scene is not None else NO_SCENARIO
    changes: dict[str, object] = {
        "half_angle": None if alpha is None else math.radians(alpha),
        "mu": given.mu,
        "voussoirs": given.voussoirs,
        "weight": given.weight,
        "depth": depth,
        "eta": given.eta,
        "lean": None if lean is None else math.radians(lean),
    }
    return replace(asked, **{key: value for key, value in changes.items() if value is not None})


def arch_of(asked: Scenario, ratio: float | None) -> Arch:
    """Return the arch asked about.

    At a share of the least thickness as built where that is given, else at the scenario's
    thickness, else at `ASIDE` of the least.
    """
    with named_options():
        if asked.eta is not None and ratio is None:
            return asked.arch(asked.eta)
        if ratio is not None:
            require(is_number(ratio, 0, 100), "--ratio", ratio, "above 0 and at most 100")
        require_friction(asked.mu)
        # Checked by the arch before anything is made of them.
        asked.arch(1.0)
        arch = asked.half_angle, asked.mu, asked.voussoirs, asked.weight
        least = least_thickness(*arch).eta
        if least is None:
            field = "--eta" if ratio is None else "--ratio"
            value = MISSING if ratio is None else ratio
            allowed = "given" if ratio is None else "left out for --eta"
            raise InputError(field, value, f"{allowed}: no thickness up to 2 stands here")
        eta = (ratio or ASIDE) * least
        if ratio is not None:
            require(eta <= ETA_MAX, "--ratio", ratio, f"at most {ETA_MAX / least:.6g}, eta = 2")
        return asked.arch(eta)


def thickness_words(asked: Scenario, ratio: float | None) -> str:
    """Say which thickness was taken where none was given, to be added to a reason."""
    if asked.eta is not None or ratio is not None:
        return ""
    return f"; no thickness was given, so it is {ASIDE:g} of the least as built"
