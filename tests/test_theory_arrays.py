"""Arrays against the scalar closed form, published constants and the map's properties."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blocksim import InputError, Mode
from blocksim.arch.theory import least_thickness, least_thicknesses, rotation
from blocksim.arch.theory.arrays import BIT

WEIGHTS = ("centreline", "sector")


def domain(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    half_angle = np.concatenate(
        [random.uniform(0.2, 3.1, count // 2), random.uniform(2.4, 2.8, count - count // 2)]
    )
    return half_angle, np.tan(random.uniform(0.02, math.pi / 2, count))


def compare(count: int, weight: str) -> None:
    half_angle, mu = domain(count, 2)
    found = least_thicknesses(half_angle, mu, weight)
    names = found.mode
    for i, (a, m) in enumerate(zip(half_angle.tolist(), mu.tolist(), strict=True)):
        one = least_thickness(a, m, weight)
        assert names[i] == one.mode.value, (a, m)
        for values, single in (
            (found.eta, one.eta),
            (found.thrust, one.thrust),
            (found.beta_s, one.beta_s),
            (found.beta_r, one.beta_r),
        ):
            if single is None:
                assert math.isnan(values[i]), (a, m)
            else:
                # The hinge is where something is flat: it is known less well.
                assert abs(values[i] - single) <= 1e-12, (a, m)


@pytest.mark.parametrize("weight", WEIGHTS)
def test_agrees_with_the_scalar(weight: str) -> None:
    compare(400, weight)


def test_flat_arches_keep_their_digits() -> None:
    """As alpha -> 0: eta = alpha^4/48 and beta_r = alpha/sqrt(2), alpha^2 apart."""
    half_angle = np.array([1e-2, 1e-4, 1e-8, 1e-12])
    found = least_thicknesses(half_angle, 1.0)
    small = 3 * half_angle**2
    assert (np.abs(48 * found.eta / half_angle**4 - 1) <= small + 1e-12).all()
    assert (np.abs(found.beta_r * math.sqrt(2) / half_angle - 1) <= small + 1e-12).all()


@pytest.mark.parametrize("weight", WEIGHTS)
def test_limits(weight: str) -> None:
    angles = [
        1e-12,
        1e-6,
        0.5,
        math.pi / 2,
        2.3,
        2.59,
        2.648,
        2.7,
        2.8,
        math.nextafter(math.pi, 0),
    ]
    frictions = [1e-300, 1e-12, 1e-3, 1.0, np.nextafter(1, 2), 3.0, 1e9, 1e300, math.inf]
    found = least_thicknesses(np.array(angles)[:, None], np.array(frictions), weight)
    stands = ~np.isnan(found.eta)
    assert (found.modes > 0).all()
    assert ((found.eta > 0) & (found.eta <= 2))[stands].all()
    assert (found.thrust >= 0)[stands].all()
    assert (found.beta_r >= 0)[stands].all()
    assert not stands[-1].any()
    # Far to the right mu no longer matters, and r is there at mu = inf only.
    np.testing.assert_allclose(found.eta[:, -2], found.eta[:, -1], rtol=1e-7)
    assert (found.modes[3:6, -1] & (BIT[Mode.RRR] | BIT[Mode.R]) > 0).all()


@given(half_angle=st.floats(0.05, 2.78))
@settings(max_examples=12, deadline=None)
def test_mode_changes_on_lines_only(half_angle: float) -> None:
    """Between two modes along mu, both are reported at the change itself."""
    mu = np.tan(np.linspace(0.02, 1.57, 500))
    found = least_thicknesses(half_angle, mu)
    for i in np.flatnonzero(np.diff(found.modes)):
        low, high = float(mu[i]), float(mu[i + 1])
        before, after = found.modes[i], found.modes[i + 1]
        while (low + high) / 2 not in (low, high):
            middle = (low + high) / 2
            if least_thicknesses(half_angle, middle).modes == before:
                low = middle
            else:
                high = middle
        at = least_thicknesses(half_angle, np.array([low, high])).modes
        beside = least_thicknesses(half_angle, np.array([low - 1e-9, high + 1e-9])).modes
        assert (at[1] & before) or (beside[1] == after) or at[0] & at[1]


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
        least_thicknesses(*values)


def test_shapes() -> None:
    assert least_thicknesses(np.empty((0, 3)), 1.0).eta.shape == (0, 3)
    assert least_thicknesses(1.0, 1.0).eta.shape == ()
    assert least_thicknesses(1.0, 1.0).mode == "rrr"


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_the_rotational_mode_that_is_read_is_the_one_that_is_solved(weight: str) -> None:
    stored, solved = rotation._rotational(weight), rotation.solved(weight)
    assert stored.widest == pytest.approx(solved.widest, rel=1e-15)
    for one, other in zip(stored.pieces, solved.pieces, strict=True):
        assert one == pytest.approx(other, abs=2e-14)
