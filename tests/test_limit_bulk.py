"""Many arches at once: the answers of the scalar limit analysis, and the static theorem."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from blocksim import Arch, InputError
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
    found = least_thickness_of_joints(half_joints(half_angle, 30), mu, "sector")
    for a, m, eta in zip(half_angle.tolist(), mu.tolist(), found.tolist(), strict=True):
        expected = least_thickness(a, m, 30, "sector").eta
        assert math.isnan(eta) if expected is None else abs(eta - expected) < 1e-14


def by_all_pairs(
    half_angle: float, mu: float, count: int, eta: float
) -> tuple[float, float, set]:
    """Ends of the interval of h by every pair of joints, and the joints that set them."""
    x = half_angle * (2.0 * np.arange(count // 2 + 1) + count % 2) / count
    sine, cosine = np.sin(x), np.cos(x)
    # |m - h cos x - x sin x + 1 - cos x| <= eta/2 (h cos x + x sin x): two lines in h.
    low, low_h = (1 - eta / 2) * x * sine - 1 + cosine, (1 - eta / 2) * cosine
    high, high_h = (1 + eta / 2) * x * sine - 1 + cosine, (1 + eta / 2) * cosine
    room, rate = high[:, None] - low, high_h[:, None] - low_h
    pairs = np.argwhere(rate != 0)
    room, rate = [room[rate != 0]], [rate[rate != 0]]
    for sign in (1, -1) if math.isfinite(mu) else ():
        pairs = np.vstack([pairs, np.repeat(np.arange(len(x))[:, None], 2, axis=1)])
        room.append(mu * x * sine + sign * x * cosine)
        rate.append(mu * cosine - sign * sine)
    ends = -np.concatenate(room) / np.concatenate(rate)
    up = np.concatenate(rate) > 0
    least, most = np.where(up, ends, -np.inf).argmax(), np.where(up, np.inf, ends).argmin()
    return ends[least], ends[most], {float(x[k]) for k in (*pairs[least], *pairs[most])}


@settings(max_examples=12, deadline=None)
@given(
    half_angle=st.floats(0.5, 2.7),
    mu=st.one_of(st.floats(0.2, 4.0), st.just(math.inf)),
    count=st.integers(97, 400),
)
def test_many_voussoirs_by_all_pairs_of_joints(
    half_angle: float, mu: float, count: int
) -> None:
    found = least_thickness(half_angle, mu, count)
    beside = np.array([1 - 1e-11, 1 + 1e-11]) * (found.eta or 2.0)
    ends = [by_all_pairs(half_angle, mu, count, eta) for eta in beside]
    assert ends[0][0] > ends[0][1]
    if found.eta is None:
        return
    least, most, joints = ends[1]
    assert least <= most
    assert found.thrust == pytest.approx(least, rel=1e-9)
    named = {*found.hinges_intrados, *found.hinges_extrados, *found.slides}
    assert sorted(named) == pytest.approx(sorted(joints))
    assert which_stand(half_angle, beside, mu, count).tolist() == [False, True]
    (many,) = least_thickness_of_joints(
        half_joints(np.array([half_angle]), count)[:, ::-1], np.array([mu]), "centreline"
    )
    assert many == pytest.approx(found.eta, rel=1e-13)


@pytest.mark.parametrize("mu", [0.35, 0.7, math.inf])
def test_of_many_joints_few_are_paired(mu: float) -> None:
    """Work counted, not timed: all pairs of 5,001 joints would be 25 million."""
    joints = Joints(half_joints(math.pi / 2, 10_000)[None])
    eta, _ = least_of(joints, mu, "centreline")
    assert eta == pytest.approx(theory.least_thickness(math.pi / 2, mu).eta, rel=1e-6)
    places, _ = joints.few
    assert len(places) < 100


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
