"""`check` asks every method the same question: both sides of what each knows as the limit."""

from __future__ import annotations

import math

import pytest
from arches import least
from hypothesis import assume, given
from hypothesis import strategies as st

from blocksim import Arch, CircularArch, JointState, Mode, Verdict, check
from blocksim.ask.methods import choose, chosen_words


@given(
    st.floats(20, 155),
    st.floats(0.2, 5.0),
    st.integers(4, 50),
    st.sampled_from(["centreline", "sector"]),
    st.sampled_from(["theory", "limit"]),
    st.sampled_from([0.5, 0.99, 1 - 1e-9, 1 + 1e-9, 1.01, 1.5]),
)
def test_static_methods_on_both_sides(
    degrees: float, mu: float, count: int, weight: str, method: str, ratio: float
) -> None:
    alpha = math.radians(degrees)
    known = least(alpha, mu, count, weight)
    exact = {
        "theory": known.eta_theory,
        "limit": known.eta_limit,
    }[method]
    eta = (exact or 1.0) * ratio
    assume(eta <= 2)
    arch = Arch(half_angle=alpha, eta=eta, voussoirs=count, weight=weight)
    seen = check(CircularArch.of(arch, friction=mu), method=method)
    stands = exact is not None and ratio > 1
    assert seen.verdict is (Verdict.STANDS if stands else Verdict.COLLAPSES)
    assert len(seen.joints) == count + 1
    assert [joint.angle for joint in seen.joints] == pytest.approx(list(arch.joint_angles))
    if stands:
        assert seen.arch.mode is None
        assert {joint.state for joint in seen.joints} == {JointState.CLOSED}
    assert seen.simulated is None
    assert seen.state_hash is None
    assert "\n" not in seen.reason


def test_joints_of_the_limit_mechanism() -> None:
    arch = Arch(half_angle=math.pi / 2, eta=0.1, voussoirs=20)
    seen = check(CircularArch.of(arch, friction=0.7), method="limit")
    found = [(i, joint.state) for i, joint in enumerate(seen.joints)]
    active = [(i, state) for i, state in found if state is not JointState.CLOSED]
    outside, inside = JointState.HINGE_EXTRADOS, JointState.HINGE_INTRADOS
    # beta_r = 54.5 deg: six joint spacings of 9 deg from the crown.
    assert active == [(0, outside), (4, inside), (10, outside), (16, inside), (20, outside)]
    assert seen.arch.mode is Mode.RRR


LEANING = (
    CircularArch.of(Arch(half_angle=1.0, eta=0.2, voussoirs=9), 0.7).problem().leaning(0.1)
)


@pytest.mark.parametrize(
    ("asked", "taken", "why"),
    [
        ({}, "limit", "no cheaper method sees the blocks as built and is exact"),
        ({"tol": 1e-9}, "limit", "is exact"),
        ({"moving": True}, "direct", "can move blocks and brackets down to 1e-08"),
        ({"moving": True, "tol": 1e-2}, "direct", "can move blocks"),
        ({"problem": LEANING}, "pybullet", "out of the plane"),
    ],
)
def test_auto_takes_the_cheapest_that_can_answer(
    asked: dict[str, float], taken: str, why: str
) -> None:
    rung = choose("auto", **asked)
    assert rung.name == taken
    assert why in chosen_words("auto", rung)
    assert chosen_words(taken, rung) == ""
