"""The map as a whole: what must hold wherever one looks.

The least thickness grows as friction falls; the mode changes only across a line of the map,
computed apart; many voussoirs converge to it, with both weights and in every mode; and
nothing breaks at the ends of the ranges.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from blocksim import InputError, Mode, theory
from blocksim.arch import limit
from blocksim.arch.theory import rotation
from blocksim.arch.theory.arrays import BIT
from blocksim.arch.theory.equations import inner_friction, shoulder_friction
from blocksim.arch.theory.regions import at_inner_sliding

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
    if theory.divide_half_angle(mu) < alpha:
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
    if mu > landmarks["J"].mu and eta > theory.crown_hinge(np.array([mu]), weight).eta[0]:
        return Mode.RS
    if mu > landmarks["S"].mu and eta > theory.equal_angles(np.array([mu]), weight).eta[0]:
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


WEIGHTS = ("centreline", "sector")


def domain(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    half_angle = np.concatenate(
        [random.uniform(0.2, 3.1, count // 2), random.uniform(2.4, 2.8, count - count // 2)]
    )
    return half_angle, np.tan(random.uniform(0.02, math.pi / 2, count))


@pytest.mark.parametrize("weight", WEIGHTS)
def test_agrees_with_the_scalar(weight: str) -> None:
    half_angle, mu = domain(400, 2)
    found = theory.least_thicknesses(half_angle, mu, weight)
    fields = ("eta", "thrust", "beta_s", "beta_r")
    for i, (a, m) in enumerate(zip(half_angle.tolist(), mu.tolist(), strict=True)):
        one = theory.least_thickness(a, m, weight)
        assert found.mode[i] == one.mode.value, (a, m)
        for many, single in ((getattr(found, each)[i], getattr(one, each)) for each in fields):
            # The hinge is where something is flat: it is known less well.
            near = math.isnan(many) if single is None else abs(many - single) <= 1e-12
            assert near, (a, m)


def test_flat_arches_keep_their_digits() -> None:
    """As alpha -> 0: eta = alpha^4/48 and beta_r = alpha/sqrt(2), alpha^2 apart."""
    half_angle = np.array([1e-2, 1e-4, 1e-8, 1e-12])
    found = theory.least_thicknesses(half_angle, 1.0)
    small = 3 * half_angle**2
    assert (np.abs(48 * found.eta / half_angle**4 - 1) <= small + 1e-12).all()
    assert (np.abs(found.beta_r * math.sqrt(2) / half_angle - 1) <= small + 1e-12).all()


@pytest.mark.parametrize("weight", WEIGHTS)
def test_limits(weight: str) -> None:
    angles = [1e-12, 1e-6, 0.5, math.pi / 2, 2.3, 2.59, 2.648, 2.7, 2.8]
    angles.append(math.nextafter(math.pi, 0))
    frictions = [1e-300, 1e-12, 1e-3, 1.0, np.nextafter(1, 2), 3.0, 1e9, 1e300, math.inf]
    found = theory.least_thicknesses(np.array(angles)[:, None], np.array(frictions), weight)
    stands = ~np.isnan(found.eta)
    assert (found.modes > 0).all()
    assert ((found.eta > 0) & (found.eta <= 2))[stands].all()
    assert (found.thrust >= 0)[stands].all()
    assert (found.beta_r >= 0)[stands].all()
    assert not stands[-1].any()
    # Far to the right mu no longer matters, and r is there at mu = inf only.
    np.testing.assert_allclose(found.eta[:, -2], found.eta[:, -1], rtol=1e-7)
    assert (found.modes[3:6, -1] & (BIT[Mode.RRR] | BIT[Mode.R]) > 0).all()


@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("half_angle", ([0.5, math.pi], 1.0)),
        ("half_angle", (math.nan, 1.0)),
        ("mu", (1.0, [0.5, 0.0])),
        ("weight", (1.0, 1.0, "stone")),
    ],
)
def test_wrong_input_is_named(field: str, values: tuple) -> None:
    with pytest.raises(InputError, match=field):
        theory.least_thicknesses(*values)


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_the_rotational_mode_that_is_read_is_the_one_that_is_solved(weight: str) -> None:
    stored, solved = rotation._rotational(weight), rotation.solved(weight)
    assert stored.widest == pytest.approx(solved.widest, rel=1e-15)
    for one, other in zip(stored.pieces, solved.pieces, strict=True):
        assert one == pytest.approx(other, abs=2e-14)


def test_special_angles_of_the_sector() -> None:
    """alpha_L of the sector is alpha_l of the centreline: A = 2/3 in both (sector.md, S9)."""
    found = theory.special_angles("sector")
    assert found.limit == pytest.approx(theory.special_angles().zero_thrust, rel=1e-14)
    near = np.array([found.widest_hinge - 1e-4, found.widest_hinge, found.widest_hinge + 1e-4])
    hinges = theory.least_thicknesses(near, math.inf, "sector").beta_r
    assert hinges[1] == pytest.approx(found.hinge, abs=1e-12)
    assert hinges[1] > max(hinges[0], hinges[2])


@pytest.mark.parametrize("weight", WEIGHTS)
def test_the_rotational_mode_ends_in_r(weight: str) -> None:
    """At alpha_l itself the hinge is at the crown: purely overturning, r alone (Fig. 25)."""
    beside = theory.special_angles(weight).zero_thrust + np.array([-1e-9, 0, 1e-9])
    names = [theory.least_thicknesses(angle, math.inf, weight).names for angle in beside]
    assert names == [(Mode.RRR,), (Mode.R,), (Mode.R,)]


def test_beside_the_lines() -> None:
    """A billionth beside a line is on its own side; on it, both sides are named."""

    def named(eta: np.ndarray, mu: np.ndarray) -> list[set[Mode]]:
        return [{*names} for names in theory.at_points(eta, mu).regions]

    first = theory.first_sliding(np.array([1.0, 2.4]))
    assert named(first.eta, first.mu) == [{Mode.RRR, Mode.SRR}] * 2
    assert named(first.eta, first.mu + 1e-9) == [{Mode.RRR}] * 2
    assert named(first.eta, first.mu - 1e-9) == [{Mode.SRR}] * 2
    mu = np.array([0.5, 2.2])
    divide = theory.divide(mu).eta
    assert all(Mode.SS in names for names in named(divide, mu))
    assert named(divide, mu - 1e-9) == [{Mode.SS}] * 2
    assert all(Mode.SS not in names for names in named(divide, mu + 1e-9))
    mu = np.array([1.9])
    equal, crown = theory.equal_angles(mu).eta, theory.crown_hinge(mu).eta
    assert named(equal, mu) == [{Mode.RRS, Mode.RSR}]
    assert named(equal - 1e-9, mu) == [{Mode.RRS}]
    assert named(equal + 1e-9, mu) == named(crown - 1e-9, mu) == [{Mode.RSR}]
    assert all({Mode.RS, Mode.RSR} >= names for names in named(crown, mu))
    assert named(crown + 1e-9, mu) == [{Mode.RS}]


@given(
    half_angle=st.floats(0.05, 2.75),
    friction_angle=st.floats(0.02, math.pi / 2),
    weight=st.sampled_from(WEIGHTS),
)
def test_look_up_inverts_least_thickness(
    half_angle: float, friction_angle: float, weight: str
) -> None:
    mu = math.tan(friction_angle)
    critical = theory.least_thickness(half_angle, mu, weight)
    if critical.eta is None or critical.eta > 1.99:
        return
    there = theory.at_points(critical.eta, mu, weight).half_angle
    assert float(there) == pytest.approx(half_angle, rel=1e-7)


def test_iso_lines_and_divide() -> None:
    alpha = math.radians(125)
    assert theory.divide_friction(alpha) == pytest.approx(0.8477497839674316, rel=1e-13)
    # Flat arches: mu -> alpha^3/12, from expanding eqs (8) and (9).
    assert theory.divide_friction(0.01) == pytest.approx(0.01**3 / 12, rel=1e-4)
    line = theory.iso_half_angle(alpha, np.linspace(0.1, 4, 200))
    assert line.mu.min() > theory.divide_friction(alpha)
    assert (np.diff(line.eta) <= 0).all()
    # Fig. 13: constant from the line of first sliding on.
    assert line.eta[-1] == pytest.approx(0.3849612500740051, rel=1e-13)
    assert theory.iso_half_angle(3.0, np.array([1.0, math.inf])).mu.size == 0


@pytest.mark.parametrize("mu", [1e8, 1e12, 1e300])
def test_the_divide_at_much_friction(mu: float) -> None:
    """Beyond 1e8 it is pi within round-off of 1/mu; with less it is in `test_precision`."""
    found = theory.divide_half_angle(mu)
    assert math.pi - found == pytest.approx(1 / mu, abs=5e-16, rel=1e-3)
