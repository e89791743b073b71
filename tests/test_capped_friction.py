"""Engines that take less friction than is asked for: what falls with less may rest with more.

A flat block on a slope slides where the slope is steeper than the friction, and tips where it
is steeper than its width over its height.
"""

import math

import pytest

from analysis import random_truth
from blocksim import Problem, Verdict, check, structure_of
from tests.certificates import certificate
from tests.random_problems import drawn

LACKING = "with less friction than asked for it starts"
WALL = 8511
"""A random wall of ten blocks without bound on friction, at 0.999 of its load."""


def flat(
    friction: float | str, *, own: float | str | None = None, height: float = 0.02
) -> Problem:
    """A block 1 m wide on a level table; its joint may have a friction of its own."""
    joint = {"a": 0, "b": 1, "ends": [[0, 0], [1, 0]]}
    return structure_of(
        {
            "friction": friction,
            "blocks": [
                {"id": 0, "vertices": [[-2, -1], [3, -1], [3, 0], [-2, 0]], "fixed": True},
                {"id": 1, "vertices": [[0, 0], [1, 0], [1, height], [0, height]]},
            ],
            "joints": [joint if own is None else {**joint, "friction": own}],
        }
    )


def sloping(problem: Problem, degrees: float, *, lean: bool) -> Problem:
    """Gravity turned, in the plane or out of it."""
    angle = math.radians(degrees)
    return problem.leaning(angle) if lean else problem.tilted(angle)


@pytest.mark.parametrize("lean", [False, True])
@pytest.mark.parametrize(
    ("friction", "own"), [("inf", None), (20.0, None), (0.5, "inf"), (0.5, 20.0)]
)
def test_pybullet_does_not_know_what_slides_for_lack_of_friction(
    friction: float | str, own: float | str | None, lean: bool
) -> None:
    """At 86 degrees it slides up to a friction of 14.3; Bullet takes 10."""
    found = check(sloping(flat(friction, own=own), 86, lean=lean), method="pybullet")
    assert found.verdict is Verdict.UNDECIDED
    # In space it is not found how it would start.
    assert found.reason.startswith(LACKING) or lean
    assert "pybullet took 10 as friction" in found.reason


@pytest.mark.parametrize("lean", [False, True])
@pytest.mark.parametrize(
    ("friction", "height", "degrees", "expected"),
    [
        ("inf", 0.02, 84, Verdict.STANDS),
        (9.0, 0.02, 86, Verdict.COLLAPSES),
        ("inf", 2.0, 28, Verdict.COLLAPSES),
        (20.0, 2.0, 25, Verdict.STANDS),
    ],
)
def test_pybullet_knows_what_does_not(
    friction: float | str, height: float, degrees: float, expected: Verdict, lean: bool
) -> None:
    """At 84 degrees a friction of 10 is enough; twice as high as wide it tips at 26.6."""
    problem = sloping(flat(friction, height=height), degrees, lean=lean)
    assert check(problem, method="pybullet").verdict is expected


def test_where_it_falls_with_any_friction_it_falls() -> None:
    """At 89 degrees it tips. In Bullet it slides, and limit analysis knows of no forces."""
    found = check(flat("inf").tilted(math.radians(89)), method="pybullet")
    assert found.verdict is Verdict.COLLAPSES


@pytest.mark.parametrize("friction", ["inf", 3000.0])
def test_other_engines_do_not_know_either(friction: float | str) -> None:
    """Pushed at its foot by 2000 times its weight, a block rests by friction of that much."""
    table = {"point": [0, 0], "block": 1, "force": [2000, 0]}
    for method, right in (("limit", True), ("direct", True), ("pymunk", False)):
        problem = structure_of(
            {
                "friction": friction,
                "blocks": [
                    {"id": 0, "vertices": [[-2, -1], [3, -1], [3, 0], [-2, 0]], "fixed": True},
                    {"id": 1, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]], "weight": 1.0},
                ],
                "dead": [{"body": [0, -1]}, table],
            }
        )
        found = check(problem, method=method)
        assert found.verdict is (Verdict.STANDS if right else Verdict.UNDECIDED)
        assert found.reason.startswith(LACKING) is not right


@pytest.mark.parametrize("method", ["pybullet", pytest.param("mujoco", marks=pytest.mark.long)])
def test_a_wall_that_rests_without_bound_on_friction_is_not_said_to_fall(method: str) -> None:
    asked = drawn(random_truth.case(WALL)).problem
    assert math.isinf(asked.mu)
    assert certificate(asked).stands is True
    assert check(asked, method=method).verdict is not Verdict.COLLAPSES
