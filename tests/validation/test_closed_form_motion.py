"""Order of the direct engine's time stepping on motions with a known course."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from blocksim import Assembly, Block, Joint, Problem
from blocksim.engines.direct import ENGINE, Blocks

STEPS = (0.02, 0.01, 0.005, 0.0025)


def standing_block(width, height, slope=0.0):
    """One block on a plane that falls to the right."""
    along = np.array([math.cos(slope), -math.sin(slope)])
    up = np.array([math.sin(slope), math.cos(slope)])
    left, right = -width / 2 * along, width / 2 * along
    corners = [left, right, right + height * up, left + height * up]
    block = Block(
        vertices=np.array(corners),
        centre=height / 2 * up,
        mass=1.0,
        inertia=(width**2 + height**2) / 12,
        depth=1.0,
    )
    # A wide joint would end where the block does: the plane ends there too, which a slide
    # shorter than the block does not notice.
    joint = Joint(before=-1, after=0, inner=right, outer=left)
    return Assembly(blocks=(block,), joints=(joint,), size=1.0), along


def world_of(assembly, mu, step):
    settings = replace(ENGINE.rule(assembly), step=step)
    return Blocks(Problem(assembly=assembly, mu=mu), settings)


def order(errors):
    return np.polyfit(np.log(STEPS), np.log(errors), 1)[0]


def test_a_block_rocks_about_its_corner():
    width, height, spin, time = 0.4, 1.0, -0.6, 0.6
    radius, lean = math.hypot(width, height) / 2, math.atan2(width, height)
    inertia = (width**2 + height**2) / 12 + radius**2

    def turn(_, state):
        return [state[1], -radius / inertia * math.sin(lean - state[0])]

    exact = solve_ivp(turn, (0, time), [0.0, -spin], rtol=1e-12, atol=1e-14).y[0, -1]
    errors = []
    for step in STEPS:
        assembly, _ = standing_block(width, height)
        world = world_of(assembly, 5.0, step)
        # About the right corner, which stays.
        world.push(np.array([[-spin * height / 2, -spin * width / 2, spin]]))
        world.advance(round(time / step))
        errors.append(abs(-world.poses()[0, 2] - exact))
        assert world.quality().penetration < 10 * step**2
    assert exact > 0.1
    assert errors[0] < 1e-4
    assert order(errors) == pytest.approx(2.0, abs=0.1)


def test_a_rocking_block_loses_energy_at_the_impact_only_as_housner_says():
    # Angular velocity after over before: 1 - 3/2 sin(lean)^2 for a slender block.
    width, height, spin = 0.2, 1.0, -0.1
    lean = math.atan2(width, height)
    assembly, _ = standing_block(width, height)
    step = 0.001
    world = world_of(assembly, 5.0, step)
    world.push(np.array([[-spin * height / 2, -spin * width / 2, spin]]))
    rates = []
    while not rates or abs(world.poses()[0, 2]) < 0.2:
        world.advance(1)
        rates.append(world.velocities[0, 2])
        if world.poses()[0, 2] > 1e-3 or len(rates) * step > 5:
            break
    rates = np.array(rates)
    at = int(np.argmax(np.abs(np.diff(rates))))
    # An impact within a step takes two: one up to the touch, one that stops there.
    ratio = rates[at + 2] / rates[at - 1]
    assert ratio == pytest.approx(1 - 1.5 * math.sin(lean) ** 2, abs=0.01)


def test_two_bars_collapse_as_their_feet_slide_apart():
    # An A of two bars: their tops lean on each other at the upper corner.
    left = np.array([(-1.2, 0.0), (-0.9, 0.0), (0.0, 0.8), (0.0, 1.0)])
    right = (left * (-1.0, 1.0))[::-1]
    inertia, mu, time = 0.1, 0.2, 0.5
    bars = tuple(
        Block(vertices=bar, centre=bar.mean(axis=0), mass=1.0, inertia=inertia, depth=1.0)
        for bar in (left, right)
    )
    joints = (
        Joint(before=-1, after=0, inner=left[1], outer=left[0]),
        Joint(before=0, after=1, inner=left[2], outer=left[3]),
        Joint(before=1, after=-1, inner=right[2], outer=right[3]),
    )
    assembly = Assembly(blocks=bars, joints=joints, size=1.0)
    top, foot = left[3] - left.mean(axis=0), left[1] - left.mean(axis=0)

    def turn(_, state):
        # The left bar: its upper corner stays on the axis, the inner corner of its foot on
        # the ground. Unknown are its angular acceleration, the thrust at the top and the
        # pressure below, whose friction holds the foot back.
        angle, speed = state
        turned = np.array(
            [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
        )
        (tx, ty), (fx, fy) = turned @ top, turned @ foot
        system = [
            [ty, 1.0, -mu],
            [-fx, 0.0, -1.0],
            [inertia, -ty, -(fx - mu * fy)],
        ]
        known = [-tx * speed**2, -1.0 - fy * speed**2, 0.0]
        return [speed, np.linalg.solve(system, known)[0]]

    exact = solve_ivp(turn, (0, time), [0.0, 0.0], rtol=1e-12, atol=1e-14).y[0, -1]
    errors = []
    for step in STEPS:
        world = world_of(assembly, mu, step)
        world.advance(round(time / step))
        turned = world.poses()[:, 2]
        assert turned[0] == pytest.approx(-turned[1], abs=1e-6)
        errors.append(abs(turned[0] - exact))
        assert world.quality().penetration < 10 * step**2
    assert exact < -0.04
    # Less than 2e-5 of the turn at any step; gaps of 1e-7 count as none.
    assert max(errors) < 1e-6
