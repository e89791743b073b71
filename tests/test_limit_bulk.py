"""Many arches at once: the answers of the scalar limit analysis, and the static theorem."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from blocksim import Arch
from blocksim.arch import theory
from blocksim.arch.limit import least_thickness, stands
from blocksim.arch.limit.bulk import least_thickness_of_joints, which_stand
from blocksim.arch.limit.halfplanes import Joints, half_joints
from blocksim.arch.limit.statics import least_of


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
        stands(Arch(half_angle=a, eta=e, voussoirs=voussoirs, weight=weight), m)
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


def test_least_thickness_of_joints() -> None:
    half_angle, mu = np.array([math.pi / 2, 2.5, 1.0, 2.9]), np.array([0.37, 2.0, np.inf, 0.9])
    found = least_thickness_of_joints(half_joints(half_angle, 30), mu, "sector")
    for a, m, eta in zip(half_angle.tolist(), mu.tolist(), found.tolist(), strict=True):
        expected = least_thickness(a, m, 30, "sector").eta
        assert math.isnan(eta) if expected is None else abs(eta - expected) < 1e-14


@pytest.mark.parametrize("mu", [0.35, 0.7, math.inf])
def test_of_many_joints_few_are_paired(mu: float) -> None:
    """Work counted, not timed: all pairs of 5,001 joints would be 25 million."""
    joints = Joints(half_joints(math.pi / 2, 10_000)[None])
    eta, _ = least_of(joints, mu, "centreline")
    assert eta == pytest.approx(theory.least_thickness(math.pi / 2, mu).eta, rel=1e-6)
    places, _ = joints.few
    assert len(places) < 100
