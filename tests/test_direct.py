"""The direct engine: exact at the onset, never gaining energy, honest about its residual."""

import math
from dataclasses import replace

import numpy as np
import pytest
from arches import arch_at, problem_at
from worlds import (
    DIRECT,
    Blocks,
    ContactProblem,
    Simulation,
    joint_motion,
    moving_run,
    observe,
    onset,
    trusted,
)

from blocksim import CircularArch, Problem, Verdict

CASES = [
    (90, 0.9, 27, "centreline"),
    (32, 1.0, 44, "centreline"),
    (65, 0.9, 9, "sector"),
    (110, 0.9, 101, "sector"),
    (90, 0.37, 30, "centreline"),
    (90, 0.31, 27, "sector"),
    (125, 0.9, 27, "centreline"),
    (150, 2.0, 40, "centreline"),
    (145, 1.6, 40, "centreline"),
    (152, 2.6, 27, "centreline"),
    (100, math.inf, 20, "centreline"),
    (154, 3.0, 7, "centreline"),
]


def held(arch, mu):
    return observe(CircularArch.of(arch, mu).problem(), "direct", moving=False).verdict


def world_of(arch, mu, step=0.01):
    assembly = arch.assembly()
    settings = replace(DIRECT.rule(assembly), step=step)
    return Blocks(Problem(assembly=assembly, mu=mu), settings)


@pytest.mark.parametrize(("half_angle_deg", "mu", "voussoirs", "weight"), CASES)
def test_a_billionth_of_the_limit_decides(half_angle_deg, mu, voussoirs, weight):
    case = (half_angle_deg, mu, voussoirs, weight)
    assert held(arch_at(1 - 1e-9, *case), mu) is Verdict.COLLAPSES
    assert held(arch_at(1 + 1e-9, *case), mu) is Verdict.STANDS


def energies_of(world, steps):
    """Of a collapse from rest, step by step."""
    world.hold(1)
    found = [world.energy]
    for _ in range(steps):
        world.advance(1)
        found.append(world.energy)
    return np.array(found)


@pytest.mark.parametrize(
    ("half_angle_deg", "mu", "ratio"), [(90, 0.37, 0.97), (145, 1.6, 0.97)]
)
def test_energy_falls_in_every_step_of_a_collapse_that_slides(half_angle_deg, mu, ratio):
    world = world_of(arch_at(ratio, half_angle_deg, mu, 20), mu)
    energies = energies_of(world, 150)
    assert np.diff(energies).max() < 1e-9
    assert energies[-1] < energies[0] - 1e-2
    assert world.quality().residual < 1e-8
    assert world.quality().penetration < 1e-5


def test_energy_of_hinges_that_only_turn_is_kept_to_second_order():
    """Nothing dissipates: what is gained is the error of a step, a share of its square."""
    arch = arch_at(0.9, 90, 0.9, 20)
    gained = []
    for step in (0.01, 0.005):
        world = world_of(arch, 0.9, step)
        energies = energies_of(world, round(1.5 / step))
        gained.append((energies - np.minimum.accumulate(energies)).max())
        moving = (arch.assembly().masses * world.velocities**2).sum() / 2
        assert gained[-1] < step**2 / 12 * moving
        assert world.quality().residual < 1e-8
        assert world.quality().penetration < 1e-5
    assert gained[1] < gained[0] / 3


def test_friction_forces_oppose_the_slip_at_the_edge_of_the_cone():
    arch, mu = arch_at(0.97, 145, 1.6, 40), 1.6
    world = world_of(arch, mu)
    motion = joint_motion(arch.assembly(), world.poses() + 1e-7 * world.hold(1))
    gap, slip = motion.gap * 1e7, motion.slip * 1e7
    slides = np.abs(slip) > 1e-3
    assert slides.any()
    # Coulomb's friction does not dilate: a joint that slides stays shut at one end.
    assert np.abs(gap[slides].min(axis=1)).max() < 1e-6
    assert gap.min() > -1e-6


def test_over_its_residual_the_answer_is_undecided():
    simulation = Simulation.of(problem_at(0.9, 90, 0.9, 20), "direct")
    settings = replace(simulation.settings, residual=0.0)
    simulation = replace(simulation, settings=settings)
    world = simulation.world()
    assert onset(world, simulation).verdict is Verdict.UNDECIDED
    assert not trusted(world, settings)


@pytest.mark.parametrize(
    ("half_angle_deg", "voussoirs", "weight", "ratio"),
    [
        (54.367, 100, "sector", 1.001),
        (21.275, 11, "centreline", 1.005),
        (21.275, 11, "sector", 1.005),
        (153, 40, "centreline", 1 - 1e-8),
        (153, 40, "centreline", 1 + 1e-8),
        (157, 40, "centreline", 1 - 1e-8),
        (153, 27, "centreline", 1 - 1e-2),
        (153, 27, "centreline", 1 + 1e-9),  # false with a friction of 1000
    ],
)
def test_without_slip_it_is_as_limit_analysis_says(half_angle_deg, voussoirs, weight, ratio):
    arch = arch_at(ratio, half_angle_deg, math.inf, voussoirs, weight)
    assert held(arch, math.inf) is (Verdict.STANDS if ratio > 1 else Verdict.COLLAPSES)


@pytest.mark.parametrize(
    ("half_angle_deg", "voussoirs", "ratio"),
    [(157, 27, 1 - 1e-8), (153.6456, 33, 1 - 1.867e-8), (156.8836, 55, 1 - 1.187e-8)],
)
def test_friction_without_pressure_is_no_detour(half_angle_deg, voussoirs, ratio, monkeypatch):
    """A hundred-millionth below the limit friction may act where nothing presses.

    Two guesses lead nowhere; the path from all contacts apart does.
    """
    solved, solve = [], ContactProblem.solve

    def counted(*args):
        solved.append(solve(*args))
        return solved[-1]

    monkeypatch.setattr(ContactProblem, "solve", counted)
    arch = arch_at(ratio, half_angle_deg, math.inf, voussoirs)
    assert held(arch, math.inf) is Verdict.COLLAPSES
    assert solved[0].residual < 1e-12
    assert solved[0].iterations < 40 * voussoirs


@pytest.mark.parametrize("half_angle_deg", [45, 100, 140])
@pytest.mark.parametrize("mu", [20.0, 1e4, 1e6])
def test_where_nothing_slides_steep_friction_moves_it_as_none_at_all(half_angle_deg, mu):
    arch = arch_at(0.99, half_angle_deg, math.inf, 15)
    assert arch_at(0.99, half_angle_deg, mu, 15).eta == pytest.approx(arch.eta, rel=1e-12)
    steep, free = (world_of(arch, each).hold(1) for each in (mu, math.inf))
    assert np.abs(steep - free).max() < 1e-9 * np.abs(free).max()


def test_deeper_overlap_than_allowed_is_undecided():
    def hold(world):
        world.hold(1)

    simulation = Simulation.of(problem_at(0.9, 90, 0.9, 12), "direct")
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
    assembly, world = arch.assembly(), world_of(arch, math.inf)
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
