"""The linear programme of any assembly, held to closed forms and to published values."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from arches import arch_at
from drawn import box, bricks, rounded
from hypothesis import assume, given
from hypothesis import strategies as st
from structure_cases import case, names, of_each_kind, scenes
from worlds import least_motion

from blocksim import CircularArch, Problem, check, collapse, equilibrium, structure_of
from blocksim.common.errors import Unsolved
from blocksim.limit import linear, programme
from blocksim.limit.cones import Cones

frictions = st.one_of(st.floats(0.05, 2.0), st.just(math.inf))
lengths = st.floats(0.2, 5.0)
FLOOR = {"id": "floor", "vertices": [[-99, -1], [99, -1], [99, 0], [-99, 0]], "fixed": True}
SIDEWAYS = [{"body": [1, 0]}]


def asked(question: str) -> list[str]:
    return [name for name in names() if case(name)["question"] == question]


def factor(table: dict[str, Any]) -> float:
    """The load factor of what a structure file says."""
    found = collapse(structure_of(table)).load_factor
    assert found is not None
    return found


def with_friction_everywhere(problem: Problem, mu: float) -> Problem:
    """All joints with the same friction, their own left aside."""
    joints = tuple(replace(joint, friction=None) for joint in problem.assembly.joints)
    return replace(problem, assembly=replace(problem.assembly, joints=joints), mu=mu)


@given(st.floats(-50.0, 50.0), frictions, lengths, lengths)
def test_a_block_slides_or_tips(slope: float, mu: float, width: float, height: float) -> None:
    """Down a slope it takes min(mu, width / height) cos - sin; a flat one: the tangent."""
    angle = math.radians(slope)
    table = {"friction": mu, "blocks": [FLOOR, box("1", 0, 0, width, height)]}
    problem = structure_of(table | {"live": SIDEWAYS}).tilted(angle)
    least = min(mu, width / height)
    want = least * math.cos(angle) - math.sin(angle)
    assert collapse(problem).load_factor == pytest.approx(want, rel=1e-9, abs=1e-9)
    assume(abs(abs(math.tan(angle)) - least) > 1e-6)
    assert equilibrium(problem).exists == (abs(math.tan(angle)) < least)


@given(frictions, lengths, lengths, st.floats(0.0, 1.0), st.floats(0.1, 100.0))
def test_a_push_at_a_height(
    mu: float, width: float, height: float, share: float, weight: float
) -> None:
    """W mu to slide, W width / (2 y) to tip: newtons, wherever the drawing's units lie."""
    push = {"block": "1", "point": [0, share * height], "force": [1, 0]}
    block = box("1", 0, 0, width, height) | {"weight": weight}
    table = {"friction": mu, "blocks": [FLOOR, block], "live": [push]}
    arm = share * height
    want = weight * min(mu, width / (2 * arm) if arm > 1e-9 else math.inf)
    assume(arm == 0 or arm > 1e-3)
    assert factor(table) == (math.inf if want == math.inf else pytest.approx(want, rel=1e-9))


@given(
    st.lists(
        st.tuples(st.floats(0.5, 2.0), st.floats(0.2, 2.0), st.floats(-0.4, 0.4), frictions),
        min_size=1,
        max_size=8,
    )
)
def test_a_stack_falls_at_its_weakest_joint(
    drums: list[tuple[float, float, float, float]],
) -> None:
    """Each joint has its own friction; what lies above it slides, or tips about its end."""
    blocks, joints, low, middle = [FLOOR], list[dict[str, Any]](), 0.0, 0.0
    bed = (-99.0, 99.0)
    for number, (width, height, shift, mu) in enumerate(drums):
        middle += shift
        left, right = middle - width / 2, middle + width / 2
        joint = (max(left, bed[0]), min(right, bed[1]))
        assume(joint[1] - joint[0] > 0.05)
        below = str(number - 1) if number else "floor"
        ends = [[joint[0], low], [joint[1], low]]
        blocks.append(box(str(number), left, low, right, low + height))
        joints.append({"a": below, "b": str(number), "ends": ends, "friction": mu})
        bed, low = (left, right), low + height
    table = {"friction": 0.0, "blocks": blocks, "joints": joints, "live": SIDEWAYS}
    problem = structure_of(table)
    least, tips = math.inf, math.inf
    for number, joint in enumerate(joints):
        above = problem.assembly.blocks[number:]
        weight = sum(block.mass for block in above)
        x, y = sum((block.mass * block.centre for block in above), np.zeros(2)) / weight
        (left, low), (right, _) = joint["ends"]
        assume(left < x < right)
        tips = min(tips, (right - x) / (y - low))
        least = min(least, drums[number][3])
    assert collapse(problem).load_factor == pytest.approx(min(least, tips), rel=1e-9)


# Smooth, or of friction that structures may have: 1e-11 is lost in the solver's 1e-10.
FRICTION = st.just(0.0) | st.floats(1e-6, 1.0)


@given(FRICTION, FRICTION, st.floats(0.5, 4.0), st.floats(0.5, 4.0))
def test_two_blocks_pushed_along_the_floor(
    one: float, other: float, first: float, second: float
) -> None:
    """Smooth between them: each adds its own friction times its weight."""
    blocks = [FLOOR, box("1", 0, 0, first, 0.2), box("2", first, 0, first + second, 0.2)]
    joints = [
        {"a": "floor", "b": "1", "ends": [[0, 0], [first, 0]], "friction": one},
        {"a": "floor", "b": "2", "ends": [[first, 0], [first + second, 0]], "friction": other},
        {"a": "1", "b": "2", "ends": [[first, 0], [first, 0.2]], "friction": 0},
    ]
    push = [{"block": "1", "point": [0, 0.1], "force": [1, 0]}]
    table = {"friction": "inf", "blocks": blocks, "joints": joints, "live": push}
    want = 0.2 * (one * first + other * second)
    assert factor(table) == pytest.approx(want, rel=1e-9, abs=1e-12)


@given(
    st.floats(0.5, 5.0),
    st.floats(0.5, 5.0),
    st.floats(0.05, 0.9),
    st.floats(0.05, 0.9),
    frictions,
)
def test_a_three_hinged_arch(
    span: float, rise: float, inward: float, up: float, mu: float
) -> None:
    """Corners at the feet (rough) and at the crown: statically determinate.

    Moments about the feet give the crown's thrust W (a - x) / rise, whatever the load, and its
    shear W lambda y / a; a foot lifts off at a / y.
    """
    x, y = span * inward, rise * up
    blocks = [FLOOR]
    joints: list[dict[str, Any]] = []
    for name, side in (("left", -1), ("right", 1)):
        corners = [[side * span, 0], [0, rise], [0, rise + 0.5]]
        blocks.append({"id": name, "vertices": corners, "centre": [side * x, y], "weight": 1})
        foot = {"a": "floor", "b": name, "ends": [[side * span, 0]], "normal": [0, 1]}
        joints.append(foot | {"friction": "inf"})
    joints.append({"a": "left", "b": "right", "ends": [[0, rise]], "normal": [1, 0]})
    table = {"friction": mu, "blocks": blocks, "joints": joints, "live": SIDEWAYS}
    thrust = (span - x) / rise
    want = min(span / y, mu * thrust * span / y)
    assert factor(table) == pytest.approx(want, rel=1e-9)


@given(st.floats(20.0, 80.0), st.floats(0.5, 6.0), st.floats(0.02, 0.4))
def test_a_plank_on_a_wall(degrees: float, length: float, thick: float) -> None:
    """Two corners: with the friction mu at both, mu Y + mu^2 X = a (1 + mu^2) just holds it."""
    angle = math.radians(degrees)
    along = length * np.array([math.cos(angle), math.sin(angle)])
    across = thick * length * np.array([-math.sin(angle), math.cos(angle)])
    corners = np.array([np.zeros(2), along, along + across, across])
    a, (x, y) = corners.mean(axis=0)[0], along
    assume(a > 1e-2 * x)
    # The smaller root of (x - a) mu^2 + y mu - a.
    least = (-y + math.sqrt(y * y + 4 * (x - a) * a)) / (2 * (x - a))
    wall = {"id": "wall", "vertices": [[x, 0], [x + 1, 0], [x + 1, 9], [x, 9]], "fixed": True}
    plank = {"id": "plank", "vertices": corners.tolist()}
    problem = structure_of({"friction": 0, "blocks": [FLOOR, wall, plank]})
    assert all(joint.is_corner for joint in problem.assembly.joints)
    assert len(problem.assembly.joints) == 2
    assert equilibrium(problem.with_friction(least * (1 + 1e-6))).exists
    assert not equilibrium(problem.with_friction(least * (1 - 1e-6))).exists


def test_a_force_high_on_a_block_far_larger_than_the_others() -> None:
    """It tips about its far corner, whatever else there is: 40 N times 5 m over 4 m."""
    table = {
        "friction": 10.0,
        "size": 3.0,
        "blocks": [
            {**box("floor", -50, -1, 50, 0), "fixed": True},
            box("large", 0, 0, 10, 4),
            *(box(f"small {at}", 20 + at, 0, 20.5 + at, 0.1) for at in range(20)),
        ],
        "live": [{"block": "large", "force": [1, 0], "point": [5, 4]}],
    }
    found = collapse(structure_of(table))
    assert found.load_factor == pytest.approx(50, rel=1e-9)
    x, y, turn = found.mechanism[0]  # type: ignore[index]
    # About the corner at 10, 0, which lies 5 m to the right of its centre and 2 m below it.
    assert (x, y) == (pytest.approx(-2 / 3 * turn), pytest.approx(-5 / 3 * turn))


def test_nothing_limits_a_block_pressed_down() -> None:
    table = {"friction": 0.5, "blocks": [FLOOR, box("1", 0, 0, 1, 1)]}
    problem = structure_of(table | {"live": [{"body": [0, -1]}]})
    assert collapse(problem).load_factor == math.inf
    assert collapse(replace(problem, gravity=np.array([0.6, -1, 0]))).load_factor == math.inf
    lifted = structure_of(table | {"live": [{"body": [1, 0]}], "dead": [{"body": [0, 1]}]})
    assert collapse(lifted).load_factor is None


@pytest.mark.parametrize("name", of_each_kind(asked("load_factor")))
def test_published_load_factors(name: str) -> None:
    (scene,) = scenes(name)
    assert factor(scene) == pytest.approx(case(name)["expected"]["value"], rel=1e-6)


@pytest.mark.parametrize("name", ["ferris_tinloi_1", "jack_arch_load", "oppenheim_28"])
def test_both_solvers_agree(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The interior point, taken of many joints, and the simplex."""
    (scene,) = scenes(name)
    assert linear.MANY > 1
    monkeypatch.setattr(linear, "MANY", 0)
    assert factor(scene) == pytest.approx(case(name)["expected"]["value"], rel=1e-9)
    pressed = structure_of(scene | {"live": [{"body": [0, -1]}]})
    monkeypatch.setattr(linear, "MANY", 10**9)
    simplex = collapse(pressed).load_factor
    monkeypatch.setattr(linear, "MANY", 0)
    assert collapse(pressed).load_factor == pytest.approx(simplex, rel=1e-9)


@pytest.mark.parametrize("name", asked("tilt_deg"))
def test_published_tilts(name: str) -> None:
    """A body force sideways is a tilt whose tangent is the load factor."""
    expected = case(name)["expected"]
    (scene,) = scenes(name)
    tilts = [(1, expected["value"])]
    if "other_direction" in expected:
        tilts.append((-1, expected["other_direction"]))
    for side, degrees in tilts:
        found = factor(scene | {"live": [{"body": [side, 0]}]})
        assert math.degrees(math.atan(found)) == pytest.approx(degrees, rel=1e-7)
        for share, rests in ((1 - 1e-6, True), (1 + 1e-6, False)):
            tilted = structure_of(scene).tilted(side * math.radians(degrees) * share)
            assert equilibrium(tilted).exists == rests


@pytest.mark.parametrize("name", of_each_kind(asked("stands")))
def test_published_structures_stand_or_fall(name: str) -> None:
    read = case(name)
    for scene, told in zip(scenes(name), read.get("scenes") or [read["scene"]], strict=True):
        found = equilibrium(structure_of(scene))
        assert found.exists == told["expected"]
        assert (found.margin < 0) == (not told["expected"]) or abs(found.margin) < 1e-9


@pytest.mark.parametrize("name", asked("least_mu"))
def test_published_least_friction(name: str) -> None:
    (scene,) = scenes(name)
    problem, least = structure_of(scene), case(name)["expected"]["value"]
    assert equilibrium(with_friction_everywhere(problem, least * (1 + 1e-6))).exists
    assert not equilibrium(with_friction_everywhere(problem, least * (1 - 1e-6))).exists


@given(st.floats(1.0, 80.0), lengths, lengths)
def test_a_smooth_block_slides_as_it_must(slope: float, width: float, height: float) -> None:
    """Without friction it starts with sin of the slope, along it, whatever its shape."""
    assume(height / width < 1 / math.tan(math.radians(slope)) * 0.99)
    table = {"friction": 0.0, "blocks": [FLOOR, box("1", 0, 0, width, height)]}
    found = least_motion(structure_of(table).tilted(math.radians(slope)))
    want = [math.sin(math.radians(slope)), 0.0, 0.0]
    assert found.accelerations[0] == pytest.approx(want, abs=1e-9)


@given(st.floats(1.0, 80.0), lengths, lengths)
def test_a_rough_block_tips_as_it_must(slope: float, width: float, height: float) -> None:
    """About its lower corner: moment of its weight over the moment of inertia there."""
    angle = math.radians(slope)
    driven = height * math.sin(angle) - width * math.cos(angle)
    assume(driven > 1e-3)
    table = {"friction": "inf", "blocks": [FLOOR, box("1", 0, 0, width, height)]}
    problem = structure_of(table).tilted(angle)
    found, size = least_motion(problem), problem.assembly.size
    turn = driven / 2 / ((width**2 + height**2) / 3)
    want = [turn * height / 2, turn * width / 2, -turn * size]
    assert found.accelerations[0] == pytest.approx(want, abs=1e-8)


@pytest.mark.parametrize("name", of_each_kind(asked("load_factor")[:8]))
def test_least_motion_is_none_where_forces_of_equilibrium_exist(name: str) -> None:
    (scene,) = scenes(name)
    problem, limit = structure_of(scene), case(name)["expected"]["value"]
    for share, moves in ((0.99, False), (1.01, True)):
        found = least_motion(problem.with_load(share * limit))
        assert bool(np.abs(found.accelerations).max() > 1e-7) == moves


def test_least_motion_wedges_nothing_between_rough_joints() -> None:
    """Forces at mu = 1000 are those of a thrust, as without slip, not thousands of weights."""
    arch = arch_at(0.99, 90, 1e3, 20)
    rough, boundless = (
        least_motion(CircularArch.of(arch, mu).problem()) for mu in (1e3, math.inf)
    )
    assert rough.accelerations == pytest.approx(boundless.accelerations, abs=1e-9)
    assert np.abs(rough.forces).max() < 20


@pytest.mark.parametrize("factor", [1e300, math.inf])
def test_a_programme_that_is_not_taken_is_no_structure_that_falls(factor: float) -> None:
    """HiGHS empties one with a factor of 1e15 or more."""
    ends = np.zeros(2), np.full(2, math.inf)
    rows = np.ones(1), np.full(1, 2.0)
    programme = linear.LinearProgramme()
    with pytest.raises(Unsolved, match="undecided"):
        programme.solve(np.ones(2), np.array([[1.0, factor]]), rows, ends)
    assert programme.solve(np.ones(2), np.array([[1.0, 1e3]]), rows, ends).exists


@pytest.mark.parametrize(("degrees", "mu"), [(0, 0.6), (29, 0.6), (40, 0.6), (5, 0.0)])
def test_large_structures_are_answered_as_small_ones_are(
    degrees: float, mu: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a wall of 145 bricks, by the interior point and by the simplex; both are proved."""
    wall = structure_of(rounded(bricks(10, 15), degrees, 15, mu=mu))
    assert Cones(wall).count > linear.MANY * (mu > 0)
    found = equilibrium(wall)
    monkeypatch.setattr(programme, "MANY", math.inf)
    vertex = equilibrium(wall)
    assert found.margin == pytest.approx(vertex.margin, abs=1e-6)
    for each in (found, vertex):
        assert each.proof.claim == ("stands" if degrees == 0 else "collapses")


@pytest.mark.long
@pytest.mark.parametrize("degrees", [0, 40])
def test_a_wall_of_ten_thousand_bricks_is_proved(degrees: float) -> None:
    """It slides where its bed is steeper than friction."""
    found = check(structure_of(rounded(bricks(80, 130), degrees, 15)), method="limit")
    assert (found.verdict.value, found.proved) == ("collapses" if degrees else "stands", True)


@pytest.mark.parametrize("seed", range(3))
def test_a_programme_given_up_by_the_dual_method_is_told_by_the_primal(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing limits it. A bound of 1e7 in its place would be a load factor that is none.

    From a corner that is known the primal method sees that in few steps; the dual one would
    take more than it is given here.
    """
    random, count, rows = np.random.default_rng(seed), 60, 40
    matrix, cost = random.normal(size=(rows, count)), random.normal(size=count)
    most, least = np.abs(random.normal(size=rows)), np.full(rows, -math.inf)
    # A way that costs less and less, and meets no end.
    way = np.abs(random.normal(size=count))
    matrix -= np.outer(np.maximum(matrix @ way, 0.0) + 1.0, way) / (way @ way)
    cost -= (cost @ way + 1.0) * way / (way @ way)
    assert (matrix @ way < 0).all()
    assert cost @ way < 0
    monkeypatch.setattr(linear, "ENDLESS", 1)
    bounds = np.zeros(count), np.full(count, math.inf)
    found = linear.LinearProgramme().solve(cost, matrix, (least, most), bounds)
    assert found.unbounded
