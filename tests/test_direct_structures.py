"""The direct engine on any assembly: the corpus at the onset, closed forms in motion."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from images import turning
from structure_cases import case, first, names, of_each_kind
from threadpoolctl import ThreadpoolController
from worlds import (
    DIRECT,
    Blocks,
    classify,
    ground_level,
    joint_motion,
    observe,
    overlap_and_slip,
)

from analysis.structure_cases import ASIDE, MOST, Question, answered, counted, questions
from blocksim import JointState, Problem, Verdict, equilibrium, structure_of
from blocksim.engines.contact import banded, interior, path_following, solver
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.geometry import Geometry
from blocksim.engines.contact.step import Answer, Step
from tests.certificates import certificate

MOVED = [
    "box2d_arch", "box2d_tilted_stack", "compas_cra_bridge", "compas_cra_shelf_stable",
    "diamond_5", "ferris_tinloi_1", "grid_wall_3_smooth_heads", "harmonic_5", "jack_arch_load",
    "oppenheim_7", "plank_on_wall", "segmental_point_quarter", "trilithon",
]  # fmt: skip
ASKED = [
    name
    for name in names()
    if case(name)["question"] in {"load_factor", "tilt_deg", "stands", "least_mu"}
    and len(first(name)["blocks"]) <= MOST
]


OPEN = {"compas_assembly_wall"}
"""All courses of it slide at once, each at the edge of friction: `direct` does not end it."""


TRUE = {"inside": Verdict.STANDS, "outside": Verdict.COLLAPSES}


def ends(question: Question) -> list[tuple[Problem, Verdict]]:
    """Problems just inside and just outside of a value, and what is true of them."""
    return [(problem, TRUE[side]) for side, problem in question.sides(ASIDE).items()]


@pytest.mark.parametrize("name", of_each_kind(ASKED))
def test_a_thousandth_of_a_known_value_decides(name: str) -> None:
    for question in questions(name):
        for problem, true in ends(question):
            found = observe(problem, "direct", moving=False).verdict
            allowed = {true}
            if name in OPEN and true is Verdict.COLLAPSES:
                allowed.add(Verdict.UNDECIDED)
            assert found in allowed, question.name


@pytest.mark.parametrize("name", MOVED)
def test_let_go_it_does_what_it_begins(name: str) -> None:
    for question in questions(name):
        for problem, true in ends(question):
            found = observe(problem, "direct", moving=True)
            assert found.verdict is true, found.reason
            assert {joint.state for joint in found.joints} - {JointState.CLOSED} or (
                true is Verdict.STANDS
            )


def world_of(problem: Problem, step: float) -> Blocks:
    return Blocks(problem, replace(DIRECT.rule(problem.assembly), step=step))


def placed(problem: Problem, world: Blocks, points: np.ndarray, block: int = 0) -> np.ndarray:
    """Where points of a block [m] are now."""
    size = problem.assembly.size
    x, y, angle = world.poses()[block]
    arms = points - problem.assembly.blocks[block].centre
    return arms @ turning(angle).T + size * np.array([x, y])


FLOOR = {"id": "floor", "vertices": [[-20, -1], [20, -1], [20, 0], [-20, 0]], "fixed": True}


def ladder(degrees: float) -> Problem:
    """A smooth bar of 4 m on a floor and against a wall, with its corners."""
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    foot, top, back = np.zeros(2), 4 * np.array([cos, sin]), 0.2 * np.array([-sin, cos])
    wall = [[top[0], 0], [top[0] + 1, 0], [top[0] + 1, 5], [top[0], 5]]
    floor = {"id": 0, "vertices": [[-4, -1], [6, -1], [6, 0], [-4, 0]], "fixed": True}
    corners = [each.tolist() for each in (foot, top, top + back, foot + back)]
    bar = {"id": 2, "vertices": corners, "centre": (top / 2).tolist(), "weight": 9.81}
    blocks = [floor, {"id": 1, "vertices": wall, "fixed": True}, {**bar, "inertia": 16 / 12}]
    return structure_of({"friction": 0.0, "blocks": blocks})


def test_a_smooth_ladder_leaves_its_wall_at_two_thirds_of_its_height() -> None:
    """Energy gives its speed, and the wall's force is gone at 2/3, whatever its inertia."""
    problem = ladder(60)
    assembly = problem.assembly
    assert [joint.is_corner for joint in assembly.joints] == [True, True]
    world = world_of(problem, 0.002)
    world.hold(1)
    half = 2 / assembly.size
    turning = half**2 + float(assembly.masses[0, 2])
    begin = math.sin(math.radians(60))
    left = None
    for _ in range(1200):
        world.advance(1)
        x, y, turned = world.poses()[0]
        angle = math.radians(60) + turned
        assert y == pytest.approx(half * math.sin(angle), abs=1e-6)
        # Until it leaves, the error of long steps is 2e-7.
        if 2 / assembly.size - x - half * math.cos(angle) > 1e-6:
            left = left or math.sin(angle) / begin
        elif left is None:
            speed = math.sqrt(2 * half * (begin - math.sin(angle)) / turning)
            assert world.velocities[0, 2] == pytest.approx(-speed, abs=4e-3)
        if angle < 0.1:
            break
    assert left == pytest.approx(2 / 3, abs=0.02)
    assert world.quality().residual < 1e-8
    # The bar comes down flat, with all of its face: it then lies on more than the corner.
    world.advance(600)
    face = placed(problem, world, np.array([[0.0, 0.0], 4 * np.array([0.5, begin])]))
    assert np.abs(face[:, 1]).max() < 2e-3


def test_a_block_slides_along_the_whole_face_and_tips_at_its_end() -> None:
    """The joint as built is 0.5 m long, the face of the support 4 m."""
    slope, mu, width = math.radians(30), 0.2, 0.5
    along, up = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    block = [0 * up, width * along, width * along + 0.2 * up, 0.2 * up]
    track = {"id": 0, "vertices": [[-0.5, -1], [4, -1], [4, 0], [-0.5, 0]], "fixed": True}
    blocks = [track, {"id": 1, "vertices": [each.tolist() for each in block]}]
    problem = structure_of({"friction": mu, "blocks": blocks}).tilted(slope)
    size, start = problem.assembly.size, problem.assembly.centres[0] / problem.assembly.size
    world = world_of(problem, 0.01)
    time, speeding = 0.0, math.sin(slope) - mu * math.cos(slope)
    while world.poses()[0, 0] * size < 3.7:
        world.advance(1)
        time += 0.01
        x, y, turned = world.poses()[0]
        way = speeding * time**2 / 2
        assert x - start[0] == pytest.approx(way, rel=1e-6)
        assert abs(turned) < 1e-9
        assert y == pytest.approx(start[1], abs=1e-9)
    # Its centre passes the end at 4 m: it turns over the edge, clockwise.
    while world.poses()[0, 0] * size < 4.2:
        world.advance(1)
    assert world.poses()[0, 2] < -1e-3


def test_a_force_at_a_point_goes_with_its_block() -> None:
    """A block tips over its corner: the work of weight and force is its energy, exactly."""
    block = {"id": 1, "vertices": [[0, 0], [1, 0], [1, 2], [0, 2]], "weight": 9.81}
    table = {"friction": "inf", "blocks": [FLOOR, block]}
    point, force = np.array([0.0, 2.0]), np.array([6.0, -1.0])
    live = [{"block": 1, "point": point.tolist(), "force": force.tolist()}]
    problem = structure_of({**table, "live": live}).with_load(1.0)
    pivot = np.array([1.0, 0.0])
    inertia = problem.assembly.blocks[0].inertia + 1.25
    world, size = world_of(problem, 2e-3), problem.assembly.size
    world.hold(1)
    energy = world.energy
    angles = []
    for _ in range(2000):
        world.advance(1)
        turned = float(world.poses()[0, 2])
        if turned < -0.5:
            break
        spin = turning(turned) - np.eye(2)
        centre = spin @ (np.array([0.5, 1.0]) - pivot)
        work = force @ (spin @ (point - pivot)) - 9.81 * centre[1]
        speed = math.sqrt(2 * work / inertia) * math.sqrt(size / 9.81)
        angles.append(turned)
        assert world.velocities[0, 2] == pytest.approx(-speed, rel=5e-3, abs=5e-3)
        assert world.energy <= energy + 1e-9
    assert min(angles) < -0.45
    assert world.energy == pytest.approx(energy, abs=2e-3)


def test_what_falls_lands_on_the_supports_there_are() -> None:
    """Off a shelf onto a step, no pier and no floor of its own."""
    blocks = [
        {"id": "step", "vertices": [[-1, 0], [9, 0], [9, 1], [-1, 1]], "fixed": True},
        {"id": "shelf", "vertices": [[0, 3], [2, 3], [2, 4], [0, 4]], "fixed": True},
        {"id": 1, "vertices": [[1.2, 4], [3, 4], [3, 4.5], [1.2, 4.5]]},
    ]
    problem = structure_of({"friction": 0.3, "blocks": blocks})
    assert ground_level(problem.assembly) == 0.0
    world = world_of(problem, 0.01)
    world.advance(1500)
    corners = placed(problem, world, problem.assembly.blocks[0].vertices)
    assert corners[:, 1].min() == pytest.approx(1.0, abs=1e-2)
    assert corners[:, 0].min() > 2.0


def test_a_block_of_several_polygons_meets_others_by_each_of_them() -> None:
    """An arch over a post slides until its leg meets the post, not its hull."""
    arch = [[0, 0], [0.5, 0], [0.5, 1], [2, 1], [2, 0], [2.5, 0], [2.5, 1.5], [0, 1.5]]
    post = {"id": "post", "vertices": [[1, 0], [1.5, 0], [1.5, 0.8], [1, 0.8]], "fixed": True}
    table = {"friction": 0.2, "blocks": [FLOOR, post, {"id": 1, "vertices": arch}]}
    problem = structure_of({**table, "live": [{"body": [0.25, 0]}]}).with_load(1.0)
    assert len(problem.assembly.blocks[0].parts) > 1
    world = world_of(problem, 0.01)
    world.hold(1)
    world.advance(800)
    x, _, turned = world.poses()[0] * [problem.assembly.size, problem.assembly.size, 1]
    assert x - problem.assembly.blocks[0].centre[0] == pytest.approx(0.5, abs=1e-3)
    assert abs(turned) < 1e-6
    assert np.abs(world.velocities).max() < 1e-9
    assert world.quality().penetration < 1e-3


def test_a_joint_that_is_given_ends_where_it_was_given() -> None:
    """Not where the faces do it lies on; where a face ends with it, that end slides."""
    table = {
        "friction": 0.5,
        "blocks": [FLOOR, {"id": 1, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}],
        "joints": [{"a": "floor", "b": 1, "ends": [[0.2, 0], [1, 0]]}],
    }
    assembly = structure_of(table).assembly
    poses = np.column_stack([assembly.centres / assembly.size, [0.0]])
    rows = Geometry(assembly).touch(poses)[0].rows
    # Moments of the normal velocities: arms of the ends from the centre, in sizes.
    assert sorted(rows[0, :2, 5] * assembly.size) == pytest.approx([-0.3, 0.5])


def falling_wall(courses: int = 8, length: float = 3) -> Problem:
    """A wall at 1.3 times the angle at which it can no longer rest (29.725 deg; `limit`)."""
    table = {"kind": "wall", "courses": courses, "length": length, "friction": 0.7}
    wall = structure_of(table)
    return wall.tilted(math.radians(1.3 * 29.725116))


def test_contacts_that_are_told_are_found_no_better_on_a_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Its forces are known to 1e-9 and no better; a path of 900 systems once ended there, too.
    def path_from_apart(*_: object) -> None:
        raise AssertionError("a path is followed")

    monkeypatch.setattr(solver, "path_from_apart", path_from_apart)
    onset = observe(falling_wall(), "direct", moving=False).onset
    assert onset.verdict is Verdict.COLLAPSES


def test_a_path_from_a_guess_is_short(monkeypatch: pytest.MonkeyPatch) -> None:
    # From all apart it takes 873 systems. Where blocks slide there may be several answers; what
    # is found has to be one.
    systems: list[int] = []

    def central_path(
        step: Step, cones: Cones, *, dilates: bool, **_: float
    ) -> tuple[Any, Any, int]:
        if dilates:
            return interior.central_path(step, cones, dilates=True)
        return np.zeros_like(step.free), np.zeros_like(cones.offset), 0

    def path_from_guess(step: Step, guess: Answer, *most: int) -> Answer | None:
        end = path_following.path_from_guess(step, guess, *most)
        systems.append(end.systems if end else 0)
        return end

    monkeypatch.setattr(solver, "central_path", central_path)
    monkeypatch.setattr(solver, "path_from_guess", path_from_guess)
    monkeypatch.setattr(solver, "path_from_apart", lambda *_: pytest.fail("from all apart"))
    world = world_of(falling_wall(), 1e-3)
    assert np.abs(world.hold(1)).max() > 0.1
    assert (world.quality().residual or 0.0) < 1e-8
    # The first path begins at the guess that is none here, and leads nowhere.
    assert len(systems) == 2
    assert systems[0] == 0
    assert 50 < systems[1] < 300


@pytest.mark.parametrize("mu", [20.0, math.inf])
def test_rest_is_found_though_what_contacts_do_is_not(
    mu: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Steep friction does not tell it by its forces; nor is there any need to know."""
    for name, found in (
        ("by_active_set", []),
        ("path_from_guess", None),
        ("path_from_apart", None),
    ):
        monkeypatch.setattr(solver, name, lambda *_, found=found: found)
    table = {"kind": "wall", "length": 2, "courses": 5, "friction": 0.7}
    upright = replace(structure_of(table), mu=mu)
    low, high = 0.2, 1.2
    while high - low > 1e-10:
        middle = (low + high) / 2
        rests = equilibrium(upright.tilted(middle)).exists
        low, high = (middle, high) if rests else (low, middle)
    for share in (0.99, 1 - 1e-7, 1 + 1e-7, 1.01):
        world = world_of(upright.tilted(share * low), 1e-3)
        moves = float(np.abs(world.hold(1)).max())
        residual = world.quality().residual or 0.0
        assert (max(moves, residual) < 1e-11) is (share < 1), share


def test_wide_systems_are_solved_by_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    pools = ThreadpoolController().select(user_api="blas")
    seen: list[int] = []
    whole = banded.Bands.factored

    def factored(bands: banded.Bands, *given: Any) -> Any:
        seen.extend(pool["num_threads"] for pool in pools.info())
        return whole(bands, *given)

    monkeypatch.setattr(banded.Bands, "factored", factored)
    with pools.limit(limits=2):
        world_of(falling_wall(12, 5), 1e-3).hold(1)
        after = {pool["num_threads"] for pool in pools.info()}
    assert set(seen) == {1}
    assert after == {2}


def test_corners_open_and_slide_and_are_no_length() -> None:
    problem = ladder(60)
    assembly, size = problem.assembly, problem.assembly.size
    assert assembly.shortest == 1.0
    built = np.column_stack([assembly.centres / size, [0.0]])
    # Down by 0.01: it slides at the wall, and would enter the floor.
    down = built - [0.0, 0.01, 0.0]
    motion = joint_motion(assembly, down)
    assert motion.gap[:, 0] == pytest.approx([-0.01, 0.0], abs=1e-12)
    assert np.abs(motion.slip) == pytest.approx([0.0, 0.01], abs=1e-12)
    assert overlap_and_slip(assembly, down)[0] == pytest.approx(1.0)
    closed, slides, opened = JointState.CLOSED, JointState.SLIDES, JointState.OPEN
    for shift, states in (
        ([0.0, 0.01, 0.0], [opened, slides]),
        ([-0.01, 0.0, 0.0], [slides, opened]),
        ([0.0, 0.0, 0.0], [closed, closed]),
        # Beyond the end of the floor there is nothing to slide on.
        ([-4.5 / size, 0.0, 0.0], [opened, opened]),
    ):
        assert [each.state for each in classify(assembly, built + shift)] == states
    # The bar turns about its foot: there it is closed, and it leaves the wall.
    angle, arm = 0.01, built[0, :2]
    turned = np.array([[*(turning(angle) @ arm), angle]])
    assert [each.state for each in classify(assembly, turned)] == [closed, opened]


def test_the_study_says_what_a_wrong_answer_is() -> None:
    (question,) = questions("trilithon")
    line = answered("trilithon", replace(question, expected=0.26), moving=False)
    assert line["inside"] == Verdict.COLLAPSES
    assert counted([line]) == {"false": 1, "right": 1}
    assert line["error"] == pytest.approx(0.01 / 0.26)


@pytest.mark.parametrize(
    ("friction", "wall", "push"),
    [
        # Its onset needs a guess by friction that is less than none can slip by.
        ("inf", (1.99988, 2, 0.392257, 0.347258), 2.55175),
        # Its moving run needs a step in two halves.
        (1.459, (1.05861, 3, 0.289222, 0.513372), 1.2217),
    ],
)
def test_pushed_walls_are_not_left_open(
    friction: float | str, wall: tuple[float, int, float, float], push: float
) -> None:
    length, courses, height, bond = wall
    table = {
        "kind": "wall", "friction": friction, "length": length, "courses": courses,
        "block_height": height, "bond": bond, "live": [{"body": [1, 0]}],
    }  # fmt: skip
    pushed = structure_of(table).with_load(push)
    assert certificate(pushed).stands is False
    assert observe(pushed, "direct").verdict is Verdict.COLLAPSES
