"""Eqs (10)-(14) against the closed form, and the lines against the static theorem."""

import math

import numpy as np
import pytest
from derivations import friction_line_slope, solve_onset, thrust_line_slope

from blocksim import Mode
from blocksim.arch.theory.arrays import least_thicknesses
from blocksim.arch.theory.critical import least_thickness
from blocksim.arch.theory.lines import critical_moment, friction_line, thrust_line

SECTIONS = 2001


def arches(count: int, seed: int) -> list[tuple[float, float]]:
    """Half of them anywhere, half beside the divide, where the mixed modes are."""
    random = np.random.default_rng(seed)
    half_angle = np.concatenate(
        [random.uniform(0.2, 2.78, count // 2), random.uniform(2.3, 2.78, count - count // 2)]
    )
    friction = np.tan(random.uniform(0.05, 1.5, count))
    return list(zip(half_angle.tolist(), friction.tolist(), strict=True))


def check_second_derivation(count: int, weight: str) -> set[Mode]:
    random = np.random.default_rng(7)
    seen: set[Mode] = set()
    for half_angle, mu in arches(count, 3):
        critical = least_thickness(half_angle, mu, weight)
        if critical.eta is None or critical.mode is Mode.R:
            continue
        seen.add(critical.mode)
        moment = critical_moment(half_angle, critical, weight)
        truth = [critical.eta, critical.thrust, moment, critical.beta_r]
        if critical.beta_s is not None:
            truth.append(critical.beta_s)
        start = np.array(truth) * (1 + 0.003 * random.uniform(-1, 1, len(truth)))
        found = solve_onset(half_angle, mu, critical.mode, start.tolist(), weight)
        # A hinge beside the crown, and those of flat arches, are known no better.
        assert np.abs(found - truth)[:3].max() <= 1e-11, (half_angle, mu)
        angle = np.linspace(0, half_angle, SECTIONS)
        assert np.abs(thrust_line(angle, *truth[1:3], truth[0], weight)).max() <= 1 + 1e-9
        assert np.abs(friction_line(angle, truth[1], mu)).max() <= 1 + 1e-9
    return seen


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_second_derivation(weight: str) -> None:
    assert {Mode.RRR, Mode.RRS, Mode.RS} <= check_second_derivation(300, weight)


@pytest.mark.long
@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_second_derivation_everywhere(weight: str) -> None:
    assert len(check_second_derivation(5000, weight)) >= 5


def test_slopes_are_derivatives() -> None:
    angle, step = np.linspace(0.1, 1.5, 9), 1e-6
    for weight in ("centreline", "sector"):

        def thrust(x: np.ndarray, weight: str = weight) -> np.ndarray:
            return thrust_line(x, 0.6, 0.63, 0.11, weight)

        difference = (thrust(angle + step) - thrust(angle - step)) / (2 * step)
        slope = thrust_line_slope(angle, 0.6, 0.63, 0.11, weight)
        np.testing.assert_allclose(slope, difference, rtol=1e-7, atol=1e-8)
    ahead, behind = friction_line(angle + step, 0.6, 0.4), friction_line(angle - step, 0.6, 0.4)
    slope = friction_line_slope(angle, 0.6, 0.4)
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * step), rtol=1e-7, atol=1e-8)


def test_lines_touch_as_the_paper_says() -> None:
    """Semicircle of Fig. 13: e_hat is -1 at crown and springing, 1 at the haunch."""
    critical = least_thickness(math.pi / 2, math.inf)
    moment = critical_moment(math.pi / 2, critical, "centreline")
    line = thrust_line(
        np.array([0, critical.beta_r, math.pi / 2]), critical.thrust, moment, critical.eta
    )
    np.testing.assert_allclose(line, [-1, 1, -1], atol=1e-13)


def test_arrays_agree_with_the_scalar_lines() -> None:
    half_angle, mu = np.array(arches(400, 11)).T
    found = least_thicknesses(half_angle, mu)
    stands = ~np.isnan(found.eta)
    angle = np.linspace(0, 1, 501)[:, None] * half_angle[stands]
    friction = friction_line(angle, found.thrust[stands], mu[stands])
    assert np.abs(friction).max() <= 1 + 1e-12
