"""First steps of `direct`, held to Lemke's pivoting of the same contact problem.

Coulomb's law may have several answers. Each of the two has to be one; they have to be the same
but where friction leaves a choice, and of rest and motion `direct` has to choose rest.
"""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from arches import least
from lemke import lemke, pivoted
from test_contact import chain, dense, step_of
from worlds import DIRECT, Blocks, ContactProblem

from blocksim import Arch, CircularArch, Problem, collapse, equilibrium
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


def released(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Compare the step that the engine's onset test asks for."""
    asked: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    solve = ContactProblem.solve

    def kept(
        self: ContactProblem,
        rows: np.ndarray,
        rates: np.ndarray,
        free: np.ndarray,
        *more: object,
    ):
        asked.append((rows, rates, free))
        return solve(self, rows, rates, free, *more)

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
    return held, other, same


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
        held, other, same = released(problem, monkeypatch)
        rests = np.abs(held).max() < 1e-9
        assert rests == equilibrium(problem).exists
        assert rests or np.abs(other).max() > 1e-6
        assert same
        told[bool(rests)] += 1
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
        held, other, same = released(problem, monkeypatch)
        rests = np.abs(held).max() < 1e-9
        assert rests == equilibrium(problem).exists
        assert rests or np.abs(other).max() > 1e-6
        told[bool(rests), bool(same)] += 1
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
