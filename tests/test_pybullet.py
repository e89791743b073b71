"""The pybullet engine: both sides of the least thickness, what cannot matter, what it says.

Held to limit analysis, and to invariance: where in Bullet's space the arch stands and how
it is turned there, mirror, size, order of insertion, which run it is.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from arches import ARCHES as OF_ENGINES
from arches import arch_at, held_in, problem_at
from images import moved
from scipy.spatial.transform import Rotation
from structure_cases import case, scenes
from worlds import Engine, hold, observe

from blocksim import (
    Arch,
    Assembly,
    CircularArch,
    Mode,
    Problem,
    Verdict,
    extruded,
    simulate,
    structure_of,
)

pytest.importorskip("pybullet", exc_type=ImportError)

from blocksim.engines.boxes import unwound
from blocksim.engines.pybullet import ENGINE, Bodies

ARCHES = OF_ENGINES["pybullet"]
SIDES = [(0.99, Verdict.COLLAPSES), (1.01, Verdict.STANDS)]
THIN = Arch(half_angle=math.pi / 2, eta=0.08, voussoirs=9)


def held(assembly: Assembly, mu: float, engine: Engine = ENGINE) -> tuple[Verdict, np.ndarray]:
    return held_in(engine, assembly, mu, sweeps=5000)


@pytest.mark.parametrize(("ratio", "expected"), SIDES)
@pytest.mark.parametrize(
    ("angle", "mu", "count", "weight", "mode"),
    [ARCHES[0], pytest.param(*ARCHES[1], marks=pytest.mark.long)],
)
def test_where_the_arch_stands_does_not_matter(
    angle: float,
    mu: float,
    count: int,
    weight: str,
    mode: Mode,
    ratio: float,
    expected: Verdict,
) -> None:
    assembly = arch_at(ratio, angle, mu, count, weight).assembly()
    verdict, start = held(moved(assembly, [100.0, 100.0]), mu)
    assert verdict is expected, mode
    assert start == pytest.approx(held(assembly, mu)[1], abs=1e-6)


def case_at(name: str, share: float) -> Problem:
    """Return a case at a share of its load factor, or as it is (`structures/cases`)."""
    read = case(name)
    problem = structure_of(read["scene"] if "scene" in read else scenes(name)[-1])
    if read["question"] == "load_factor":
        return problem.with_load(share * read["expected"]["value"])
    return problem


WALLS = ["grid_wall_3", "grid_wall_efficientPro_smooth_heads", "jack_arch_load"]


@pytest.mark.parametrize(
    ("name", "share", "expected"),
    [
        (WALLS[1], 1.01, Verdict.COLLAPSES),
        (WALLS[2], 0.99, Verdict.STANDS),
        (WALLS[2], 1.01, Verdict.COLLAPSES),
    ],
)
def test_walls(name: str, share: float, expected: Verdict) -> None:
    """Several joints a face, joints with friction of their own: published load factors."""
    seen = observe(case_at(name, share), "pybullet", moving=False)
    assert seen.verdict is expected, seen.reason


def off_ends(world: Bodies, assembly: Assembly) -> np.ndarray:
    """Distances in the plane from each end of a joint to each point of contact."""
    places = np.array([contact.place[:2] for contact in world._space.contacts()])
    ends = assembly.joint_arrays.ends.reshape(-1, 2)
    return np.hypot(*(ends[:, None] - places[None]).transpose(2, 0, 1))


@pytest.mark.parametrize("name", WALLS[:2])
def test_each_joint_has_two_contacts_at_its_ends(name: str) -> None:
    """And they touch nothing else: one box of each block, whatever lies beside it."""
    problem = case_at(name, 1.0)
    assembly = problem.assembly
    world = Bodies(problem, ENGINE.rule(assembly))
    world.hold(1)
    resultants = world.resultants()
    off = off_ends(world, assembly)
    assert off.shape[1] == 2 * len(assembly.joints)
    # Two joints may end at the same place.
    assert off.min(axis=0).max() < 1e-6
    assert off.min(axis=1).max() < 1e-6
    assert np.isfinite(resultants).all()


NARROW_INTRADOS = CircularArch.of(
    Arch(half_angle=math.radians(120), eta=1.99, voussoirs=11), 1.5
).problem()
"""Its voussoirs are narrower there than the boxes on their faces."""


@pytest.mark.parametrize("problem", [NARROW_INTRADOS, case_at("grid_wall_3", 0.5)])
def test_let_go_blocks_touch_at_the_ends_of_joints_only(problem: Problem) -> None:
    world = Bodies(problem, ENGINE.rule(problem.assembly))
    world.hold(1000)
    world.advance(1)
    off = off_ends(world, problem.assembly)
    assert off.min(axis=0).max() < 1e-6
    assert off.min(axis=1).max() < 1e-6


def test_other_spaces_do_not_disturb_a_held_one() -> None:
    """Bullet has settings that all its spaces share."""
    alone, beside = (hold(CircularArch.of(THIN, 0.7).problem(), "pybullet") for _ in range(2))
    undisturbed = alone.release(0.5).recording
    hold(CircularArch.of(replace(THIN, eta=1.0), 0.7).problem(), "pybullet")
    assert beside.release(0.5).recording.state_hash == undisturbed.state_hash


def test_the_thinnest_arches_are_given_up_soon() -> None:
    """Sweeps would grow without end as joints shorten; what few can tell is undecided."""
    arch = Arch(half_angle=math.radians(60), eta=1e-9, voussoirs=3)
    assert (
        observe(CircularArch.of(arch, 1.0).problem(), "pybullet").verdict is Verdict.UNDECIDED
    )


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0, -1), (0.6, 0, 0.8), (1, 0, 0)])
@pytest.mark.parametrize("end", [3.2, 2 * math.pi, 20.0])
def test_whole_turns_are_counted(axis: tuple[float, ...], end: float) -> None:
    """An orientation is the same after each, and knows half a turn at most."""
    turned = np.zeros((1, 3))
    for angle in [*np.arange(0.0, end, 0.5), end]:
        expected = angle * np.array([axis])
        seen = Rotation.from_rotvec(expected).as_rotvec()
        turned = unwound(seen, turned)
        assert turned == pytest.approx(expected, abs=1e-9)


def test_an_arch_that_falls_stays_symmetric_and_falls_as_pymunk_has_it() -> None:
    """Its springings are level joints, which turn by more in a step than blocks overlap.

    In pymunk with short steps: with its usual ones `direct` starts early.
    """
    problem = problem_at(0.93, 90, 0.7, 9)
    bullet, fine = (
        simulate(problem, method=name, duration=2.0, settings=settings)
        for name, settings in (("pybullet", {}), ("pymunk", {"step": 0.002}))
    )
    fallen, known = (run.poses[-1, :, :2] - run.poses[0, :, :2] for run in (bullet, fine))
    assert known[4, 1] < -0.5
    assert fallen[4, 1] == pytest.approx(known[4, 1], rel=0.02)
    assert np.abs(fallen - fallen[::-1] * (-1, 1)).max() < 1e-3


def test_blocks_let_go_start_neither_early_nor_late() -> None:
    """A slab slides by g (sin phi - mu cos phi) t^2 / 2; an arch falls as in `direct`.

    With a whole step's velocity from the first step on both were half a step early.
    """
    floor = {"id": 0, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
    slab = {"id": 1, "vertices": [[0, 0], [1, 0], [1, 0.2], [0, 0.2]]}
    slope = structure_of({"friction": 0.2, "blocks": [floor, slab]}).tilted(math.pi / 6)
    slides = simulate(slope, method="pybullet", duration=1.0)
    pull = math.sin(math.pi / 6) - 0.2 * math.cos(math.pi / 6)
    assert slides.displacement == pytest.approx(pull * slides.times**2 / 2, rel=1e-4, abs=1e-6)
    arch = CircularArch.of(Arch(half_angle=math.pi / 2, eta=0.07, voussoirs=7), 0.7).problem()
    truth = simulate(arch, method="direct", duration=0.7)
    # Its error is of first order: at a quarter of the usual step little is left.
    seen = simulate(arch, method="pybullet", duration=0.7, settings={"step": 0.004})
    for level in (2e-3, 1e-2, 5e-2):
        early, late = (
            np.interp(level**0.5, each.displacement**0.5, each.times) for each in (seen, truth)
        )
        assert early == pytest.approx(late, rel=1e-3)


@pytest.mark.parametrize("in_space", [False, True])
def test_what_falls_beside_what_it_stood_on_lies_on_the_floor(in_space: bool) -> None:
    """It lay a thousandth of the size above it."""
    ledge = {"id": 0, "vertices": [[0, -2], [1, -2], [1, 0], [0, 0]], "fixed": True}
    corners = [[1.5, -1.2], [2, -1.2], [2, -0.7], [1.5, -0.7]]
    cube = {"id": 1, "vertices": corners, "free": True}
    problem = structure_of({"friction": 0.5, "blocks": [ledge, cube]})
    problem = extruded(problem) if in_space else problem
    size = problem.assembly.size
    fell = simulate(problem, method="pybullet", duration=math.sqrt(1.6 / size) + 0.5)
    way = fell.poses[-1, 0] - fell.poses[0, 0]
    assert way[2 if in_space else 1] * size == pytest.approx(-0.8, abs=3e-6)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_recording_tells_how_deep_a_corner_is_in_the_ground(seed: int) -> None:
    """Bullet rounds corners of hulls, and knows only of overlap beyond that."""
    draw = np.random.default_rng(seed)
    turn = np.sort(draw.uniform(0, 2 * math.pi, 7))
    corners = np.stack([np.cos(turn), 0.7 * np.sin(turn)], axis=1)
    corners[:, 1] += 0.3 - corners[:, 1].min()
    ground = {"id": 0, "fixed": True, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]]}
    stone = {"id": 1, "vertices": corners.tolist(), "free": True}
    problem = structure_of({"friction": 0.6, "size": 1, "blocks": [ground, stone]})
    fell = simulate(problem, method="pybullet", duration=2.0)
    arms = corners - problem.assembly.centres[0]
    lowest = min(
        float((y + arms @ [math.sin(turned), math.cos(turned)]).min())
        for _, y, turned in fell.poses[:, 0]
    )
    assert fell.quality.penetration is not None
    assert 0 < -lowest < fell.quality.penetration
