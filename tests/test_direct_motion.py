"""The direct engine in large motion: a collapse goes to the ground."""

import math
from dataclasses import replace

import numpy as np
import pytest
from arches import arch_at

from blocksim.arch.circular import Arch
from blocksim.ask.simulate import simulate
from blocksim.blocks.assembly import displacement
from blocksim.blocks.joints import joint_motion
from blocksim.blocks.problem import Problem
from blocksim.engines.direct import ENGINE, Blocks
from blocksim.engines.ground import ground_level, piers
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.motion import moving_run
from blocksim.simulation.simulated import Simulation
from blocksim.simulation.verdict import Verdict


def world_of(assembly, mu, step):
    settings = replace(ENGINE.rule(assembly), step=step)
    return Blocks(Problem(assembly=assembly, mu=mu), settings)


FALLS = [
    pytest.param(90, 0.9, 20, 0.9, marks=pytest.mark.long),
    pytest.param(125, 0.9, 15, 0.9, marks=pytest.mark.long),
    pytest.param(150, 2.0, 15, 0.97, marks=pytest.mark.long),
    (65, 0.35, 12, 0.7),
]


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


@pytest.mark.parametrize(("half_angle_deg", "mu", "voussoirs", "ratio"), FALLS)
def test_a_collapse_ends_on_the_ground_with_no_block_in_another(
    half_angle_deg, mu, voussoirs, ratio
):
    arch = arch_at(ratio, half_angle_deg, mu, voussoirs)
    assembly = arch.assembly()
    world = world_of(assembly, mu, 0.01)
    world.hold(1)
    energies = [world.energy]
    level = ground_level(assembly)
    area = arch.eta * 2 * arch.half_angle / voussoirs
    for frame in range(70):
        for _ in range(10):
            world.advance(1)
            energies.append(world.energy)
        if frame % 10 and frame < 66:
            continue
        shapes = []
        for block, (x, y, angle) in zip(assembly.blocks, world.poses(), strict=True):
            cos, sin = math.cos(angle), math.sin(angle)
            turned = (block.vertices - block.centre) @ np.array([[cos, sin], [-sin, cos]])
            shapes.append(turned + np.array([x, y]))
        assert min(shape[:, 1].min() for shape in shapes) > level - 3e-3
        everything = [*shapes, *piers(assembly)]
        for i, shape in enumerate(shapes):
            for other in everything[i + 1 :]:
                assert clipped(shape, other) < 0.02 * area
    # Impacts take energy, steps of second order give less than a share of their square, and at
    # last all lies still.
    gained = np.array(energies) - np.minimum.accumulate(energies)
    assert gained.max() < 0.01**2 / 12 * (energies[0] - energies[-1])
    assert world.poses()[:, 1].max() < 0.5 + level + arch.eta * 3
    assert world.quality().residual < 1e-7
    assert world.quality().penetration < 0.02


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


def test_a_recording_of_a_collapse_goes_to_the_ground():
    arch = arch_at(0.8, 90, 0.9, 9)
    recording = simulate(CircularArch.of(arch, friction=0.9), method="direct", duration=12.0)
    # It ends when the rubble lies still, not before.
    assert recording.times[-1] < 12.0
    resting = displacement(recording.poses - recording.poses[-1], recording.assembly)
    assert resting[-41:].max() < 1e-3 < resting[-43]
    lowest = recording.poses[-1, :, 1].min() - ground_level(arch.assembly())
    assert 0.0 < lowest < arch.eta


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
