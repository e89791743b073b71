"""Limit analysis, held to an independent formulation and to the continuous arch.

The independent formulation is a linear programme over the whole arch: no symmetry, three
unknown forces at every joint, equilibrium of every block as the assembly gives it. It finds
the least violation of strength, whose zero in eta is the least thickness. Convergence to
the closed form is exact where the hinges fall on joints and of second order otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from own_balance import violation
from scipy.optimize import brentq, linprog

from blocksim import Arch, Mode
from blocksim.arch import limit, theory
from blocksim.arch.limit import least_thickness, slack
from blocksim.arch.limit.bulk import which_stand
from blocksim.arch.limit.halfplanes import Joints, half_joints
from blocksim.arch.limit.statics import least_of

degrees = st.floats(10, 158)
friction = st.one_of(st.floats(0.1, 10.0), st.just(math.inf))
counts = st.integers(4, 60)
"""Three voussoirs are a case of their own, below."""
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


@given(degrees, friction, counts, weights)
def test_stands_agrees_with_the_least_thickness(
    angle: float, mu: float, count: int, weight: str
) -> None:
    alpha = math.radians(angle)
    found = limit.least_thickness(alpha, mu, count, weight)

    def stands(eta: float) -> bool:
        arch = Arch(half_angle=alpha, eta=eta, voussoirs=count, weight=weight)
        return limit.slack(arch, mu) >= -1e-12

    if found.eta is None:
        assert not any(stands(eta) for eta in np.linspace(0.05, 2, 40))
        return
    assert not stands(found.eta * (1 - 1e-9))
    assert found.eta * (1 + 1e-9) > 2 or stands(found.eta * (1 + 1e-9))
    # Between the least thickness and 2 there is no gap in what stands.
    assert all(stands(eta) for eta in np.linspace(found.eta * (1 + 1e-9), 2, 20)[:-1])


def rotational(alpha: float) -> tuple[float, float]:
    return alpha, 3.0


def shoulder_slides(mu: float) -> tuple[float, float]:
    return math.pi / 2, mu


@pytest.mark.parametrize("weight", ["centreline", "sector"])
@pytest.mark.parametrize(
    ("family", "low", "high", "mode", "share", "step"),
    [
        (rotational, math.radians(60), math.radians(110), Mode.RRR, 3 / 5, 10),
        (rotational, math.radians(110), math.radians(135), Mode.RRR, 1 / 2, 8),
        (shoulder_slides, 0.314, 0.392, Mode.SRR, 2 / 3, 12),
    ],
)
def test_exact_where_the_hinges_fall_on_joints(
    family: Callable[[float], tuple[float, float]],
    low: float,
    high: float,
    mode: Mode,
    share: float,
    step: int,
    weight: str,
) -> None:
    """The joints of the mechanism are all that matters: no discretisation error is left."""

    def off_joint(parameter: float) -> float:
        alpha, mu = family(parameter)
        return theory.least_thickness(alpha, mu, weight).beta_r / alpha - share

    alpha, mu = family(brentq(off_joint, low, high, xtol=1e-15))
    continuous = theory.least_thickness(alpha, mu, weight)
    assert continuous.modes == (mode,)
    for count in (step, 3 * step, 6 * step):
        built = limit.least_thickness(alpha, mu, count, weight)
        assert built.eta == pytest.approx(continuous.eta, rel=1e-12)
        assert built.mode is mode
        assert built.thrust == pytest.approx(continuous.thrust, rel=1e-10)
        assert built.hinges_intrados == pytest.approx((continuous.beta_r,), rel=1e-12)
    # Both sides: one voussoir pair more puts the hinge between joints, and it shows.
    off = limit.least_thickness(alpha, mu, step + 2, weight)
    assert off.eta < continuous.eta * (1 - 1e-6)


@settings(max_examples=15)
@given(st.floats(0.1, 1.8), st.integers(20, 120), weights, st.floats(0.01, 0.1), st.booleans())
def test_no_wrong_none(mu: float, count: int, weight: str, aside: float, stands: bool) -> None:
    """Off the divide by a percent or more, voussoirs and closed form agree on None.

    Up to mu = 1.8, where no thickness beyond 2 would be needed on either side.
    """
    divide = theory.regions.divide_half_angle(mu)
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
        return theory.critical.inner_sliding(mu)[1] / theory.regions.divide_half_angle(mu)

    mu = brentq(lambda mu: share(mu) - 0.25, 0.2, 1.5, xtol=1e-15)
    alpha = theory.regions.divide_half_angle(mu)
    assert limit.least_thickness(alpha, mu * (1 + 1e-9), 16).eta is not None
    failed = limit.least_thickness(alpha, mu * (1 - 1e-9), 16)
    assert (failed.eta, failed.mode) == (None, Mode.SS)
    assert failed.slides == pytest.approx((alpha / 4, alpha), rel=1e-12)


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_three_voussoirs_stand_at_any_thickness(weight: str) -> None:
    """Two joints on each half: a thrust and a moment always lead the line through both.

    Four voussoirs have a joint at the crown, too, and need a thickness.
    """
    assert limit.least_thickness(1.5, math.inf, 3, weight).eta == 0
    assert limit.slack(Arch(half_angle=1.5, eta=1e-6, voussoirs=3, weight=weight), 1.0) >= 0
    assert limit.least_thickness(1.5, math.inf, 4, weight).eta > 0.01
    # Friction still has its say.
    assert limit.least_thickness(1.5, 0.1, 3, weight).eta is None


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
    half_angle = random.uniform(0.05, 3.0, 300)
    eta = 2 * random.uniform(0, 1, 300) ** 3 + 1e-6
    mu = np.where(
        random.uniform(size=300) < 0.1, np.inf, np.tan(random.uniform(0.01, 1.5, 300))
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


def test_static_theorem_by_linear_programming() -> None:
    """The half-planes in (h, m), given to HiGHS: no shared code."""
    random = np.random.default_rng(5)
    half_angle, eta = random.uniform(0.5, 2.7, 60), 2 * random.uniform(0.05, 1, 60) ** 2
    mu = np.tan(random.uniform(0.2, 1.4, 60))
    found = which_stand(half_angle, eta, mu, 12)
    for a, e, m, stood in zip(half_angle, eta, mu, found, strict=True):
        x = a * np.arange(7) / 6
        sine, cosine, one = np.sin(x), np.cos(x), np.ones(7)
        # columns h, m; M, N and T of the module docstring of `statics`
        moment, moment_0 = np.column_stack([-cosine, one]), 1 - cosine - x * sine
        force, force_0 = np.column_stack([cosine, 0 * one]), x * sine
        shear, shear_0 = np.column_stack([sine, 0 * one]), -x * cosine
        rows, right = [], []
        for sign in (1, -1):
            rows += [sign * moment - e / 2 * force, sign * shear - m * force]
            right += [e / 2 * force_0 - sign * moment_0, m * force_0 - sign * shear_0]
        result = linprog(
            [0, 0], A_ub=np.vstack(rows), b_ub=np.concatenate(right), bounds=(None, None)
        )
        assert stood == (result.status == 0)


@pytest.mark.parametrize("mu", [0.35, 0.7, math.inf])
def test_of_many_joints_few_are_paired(mu: float) -> None:
    """Work counted, not timed: all pairs of 5,001 joints would be 25 million."""
    joints = Joints(half_joints(math.pi / 2, 10_000)[None])
    eta, _ = least_of(joints, mu, "centreline")
    assert eta == pytest.approx(theory.least_thickness(math.pi / 2, mu).eta, rel=1e-6)
    places, _ = joints.few
    assert len(places) < 100
