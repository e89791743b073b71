"""Limit analysis, held to an independent formulation and to the continuous arch.

The independent formulation is a linear programme over the whole arch: no symmetry, three
unknown forces at every joint, equilibrium of every block as the assembly gives it. It finds
the least violation of strength, whose zero in eta is the least thickness. Convergence to
the closed form is exact where the hinges fall on joints and of second order otherwise.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from own_balance import violation
from scipy.optimize import brentq

from blocksim import Arch, Mode, theory
from blocksim.arch import limit
from blocksim.arch.limit import least_thickness, slack
from blocksim.arch.limit.bulk import which_stand
from blocksim.arch.limit.halfplanes import Joints, half_joints
from blocksim.arch.limit.statics import least_of

degrees = st.floats(10, 158)
friction = st.one_of(st.floats(0.1, 10.0), st.just(math.inf))
weights = st.sampled_from(["centreline", "sector"])
ARCHES = [
    (90, 0.7, 27, "centreline", Mode.RRR),
    (90, 0.7, 20, "sector", Mode.RRR),
    (60, math.inf, 15, "centreline", Mode.RRR),
    (90, 0.35, 30, "centreline", Mode.SRR),
    (110, 0.6, 28, "sector", Mode.SRR),
    (125, 0.9, 25, "centreline", Mode.SRR),
    (145, 1.6, 25, "centreline", Mode.RRS),
    (145, 1.65, 28, "sector", Mode.RRS),
    (155, 3.0, 24, "centreline", Mode.RS),
    (148, 1.8, 23, "sector", Mode.RS),
    (155, math.inf, 22, "centreline", Mode.R),
]


@settings(max_examples=12)
@given(degrees, friction, st.integers(4, 20), weights)
def test_against_the_whole_arch_anywhere(
    angle: float, mu: float, count: int, weight: str
) -> None:
    alpha = math.radians(angle)
    found = limit.least_thickness(alpha, mu, count, weight)

    def excess(eta: float) -> float:
        arch = Arch(half_angle=alpha, eta=eta, voussoirs=count, weight=weight)
        return violation(arch.assembly(), mu)

    if found.eta is None:
        assert excess(2.0) > 0
        return
    assert excess(found.eta * (1 - 1e-6)) > 0
    assert excess(min(found.eta * (1 + 1e-6), 2.0)) < 1e-10


@pytest.mark.parametrize(("angle", "mu", "count", "weight", "mode"), ARCHES[:10])
@pytest.mark.parametrize("ratio", [0.9, 1.1])
def test_slack_against_the_whole_arch(
    angle: float, mu: float, count: int, weight: str, mode: Mode, ratio: float
) -> None:
    alpha = math.radians(angle)
    least = limit.least_thickness(alpha, mu, count, weight)
    assert least.mode is mode
    arch = Arch(
        half_angle=alpha, eta=min(least.eta * ratio, 2.0), voussoirs=count, weight=weight
    )
    spare = limit.slack(arch, mu)
    assert (spare > 0) == (ratio > 1)
    left = 1 - spare
    assembly = arch.assembly()
    assert violation(assembly, mu, left * (1 - 1e-6), left * (1 - 1e-6)) > 0
    assert violation(assembly, mu, left * (1 + 1e-6), left * (1 + 1e-6)) < 1e-10


@given(st.floats(0.1, 1.8), st.integers(20, 120), weights, st.floats(0.01, 0.1), st.booleans())
def test_no_wrong_none(mu: float, count: int, weight: str, aside: float, stands: bool) -> None:
    """Off the divide by a percent or more, voussoirs and closed form agree on None.

    Up to mu = 1.8, where no thickness beyond 2 would be needed on either side.
    """
    divide = theory.divide_half_angle(mu)
    alpha = divide * (1 - aside if stands else 1 + aside)
    continuous = theory.least_thickness(alpha, mu, weight).eta
    built = limit.least_thickness(alpha, mu, count, weight)
    assert (continuous is not None) == stands
    if stands:
        assert built.eta is not None
    elif count >= 60:
        assert built.eta is None
        assert built.mode is Mode.SS
        assert built.thrust is None


def test_sliding_threshold_where_the_inner_joint_falls_on_a_joint() -> None:
    """Purely sliding: mu at which nothing stands, exact where beta_s/alpha is rational."""

    def share(mu: float) -> float:
        return theory.critical.inner_sliding(mu)[1] / theory.divide_half_angle(mu)

    mu = brentq(lambda mu: share(mu) - 0.25, 0.2, 1.5, xtol=1e-15)
    alpha = theory.divide_half_angle(mu)
    assert limit.least_thickness(alpha, mu * (1 + 1e-9), 16).eta is not None
    failed = limit.least_thickness(alpha, mu * (1 - 1e-9), 16)
    assert (failed.eta, failed.mode) == (None, Mode.SS)
    assert failed.slides == pytest.approx((alpha / 4, alpha), rel=1e-12)


def test_overhanging_arch_that_never_stands() -> None:
    """Beyond alpha_L = 159.65 deg each half overturns whatever friction and thickness."""
    just_stands = limit.least_thickness(math.radians(159.6), math.inf, 40)
    never = limit.least_thickness(math.radians(159.7), math.inf, 40)
    assert just_stands.eta == pytest.approx(2, abs=0.02)
    assert never.eta is None
    assert limit.slack(Arch(half_angle=2.0, eta=0.5, voussoirs=9), 1e-3) < -100
    assert limit.slack(Arch(half_angle=2.0, eta=0.5, voussoirs=9), 1e-9) == -math.inf


@pytest.mark.parametrize("weight", ["centreline", "sector"])
@pytest.mark.parametrize("voussoirs", [3, 4, 27])
def test_same_answers_as_one_by_one(weight: str, voussoirs: int) -> None:
    random = np.random.default_rng(voussoirs)
    half_angle = random.uniform(0.05, 3.0, 100)
    eta = 2 * random.uniform(0, 1, 100) ** 3 + 1e-6
    mu = np.where(
        random.uniform(size=100) < 0.1, np.inf, np.tan(random.uniform(0.01, 1.5, 100))
    )
    found = which_stand(half_angle, eta, mu, voussoirs, weight)
    expected = [
        slack(Arch(half_angle=a, eta=e, voussoirs=voussoirs, weight=weight), m) >= 0
        for a, e, m in zip(half_angle.tolist(), eta.tolist(), mu.tolist(), strict=True)
    ]
    assert found.tolist() == expected
    assert 20 < sum(expected) < 280


def test_same_answers_beside_the_limit() -> None:
    for half_angle, mu in ((math.pi / 2, 0.7), (math.pi / 2, 0.37), (2.5, 2.0), (2.18, 0.9)):
        eta = least_thickness(half_angle, mu, 27).eta
        beside = np.array([eta, np.nextafter(eta, 0), eta * (1 + 1e-12), eta * (1 - 1e-12)])
        found = which_stand(half_angle, beside, mu, 27)
        assert found.tolist() == [True, False, True, False]


@pytest.mark.parametrize("mu", [0.35, 0.7, math.inf])
def test_of_many_joints_few_are_paired(mu: float) -> None:
    """Work counted, not timed: all pairs of 5,001 joints would be 25 million."""
    joints = Joints(half_joints(math.pi / 2, 10_000)[None])
    eta, _ = least_of(joints, mu, "centreline")
    assert eta == pytest.approx(theory.least_thickness(math.pi / 2, mu).eta, rel=1e-6)
    places, _ = joints.few
    assert len(places) < 100
