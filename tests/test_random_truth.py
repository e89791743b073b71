"""What the study of random truth rests on: proofs by plain statics, and images of problems."""

import math

import numpy as np
import pytest

from analysis import random_truth
from blocksim import Problem, Verdict, check, collapse, equilibrium, structure_of
from tests import random_problems
from tests.certificates import balance, certificate, cone_edges, loads_on, needed, unbalanced
from tests.images import mirrored, renumbered
from tests.random_problems import GROUPS, Case, Question, drawn


def column(tilt: float, friction: float, drums: int = 2, height: float = 0.5) -> Problem:
    """A column of drums 1 m wide on a table tilted by so many degrees."""
    table = {"kind": "column", "drums": drums, "drum_height": height, "friction": friction}
    return structure_of(table).tilted(math.radians(tilt))


@pytest.mark.parametrize("aside", [1e-3, 0.1])
@pytest.mark.parametrize(
    ("friction", "drums", "tangent"), [(0.3, 2, 0.3), (1.5, 2, 1.0), (1.5, 5, 0.4)]
)
def test_columns_are_proved_to_slide_and_to_tip(
    aside: float, friction: float, drums: int, tangent: float
) -> None:
    """On a slope as steep as the friction, or as the width over the height."""
    for sign in (-1, 1):
        tilt = math.degrees(math.atan(tangent * (1 + sign * aside)))
        assert certificate(column(tilt, friction, drums)).stands is (sign < 0)


@pytest.mark.parametrize("rows", [1, 4])
def test_harmonic_stacks_are_proved_to_fall_beyond_their_overhang(rows: int) -> None:
    most = sum(1 / row for row in range(1, rows + 1)) / 2
    for share in (0.999, 1.001):
        table = {"kind": "stack", "rows": rows, "overhang": share * most, "friction": 0.7}
        assert certificate(structure_of(table)).stands is (share < 1)


def test_wrong_forces_and_velocities_prove_nothing() -> None:
    """A block of 1 by 1 m: half its weight at each corner holds it, on a level table."""
    problem = column(0.0, 0.5, drums=1, height=1.0)
    edges, loads = cone_edges(problem), loads_on(problem)
    matrix, free = balance(problem, edges), np.zeros(4, dtype=bool)
    np.testing.assert_allclose(loads, [0, -1, 0], atol=1e-12)
    held = np.full(4, 0.25)
    assert unbalanced(matrix, loads, held, free) < 1e-12
    assert unbalanced(matrix, loads, 1.01 * held, free) == pytest.approx(0.01)
    # What pulls does not count.
    assert unbalanced(matrix, loads, held + np.array([0.5, 0.5, -0.5, -0.5]), free) > 0.1
    # To rise takes power, to sink closes the joint, to slide along it too, as it has to open.
    assert needed(matrix, loads, np.array([0.0, 1.0, 0.0]), free) == math.inf
    assert needed(matrix, loads, np.array([0.0, -1.0, 0.0]), free) == pytest.approx(1.0)
    steep = loads_on(column(40.0, 0.5, drums=1, height=1.0))
    down = np.array([math.copysign(1.0, steep[0]), 0.5, 0.0])
    assert needed(matrix, steep, down, free) < 1e-12
    assert needed(matrix, steep, down * [1, 0.9, 0], free) > 0.01


@pytest.mark.parametrize("group", [0, 1, 10, 13, 15, 18])
def test_images_are_of_the_same_problem(group: int) -> None:
    asked = drawn(Case(len(GROUPS) + group, 16)).problem
    image = mirrored(asked)
    np.testing.assert_allclose(
        image.applied_forces(), asked.applied_forces() * [-1, 1, -1], atol=1e-12
    )
    back = mirrored(image)
    for one, other in zip(back.assembly.joints, asked.assembly.joints, strict=True):
        np.testing.assert_allclose(one.inner, other.inner, atol=1e-12)
        np.testing.assert_allclose(one.normal, other.normal, atol=1e-12)
    other = renumbered(asked, 5)
    order = [block.centre.tolist() for block in asked.assembly.blocks]
    place = [order.index(block.centre.tolist()) for block in other.assembly.blocks]
    assert place != sorted(place)
    np.testing.assert_allclose(
        other.applied_forces(), asked.applied_forces()[place], atol=1e-12
    )
    if asked.live:
        factors = [collapse(each).load_factor for each in (asked, image, other)]
        assert factors == pytest.approx([factors[0]] * 3, rel=1e-9)
    assert len({certificate(each).stands for each in (asked, image, other)}) == 1


@pytest.mark.parametrize(
    "index",
    [
        pytest.param(9014, id="two slides without pressure say the same, a singular system"),
        pytest.param(
            272, id="blocks turn as one, and a step leaves gaps that cannot all close"
        ),
        pytest.param(130, id="bed joints part, which held friction that dilates"),
        pytest.param(3970, id="faces of rubble that fit to a millionth"),
        pytest.param(2091, id="drums that do not quite fit, and turn fast for that"),
        pytest.param(3683, id="a load of thirty times the weight, far beyond all in one step"),
    ],
)
def test_what_was_open_once_is_decided(index: int) -> None:
    """And as statics prove; each was undecided, or a traceback, for another reason."""
    asked = drawn(random_truth.case(index))
    assert certificate(asked.problem).stands is False
    assert check(asked.problem, method="direct").verdict is Verdict.COLLAPSES


def test_a_wall_a_hair_inside_its_limit_stands() -> None:
    """Contacts that yield, by 1e-10 of their force, miss its rest for a motion of 4 g."""
    asked = drawn(random_truth.case(8352))
    assert certificate(asked.problem).stands
    assert check(asked.problem, method="direct").verdict is Verdict.STANDS


def test_a_load_that_nothing_limits_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """HiGHS's dual simplex gets lost in one of these, and says neither of the two."""
    asked: list[Problem] = []

    def family(problem: Problem, kind: str, over: str) -> Question | None:
        if over == "load":
            asked.append(problem)
        return whole(problem, kind, over)

    whole = random_problems._family
    monkeypatch.setattr(random_problems, "_family", family)
    drawn(random_truth.case(1197))
    assert len(asked) == 2
    for problem in asked:
        assert collapse(problem).load_factor == math.inf
        assert all(equilibrium(problem.with_load(load)).exists for load in (0, 1, 30, 1000))
