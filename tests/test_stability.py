"""Both sides of the boundaries within which engines answer: right inside, undecided outside.

Where they lie was measured over arches, steps and sweeps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from arches import arch_at

from blocksim import CircularArch, Problem, Verdict, check, simulate

SIDES = [(0.98, Verdict.COLLAPSES), (1.02, Verdict.STANDS)]


def problem_at(ratio: float, angle: float, mu: float, count: int) -> Problem:
    return CircularArch.of(arch_at(ratio, angle, mu, count), mu).problem()


def moved_away(problem: Problem, distance: float) -> Problem:
    """The same built elsewhere, by a distance to the right [size]."""
    assembly = problem.assembly
    by = np.array([distance * assembly.size, 0.0])
    blocks = [
        replace(block, vertices=block.vertices + by, centre=block.centre + by)
        for block in assembly.blocks
    ]
    joints = [
        replace(joint, inner=joint.inner + by, outer=joint.outer + by)
        for joint in assembly.joints
    ]
    away = replace(assembly, blocks=tuple(blocks), joints=tuple(joints))
    return Problem(assembly=away, mu=problem.mu)


@pytest.mark.parametrize(("ratio", "right"), SIDES)
@pytest.mark.parametrize(
    ("engine", "angle", "count", "short"),
    [("pymunk", 90, 27, 5), ("pybullet", 45, 7, 80)],
)
def test_sweeps_allowed_to_slender_arches(
    engine: str, angle: float, count: int, short: int, ratio: float, right: Verdict
) -> None:
    """The shorter the joints, the more sweeps; with too few of them it is undecided."""
    pytest.importorskip(engine, exc_type=ImportError)
    problem = problem_at(ratio, angle, 0.9, count)
    few = {"hold_sweeps": short * count**2}
    assert check(problem, method=engine, reduce=False).verdict is right
    seen = check(problem, method=engine, reduce=False, settings=few)
    assert seen.verdict in (right, Verdict.UNDECIDED)
    if engine == "pybullet":
        assert "not converged" in seen.reason


@pytest.mark.parametrize("engine", ["direct", "pymunk", "pybullet"])
@pytest.mark.parametrize(("ratio", "right"), SIDES)
def test_far_from_the_origin(engine: str, ratio: float, right: Verdict) -> None:
    """Beyond, round-off would hide what starts to move, or throw blocks."""
    pytest.importorskip("pybullet" if engine == "pybullet" else "numpy", exc_type=ImportError)
    problem = problem_at(ratio, 90, 0.7, 9)
    farthest = simulate(problem, method=engine, duration=0.01).settings.farthest
    near, far = (
        check(moved_away(problem, share * farthest), method=engine) for share in (0.99, 1.01)
    )
    assert near.verdict is right
    assert "from the origin" not in near.reason
    assert far.verdict is Verdict.UNDECIDED
    assert "from the origin" in far.reason


@pytest.mark.parametrize(
    ("step", "sweeps", "word"),
    [
        (1.9, 1, ""),
        (0.5, 0.5, ""),
        (2.1, 2.1, "time step 2.1"),
        (1, 0.4, "sweeps 0.4"),
        (1.9, 0.8, "sweeps 0.4"),
    ],
)
def test_settings_beyond_those_measured_are_named(
    step: float, sweeps: float, word: str
) -> None:
    """Of a moving run: what a setting does to the onset test shows in that itself."""
    problem = problem_at(1.02, 90, 0.7, 27)
    rule = simulate(problem, method="pymunk", duration=0.01).settings
    chosen = {"step": rule.step * step, "sweeps": round(rule.sweeps * sweeps)}
    seen = check(problem, method="pymunk", reduce=False, settings=chosen)
    assert ("to be sure" in seen.reason) == (word != "")
    assert word in seen.reason
