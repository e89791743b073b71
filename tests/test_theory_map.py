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
from blocksim.arch.theory.critical import inner_sliding
from blocksim.arch.theory.equations import inner_friction, shoulder_friction
from blocksim.arch.theory.regions import (
    at_inner_sliding,
    crown_hinge,
    divide,
    divide_half_angle,
    equal_angles,
    first_sliding,
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


@settings(max_examples=40)
@given(angles, st.floats(1.0, 1.5), st.one_of(frictions, st.just(math.inf)), weights)
def test_a_wider_arch_asks_for_more(alpha: float, ratio: float, mu: float, weight: str) -> None:
    wide = min(alpha * ratio, 3.14)
    narrow = theory.least_thickness(alpha, mu, weight).eta
    wider = theory.least_thickness(wide, mu, weight).eta
    assert (wider or math.inf) >= (narrow or math.inf) * (1 - 1e-12)


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


@pytest.mark.parametrize("weight", ["centreline", "sector"])
@pytest.mark.parametrize("degrees", [60, 90, 120, 135, 143, 145, 147])
def test_modes_follow_one_another_from_right_to_left(degrees: float, weight: str) -> None:
    """On a line of constant alpha, from rrr to ss through srr below T or rrs above it."""
    alpha = math.radians(degrees)
    above = alpha > theory.landmarks(weight)["T"].half_angle
    orders = {
        False: [Mode.RRR, Mode.SRR, Mode.SS],
        True: [Mode.RRR, Mode.RRS, Mode.RSR, Mode.RS, Mode.SS],
    }
    seen: list[Mode] = []
    for mu in np.geomspace(20, 0.02, 60):
        mode = theory.least_thickness(alpha, float(mu), weight).mode
        if not seen or seen[-1] is not mode:
            seen.append(mode)
    order = orders[above]
    assert seen[0] is Mode.RRR
    assert seen[-1] is Mode.SS
    assert seen == [mode for mode in order if mode in seen]


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_lines_end_at_the_landmarks(weight: str) -> None:
    points = theory.landmarks(weight)
    for name, point in points.items():
        assert divide(np.array([point.mu]), weight).eta == pytest.approx([point.eta]), name
        assert divide_half_angle(point.mu) == pytest.approx(point.half_angle)
    first = first_sliding(np.array([points["T"].half_angle]), weight)
    assert first.mu == pytest.approx([points["T"].mu], rel=1e-10)
    # Just right of S and J the lines start there: their mu is a limit, not a value.
    for name, line in (("S", equal_angles), ("J", crown_hinge)):
        near = line(np.array([points[name].mu * (1 + 1e-9)]), weight)
        assert near.eta == pytest.approx([points[name].eta], rel=1e-6)


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


@settings(max_examples=40)
@given(frictions)
def test_inner_sliding_solves_its_equation(mu: float) -> None:
    """(9) in its plain form, though the solver uses Kepler's."""
    thrust, beta = inner_sliding(mu)
    assert 0 < thrust < 1
    assert beta == pytest.approx(math.sqrt(thrust * (1 - thrust)), rel=1e-12)
    assert inner_friction(thrust) == pytest.approx(mu, rel=1e-9)


@pytest.mark.parametrize(
    ("mu", "power", "factor"), [(1e-3, 2, None), (1e3, -2, 0.25), (1e5, -2, 0.25)]
)
def test_inner_sliding_far_out(mu: float, power: int, factor: float | None) -> None:
    """Large friction: h -> 1/(4 mu^2). Small friction: E of Kepler's equation is small."""
    thrust, _ = inner_sliding(mu)
    if factor:
        assert thrust == pytest.approx(factor * mu**power, rel=3 / mu)
    else:
        # E - sin E = E^3/6 = 2 mu and 1 - h = sin^2(E/2) = E^2/4.
        assert 1 - thrust == pytest.approx((12 * mu) ** (2 / 3) / 4, rel=0.02)


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


def test_overturning_in_closed_form() -> None:
    """(3) with h = 0: eta = 2/A - 2 for every arch past alpha_l at unbounded friction."""
    for alpha in np.linspace(2.6484, 2.7864, 20):
        found = theory.least_thickness(float(alpha), math.inf)
        assert found.modes == (Mode.R,)
        assert found.thrust == pytest.approx(0, abs=1e-15)
        assert found.eta == pytest.approx(2 * math.tan(alpha / 2) / alpha - 2, rel=1e-12)


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
