"""pybullet and mujoco in space, held to known cases a hundredth to either side."""

from __future__ import annotations

import pytest
from space_cases import NAMES, asked

import blocksim
from blocksim import Verdict
from blocksim.engines import get_engine
from blocksim.simulation.space import observe_in_space

ENGINES = ("pybullet", "mujoco")
QUICK = ("block_topples_20", "plate_slides_25", "tower_102", "tower_113", "harmonic_4_out")
"""Of each kind one that is answered at once: turning, sliding, rest, a fall."""


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("case", QUICK)
def test_a_case_is_told_by_onset_test_and_moving_run(case: str, name: str) -> None:
    pytest.importorskip(name, exc_type=ImportError)
    for problem, verdict in asked(case, 0.01):
        answer = blocksim.check(problem, method=name)
        assert answer.verdict is verdict
        assert [each.test for each in answer.evidence][:2] == ["onset test", "moving run"]


@pytest.mark.long
@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("case", [each for each in NAMES if "dome_12" not in each])
def test_no_case_is_told_falsely(case: str, name: str) -> None:
    """What an engine does not find is open, never false; by the onset test."""
    pytest.importorskip(name, exc_type=ImportError)
    for problem, verdict in asked(case, 0.01):
        seen = observe_in_space(problem, get_engine(name), moving=False)
        assert seen.verdict in (verdict, Verdict.UNDECIDED)
