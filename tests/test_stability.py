"""Both sides of the boundaries within which engines answer: right inside, undecided outside.

Where they lie was measured over arches, steps and sweeps.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from blocksim import Arch, Assembly, CircularArch, Problem, Verdict
from blocksim.arch.limit import least_thickness
from blocksim.simulation.motion import Motion, moving_run
from blocksim.simulation.observation import Held, conclude
from blocksim.simulation.onset import Onset, onset
from blocksim.simulation.simulated import Simulation

SIDES = [(0.98, Verdict.COLLAPSES), (1.02, Verdict.STANDS)]


def setup_at(ratio: float, angle: float, mu: float, count: int, engine: str) -> Simulation:
    if engine == "pybullet":
        pytest.importorskip("pybullet", exc_type=ImportError)
    least = least_thickness(math.radians(angle), mu, count).eta
    arch = Arch(half_angle=math.radians(angle), eta=least * ratio, voussoirs=count)
    return Simulation.of(CircularArch.of(arch, mu).problem(), engine)


def moved_away(assembly: Assembly, distance: float) -> Assembly:
    """The same built elsewhere, by a distance to the right [size]."""
    by = np.array([distance * assembly.size, 0.0])
    blocks = [
        replace(block, vertices=block.vertices + by, centre=block.centre + by)
        for block in assembly.blocks
    ]
    joints = [
        replace(joint, inner=joint.inner + by, outer=joint.outer + by)
        for joint in assembly.joints
    ]
    return replace(assembly, blocks=tuple(blocks), joints=tuple(joints))


def held(simulation: Simulation) -> Onset:
    return onset(simulation.world(), simulation)


def released(simulation: Simulation, until: float | None = None) -> Motion:
    """Let go from impulses that the rule's own settings have converged."""
    ruled = replace(simulation, settings=simulation.engine.rule(simulation.assembly))
    repeat = held(ruled).repeat
    world = simulation.world()
    repeat(world)
    return moving_run(simulation, world, repeat, until=until)


@pytest.mark.parametrize(("ratio", "right"), SIDES)
@pytest.mark.parametrize(
    ("engine", "angle", "count", "short"),
    [("pymunk", 20, 8, 4000), ("pymunk", 90, 27, 5), ("pybullet", 45, 7, 80)],
)
def test_sweeps_allowed_to_slender_arches(
    engine: str, angle: float, count: int, short: float, ratio: float, right: Verdict
) -> None:
    """The shorter the joints, the more sweeps; with too few of them it is undecided."""
    simulation = setup_at(ratio, angle, 0.9, count, engine)
    assert held(simulation).verdict is right
    # From nothing: with forces to begin with pymunk takes fewer.
    few = replace(simulation.settings, hold_sweeps=round(short * count**2), unaided=None)
    seen = held(replace(simulation, settings=few))
    assert seen.verdict is Verdict.UNDECIDED
    assert "not converged" in seen.reason


@pytest.mark.parametrize(("sweeps", "right"), [(1 / 16, False), (1, True)])
@pytest.mark.parametrize("ratio", [0.98, 0.995])
def test_sweeps_of_a_release(ratio: float, sweeps: float, right: bool) -> None:
    """Too few of them press blocks into each other, which is seen, and mended by more."""
    simulation = setup_at(ratio, 90, 0.7, 27, "pymunk")
    changed = round(simulation.settings.sweeps * sweeps)
    simulation = replace(simulation, settings=replace(simulation.settings, sweeps=changed))
    seen = released(replace(simulation, settings=replace(simulation.settings, repeats=0)))
    assert seen.verdict is (Verdict.COLLAPSES if right else Verdict.UNDECIDED)
    assert right or "overlap" in seen.reason
    assert released(simulation).verdict is Verdict.COLLAPSES


@pytest.mark.parametrize("engine", ["direct", "pymunk", "pybullet"])
@pytest.mark.parametrize("far", [False, True])
@pytest.mark.parametrize(("ratio", "right"), SIDES)
def test_far_from_the_origin(engine: str, far: bool, ratio: float, right: Verdict) -> None:
    """Beyond, round-off would hide what starts to move, or throw blocks."""
    simulation = setup_at(ratio, 90, 0.7, 9, engine)
    farthest = simulation.settings.farthest
    assembly = moved_away(simulation.assembly, farthest * (1.01 if far else 0.99))
    problem = Problem(assembly=assembly, mu=simulation.problem.mu)
    away = replace(simulation, problem=problem)
    seen = onset(away.world(), away)
    assert seen.verdict is (Verdict.UNDECIDED if far else right)
    assert ("from the origin" in seen.reason) == far


@pytest.mark.parametrize(
    ("step", "sweeps", "word"),
    [
        (1, 1, ""),
        (1.9, 1, ""),
        (0.5, 0.5, ""),
        (2.1, 2.1, "time step 2.1"),
        (1, 0.4, "sweeps 0.4"),
        (1.9, 0.8, "sweeps 0.4"),
    ],
)
@pytest.mark.parametrize("moving", [True, False])
def test_settings_beyond_those_measured_are_named(
    step: float, sweeps: float, word: str, moving: bool
) -> None:
    """Of a moving run: what a setting does to the onset test shows in that itself."""
    simulation = setup_at(1.02, 90, 0.7, 27, "pymunk")
    rule = simulation.settings
    chosen = replace(rule, step=rule.step * step, sweeps=round(rule.sweeps * sweeps))
    changed = replace(simulation, settings=chosen)
    world = changed.world()
    first = onset(world, changed)
    seen = conclude(Held(simulation=changed, world=world, onset=first), moving=moving)
    assert ("to be sure" in seen.reason) == (moving and word != "")
    assert not moving or word in seen.reason
