"""The search for the least thickness, on judges whose answer is known beforehand.

A judge with a threshold must be bracketed to the tolerance; one that goes dark near its
threshold must leave a bracket that still holds it; one that never stands must say so.
"""

import math
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from worlds import hold

from blocksim import CircularArch, Mode, Problem, Verdict, Wall, bracket
from blocksim.arch.circular import ETA_MAX
from blocksim.ask.search import Answer, Bisection
from blocksim.simulation.observation import Held

tolerances = st.floats(1e-4, 0.3)
thresholds = st.floats(1e-3, 1.99)
guesses = st.floats(0.2, 5.0)
"""Guess over threshold."""


def run(judge, guess: float, tol: float) -> tuple[Bisection, list[float]]:
    asked: list[float] = []

    def listening(eta: float) -> Answer:
        asked.append(eta)
        return Answer(judge(eta), math.nan)

    search = Bisection(judge=listening)
    search.expand(min(guess, ETA_MAX))
    search.bisect(tol)
    return search, asked


@given(thresholds, guesses, tolerances)
def test_threshold_is_bracketed(threshold: float, guess: float, tol: float) -> None:
    search, asked = run(
        lambda eta: Verdict.STANDS if eta >= threshold else Verdict.COLLAPSES,
        threshold * guess,
        tol,
    )
    assert search.low < threshold <= search.high
    assert 1 - search.low / search.high <= tol
    assert search.undecided == 0
    assert search.runs == len(asked) == len(set(asked))
    # Doubling steps, then halves: logarithmic in what is asked for.
    assert search.runs <= 14 + math.log2(1 / tol) + 4 * abs(math.log2(guess))
    assert all(0 < eta <= ETA_MAX for eta in asked)


@given(thresholds, guesses, st.floats(1e-8, 0.1), st.floats(-0.9, 3.0), st.floats(0.1, 10.0))
def test_accelerations_shorten_the_search(
    threshold: float, guess: float, tol: float, bend: float, slope: float
) -> None:
    """An acceleration that vanishes at the threshold, in a straight line or a bent one."""

    def judge(eta: float) -> Answer:
        short = 1 - eta / threshold
        if short <= 0:
            return Answer(Verdict.STANDS, 0.0)
        return Answer(Verdict.COLLAPSES, slope * short * (1 + bend * short))

    search = Bisection(judge)
    search.expand(min(threshold * guess, ETA_MAX))
    before = search.runs
    search.bisect(tol)
    assert search.low < threshold <= search.high
    assert 1 - search.low / search.high <= tol
    # Halving alone takes up to 26; of 60,000 such searches the longest took 17.
    assert search.runs - before <= 18


@given(thresholds, st.floats(1e-6, 0.1), st.randoms(use_true_random=False))
def test_senseless_accelerations_do_no_harm(threshold: float, tol: float, random) -> None:
    search = Bisection(
        lambda eta: Answer(
            Verdict.STANDS if eta >= threshold else Verdict.COLLAPSES, random.uniform(0, 1)
        )
    )
    search.expand(threshold)
    search.bisect(tol)
    assert search.low < threshold <= search.high
    assert 1 - search.low / search.high <= tol
    assert search.runs <= 14 + 3 * math.log2(1 / tol)


@given(thresholds, st.floats(0.97, 1.03), tolerances, st.floats(1e-4, 0.05))
def test_undecided_band_stays_inside_the_bracket(
    threshold: float, guess: float, tol: float, band: float
) -> None:
    def judge(eta: float) -> Verdict:
        if abs(eta / threshold - 1) < band:
            return Verdict.UNDECIDED
        return Verdict.STANDS if eta > threshold else Verdict.COLLAPSES

    search, asked = run(judge, threshold * guess, tol)
    dark = [eta for eta in asked if judge(eta) is Verdict.UNDECIDED]
    assert search.undecided == len(dark)
    assert search.runs == len(asked) < 80
    if search.high is not None:
        assert search.low < threshold < search.high
        # Not wider than the band and the tolerance leave it.
        width = 1 - search.low / search.high
        assert width <= max(tol, 1 - (1 - band) / (1 + band) + tol)
    else:
        assert threshold * (1 + band) > ETA_MAX


@given(st.floats(1e-3, 2.0), tolerances, st.sampled_from([*Verdict]))
def test_where_nothing_changes_one_end_is_open(
    guess: float, tol: float, verdict: Verdict
) -> None:
    search, asked = run(lambda _eta: verdict, guess, tol)
    assert search.low == (ETA_MAX if verdict is Verdict.COLLAPSES else None)
    assert search.high == (min(asked) if verdict is Verdict.STANDS else None)
    assert search.undecided == (search.runs if verdict is Verdict.UNDECIDED else 0)
    assert search.runs == len(asked) < (20 if verdict is Verdict.COLLAPSES else 60)


@pytest.mark.parametrize("verdict", [Verdict.STANDS, Verdict.COLLAPSES, Verdict.UNDECIDED])
@given(st.floats(1e-9, 1e9), st.floats(1.0, 1e6), st.floats(0.1, 10.0))
def test_nothing_beyond_the_range_is_asked(
    verdict: Verdict, floor: float, wide: float, guess: float
) -> None:
    """Nor is the range left before both of its ends have had their say."""
    asked: list[float] = []

    def judge(value: float) -> Answer:
        asked.append(value)
        return Answer(verdict, math.nan)

    ceiling = floor * wide
    Bisection(judge, floor=floor, ceiling=ceiling).expand(guess * math.sqrt(floor * ceiling))
    assert floor <= min(asked)
    assert max(asked) <= ceiling
    assert verdict is Verdict.STANDS or max(asked) == ceiling
    assert verdict is Verdict.COLLAPSES or min(asked) == floor


@pytest.mark.parametrize("method", ["theory", "limit", "pymunk"])
def test_where_nothing_stands(method: str) -> None:
    arch = CircularArch(half_angle=math.pi / 2, friction=0.25, voussoirs=9, weight="centreline")
    told = bracket(arch, method=method).arch
    assert (told.eta_low, told.eta_high, told.centre) == (2, None, None)
    assert (told.mode, told.eta_theory) == (Mode.SS, None)


def test_what_stands_without_friction_stands_down_to_the_end_of_the_range() -> None:
    found = bracket(Wall(friction=0.8), over="mu")
    assert (found.low, found.high, found.limit, found.confirmed) == (None, 0.0, 0.0, None)
    assert "forces of equilibrium exist down to 0" in str(found.evidence)


@pytest.mark.parametrize("confirm", [True, False])
def test_no_ratio_is_held_twice(confirm: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    held: list[float] = []

    def counted(problem: Problem, engine: str, **asked: object) -> Held:
        arch = problem.maker.shape
        assert arch
        held.append(arch.eta)
        return hold(problem, engine, **asked)

    monkeypatch.setattr(sys.modules["blocksim.simulation.observation"], "hold", counted)
    arch = CircularArch(half_angle=math.pi / 2, friction=0.7, voussoirs=9, weight="centreline")
    found = bracket(arch, method="pymunk", confirm=confirm)
    assert found.runs == len(held) == len(set(held))
    assert {found.arch.eta_low, found.arch.eta_high} <= set(held)
    assert found.arch.mode is Mode.RRR
    assert found.confirmed is (True if confirm else None)
    assert f"ends {'confirmed' if confirm else 'not tried'} by moving runs" in found.reason
