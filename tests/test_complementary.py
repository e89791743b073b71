"""Eqs (15) and (16) on voussoirs: thickness and modes are those that the paper prints."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from blocksim import Mode
from blocksim.arch.limit.complementary import complementary, joints_through
from blocksim.arch.theory import least_thickness
from blocksim.arch.theory.critical import inner_sliding

PRINTED = tomllib.loads(
    (Path(__file__).parent / "validation" / "cocchetti_rizzi_2024.toml").read_text("utf-8")
)


def arches() -> dict[tuple[float, float], tuple[float, set[str]]]:
    """Printed arches by half-angle and friction: thickness, and all modes of captions."""
    found: dict[tuple[float, float], tuple[float, set[str]]] = {}
    for each in PRINTED["captions"]:
        alpha = each.get("alpha") or math.radians(each["alpha_deg"])
        _, modes = found.setdefault((alpha, each["mu"]), (each["eta"], set()))
        modes.add(each["mode"])
    return found


ARCHES = [(*place, *said) for place, said in arches().items()]


@pytest.mark.parametrize(("alpha", "mu", "eta", "modes"), ARCHES)
def test_modes_are_those_that_captions_name(
    alpha: float, mu: float, eta: float, modes: set[str]
) -> None:
    exact = least_thickness(alpha, mu)
    places = [exact.beta_r or 0.0, *([inner_sliding(mu)[1]] if math.isfinite(mu) else [])]
    angles = joints_through(alpha, places, 30)
    found = complementary(angles, exact.eta or eta, mu)
    # At equal angles one joint does both: the paper counts it to either mode.
    names = (
        {"rrs", "rsr"} if modes == {"rrs", "rsr"} else {str(each.mode) for each in found.modes}
    )
    if modes == {"rrs", "rsr"}:
        assert [each.mode for each in found.modes] == [Mode.RRS]
    assert names == modes | ({"srr"} if modes == {"ss"} else set())
    assert abs(found.extra_strength) < 1e-14
    assert found.strength.max() < 1e-14
    for each in found.modes:
        assert abs(each.product) < 1e-14
        assert each.collapse.rates.min() >= 0
        assert each.collapse.rates.sum() == pytest.approx(1, abs=1e-12)
        # What the mechanism does at the last joint brings it back to the springing's rest.
        last = each.collapse.motions[-1] + each.collapse.motions[0] * [1, -1, 1]
        assert np.abs(last).max() < 1e-9
    # With any less than the printed thickness these voussoirs lack strength.
    assert complementary(angles, eta * (1 - 1e-11), mu).extra_strength > 2e-14
    assert complementary(angles, eta, mu).extra_strength < 1e-14


def test_joints_are_where_they_are_wanted() -> None:
    angles = joints_through(2.0, [0.3, 1.1], 30)
    assert {0.0, 0.3, 1.1, 2.0} <= set(angles.tolist())
    widths = np.diff(angles)
    assert widths.max() / widths.min() < 1.3
    assert 28 <= 2 * len(angles) - 2 <= 32
    # Places that coincide, with each other or with an end, are one joint.
    again = joints_through(2.0, [0.3, 0.3 + 1e-9, 1e-9, 2.0 - 1e-9], 30)
    assert np.diff(again).min() > 0.05


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_beside_the_least_thickness_nothing_is_named(share: float) -> None:
    """Below it some strength is lacking; above it there is some to spare."""
    alpha, mu, eta = math.radians(125), 0.9, 0.4208869235292454
    found = complementary(np.linspace(0, alpha, 16), share * eta, mu)
    assert found.modes == ()
    assert (found.extra_strength > 0) is (share < 1)
