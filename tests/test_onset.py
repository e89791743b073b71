"""Where Coulomb's law has two answers, rest and motion, and what the onset test says there.

An equilibrium exists above the least thickness: that is exact, by limit analysis and by
`direct`. A motion found there by an impulse engine must not be believed.
"""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from arches import arch_at, bracket_at
from worlds import ContactProblem, hold, observe

from blocksim import CircularArch, Verdict, check
from blocksim.engines.contact import Solution

TWO_ANSWERS = [
    (125.023, 0.8594, 10, "centreline"),
    (129.59079, 0.9681690607, 24, "sector"),
    (148.65732, 2.0065096596, 12, "sector"),
    (150.094, 2.7221, 5, "sector"),
    (151.66775, 2.150333384, 7, "sector"),
    (155.0, 3.0, 7, "centreline"),
]
"""Half-angle, friction, voussoirs, weight: above the limit impulses from nothing move these."""
Case = tuple[float, float, int, str]
every_case = pytest.mark.parametrize("case", TWO_ANSWERS)


@every_case
@pytest.mark.parametrize(
    ("ratio", "right"), [(0.99, "collapses"), (0.9995, "collapses"), (1.0005, "stands")]
)
@pytest.mark.parametrize("engine", ["pymunk", "direct"])
def test_an_arch_stands_if_it_can_rest(
    engine: str, ratio: float, right: str, case: Case
) -> None:
    arch = CircularArch.of(arch_at(ratio, *case), case[1])
    assert check(arch, method=engine, reduce=False).verdict == right


@every_case
def test_brackets_close_where_there_are_two_answers(case: Case) -> None:
    exact = arch_at(1.0, *case).eta
    found = bracket_at(*case, method="pymunk", tol=2e-4)
    assert found.confirmed
    assert found.undecided == 0
    assert found.arch.eta_low < exact < found.arch.eta_high
    assert found.arch.eta_high / found.arch.eta_low <= 1 + 2.1e-4
    assert found.arch.mode == found.arch.mode_limit


def test_what_was_given_is_told() -> None:
    """The answer says whether it took forces of equilibrium to find rest."""
    case = TWO_ANSWERS[-1]
    assert (
        "they were given"
        in hold(CircularArch.of(arch_at(1.01, *case), case[1]).problem(), "pymunk").onset.reason
    )
    alone = hold(CircularArch.of(arch_at(1.01, 90.0, 0.7, 27), 0.7).problem(), "pymunk").onset
    assert alone.verdict is Verdict.STANDS
    assert alone.forces is None


@pytest.mark.parametrize(
    "case",
    [pytest.param(TWO_ANSWERS[1], marks=pytest.mark.long), TWO_ANSWERS[2], *TWO_ANSWERS[4:]],
)
def test_bullet_keeps_forces_it_is_given(case: Case) -> None:
    """It keeps no impulses: joints press by themselves, and friction has to be found."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    below = hold(CircularArch.of(arch_at(0.9995, *case), case[1]).problem(), "pybullet").onset
    above = hold(CircularArch.of(arch_at(1.0005, *case), case[1]).problem(), "pybullet").onset
    assert below.verdict is Verdict.COLLAPSES
    assert above.verdict is Verdict.STANDS
    assert "they were given" in above.reason


def test_pybullet_says_why_it_is_undecided() -> None:
    """Let go, it moves: blocks that can rest may do so, and Bullet forgets friction."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    case = TWO_ANSWERS[-1]
    seen = observe(CircularArch.of(arch_at(1.0005, *case), case[1]).problem(), "pybullet")
    assert seen.verdict is Verdict.UNDECIDED
    assert "friction may let it move, too" in seen.reason
    assert "released, it moved" in seen.reason


def test_what_cannot_be_found_is_said_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers that end in none give no verdict, and no reason says nan."""
    problem = CircularArch.of(arch_at(1.01, 90, 0.7, 9), 0.7).problem()
    held = hold(problem, "direct")
    solve = ContactProblem.solve

    def broken(*args: object, **named: object) -> Solution:
        found = solve(*args, **named)
        return replace(found, acceleration=found.acceleration * math.nan, residual=math.nan)

    monkeypatch.setattr(ContactProblem, "solve", broken)
    for seen in (hold(problem, "direct").onset, held.release()):
        assert seen.verdict is Verdict.UNDECIDED
        assert "contact forces could not be found" in seen.reason
        assert "nan" not in seen.reason
