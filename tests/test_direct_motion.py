"""The direct engine in large motion: a collapse goes to the ground."""

import math
from dataclasses import replace

import numpy as np
from arches import arch_at

from blocksim import CircularArch, Problem, Verdict
from blocksim.blocks.joints import joint_motion
from blocksim.engines.direct import ENGINE, Blocks
from blocksim.simulation.motion import moving_run
from blocksim.simulation.simulated import Simulation


def world_of(assembly, mu, step):
    settings = replace(ENGINE.rule(assembly), step=step)
    return Blocks(Problem(assembly=assembly, mu=mu), settings)


def test_deeper_overlap_than_allowed_is_undecided():
    def hold(world):
        world.hold(1)

    simulation = Simulation.of(
        CircularArch.of(arch_at(0.9, 90, 0.9, 12), 0.9).problem(), "direct"
    )
    # Below the round-off of corners at rest nothing could pass.
    strict = replace(simulation, settings=replace(simulation.settings, penetration=-1.0))
    world = strict.world()
    world.hold(1)
    motion = moving_run(strict, world, hold)
    assert motion.verdict is Verdict.UNDECIDED
    assert "overlap" in motion.reason
    world = simulation.world()
    world.hold(1)
    assert moving_run(simulation, world, hold).verdict is Verdict.COLLAPSES


def test_without_slip_joints_turn_and_part_but_do_not_slide():
    arch = arch_at(0.95, 90, math.inf, 15)
    assembly = arch.assembly()
    world = world_of(assembly, math.inf, 0.01)
    world.hold(1)
    for _ in range(130):
        world.advance(1)
    motion = joint_motion(assembly, world.poses())
    closed = motion.gap.min(axis=1) < 1e-6
    assert np.abs(motion.gap).max() > 0.02
    assert closed.sum() > 10
    # Friction of 0.35 lets the same joints slide by far more.
    assert np.abs(motion.slip[closed]).max() < 1e-3
    assert world.quality().residual < 1e-7
