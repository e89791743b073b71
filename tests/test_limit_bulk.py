"""Many arches at once: the answers of the scalar limit analysis, and the static theorem."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from blocksim.arch.circular import Arch
from blocksim.arch.limit import least_thickness, stands
from blocksim.arch.limit.bulk import joints_of, least_thickness_of_joints, which_stand
from blocksim.common.errors import InputError


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
        assert eta is not None
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
    found = least_thickness_of_joints(joints_of(half_angle, 30), mu, "sector")
    for a, m, eta in zip(half_angle.tolist(), mu.tolist(), found.tolist(), strict=True):
        expected = least_thickness(a, m, 30, "sector").eta
        assert math.isnan(eta) if expected is None else abs(eta - expected) < 1e-14


def test_shapes_broadcast() -> None:
    found = which_stand(np.full((4, 1), 1.5), 0.2, np.full(3, 0.8), 27)
    assert found.shape == (4, 3)
    assert found.all()


@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("half_angle", (math.pi, 0.1, 1.0, 9)),
        ("eta", (1.0, [0.1, 2.1], 1.0, 9)),
        ("mu", (1.0, 0.1, [math.nan], 9)),
        ("voussoirs", (1.0, 0.1, 1.0, 2)),
    ],
)
def test_wrong_input_is_named(field: str, values: tuple) -> None:
    with pytest.raises(InputError, match=field):
        which_stand(*values)
