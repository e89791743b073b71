"""First steps of `direct`, held to Lemke's pivoting of the same contact problem.

Coulomb's law may have several answers. Each of the two has to be one; they have to be the same
but where friction leaves a choice, and of rest and motion `direct` has to choose rest.
"""

import math
from collections import Counter
from typing import Any

import numpy as np
import pytest
from arches import least
from hypothesis import given, settings
from hypothesis import strategies as st
from images import turning
from lemke import lemke, pivoted
from scipy.spatial import ConvexHull
from worlds import DIRECT, Blocks, ContactProblem

from blocksim import Arch, CircularArch, Problem, collapse, equilibrium
from blocksim.engines.contact.banded import Bands, System
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.coulomb import Friction
from blocksim.engines.contact.interior import central_path
from blocksim.engines.contact.jammed import around_folds
from blocksim.engines.contact.meeting import Polygons
from blocksim.engines.contact.path_following import path_from_apart
from blocksim.engines.contact.step import Step
from tests.assemblies import drawn

SAME = 1e-8
SIDES = (0.9, 0.999, 1.001, 1.1)


def compared(
    joints: tuple[np.ndarray, np.ndarray],
    step: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    mu: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Accelerations by both, and whether they are the same; that each is a solution."""
    mass, rows, rates, free = step
    found = ContactProblem(*joints, mass, mu).solve(rows, rates, free, None, 1e-14)
    other = pivoted(dense(*joints, len(mass), rows), rates, mass, free, mu)
    assert other is not None, "Lemke's method ends on a ray"
    law = step_of(*joints, *step, mu)
    for x, forces in ((found.acceleration, found.forces), other):
        assert law.residual((x * np.sqrt(mass)).ravel(), forces) < 1e-9
    apart = np.abs(found.acceleration - other[0]).max()
    return found.acceleration, other[0], apart < SAME * max(1.0, np.abs(other[0]).max())


def released(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> tuple[bool, bool]:
    """Compare steps that the engine's onset test asks for: whether it rests, and both do."""
    asked: list[tuple[Any, ...]] = []
    solve = ContactProblem.solve

    def kept(self: ContactProblem, *step: Any):
        asked.append(step[:3])
        return solve(self, *step)

    with monkeypatch.context() as patch:
        patch.setattr(ContactProblem, "solve", kept)
        world = Blocks(problem, DIRECT.rule(problem.assembly))
        held = world.hold(1)
    pairs = world._pairs.T
    own, other, same = compared(
        (pairs[0], pairs[1]),
        (world._mass, *asked[0]),
        world._problem.friction.mu[:, 0],
    )
    assert np.abs(held - own).max() < SAME * max(1.0, np.abs(own).max())
    rests = bool(np.abs(held).max() < 1e-9)
    assert rests == equilibrium(problem).exists
    assert rests or np.abs(other).max() > 1e-6
    return rests, bool(same)


def test_random_chains_move_as_by_pivoting() -> None:
    """But where Coulomb's law has two answers, in one chain of twenty; both are held to it."""
    same = 0
    for seed in range(40):
        random = np.random.default_rng(seed)
        before, after, *step = chain(seed, int(random.integers(1, 7)))
        mu = random.uniform(0.05, 0.6, len(before))
        same += compared((before, after), tuple(step), mu)[2]
    assert same >= 36


@pytest.mark.parametrize("largest", [9, pytest.param(30, marks=pytest.mark.long)])
def test_arches_start_as_by_pivoting(largest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Thinner and thicker than the least thickness, or at any where none will do."""
    random, told = np.random.default_rng(5), Counter[bool]()
    for _ in range(30):
        alpha, mu = math.radians(random.uniform(40, 155)), random.uniform(0.25, 2.0)
        count = int(random.integers(3, largest + 1))
        eta = random.choice(SIDES) * (least(alpha, mu, count).eta_limit or 0.3)
        problem = CircularArch.of(
            Arch(half_angle=alpha, eta=min(eta, 2.0), voussoirs=count), mu
        ).problem()
        rests, same = released(problem, monkeypatch)
        assert same
        told[rests] += 1
    assert min(told[True], told[False]) > 8


@pytest.mark.parametrize("largest", [8, pytest.param(24, marks=pytest.mark.long)])
def test_assemblies_start_as_by_pivoting(largest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Walls, stacks, rubble, under less and more than the load they can carry."""
    told, kinds = Counter[tuple[bool, bool]](), set[str]()
    for seed in range(48):
        sketch = drawn(seed)
        problem = sketch.problem()
        if len(problem.assembly.blocks) > largest or not np.isfinite(problem.friction).all():
            continue
        factor = SIDES[seed % 4] * (collapse(problem).load_factor or 0.0)
        problem = problem.with_load(factor)
        rests, same = released(problem, monkeypatch)
        told[rests, same] += 1
        kinds.add(sketch.kind)
    # Where they differ, both obey the law: friction leaves a choice.
    assert told[True, True] > 5
    assert told[False, True] > max(5, 3 * told[False, False])
    assert len(kinds) >= 5


def test_pivoting_solves_a_problem_of_which_the_answer_is_known() -> None:
    """Murty's, of which the one solution is (0, ..., 0, 1); and one without any."""
    size = 6
    matrix = np.eye(size) + 2 * np.tril(np.ones((size, size)), -1)
    found = lemke(matrix.T, -np.ones(size))
    assert found == pytest.approx([0.0] * (size - 1) + [1.0])
    assert lemke(np.array([[-1.0]]), np.array([-1.0])) is None


def chain(seed, blocks):
    """Blocks in a row between two walls, touching at random places in random directions.

    What their velocities would be without acceleration comes from velocities of the blocks,
    so that stopping them all is always possible.
    """
    random = np.random.default_rng(seed)
    before, after = np.arange(-1, blocks), np.append(np.arange(blocks), -1)
    if blocks > 3:
        # Two that are no neighbours in the row.
        before, after = np.append(before, 0), np.append(after, blocks - 1)
    joints = len(before)
    angle = random.uniform(-0.3, 0.3, (joints, 2))
    angle[:, 1] = angle[:, 0] + random.choice([0.0, 0.05], joints)
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    tangent = np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
    axes = np.concatenate([normal, tangent], axis=1)
    arms = random.uniform(-1, 1, (joints, 2, 2, 2))
    arms = np.concatenate([arms, arms], axis=1)
    turn = arms[..., 0] * axes[:, :, None, 1] - arms[..., 1] * axes[:, :, None, 0]
    rows = np.concatenate([-axes, -turn[:, :, :1], axes, turn[:, :, 1:]], axis=-1)
    velocities = np.vstack([random.normal(size=(blocks, 3)), np.zeros(3)])
    pairs = np.stack([before, after], axis=1)
    rates = np.matmul(rows, velocities[pairs].reshape(joints, 6, 1))[:, :, 0]
    rates[:, :2] += random.uniform(0, 2, (joints, 2)) * random.integers(0, 2, (joints, 2))
    mass = np.repeat(random.uniform(0.5, 2, (blocks, 1)), 3, axis=1)
    mass[:, 2] *= 0.2
    free = np.tile([0.0, -1.0, 0.0], (blocks, 1))
    return before, after, mass, rows, rates, free


def step_of(before, after, mass, rows, rates, free, mu):
    """The same as a step, in accelerations times the root of mass."""
    bands = Bands(before, after, len(mass))
    return Step(
        bands=bands,
        rows=rows * bands.of_joints(1 / np.sqrt(mass).ravel())[:, None, :],
        rates=rates,
        free=(free * np.sqrt(mass)).ravel(),
        friction=Friction.of(mu, len(before)),
    )


def dense(before, after, blocks, rows):
    """Rows as a matrix on all velocities, shape (joints, 4, 3 blocks)."""
    matrix = np.zeros((*rows.shape[:2], 3 * blocks))
    for joint, pair in enumerate(zip(before, after, strict=True)):
        for side, block in enumerate(pair):
            if block >= 0:
                part = rows[joint, :, 3 * side : 3 * side + 3]
                matrix[joint, :, 3 * block : 3 * block + 3] += part
    return matrix


@settings(max_examples=60)
@given(st.integers(0, 2**32), st.integers(1, 8), st.floats(0.05, 3.0))
def test_a_solution_obeys_newton_signorini_and_coulomb(seed, blocks, mu):
    solution, left, (pressure, friction), (opening, slip) = solved(seed, blocks, mu)
    scale = max(1.0, np.abs(solution.acceleration).max())
    assert left < 1e-7 * scale
    assert opening.min() > -1e-8 * scale
    assert np.minimum(pressure, opening).max() < 1e-8 * scale
    assert (np.abs(friction) - mu * pressure).max() < 1e-7 * scale
    slides = np.abs(slip) > 1e-7 * scale
    assert (
        np.abs(friction + mu * pressure * np.sign(slip))[slides].max(initial=0) < 1e-6 * scale
    )


def solved(seed, blocks, mu):
    """A chain's step: its solution, what is out of balance, forces and ways at the ends."""
    before, after, mass, rows, rates, free = chain(seed, blocks)
    solution = ContactProblem(before, after, mass, mu).solve(rows, rates, free, None, 1e-12)
    matrix, x = dense(before, after, blocks, rows), solution.acceleration.ravel()
    pull = np.einsum("jk,jkx->x", solution.forces, matrix)
    left = np.abs(mass.ravel() * (x - free.ravel()) - pull).max()
    ahead, forces = rates + matrix @ x, solution.forces
    assert forces[:, :2].min() >= 0
    return solution, left, (forces[:, :2], forces[:, 2:]), (ahead[:, :2], ahead[:, 2:])


@pytest.mark.parametrize("seeds", [60, pytest.param(601, marks=pytest.mark.long)])
def test_every_joint_keeps_the_law_of_its_own_friction(seeds):
    for seed in range(seeds):
        keeps_the_law_of_its_own_friction(seed, 1 + seed % 6)


@pytest.mark.long
@settings(max_examples=500)
@given(st.integers(0, 2**32), st.integers(1, 6))
def test_every_joint_keeps_the_law_of_its_own_friction_wherever_it_is_drawn(seed, blocks):
    keeps_the_law_of_its_own_friction(seed, blocks)


def keeps_the_law_of_its_own_friction(seed, blocks):
    mu = np.random.default_rng(seed).choice(
        [0.0, 0.6, 40.0, 1e7, np.inf], len(chain(seed, blocks)[0])
    )
    solution, left, (pressure, friction), (opening, slip) = solved(seed, blocks, mu)
    assert solution.residual < 1e-8, seed
    scale = max(1.0, np.abs(solution.acceleration).max(), np.abs(solution.forces).max())
    assert left < 1e-7 * scale
    assert opening.min() > -1e-7 * scale
    assert np.minimum(pressure, opening).max() < 1e-7 * scale
    # No friction across a gap, and none that helps the slip.
    assert np.minimum(np.abs(friction), opening).max() < 1e-6 * scale
    assert np.minimum(friction * np.sign(slip), np.abs(slip)).max() < 1e-6 * scale
    free_of = mu == np.inf
    assert np.minimum(pressure, np.abs(slip))[free_of].max(initial=0) < 1e-6 * scale
    bound = mu[~free_of, None] * pressure[~free_of]
    most = np.maximum(1.0, mu[~free_of, None]) * 1e-6 * scale
    assert (np.abs(friction[~free_of]) - bound - most).max(initial=-1) < 0


def test_a_change_of_forces_that_falls_slowly_is_followed_to_its_end():
    """By four hundredths in a system; taken for one without end it leads far away."""
    keeps_the_law_of_its_own_friction(1250, 5)


def test_a_path_goes_around_its_folds_where_one_that_only_falls_stops():
    """It ends at Coulomb's law every time; the other one is left with 0.1 g in half of them."""
    stopped = 0
    for seed in range(41, 53):
        random = np.random.default_rng(seed)
        before, after, *step = chain(seed, int(random.integers(1, 40)))
        asked = step_of(before, after, *step, random.uniform(0.3, 2.0, len(before)))
        end = around_folds(asked)
        assert asked.residual(end.x, end.forces) < 1e-8
        assert end.systems < 200
        cones = Cones.of(asked)
        falls = cones.answer(asked, *central_path(asked, cones, dilates=False, moves=True))
        stopped += asked.residual(falls.x, falls.forces) > 0.1
    assert stopped == 6


def test_stiff_springs_of_a_wide_system_come_and_go_and_keep_their_digits():
    """Their forces are a hundred-millionth of what makes them up."""
    random, stiff, blocks = np.random.default_rng(3), 1e8, 30
    before = random.integers(0, blocks, 60)
    after = (before + random.integers(1, blocks, 60)) % blocks
    bands = Bands(before, after, blocks)
    assert bands.is_wide
    rows, pushes = random.normal(size=(60, 6)), random.uniform(1, 2, 60)
    free = random.normal(size=bands.size)
    nothing = bands.band(np.zeros((60, 1, 6)), np.zeros((60, 1)), np.zeros((60, 1, 6)))
    system, closed = System(bands, nothing, free), np.zeros(60, dtype=bool)
    for joint in random.integers(0, 60, 100):
        sign = -stiff if closed[joint] else stiff
        closed[joint] = ~closed[joint]
        row = rows[joint]
        system.add(joint, sign * np.outer(row, row), sign * pushes[joint] * row)
        found = stiff * (pushes - (rows * bands.of_joints(system.solve())).sum(axis=1))
        ways = np.zeros((closed.sum(), bands.size + 1))
        for way, at in zip(ways, np.flatnonzero(closed), strict=True):
            np.add.at(way, bands.place[at], rows[at])
        ways = ways[:, :-1]
        flexible = np.eye(len(ways)) / stiff + ways @ ways.T
        forces = np.linalg.solve(flexible, pushes[closed] - ways @ free)
        assert np.abs(found[closed] - forces).max(initial=0.0) < 1e-4


def test_without_slip_a_pushed_block_turns_over_its_corner_and_does_not_slide():
    # A unit square on the ground, gravity leaning: it turns if the lean is beyond 45 degrees.
    mass = np.array([[1.0, 1.0, 1 / 6]])
    corners = np.array([[-0.5, -0.5], [0.5, -0.5]])
    rows = np.zeros((1, 4, 6))
    for end, (x, y) in enumerate(corners):
        rows[0, end, 3:] = 0, 1, x
        rows[0, 2 + end, 3:] = 1, 0, -y
    problem = ContactProblem(np.array([-1]), np.array([0]), mass, np.inf)
    for lean in (0.3, 0.78, 0.79, 1.2, 1.57):
        pull = np.array([[np.sin(lean), -np.cos(lean), 0.0]])
        found = problem.solve(rows, np.zeros((1, 4)), pull)
        # About the corner: moment sin - cos over 2, inertia 1/6 + 1/2, clockwise.
        turning = max(0.0, (np.sin(lean) - np.cos(lean)) / 2 / (2 / 3))
        exact = [turning / 2, turning / 2, -turning]
        assert np.abs(found.acceleration[0] - exact).max() < 1e-9
    # Lifted, it takes no friction.
    lifted = problem.solve(rows, np.zeros((1, 4)), np.array([[0.2, 0.5, 0.0]]))
    assert np.abs(lifted.acceleration[0] - [0.2, 0.5, 0.0]).max() < 1e-9


@settings(max_examples=60)
@given(st.integers(0, 2**32), st.integers(1, 8), st.floats(0.05, 5.0))
def test_the_path_from_apart_always_arrives(seed, blocks, mu):
    before, after, mass, rows, rates, free = chain(seed, blocks)
    step = step_of(before, after, mass, rows, rates, free, mu)
    end = path_from_apart(step)
    assert step.residual(end.x, end.forces) < 1e-5
    assert 0 < end.systems < 40 * len(rows)


def convex(random):
    """The hull of a few random points, about the mean of its corners."""
    points = random.normal(size=(random.integers(3, 9), 2)) * random.uniform(0.3, 1, 2)
    corners = points[ConvexHull(points).vertices]
    return corners - corners.mean(axis=0)


def depth_in(corners, polygon):
    """How far the deepest corner is inside a convex polygon; negative if none is inside."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    off = corners[:, None] - polygon
    heights = edges[:, 0] * off[..., 1] - edges[:, 1] * off[..., 0]
    return float((heights / np.hypot(*edges.T)).min(axis=1).max())


def test_a_corner_inside_a_polygon_is_a_contact():
    """However many corners the other one has."""
    random, count = np.random.default_rng(5), 2000
    shapes = [convex(random) for _ in range(2 * count)]
    poses = np.column_stack(
        [random.normal(size=(2 * count, 2)), random.uniform(0, 6, 2 * count)]
    )
    one, other = np.arange(count), np.arange(count, 2 * count)
    found = Polygons(shapes, []).touch(poses, one, other).gap.min(axis=1)
    placed = [
        corners @ turning(turn).T + (x, y)
        for corners, (x, y, turn) in zip(shapes, poses, strict=True)
    ]
    pairs = [(placed[a], placed[b]) for a, b in zip(one, other, strict=True)]
    deepest = np.array([max(depth_in(a, b), depth_in(b, a)) for a, b in pairs])
    inside = deepest > 1e-9
    assert inside.sum() > 400
    assert (found[inside] < 0).all()
