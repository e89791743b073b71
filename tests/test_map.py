"""The map as an object: regions, ties, inverse look-up and special angles."""

import math

import exact
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blocksim import Mode
from blocksim.arch.theory import landmarks, least_thickness, least_thicknesses, regions
from blocksim.arch.theory.map import (
    at_points,
    divide_friction,
    iso_half_angle,
    special_angles,
)

WEIGHTS = ("centreline", "sector")


def test_special_angles_as_published() -> None:
    found = special_angles()
    assert found.hinge == pytest.approx(1.129085087576187, rel=1e-13)
    assert found.widest_hinge == pytest.approx(2.230312828619947, rel=1e-13)
    assert found.zero_thrust == pytest.approx(2.648388899151005, rel=1e-13)
    assert found.limit == pytest.approx(2.786498150651177, rel=1e-13)


def test_special_angles_of_the_sector() -> None:
    """alpha_L of the sector is alpha_l of the centreline: A = 2/3 in both (sector.md, S9)."""
    found = special_angles("sector")
    assert found.limit == pytest.approx(special_angles().zero_thrust, rel=1e-14)
    near = np.array([found.widest_hinge - 1e-4, found.widest_hinge, found.widest_hinge + 1e-4])
    hinges = least_thicknesses(near, math.inf, "sector").beta_r
    assert hinges[1] == pytest.approx(found.hinge, abs=1e-12)
    assert hinges[1] > max(hinges[0], hinges[2])


@pytest.mark.parametrize("weight", WEIGHTS)
def test_the_rotational_mode_ends_in_r(weight: str) -> None:
    """At alpha_l itself the hinge is at the crown: purely overturning, r alone (Fig. 25)."""
    beside = special_angles(weight).zero_thrust + np.array([-1e-9, 0, 1e-9])
    names = [least_thicknesses(angle, math.inf, weight).names for angle in beside]
    assert names == [(Mode.RRR,), (Mode.R,), (Mode.R,)]


@pytest.mark.parametrize(
    ("eta", "mu", "mode"),
    [
        (0.3, 2.0, "rrr"),
        (0.3, 0.3, "ss"),
        (1.5, 1.0, "ss"),
        (0.3, 0.6, "srr"),
        (0.85, 2.5, "rrs"),
        (0.963, 1.79, "rsr"),
        (1.4, 3.0, "rs"),
        (1.4, math.inf, "r"),
        (0.7, math.inf, "rrr"),
        (1e-9, 0.2, "rrr"),
    ],
)
def test_regions_of_fig_9(eta: float, mu: float, mode: str) -> None:
    assert at_points(eta, mu).regions.item() == (Mode(mode),)


@pytest.mark.parametrize("weight", WEIGHTS)
def test_landmarks_belong_to_all_their_regions(weight: str) -> None:
    around = {"T": 4, "S": 3, "J": 3, "B": 2}
    for name, mark in landmarks(weight).items():
        point = at_points(mark.eta, mark.mu, weight)
        assert len(point.regions[()]) == around[name], name
        assert float(point.half_angle) == pytest.approx(mark.half_angle, abs=1e-11)


def test_beside_the_lines() -> None:
    """A billionth beside a line is on its own side; on it, both sides are named."""
    alpha = np.array([1.0, 2.4])
    first = regions.first_sliding(alpha)
    on = at_points(first.eta, first.mu)
    assert all({Mode.RRR, Mode.SRR} == set(names) for names in on.regions)
    assert all(names == (Mode.RRR,) for names in at_points(first.eta, first.mu + 1e-9).regions)
    assert all(names == (Mode.SRR,) for names in at_points(first.eta, first.mu - 1e-9).regions)
    mu = np.array([0.5, 2.2])
    divide = regions.divide(mu)
    assert all(Mode.SS in names for names in at_points(divide.eta, mu).regions)
    assert all(names == (Mode.SS,) for names in at_points(divide.eta, mu - 1e-9).regions)
    assert all(Mode.SS not in names for names in at_points(divide.eta, mu + 1e-9).regions)
    mu = np.array([1.9])
    equal = regions.equal_angles(mu).eta
    assert all({Mode.RRS, Mode.RSR} == set(names) for names in at_points(equal, mu).regions)
    assert all(names == (Mode.RRS,) for names in at_points(equal - 1e-9, mu).regions)
    assert all(names == (Mode.RSR,) for names in at_points(equal + 1e-9, mu).regions)
    crown = regions.crown_hinge(mu).eta
    assert all({Mode.RS, Mode.RSR} >= set(names) for names in at_points(crown, mu).regions)
    assert all(names == (Mode.RSR,) for names in at_points(crown - 1e-9, mu).regions)
    assert all(names == (Mode.RS,) for names in at_points(crown + 1e-9, mu).regions)


@given(
    half_angle=st.floats(0.05, 2.75),
    friction_angle=st.floats(0.02, math.pi / 2),
    weight=st.sampled_from(WEIGHTS),
)
@settings(max_examples=15, deadline=None)
def test_look_up_inverts_least_thickness(
    half_angle: float, friction_angle: float, weight: str
) -> None:
    mu = math.tan(friction_angle)
    critical = least_thickness(half_angle, mu, weight)
    if critical.eta is None or critical.eta > 1.99:
        return
    there = at_points(critical.eta, mu, weight).half_angle
    assert float(there) == pytest.approx(half_angle, rel=1e-7)


def test_iso_lines_and_divide() -> None:
    alpha = math.radians(125)
    assert divide_friction(alpha) == pytest.approx(0.8477497839674316, rel=1e-13)
    # Flat arches: mu -> alpha^3/12, from expanding eqs (8) and (9).
    assert divide_friction(0.01) == pytest.approx(0.01**3 / 12, rel=1e-4)
    line = iso_half_angle(alpha, np.linspace(0.1, 4, 200))
    assert line.mu.min() > divide_friction(alpha)
    assert (np.diff(line.eta) <= 0).all()
    # Fig. 13: constant from the line of first sliding on.
    assert line.eta[-1] == pytest.approx(0.3849612500740051, rel=1e-13)
    assert iso_half_angle(3.0, np.array([1.0, math.inf])).mu.size == 0


@pytest.mark.parametrize("mu", [1e-9, 0.3, 1.0, 3.0, 1e8, 1e12, 1e300])
def test_the_divide_for_any_friction(mu: float) -> None:
    """From (8) and (9) in 50 digits; beyond 1e8 it is pi within round-off of 1/mu."""
    found = regions.divide_half_angle(mu)
    if mu < 1e8:
        assert found == pytest.approx(float(exact.divide_half_angle(mu, found)), rel=1e-12)
    else:
        assert math.pi - found == pytest.approx(1 / mu, abs=5e-16, rel=1e-3)
