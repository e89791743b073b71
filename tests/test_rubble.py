"""Blocks that have come apart are solid in every engine, and nothing gives them energy."""

import math
from itertools import pairwise

import numpy as np
import pytest
from worlds import DIRECT, Blocks, ground_level

from analysis import rubble
from blocksim import Arch, CircularArch, Recording, equilibrium, simulate, structure_of
from blocksim.engines.energy import Balance, energy
from blocksim.engines.solids import obj_text, prism

CASES = {case.number: case for case in rubble.cases(rubble.COUNT)}
ARCH, STACK = CASES[12], CASES[14]
LONG = pytest.mark.long


def lies_still(recording: Recording) -> bool:
    late = recording.poses[recording.times > recording.times[-1] - 1.9]
    return float(recording.assembly.displacement(late - late[-1]).max()) < 1e-3


@pytest.mark.parametrize(
    ("engine", "case"),
    [
        # Each case by one engine of the plane.
        pytest.param(
            engine,
            case,
            marks=[] if (engine, case) in {("direct", ARCH), ("pymunk", STACK)} else LONG,
            id=f"{engine}-{name}",
        )
        for engine in ("direct", "pymunk", "pybullet", "mujoco")
        for name, case in (("arch", ARCH), ("stack", STACK))
    ],
)
def test_a_collapse_ends_on_the_ground(engine: str, case: rubble.Case) -> None:
    problem = rubble.drawn(case)
    recording = simulate(problem, method=engine, duration=rubble.LONGEST)
    found = rubble.measured(recording)
    assert found["overlap"] < rubble.ALLOWED
    assert found["sunk"] < 2e-3
    assert found["thrown"] == 0.0
    quality = recording.quality
    assert quality.gain < rubble.GAIN
    assert quality.penetration < 3e-3
    # Something lies on the floor, and all is at rest.
    assembly = problem.assembly
    lowest = recording.poses[-1, :, 1].min() - ground_level(assembly) / assembly.size
    assert 0 < lowest < 0.3
    assert recording.times[-1] < rubble.LONGEST
    assert lies_still(recording)


@LONG
def test_every_heap_begins_to_fall() -> None:
    """Of 30 to 180 stones; statics proves that each falls."""
    for case in rubble.cases(rubble.COUNT, rubble.HEAPS):
        problem = rubble.drawn(case)
        assert not equilibrium(problem).exists
        world = Blocks(problem, DIRECT.rule(problem.assembly))
        assert np.abs(world.hold(1)).max() > 0.1, case
        assert world.quality().residual < 1e-9, case


@LONG
@pytest.mark.parametrize(("engine", "number"), [("direct", 10), ("pymunk", 0), ("pymunk", 5)])
def test_a_heap_is_followed_to_its_end(engine: str, number: int) -> None:
    """Stones stay solid, and gain no energy, though joints are as short as 2e-4."""
    row = rubble.ask(rubble.Case(number, "heap"), engine)
    assert row["rested"] or row["ended"] >= rubble.LONGEST
    assert max(row["overlap"], row["own_overlap_of_smallest"]) < rubble.ALLOWED
    assert max(row["gain"], row["own_gain"]) < rubble.GAIN
    assert row["thrown"] == 0.0


def test_stones_that_friction_lets_stay_do_while_another_falls() -> None:
    """Of 42 one slides off. Friction allows forces with which 16 of the others move, too."""
    problem = rubble.drawn(rubble.Case(10, "heap"))
    world = Blocks(problem, DIRECT.rule(problem.assembly))
    world.hold(1)
    world.advance(4)
    moving = np.abs(world.velocities).max(axis=1) > 1e-9
    assert moving.sum() == 1
    assert world.quality().residual < 1e-9


def test_what_leaves_the_plane_falls_onto_the_ground() -> None:
    """An arch in gravity that leans out of its plane overturns, and lies on its side."""
    arch = Arch(half_angle=math.pi / 2, eta=0.3, voussoirs=5, depth=0.3)
    problem = CircularArch.of(arch, 0.8).problem().leaning(math.radians(20))
    recording = simulate(problem, method="pybullet", duration=3.0)
    assert recording.quality.penetration < 2e-3
    assert recording.quality.gain < rubble.GAIN
    # The crown has left the plane by more than its depth, and is on the floor.
    _, y, z = recording.poses[-1, 2, :3]
    assert -y > 0.3
    assert 0 < z < 0.3


def test_free_fall_keeps_its_energy_and_a_push_is_seen() -> None:
    problem = rubble.drawn(STACK)
    count = len(problem.assembly.blocks)
    first = np.column_stack([problem.assembly.centres / problem.assembly.size, np.zeros(count)])
    balance = Balance.of(problem, first)
    step, poses, velocity = 0.01, first.copy(), np.zeros_like(first)
    pull = np.zeros_like(first)
    pull[:, :2] = problem.gravity[:2]
    # As engines of impulses do: the velocity of a step is that of its middle.
    velocity += pull * step / 2
    for _ in range(50):
        poses = poses + step * velocity
        after = velocity + step * pull
        balance.look(poses, velocity, after)
        velocity = after
    assert balance.gain < 1e-12
    start = energy(problem, first, np.zeros_like(first))
    fallen = start - energy(problem, poses, np.zeros_like(first))
    pushed = velocity * 1.1
    balance.look(poses, pushed, pushed)
    gained = energy(problem, poses, pushed) - start
    assert balance.gain == pytest.approx(gained / fallen, rel=1e-9)
    assert balance.gain > 0.1


def test_energy_that_rises_after_a_fall_is_a_gain() -> None:
    """What has fallen and lies still is thrown up by less than it fell."""
    problem = rubble.drawn(STACK)
    count = len(problem.assembly.blocks)
    first = np.column_stack([problem.assembly.centres / problem.assembly.size, np.zeros(count)])
    still = np.zeros_like(first)
    balance = Balance.of(problem, first)
    fallen = first + 0.5 * np.array([*problem.gravity[:2], 0.0])
    balance.look(fallen, still, still)
    assert balance.gain == 0.0
    thrown = still + np.array([0.0, 0.4, 0.0])
    balance.look(fallen, thrown, thrown)
    # By energy: 0.4^2 / 2 of the 0.5 that each fell.
    assert balance.gain == pytest.approx(0.16, rel=1e-9)


@pytest.mark.parametrize("method", ["direct", "pymunk"])
def test_a_block_that_is_thrown_up_gains_nothing(method: str) -> None:
    """The energy it begins with is its own."""
    corners = [(0.0, 2.0), (1.0, 2.0), (1.0, 3.0), (0.0, 3.0)]
    table = {
        "friction": 0.6,
        "blocks": [
            {"id": "ground", "vertices": [(-2, -1), (4, -1), (4, 0), (-2, 0)], "fixed": True},
            {
                "id": "stone",
                "vertices": corners,
                "free": True,
                "velocity": [0.5, 3.0],
                "spin_deg_s": 45,
            },
        ],
    }
    gain = simulate(structure_of(table), method=method, duration=2.0).quality.gain
    assert gain is not None
    assert gain < 1e-9


def test_a_prism_is_written_with_faces_outwards() -> None:
    """By the divergence theorem its volume is that of the polygons times the depth."""
    square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])
    triangle = np.array([(2.0, 0.0), (3.0, 0.0), (2.0, 1.0)])
    lines = obj_text(prism(each, 3.0) for each in (square, triangle)).splitlines()
    corners = np.array([line.split()[1:] for line in lines if line[0] == "v"], dtype=float)
    faces = [[int(k) - 1 for k in line.split()[1:]] for line in lines if line[0] == "f"]
    volume = 0.0
    for face in faces:
        for second, third in pairwise(face[1:]):
            volume += float(np.linalg.det(corners[[face[0], second, third]])) / 6
    assert volume == pytest.approx((2.0 + 0.5) * 3.0)
    assert sum(line.startswith("o ") for line in lines) == 2
