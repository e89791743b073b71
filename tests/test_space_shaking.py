"""Ground that shakes below blocks in space: the plane, statics and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rocking import block, on_pulse
from running import inside

import blocksim
from blocksim import Problem, Verdict, assembly_in_space, check
from blocksim.blocks.shaking import Shaking, table_of
from blocksim.blocks.space.extruded import extruded, lifted
from blocksim.blocks.space.files import problem_in_space, solids_record
from blocksim.blocks.space.parting import joined, turned_over
from blocksim.simulation.observation import hold

G = 9.80665
AZIMUTH = math.radians(40)
TOWARDS = np.array([math.cos(AZIMUTH), math.sin(AZIMUTH), 0.0])


def box(low: tuple[float, ...], high: tuple[float, ...]) -> list[list[float]]:
    """Corners of a box."""
    return [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1])
            for z in (low[2], high[2])]  # fmt: skip


def on_table(shaking: Shaking, mu: float, height: float = 0.5) -> Problem:
    """A block of 1 x 0.6 m on a table that shakes towards an azimuth."""
    solids = [
        blocksim.Solid(parts=(box((-3, -3, -1), (3, 3, 0)),), fixed=True, name="table"),
        blocksim.Solid(parts=(box((0, 0, 0), (1, 0.6, height)),), name="block"),
    ]
    return Problem(assembly=assembly_in_space(solids), mu=mu, shaking=shaking, azimuth=AZIMUTH)


def constant(amplitude: float, duration: float = 0.3) -> Shaking:
    return Shaking(shape="constant", amplitude=amplitude, duration=duration)


def test_a_prism_in_space_rocks_as_its_section_does_until_it_hits() -> None:
    problem = on_pulse(block(1.0, 4.0, 2.0), "half-sine", 0.4, 0.6)
    paths: list[np.ndarray] = []
    for each in (problem, extruded(problem)):
        held = hold(each, "direct")
        frames: list[np.ndarray] = []
        for _ in range(20):
            held.world.advance(4)
            frames.append(held.world.poses())
        paths.append(np.array(frames))
    plane, space = lifted(paths[0]), paths[1]
    # It has turned, and is on its way back.
    turned = np.abs(plane[:, 0, 4])
    assert turned.max() > 0.03
    assert turned[-1] < 0.9 * turned.max()
    np.testing.assert_allclose(space, plane, atol=1e-6)


def slid(drive: float, brake: float, time: float) -> float:
    """How far a block slides on ground that pulls away for a time, and stops at its end [m].

    `drive`, `brake`: What accelerates and what stops it, seen from the ground [g].
    """
    speed = drive * G * time
    return drive * G * time**2 / 2 + speed**2 / (2 * brake * G)


def test_a_block_slides_against_the_azimuth_as_far_as_friction_lets_it() -> None:
    found = check(on_table(constant(0.5), mu=0.3), method="direct")
    assert found.verdict is Verdict.STANDS
    recording = found.recording
    way = (recording.poses[-1, 0, :3] - recording.poses[0, 0, :3]) * recording.assembly.size
    np.testing.assert_allclose(way, -slid(0.2, 0.3, 0.3) * TOWARDS, rtol=2e-3, atol=1e-6)


def test_ground_that_falls_away_takes_friction_with_it() -> None:
    """At half the weight friction of 0.3 bears 0.15 g: of 0.2 g across 0.05 g are left."""
    rows = np.array([(0.0, 0.2, -0.5), (0.3, 0.2, -0.5)])
    found = check(on_table(table_of(*rows.T), mu=0.3), method="direct")
    recording = found.recording
    way = (recording.poses[-1, 0, :3] - recording.poses[0, 0, :3]) * recording.assembly.size
    np.testing.assert_allclose(way, -slid(0.05, 0.3, 0.3) * TOWARDS, rtol=5e-3, atol=1e-6)


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_what_statics_holds_does_not_move_and_what_it_does_not_rocks(share: float) -> None:
    still = replace(on_table(constant(0.1), mu=2.0, height=3.0), shaking=None)
    limit = blocksim.bracket(still, over="push").limit
    # Its edge along x is nearer: 0.3 m over 1.5 m, of the part of the push across it.
    assert limit == pytest.approx(0.2 / math.sin(AZIMUTH), rel=1e-6)
    found = check(replace(still, shaking=constant(share * limit, 0.2)), method="direct")
    turned = np.abs(found.recording.poses[:, 0, 3:]).max()
    assert turned < 1e-9 if share < 1 else turned > 1e-4
    assert found.verdict is Verdict.STANDS


def test_joints_are_those_whose_faces_lie_over_each_other() -> None:
    assembly = on_table(constant(0.1), mu=0.5).assembly
    size = assembly.size
    built = assembly.built[:-1]

    def holds(way: tuple[float, ...], turn: tuple[float, ...] = (0.0, 0.0, 0.0)) -> bool:
        moved = built + np.array([*(np.array(way) / size), *turn])
        return bool(joined(assembly, moved, 0.01).all())

    assert holds((2.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert not holds((3.1, 0.0, 0.0))
    assert not holds((0.0, 0.0, 0.02 * size))
    # Fallen onto its side, it lies on the table by another face.
    assert not holds((0.0, 0.0, 0.25), (0.0, math.pi / 2, 0.0))


def test_a_joint_that_turned_over_on_the_way_is_seen() -> None:
    assembly = on_table(constant(0.1), mu=0.5).assembly
    turns = np.linspace(0.0, 2 * math.pi, 9)

    def paths(axis: int, most: float) -> np.ndarray:
        found = np.repeat(assembly.built[None, :-1], len(turns), axis=0)
        found[:, 0, 3 + axis] = most * turns
        return found

    assert turned_over(assembly, paths(0, 1.0)).all()
    assert not turned_over(assembly, paths(0, 0.2)).any()
    # About the vertical its face stays on the table.
    assert not turned_over(assembly, paths(2, 1.0)).any()


def test_an_arch_without_drawn_supports_stands_on_its_springings_in_space() -> None:
    """It fell freely until the floor below caught it: joints with the ground had no face."""
    arch = blocksim.CircularArch(half_angle_deg=70, eta=0.3, voussoirs=5, friction=0.7)
    problem = extruded(arch.problem())
    held = hold(problem, "direct")
    held.world.advance(8)
    moved = held.world.poses() - problem.assembly.built[:-1]
    assert np.abs(moved).max() < 1e-12


def test_a_file_says_towards_where_the_ground_shakes() -> None:
    problem = on_table(constant(0.2), mu=0.5)
    again = problem_in_space(solids_record(problem))
    assert again.azimuth == pytest.approx(AZIMUTH)
    assert again.shaking.gained(0.0, 0.3) == pytest.approx(problem.shaking.gained(0.0, 0.3))
    np.testing.assert_allclose(again.shaken(0.0, 1.0), problem.shaken(0.0, 1.0))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--method", "pybullet"], "--method = 'pybullet': must be one of direct"),
        (["--method", "limit"], "--method = 'limit': must be one of direct"),
        (["--method", "pymunk"], "pymunk knows no blocks in space"),
    ],
)
def test_who_knows_no_ground_that_shakes_in_space_is_refused(
    options: list[str], said: str
) -> None:
    shake = ["--shake", "constant", "--amplitude", "0.1", "--duration", "0.2"]
    done = inside("check", "tower", "--mu", "0.7", *shake, *options)
    assert done.returncode == 2
    assert said in done.stderr
