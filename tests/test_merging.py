"""Blocks that do not part, merged: the answer is that of all blocks, of any structure.

Truth is the known limits of structures, Newton's law for every block, and all blocks in the
same engine. A guess of which blocks part is made wrong on purpose, and must not change an
answer.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from structure_cases import case, scenes
from worlds import Simulation, hold, observe, onset

from blocksim import (
    JointState,
    Load,
    Problem,
    Verdict,
    assembly_of_polygons,
    bracket,
    check,
    equilibrium,
    structure_of,
)
from blocksim.simulation.merging import Merging
from tests.assemblies import KINDS as DRAWN
from tests.assemblies import box, sketch

SLOW = ("ferris_tinloi_1", 1)
LOADED = ("oppenheim_28", "ferris_tinloi_1", "two_spans_load_b9")
"""Structures whose largest load factor is known."""


def known(name: str, share: float) -> Problem:
    """Return a structure under a share of the load it bears."""
    problem = structure_of(scenes(name)[0])
    return problem.with_load(share * case(name)["expected"]["value"])


def merged(problem: Problem, *bodies: tuple[int, ...]) -> Merging:
    """Merge as told; what is not told of is a body each."""
    owner = np.full(len(problem.assembly.blocks), -1)
    for body, its in enumerate(bodies):
        owner[list(its)] = body
    alone = np.flatnonzero(owner < 0)
    owner[alone] = len(bodies) + np.arange(len(alone))
    return Merging(problem, owner)


def at_random(kind: str, seed: int) -> Problem:
    """Return an assembly drawn at random under half the load it was drawn with."""
    return sketch(kind, np.random.default_rng(seed)).problem().with_load(0.5)


def pillar(tilt_deg: float) -> Problem:
    """Three blocks on a floor: the slender one on top topples at atan(0.3/2), 8.5 deg."""
    polygons = [box(-9, -1, 9, 0), box(0, 0, 6, 1), box(0, 1, 6, 2), box(2, 2, 2.3, 4)]
    assembly = assembly_of_polygons(polygons, fixed={0})
    return Problem(assembly=assembly, mu=0.9).tilted(math.radians(tilt_deg))


def accelerations(held) -> np.ndarray:
    return held.world.hold(1)[:, :3]


# What is simulated.


@pytest.mark.parametrize("kind", DRAWN)
def test_bodies_weigh_and_are_pulled_as_their_blocks(kind: str) -> None:
    whole = at_random(kind, 3)
    count = len(whole.assembly.blocks)
    whole = replace(whole, dead=(Load(force=(3.0, 1.0), blocks=tuple({0, count - 1})),))
    rng = np.random.default_rng(1)
    owner = np.unique(rng.integers(0, 1 + count // 3, count), return_inverse=True)[1]
    bodies = Merging(whole, owner).problem

    def about_origin(problem: Problem) -> tuple[np.ndarray, ...]:
        """Forces and moments [N, N m], masses and polar moments about the origin."""
        assembly, pull = problem.assembly, problem.applied_forces() * problem.unit_force
        x, y = assembly.centres.T
        pull[:, 2] = pull[:, 2] * assembly.size + x * pull[:, 1] - y * pull[:, 0]
        mass = np.array([block.mass for block in assembly.blocks])
        inertia = np.array([block.inertia for block in assembly.blocks])
        moments = np.column_stack([mass, mass * x, mass * y, inertia + mass * (x**2 + y**2)])
        return pull, moments

    for few, every in zip(about_origin(bodies), about_origin(whole), strict=True):
        for body in range(owner.max() + 1):
            expected = every[owner == body].sum(axis=0)
            assert few[body] == pytest.approx(
                expected, rel=1e-9, abs=1e-9 * np.abs(every).max()
            )


@pytest.mark.parametrize("columns", [3, 6])
def test_blocks_of_a_body_stay_where_they_are_in_it(columns: int) -> None:
    whole = known("oppenheim_28", 1.0)
    made = merged(whole, tuple(range(5)), tuple(range(5, 20)))
    start = np.zeros((len(made.assembly.blocks), columns))
    start[:, :2] = made.assembly.centres / whole.assembly.size
    rng = np.random.default_rng(2)
    moved = start + rng.uniform(-1, 1, start.shape)
    built, poses = made.poses(start), made.poses(moved)
    assert built[:, :2] == pytest.approx(
        whole.assembly.centres / whole.assembly.size, abs=1e-12
    )
    for first, last in ((0, 4), (5, 19)):
        place = [0, 1, 3] if columns == 6 else [0, 1]
        apart = [
            np.linalg.norm(each[last, place] - each[first, place]) for each in (built, poses)
        ]
        assert apart[0] == pytest.approx(apart[1], abs=1e-12)
        assert poses[first, 2] == poses[last, 2]
    rates = rng.uniform(-1, 1, start.shape)
    after, before = (made.poses(start + sign * 1e-4 * rates) for sign in (1, -1))
    assert (after - before) / 2e-4 == pytest.approx(made.rates(rates), abs=1e-7)


# Whether the guess was right.


@pytest.mark.parametrize("name", LOADED)
@pytest.mark.parametrize("share", [0.9, 0.99])
def test_forces_of_equilibrium_are_taken_and_no_others(name: str, share: float) -> None:
    """What joints carry is given: of a state of all blocks, and of one without its friction."""
    problem = known(name, share)
    guess = Merging.of(problem)
    joints = problem.assembly.joint_arrays
    forces = equilibrium(problem).forces
    along = np.stack([joints.normal, joints.tangent], axis=1)
    acting = np.einsum("jek,jkd->jed", forces, along)
    x, y = joints.ends[..., 0], joints.ends[..., 1]
    moments = (x * acting[..., 1] - y * acting[..., 0]).sum(axis=1)
    carried = np.column_stack([acting.sum(axis=1), moments])
    carried *= problem.unit_force / guess.problem.unit_force
    carried = carried[list(guess.kept)]
    assert guess.left(carried, problem)[:, :2].sum() == pytest.approx(0, abs=1e-6)
    assert guess.parting(carried, problem, 1e-9)[0]
    # Bodies that carry ten times their weight upside down hold together by nothing.
    assert not guess.parting(-10 * carried, problem, 1e-6)[0]


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_resultants_obey_newton_for_every_body(engine: str, share: float) -> None:
    """Several joints lie between the same two bodies of a wall."""
    problem = known("ferris_tinloi_1", share)
    fives = Merging(problem, np.arange(33) // 5)
    world = Simulation.of(problem, engine, reduction=fives).world()
    rates = world.hold(20_000 if engine != "direct" else 1)[:, :3]
    found = fives.acting(world.resultants(), problem)[1]
    assert found == pytest.approx(rates, abs=1e-4)


def test_without_a_second_look_a_wrong_guess_would_stand(engine: str) -> None:
    problem = pillar(10.0)
    assert not equilibrium(problem).exists
    wrong = merged(problem, (0, 1, 2))
    simulation = Simulation.of(problem, engine, reduction=wrong)
    world = simulation.world()
    first = onset(world, simulation)
    assert first.verdict is Verdict.STANDS
    held = hold(problem, engine, reduction=wrong)
    assert held.onset.verdict is Verdict.COLLAPSES
    # The slender one has parted from the others, or all have.
    assert held.simulation.blocks > 1


def test_a_wrong_guess_that_slides_is_seen() -> None:
    """A block on a smooth joint within a body."""
    problem = pillar(5.0)
    joints = [
        replace(joint, friction=0.05) if joint.after == 2 or joint.before == 2 else joint
        for joint in problem.assembly.joints
    ]
    smooth = replace(problem, assembly=replace(problem.assembly, joints=tuple(joints)))
    held = hold(smooth, "direct", reduction=merged(smooth, (0, 1, 2)))
    assert held.onset.verdict is Verdict.COLLAPSES
    slides = 9.81 * 0 + math.sin(math.radians(5)) - 0.05 * math.cos(math.radians(5))
    found = accelerations(held)
    assert found[2, 0] == pytest.approx(slides, abs=1e-6)
    assert np.abs(found[:2]).max() < 1e-9


@pytest.mark.parametrize("name", ["oppenheim_28", "two_spans_load_b9", "trilithon"])
@pytest.mark.parametrize("share", [0.99, 1.01, 1.3])
def test_any_guess_is_corrected(name: str, share: float) -> None:
    """All blocks of each part that hangs together taken for one."""
    problem = known(name, share)
    joints = problem.assembly.joint_arrays
    owner = np.arange(len(problem.assembly.blocks))
    for before, after in zip(joints.before.tolist(), joints.after.tolist(), strict=True):
        if -1 not in (before, after):
            owner[owner == owner[before]] = owner[after]
    wrong = Merging(problem, np.unique(owner, return_inverse=True)[1])
    held, every = (hold(problem, "direct", reduction=each) for each in (wrong, None))
    assert held.onset.verdict is every.onset.verdict
    if held.onset.verdict is Verdict.COLLAPSES:
        assert accelerations(held) == pytest.approx(accelerations(every), abs=1e-6)


# The answers.


@pytest.mark.parametrize(
    ("name", "side"),
    [
        pytest.param(name, side, marks=[pytest.mark.long] * ((name, side) == SLOW))
        for name in (*LOADED, "segmental_point_quarter")
        for side in (-1, 1)
    ],
)
def test_merged_it_answers_as_is_known(engine: str, name: str, side: int) -> None:
    problem = known(name, 1 + 0.01 * side)
    expected = Verdict.STANDS if side < 0 else Verdict.COLLAPSES
    seen = observe(problem, engine, moving=False, reduction=Merging.of(problem))
    assert seen.verdict is expected, seen.reason
    if expected is Verdict.STANDS and engine != "direct":
        assert seen.blocks < len(problem.assembly.blocks) / 2


def test_let_go_blocks_of_a_body_move_as_one() -> None:
    problem = known("oppenheim_28", 1.01)
    seen = observe(problem, "pymunk", reduction=Merging.of(problem))
    assert seen.verdict is Verdict.COLLAPSES
    assert seen.blocks < 8
    assert f"{seen.blocks} instead of 28 blocks were simulated, by merging" in seen.reason
    recording = seen.motion.recording
    assert recording.problem is problem
    poses = recording.poses
    assert poses.shape[1:] == (28, 3)
    # Blocks turn against each other at hinges of the case, and else not by the last digit.
    turned = {int(k) + 1 for k in np.flatnonzero(np.diff(poses[-1, :, 2]))}
    hinges = {int(index) for index in case("oppenheim_28")["expected"]["joints"]}
    assert len(turned) == seen.blocks - 1
    moving = {k for k, joint in enumerate(seen.joints) if joint.state is not JointState.CLOSED}
    assert moving == hinges
    assert moving <= turned | {0, 28}


def test_by_default_impulse_engines_are_given_few_bodies() -> None:
    problem = known("oppenheim_28", 0.99)
    for method, few in (("direct", False), ("pymunk", True)):
        assert (check(problem, method=method).blocks < 28) is few
    assert check(problem, method="pymunk", reduce=True).blocks < 8
    assert check(problem, method="pymunk", reduce=False).blocks == 28


def test_a_bracket_is_that_of_all_blocks() -> None:
    problem = structure_of(scenes("oppenheim_28")[0])
    few, every = (
        bracket(problem, over="load", method="pymunk", tol=2e-3, reduce=reduce)
        for reduce in (True, False)
    )
    exact = case("oppenheim_28")["expected"]["value"]
    for each in (few, every):
        assert each.low <= exact * (1 + 1e-9)
        assert each.high >= exact * (1 - 1e-9)
        assert each.confirmed
    assert (few.low, few.high) == pytest.approx((every.low, every.high), rel=1e-3)
    assert "were simulated, by merging" in few.reason
    assert "reduced" not in every.reason
