"""The map as a whole: what must hold wherever one looks.

The least thickness grows as friction falls; the mode changes only across a line of the map,
computed apart; many voussoirs converge to it, with both weights and in every mode; and
nothing breaks at the ends of the ranges.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from blocksim import InputError, Mode
from blocksim.arch import limit, theory
from blocksim.arch.theory.equations import inner_friction, shoulder_friction
from blocksim.arch.theory.regions import (
    at_inner_sliding,
    crown_hinge,
    divide_half_angle,
    equal_angles,
)
from blocksim.arch.theory.sliding import thrust_intervals

angles = st.floats(math.radians(2), math.radians(178))
frictions = st.floats(0.02, 50.0)
weights = st.sampled_from(["centreline", "sector"])


@settings(max_examples=40)
@given(angles, frictions, st.floats(1.0, 5.0), weights)
def test_less_friction_asks_for_more(
    alpha: float, mu: float, ratio: float, weight: str
) -> None:
    low = theory.least_thickness(alpha, mu, weight).eta
    high = theory.least_thickness(alpha, mu * ratio, weight).eta
    unbounded = theory.least_thickness(alpha, math.inf, weight).eta
    assert (low or math.inf) >= (high or math.inf) * (1 - 1e-12)
    assert (high or math.inf) >= (unbounded or math.inf) * (1 - 1e-12)


def region(alpha: float, mu: float, weight: str) -> Mode:
    """Mode by the side of every line on which the arch lies, none of it from the solver."""
    if divide_half_angle(mu) < alpha:
        return Mode.SS
    thrust = theory.critical.rotational_thrust(alpha, weight)
    if thrust > 0:
        shoulder, inner = float(shoulder_friction(alpha, thrust)), float(inner_friction(thrust))
        if max(shoulder, inner) < mu:
            return Mode.RRR
        if shoulder > inner:
            return Mode.SRR
    eta, _ = at_inner_sliding(mu, alpha, weight)
    landmarks = theory.landmarks(weight)
    if mu > landmarks["J"].mu and eta > crown_hinge(np.array([mu]), weight).eta[0]:
        return Mode.RS
    if mu > landmarks["S"].mu and eta > equal_angles(np.array([mu]), weight).eta[0]:
        return Mode.RSR
    return Mode.RRS


@settings(max_examples=40)
@given(st.floats(1.2, 2.79), st.floats(0.2, 6.0), weights)
def test_mode_is_that_of_the_region(alpha: float, mu: float, weight: str) -> None:
    found = theory.least_thickness(alpha, mu, weight)
    assume(len(found.modes) == 1)
    # Where no thickness up to 2 stands to the right of the divide, no region has a name.
    assume(found.eta is not None or found.mode is Mode.SS)
    assert found.mode is region(alpha, mu, weight)


def distance_to_a_tie(alpha: float, mu: float, weight: str) -> bool:
    """Whether a change of friction or angle by 2 % leaves the mode as it is."""
    modes = {
        theory.least_thickness(alpha * a, mu * m, weight).mode
        for a in (0.98, 1.0, 1.02)
        for m in (0.97, 1.0, 1.03)
    }
    return len(modes) == 1


@settings(max_examples=40)
@given(
    st.floats(math.radians(25), math.radians(157)),
    st.floats(0.1, 8.0),
    weights,
    st.integers(100, 200),
)
def test_many_voussoirs_converge_to_the_closed_form(
    alpha: float, mu: float, weight: str, count: int
) -> None:
    exact = theory.least_thickness(alpha, mu, weight)
    assume(distance_to_a_tie(alpha, mu, weight))
    built = limit.least_thickness(alpha, mu, count, weight)
    if exact.eta is None:
        assert built.eta is None
        return
    assert built.eta == pytest.approx(exact.eta, rel=30 / count**2)
    assert built.eta <= exact.eta * (1 + 1e-9)
    assert built.thrust == pytest.approx(exact.thrust, abs=60 / count**2)
    if exact.mode is not Mode.RSR:  # so thin a region that one voussoir spans it
        assert built.mode is exact.mode
    spacing = 2 * alpha / count
    if exact.mode in {Mode.RRR, Mode.SRR, Mode.RRS} and exact.beta_r > 5 * spacing:
        assert built.hinges_intrados[-1] == pytest.approx(exact.beta_r, abs=2 * spacing)


@pytest.mark.parametrize("weight", ["centreline", "sector"])
@pytest.mark.parametrize("mu", [1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e9, math.inf])
@pytest.mark.parametrize(
    "alpha", [1e-3, 0.1, 1.0, math.pi / 2, 2.7, 3.0, math.pi - 1e-3, math.pi - 1e-9]
)
def test_ends_of_the_ranges(alpha: float, mu: float, weight: str) -> None:
    found = theory.least_thickness(alpha, mu, weight)
    for value in (found.eta, found.thrust, found.beta_r, found.beta_s):
        assert value is None or math.isfinite(value)
    # eta goes as alpha^4/48.
    assert found.eta is None or 1e-15 <= found.eta <= 2
    assert found.modes
    for bound in thrust_intervals(np.array([alpha]), np.array([mu]))[:2]:
        assert not np.isnan(bound).any()


def test_shallow_arch() -> None:
    """Small angles, derived here: eta = alpha^4/48, beta_r = alpha/sqrt 2, h = 1 - alpha^2/6.

    To the fourth order the line of thrust is off the mean line by
    const + (h - 1) x^2/2 + x^4/12. The even quartic of least range on [0, alpha] is
    Chebyshev's: equal at 0 and alpha, extreme at alpha/sqrt 2, of range alpha^4/48.
    The departure from it is of relative order alpha^2.
    """
    errors = []
    for alpha in (0.4, 0.2, 0.1):
        found = theory.least_thickness(alpha, math.inf)
        errors.append(
            [
                1 - found.eta * 48 / alpha**4,
                1 - found.beta_r * math.sqrt(2) / alpha,
                1 - (1 - found.thrust) * 6 / alpha**2,
            ]
        )
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert ratios == pytest.approx(np.full((2, 3), 4.0), rel=0.05)


@pytest.mark.parametrize(
    ("field", "alpha", "mu", "weight"),
    [
        ("half_angle", 0.0, 1.0, "centreline"),
        ("half_angle", math.pi, 1.0, "centreline"),
        ("half_angle", math.nan, 1.0, "centreline"),
        ("mu", 1.0, 0.0, "centreline"),
        ("mu", 1.0, -math.inf, "centreline"),
        ("mu", 1.0, math.nan, "centreline"),
        ("mu", 1.0, "0.7", "centreline"),
        ("weight", 1.0, 1.0, "milankovitch"),
    ],
)
def test_wrong_values(field: str, alpha: float, mu: float, weight: str) -> None:
    with pytest.raises(InputError) as caught:
        theory.least_thickness(alpha, mu, weight)
    assert caught.value.field == field
