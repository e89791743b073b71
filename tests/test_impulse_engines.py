"""Engines of impulses, on both sides of the least thickness and under what cannot matter.

Truth: limit analysis. How near to it each is asked is what its contacts allow.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pytest
from arches import ARCHES, arch_at, box, bracket_at, held_in, least, on_a_slope, problem_at
from images import mirrored, renumbered
from worlds import get_engine, observe, observed_mode

from blocksim import (
    Arch,
    Assembly,
    CircularArch,
    JointState,
    Problem,
    Settings,
    Verdict,
    simulate,
)

LONG = pytest.mark.long
ASIDE = {"pymunk": 0.01, "pybullet": 0.01, "mujoco": 0.005}
NEAREST = {"pymunk": 0.002, "pybullet": 0.005, "mujoco": 0.005}
"""Below the least thickness the mode is told from so near on."""
SWEEPS = {"pymunk": 1, "pybullet": 5000, "mujoco": 1000}
EACH = [
    pytest.param(engine, arch, marks=[LONG] if (engine, at) == ("mujoco", 2) else [])
    for engine, arches in ARCHES.items()
    for at, arch in enumerate(arches)
]


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(("engine", "arch"), EACH)
def test_both_sides_of_the_least_thickness(engine: str, arch: Any, side: int) -> None:
    """By the onset test, and let go, but for mujoco: a motion takes it minutes."""
    *shape, mode = arch
    assert least(math.radians(shape[0]), *shape[1:]).mode_limit is mode
    moving = engine != "mujoco"
    seen = observe(problem_at(1 + side * ASIDE[engine], *shape), engine, moving=moving)
    right = Verdict.STANDS if side > 0 else Verdict.COLLAPSES
    assert seen.verdict is right
    assert not moving or seen.motion.verdict is right
    if engine == "pymunk" and side > 0:
        assert seen.onset.acceleration < Settings.still
        assert {joint.state for joint in seen.joints} == {JointState.CLOSED}


@pytest.mark.parametrize(("engine", "arch"), EACH)
def test_mode_just_below_the_least_thickness(engine: str, arch: Any) -> None:
    *shape, mode = arch
    problem = problem_at(1 - NEAREST[engine], *shape)
    seen = observe(problem, engine, moving=False)
    assert seen.verdict is Verdict.COLLAPSES
    assert observed_mode(seen.joints, problem.maker.shape) is mode


@pytest.mark.parametrize(
    ("engine", "arch", "tol"),
    [
        *(("pymunk", ARCHES["pymunk"][at], 0.002) for at in (1, 3, 5, 8)),
        ("mujoco", ARCHES["mujoco"][0], 1e-3),
    ],
)
def test_bracket_holds_the_limit(engine: str, arch: Any, tol: float) -> None:
    *shape, mode = arch
    found = bracket_at(*shape, method=engine, tol=tol, confirm=engine != "mujoco")
    assert found.arch.mode_limit is mode
    assert found.arch.centre == pytest.approx(found.arch.eta_limit, rel=tol)
    assert found.arch.eta_low < found.arch.eta_high
    assert 1 - found.arch.eta_low / found.arch.eta_high <= tol
    assert found.undecided == 0


@pytest.mark.parametrize(
    ("engine", "seconds"),
    [("pymunk", 1.0), ("pybullet", 0.5), pytest.param("mujoco", 0.1, marks=LONG)],
)
def test_same_motion_in_every_run(engine: str, seconds: float) -> None:
    arch = Arch(half_angle=math.pi / 2, eta=0.09, voussoirs=9)
    first, second, sliding = (
        simulate(CircularArch.of(arch, friction=mu), method=engine, duration=seconds).state_hash
        for mu in (0.6, 0.6, 0.3)
    )
    assert first == second != sliding


def verdict(engine: str, assembly: Assembly, mu: float) -> Any:
    return held_in(get_engine(engine), assembly, mu, sweeps=SWEEPS[engine])


@pytest.mark.parametrize("change", [mirrored, partial(renumbered, seed=1)])
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(
    ("engine", "arch"),
    [
        *(("pymunk", ARCHES["pymunk"][at]) for at in (1, 3, 5, 8)),
        *(("pybullet", ARCHES["pybullet"][at]) for at in (0, 1)),
    ],
)
def test_mirror_and_order_change_no_verdict(
    engine: str, arch: Any, side: int, change: Callable[[Problem], Problem]
) -> None:
    image = change(problem_at(1 + side * ASIDE[engine], *arch[:4]))
    right = Verdict.STANDS if side > 0 else Verdict.COLLAPSES
    assert verdict(engine, image.assembly, arch[1])[0] is right


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(
    ("engine", "other"),
    [
        # Radius and depth together: a deeper arch is another one in space.
        ("pybullet", {"radius": 0.01, "depth": 0.01}),
        ("pybullet", {"radius": 100.0, "depth": 100.0}),
        ("mujoco", {"radius": 100.0, "depth": 100.0, "specific_weight": 10.0}),
    ],
)
def test_size_and_material_change_nothing(
    engine: str, other: dict[str, float], side: int
) -> None:
    arch = arch_at(1 + side * ASIDE[engine], *ARCHES[engine][0][:4])
    said, start = verdict(engine, replace(arch, **other).assembly(), 0.7)
    assert said is (Verdict.STANDS if side > 0 else Verdict.COLLAPSES)
    assert start == pytest.approx(verdict(engine, arch.assembly(), 0.7)[1], abs=1e-6)


FINE = {"pymunk": 1e-6, "mujoco": 1e-5}
"""Of accelerations [g]; of MuJoCo, whose contacts are soft, of those that are slow."""


def started(engine: str, assembly: Assembly, mu: float) -> tuple[Verdict, Any]:
    """Verdict, and the acceleration of each block."""
    seen, found = held_in(get_engine(engine), assembly, mu, sweeps=9000)
    return seen, found[:, :3]


@pytest.mark.parametrize("degrees", [5, 20, 45])
@pytest.mark.parametrize(
    ("engine", "share"), [*product(FINE, (1.0005, 0.9995)), ("pymunk", 0.5)]
)
def test_a_block_slides_down_what_is_steeper_than_its_friction(
    engine: str, degrees: float, share: float
) -> None:
    """Closed form: g (sin phi - mu cos phi), straight downhill, without turning."""
    angle = math.radians(degrees)
    mu = share * math.tan(angle)
    seen, start = started(engine, on_a_slope(angle, 1.0, 0.2), mu)
    assert seen is (Verdict.STANDS if share > 1 else Verdict.COLLAPSES)
    rate = max(0.0, math.sin(angle) - mu * math.cos(angle))
    downhill = [-rate * math.cos(angle), -rate * math.sin(angle), 0.0]
    assert start[0] == pytest.approx(downhill, abs=FINE[engine])


@pytest.mark.parametrize("degrees", [10, 20, 40])
@pytest.mark.parametrize(("engine", "share"), [*product(FINE, (0.999, 1.001)), ("pymunk", 3.0)])
def test_a_block_tips_where_its_weight_leaves_its_base(
    engine: str, degrees: float, share: float
) -> None:
    """Closed form: moment of the weight about the lower corner over the inertia there."""
    assembly = on_a_slope(math.radians(degrees), 1.0, share / math.tan(math.radians(degrees)))
    seen, start = started(engine, assembly, 50.0)
    assert seen is (Verdict.STANDS if share < 1 else Verdict.COLLAPSES)
    block = assembly.blocks[0]
    x, y = block.centre  # the lower corner is at the origin
    spin = max(0.0, -block.mass * x / (block.inertia + block.mass * (x * x + y * y)))
    assert start[0] == pytest.approx([-spin * y, spin * x, spin], rel=1e-5, abs=FINE[engine])


@pytest.mark.parametrize("engine", FINE)
def test_a_block_on_nothing_falls_freely(engine: str) -> None:
    standing = on_a_slope(0.0, 1.0, 1.0)
    loose = box(np.array([3.0, 5.0]), np.array([1.0, 0.0]), 0.5, 1.0)
    _, start = started(engine, replace(standing, blocks=(*standing.blocks, loose)), 0.5)
    assert start[1] == pytest.approx([0.0, -1.0, 0.0], abs=1e-9)
    assert start[0] == pytest.approx([0.0, 0.0, 0.0], abs=FINE[engine])
