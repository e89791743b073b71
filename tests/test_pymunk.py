"""The pymunk engine, its onset test and its moving run.

Held to limit analysis on both sides of the least thickness, to the closed form of a block
that falls, slides or tips, and to what cannot matter: size, material, mirror, order of
insertion, which process runs it. Energy never grows.
"""

import gc
import math
import subprocess
import sys
import weakref
from dataclasses import replace

import numpy as np
import pytest
from arches import ARCHES as OF_ENGINES
from arches import arch_at, least, problem_at
from hypothesis import given, settings
from hypothesis import strategies as st
from worlds import Simulation, get_engine, least_motion, observe, observed_mode, onset

from blocksim import Arch, CircularArch, Load, Mode, Verdict, Wall, bracket, check, simulate

ARCHES = OF_ENGINES["pymunk"]
SMALL = Arch(half_angle=math.pi / 2, eta=0.11, voussoirs=13)


def test_a_space_goes_without_pythons_collector() -> None:
    """What chooses holds its space, in pymunk: 2,000 checks grew by 5 MB of old ones."""
    engine, problem = get_engine("pymunk"), CircularArch.of(SMALL, 0.3).problem()
    gc.collect()
    gc.disable()
    try:
        world = engine.build(problem, replace(engine.rule(problem.assembly), step=0.02))
        world.hold(100)
        world.advance(60)
        assert np.abs(world.poses()[:, 2]).max() > 0.01
        assert world._space.solids.loose or world._space.is_solid
        space = weakref.ref(world._space._space)
        assert space() is not None
        del world
        assert space() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("eta", [0.05, 0.5, 1.0, 1.9])
def test_purely_sliding_at_any_thickness(eta: float) -> None:
    arch = Arch(half_angle=math.pi / 2, eta=eta, voussoirs=15)
    assert least(arch.half_angle, 0.28, 15).eta_limit is None
    seen = observe(CircularArch.of(arch, 0.28).problem(), "pymunk")
    assert seen.verdict is Verdict.COLLAPSES
    if eta >= 0.5:  # thin ones are overcome by turning, too
        assert observed_mode(seen.joints, arch) is Mode.SS


@pytest.mark.parametrize(("ratio", "right"), [(0.999, "collapses"), (1.001, "stands")])
def test_forces_to_begin_with_decide_thin_arches(ratio: float, right: str) -> None:
    """All voussoirs; from nothing it took 17 million sweeps, two minutes."""
    problem = problem_at(ratio, 20, 0.7, 27)
    seen = observe(problem, "pymunk")
    assert seen.verdict.value == right
    assert seen.motion.verdict.value == right
    assert seen.onset.sweeps < 300_000
    assert "begun with forces of limit analysis" in seen.reason
    if right == "collapses":
        assert observed_mode(seen.joints, problem.maker.shape) is Mode.RRR


@pytest.mark.parametrize(("angle", "mu", "count"), [(30, 0.7, 27), (125, 0.9, 20)])
@pytest.mark.parametrize(("ratio", "wrong"), [(0.99, "stands"), (1.01, "collapses")])
@pytest.mark.parametrize("other", [0.9, 1.1])
def test_no_forces_to_begin_with_make_a_verdict(
    angle: float, mu: float, count: int, ratio: float, wrong: str, other: float
) -> None:
    """Forces of a thinner or a thicker arch: those that it would fall, or stand with."""
    forces = least_motion(problem_at(other, angle, mu, count)).forces
    simulation = Simulation.of(problem_at(ratio, angle, mu, count), "pymunk")
    world = simulation.world()
    world.begin(forces)
    chosen = replace(simulation.settings, hold_sweeps=30_000, unaided=None)
    seen = onset(world, replace(simulation, settings=chosen))
    assert seen.verdict.value != wrong


HASH = """
from blocksim import Arch, CircularArch, simulate
arch = Arch(half_angle=1.5707963267948966, eta=0.1, voussoirs=13)
print(simulate(CircularArch.of(arch, friction=0.6), method="pymunk", duration=1.0).state_hash)
"""


def test_a_wall_that_slides_by_a_hundredth_as_it_parts_keeps_its_forces() -> None:
    """Tall blocks in bond, pushed: 5 % to either side of what limit analysis proves."""
    wall = Wall(length=96.72, courses=4, block_length=17.07, block_height=32.38, bond=0.2145,
                friction=0.1797)  # fmt: skip
    found, problem = bracket(wall, over="push"), wall.problem()
    assert found.proved
    every = tuple(range(len(problem.assembly.blocks)))
    for share, verdict in ((0.95, Verdict.STANDS), (1.05, Verdict.COLLAPSES)):
        push = Load(force=np.array([share * found.limit, 0]), blocks=every, per_weight=True)
        seen = check(replace(problem, dead=(push,)), method="pymunk")
        assert seen.verdict is verdict


def test_same_motion_in_every_process() -> None:
    arch = Arch(half_angle=math.pi / 2, eta=0.1, voussoirs=13)
    here = simulate(CircularArch.of(arch, friction=0.6), method="pymunk", duration=1.0)
    done = subprocess.run([sys.executable, "-c", HASH], capture_output=True, check=True)
    assert done.stdout.decode().strip() == here.state_hash
    assert len(here.state_hash) == 16


@settings(max_examples=8)
@given(
    st.sampled_from([0.93, 1.05]),
    st.integers(-9, 9),
    st.integers(-9, 9),
    st.integers(-9, 9),
)
def test_size_and_material_change_no_bit(
    ratio: float, size: int, mass: int, depth: int
) -> None:
    """By powers of two, which round nothing, every pose is the same to the last bit."""
    arch = arch_at(ratio, 90, 0.6, 13)
    other = replace(
        arch, radius=2.0**size, specific_weight=20_000 * 2.0**mass, depth=2.0**depth
    )
    one = simulate(CircularArch.of(arch, friction=0.6), method="pymunk", duration=1.0)
    two = simulate(CircularArch.of(other, friction=0.6), method="pymunk", duration=1.0)
    assert one.state_hash == two.state_hash


def test_blocks_at_rest_are_put_back() -> None:
    """`hold` moves nothing, however often."""
    simulation = Simulation.of(
        CircularArch.of(replace(SMALL, eta=0.05), 0.6).problem(), "pymunk"
    )
    world = simulation.world()
    before = world.poses()
    for _ in range(3):
        world.hold(100)
    assert np.array_equal(world.poses(), before)
    assert before[:, :2] == pytest.approx(simulation.assembly.centres, abs=1e-15)
