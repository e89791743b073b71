"""pybullet and mujoco in space, held to known cases a hundredth to either side."""

from __future__ import annotations

import numpy as np
import pytest
from space_cases import asked
from worlds import observe

import blocksim
from blocksim import Verdict

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


FEW = (
    *("arch_15_skew_0_crown", "arch_15_skew_30_across", "column_4_4_30", "dome_8_5_falls"),
    *("dome_8_5_stands", "jenga_8_falls", "three_posts_shared", "tower_102_pushed", "twist_4"),
    *("twist_6", "wall_6_4_2_0_-1_0"),
)
"""Of each shape and load one; the study `space_cases` asks about all 55."""


@pytest.mark.long
@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("case", FEW)
def test_no_case_is_told_falsely(case: str, name: str) -> None:
    """What an engine does not find is open, never false; by the onset test."""
    pytest.importorskip(name, exc_type=ImportError)
    for problem, verdict in asked(case, 0.01):
        seen = observe(problem, name, moving=False)
        assert seen.verdict in (verdict, Verdict.UNDECIDED)


@pytest.mark.parametrize("case", ["tower_102", "twist_6", "arch_15_skew_30_crown"])
def test_bullet_finds_one_contact_at_each_corner(case: str) -> None:
    """Where limit analysis has its points."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    from blocksim.engines.bulletsolids import Spatial
    from blocksim.engines.bulletspace import Space

    (problem, _), *_ = asked(case, 0.5)
    parts = Spatial(problem)
    space = Space(parts.frame, parts.breaking)
    parts.linked(space)
    space.find_contacts()
    found = np.array([each.place for each in space.contacts()])
    joints = problem.assembly.joints
    known = np.concatenate([each.points for each in joints]) / problem.assembly.size
    assert len(found) == len(known)
    apart = np.linalg.norm(found[:, None] - known, axis=2)
    assert apart.min(axis=0).max() < 2e-6
    assert apart.min(axis=1).max() < 2e-6
