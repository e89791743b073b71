"""The direct engine in large motion: a collapse goes to the ground."""

import math
from dataclasses import replace

import numpy as np
import pytest
from arches import arch_at

from blocksim import Arch, CircularArch, Problem, Verdict
from blocksim.blocks.joints import joint_motion
from blocksim.engines.direct import ENGINE, Blocks
from blocksim.engines.ground import ground_level, piers
from blocksim.simulation.motion import moving_run
from blocksim.simulation.simulated import Simulation


def world_of(assembly, mu, step):
    settings = replace(ENGINE.rule(assembly), step=step)
    return Blocks(Problem(assembly=assembly, mu=mu), settings)


def clipped(polygon, other):
    """Area that a convex polygon shares with another, both counter-clockwise."""
    for start, end in zip(other, np.roll(other, -1, axis=0), strict=True):
        edge = end - start
        side = edge[0] * (polygon[:, 1] - start[1]) - edge[1] * (polygon[:, 0] - start[0])
        kept = []
        for i in range(len(polygon)):
            j = (i + 1) % len(polygon)
            if side[i] >= 0:
                kept.append(polygon[i])
            if side[i] * side[j] < 0:
                kept.append(
                    polygon[i] + side[i] / (side[i] - side[j]) * (polygon[j] - polygon[i])
                )
        if len(kept) < 3:
            return 0.0
        polygon = np.array(kept)
    x, y = polygon.T
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


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


@pytest.mark.parametrize("half_angle_deg", [20, 60, 90, 120, 159])
def test_piers_carry_their_joint_and_touch_nothing_else(half_angle_deg):
    arch = Arch(half_angle=math.radians(half_angle_deg), eta=0.3, voussoirs=9)
    assembly = arch.assembly()
    level = ground_level(assembly)
    lowest = min(block.vertices[:, 1].min() for block in assembly.blocks)
    assert lowest == pytest.approx(level + 0.5)
    for pier, joint in zip(
        piers(assembly), (assembly.joints[0], assembly.joints[-1]), strict=True
    ):
        assert {tuple(corner) for corner in pier} >= {tuple(joint.inner), tuple(joint.outer)}
        assert pier[:, 1].min() == level
        edge = np.roll(pier, -1, axis=0) - pier
        following = np.roll(edge, -1, axis=0)
        assert (edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]).min() > 0
        for block in assembly.blocks:
            assert clipped(block.vertices, pier) < 1e-12


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
