"""Blocks in space that move, held to known cases, closed forms, conservation and the plane."""

import math
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial import ConvexHull, Delaunay
from scipy.spatial.transform import Rotation
from space_cases import GROUND, NAMES, asked, box, case, enclosed, problem_of
from worlds import observe

import blocksim
from analysis import known_motions
from blocksim import (
    Dome,
    GroinVault,
    Load,
    Problem,
    SkewArch,
    Solid,
    Verdict,
    extruded,
    structure_of,
)
from blocksim.engines.direct import USUAL
from blocksim.engines.solid.between import ROUNDED
from blocksim.engines.solid.meeting import Points
from blocksim.engines.solid.memory import Borne
from blocksim.engines.solid.stepping import SolidBlocks, depth
from blocksim.simulation.looking import Looking
from blocksim.simulation.simulated import Simulation
from blocksim.view.film import Film
from blocksim.view.timeline import UPRIGHT


@pytest.mark.parametrize("name", NAMES[::3])
def test_direct_tells_a_case_a_thousandth_to_both_sides(name: str) -> None:
    """By the onset test; the study `space_cases` asks about all 55."""
    for problem, verdict in asked(name, 0.001):
        assert observe(problem, "direct", moving=False).verdict is verdict


@pytest.mark.parametrize(("sides", "mu"), [(4, 0.17), (5, 0.285), (12, 0.6)])
def test_a_prism_that_can_rest_as_well_as_turn_rests(sides: int, mu: float) -> None:
    """A plate twisted 0.1 % below its limit: Coulomb's law allows both."""
    turns = 2 * np.pi * np.arange(sides) / sides
    base = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    plate = np.concatenate([np.column_stack([base, np.full(sides, z)]) for z in (0, 0.2)])
    solids = [Solid(parts=(GROUND,), fixed=True), Solid(parts=(plate,))]
    push = Load(force=np.array([0.0, 1, 0]), blocks=(0,), point=np.array([3.0, 0, 0.1]))
    problem = problem_of(solids, mu, live=(push,))
    most = blocksim.collapse(problem).load_factor
    below = problem.with_load(0.999 * most)
    assert blocksim.check(below, method="direct").verdict is Verdict.STANDS


def test_an_arch_that_can_rest_as_well_as_slide_is_not_said_to_fall() -> None:
    """A skew one of four voussoirs, tilted 1 % less than it bears."""
    arch = SkewArch(radius=0.8211, thickness=0.1714, width=0.4214, half_angle_deg=73.4231,
                    skew_deg=24.7234, voussoirs=4, friction=0.2587)  # fmt: skip
    problem = replace(arch.problem(), azimuth=math.radians(-140.4373))
    most = blocksim.bracket(problem, over="tilt")
    assert most.proved
    below = problem.tilted(math.radians(0.99 * most.limit))
    assert blocksim.check(below).verdict is Verdict.STANDS
    assert blocksim.check(below, method="direct").verdict is Verdict.STANDS


def test_a_dome_that_can_rest_as_well_as_slide_rests_by_forces_it_is_given() -> None:
    """Three blocks, pushed 0.1 % less than they bear: begun with nothing they move."""
    dome = Dome(radius=1.5316, thickness=0.092608, rise=1.47929, eye_deg=31.7112, lunes=3,
                courses=1, friction=1.290886).problem()  # fmt: skip
    way = np.array([math.cos(1.5421025), math.sin(1.5421025), 0.0])
    problem = replace(dome, live=(Load(force=way, blocks=(0, 1, 2), per_weight=True),))
    most = blocksim.collapse(problem).load_factor
    seen = blocksim.check(problem.with_load(0.999 * most), method="direct")
    assert seen.verdict is Verdict.STANDS
    assert seen.rest == "can"
    assert "contacts keep the forces of equilibrium that they were given" in seen.reason


@pytest.mark.parametrize("beside", [pytest.param(0.01, marks=pytest.mark.long), 0.001])
@pytest.mark.parametrize("name", ["dome_12_7_loaded", "dome_12_7_pushed"])
def test_a_dome_of_84_blocks_begins_to_fall_beyond_its_limit(name: str, beside: float) -> None:
    """A path to Coulomb's law turns back on its way here, and goes on."""
    problem, verdict = asked(name, beside)[1]
    assert observe(problem, "direct", moving=False).verdict is verdict


def test_a_groin_vault_begins_to_fall_beyond_its_limit() -> None:
    """Pushed aslant by 1 % beside its load factor, which two linear programmes enclose."""
    vault = GroinVault(thickness=0.3, half_angle_deg=60, courses=4, friction=0.7).problem()
    blocks, way = tuple(range(len(vault.assembly.blocks))), np.array([0.88, 0.48, 0.0])
    problem = replace(vault, live=(Load(force=way, blocks=blocks, per_weight=True),))
    least, most = enclosed(problem, sides=16)
    factor = blocksim.collapse(problem).load_factor
    assert least < factor < most
    for share, verdict in ((0.99, Verdict.STANDS), (1.01, Verdict.COLLAPSES)):
        seen = observe(problem.with_load(share * factor), "direct", moving=False)
        assert seen.verdict is verdict


@pytest.mark.parametrize(
    "name", ["block_topples_20", "tower_113", "tower_103", "harmonic_4_out"]
)
def test_what_is_let_go_does_what_the_onset_test_said(name: str) -> None:
    """The moving run agrees, by the public verb."""
    for problem, verdict in asked(name, 0.01):
        answer = blocksim.check(problem, method="direct")
        assert answer.verdict is verdict
        assert [each.test for each in answer.evidence][:2] == ["onset test", "moving run"]


def test_what_stands_on_an_edge_turns_about_it() -> None:
    """A block of 1 x 4 m that leans: nothing parts there, and round-off is no overlap."""
    problem = extruded(known_motions.rocking(1).problem)
    assert blocksim.check(problem, method="direct").verdict is Verdict.COLLAPSES
    assert blocksim.simulate(problem, method="direct", duration=0.5).times[-1] == 0.5


@pytest.mark.parametrize("name", NAMES[::3])
def test_blocks_meet_where_their_joints_are(name: str) -> None:
    """Two ways to find points of contact: of blocks as built, and of blocks that move."""
    stepping = SolidBlocks(structure_of(case(name)["scene"]), USUAL)
    points, *_ = stepping._points(stepping._place, 0.0)
    closed = int((points.gaps < 1e-6).sum())
    joints = stepping.bodies.problem.assembly.joints
    assert closed == sum(len(joint.points) for joint in joints)


@pytest.mark.parametrize("made", [GroinVault(courses=2), Dome(lunes=5, courses=2, bond="half")])
def test_what_shares_an_edge_as_drawn_and_no_joint_is_not_closed(made: Any) -> None:
    """Points of contact that are closed lie along joints, of stones with many parts, too."""
    problem = replace(made, friction=0.7).problem()
    stepping = SolidBlocks(problem, USUAL)
    points, *_ = stepping._points(stepping._place, 0.0)
    closed = points.gaps < 1e-6
    owner = stepping.bodies.hulls.owner
    for at in np.flatnonzero(closed).tolist():
        sides = {int(owner[points.before[at]]), int(owner[points.after[at]])}
        along = [
            abs(joint.normal @ points.normals[at])
            for joint in problem.assembly.joints
            if {joint.before, joint.after} == sides
        ]
        assert max(along) > 0.999


def incline(angle: float, mu: float) -> Problem[Any]:
    """A flat block on level ground, under gravity that leans towards 30 deg from x."""
    solids = [Solid(parts=(GROUND,), fixed=True), Solid(parts=(box((0, 0, 0), (2, 1, 0.2)),))]
    return replace(problem_of(solids, mu), azimuth=math.radians(30)).tilted(angle)


@pytest.mark.parametrize("mu", [0.0, 0.2, 0.5])
def test_a_block_slides_down_as_coulomb_says(mu: float) -> None:
    """Its acceleration is g (sin a - mu cos a), straight down the slope."""
    angle = math.radians(35)
    recording = blocksim.simulate(incline(angle, mu), method="direct", duration=1.0)
    size = recording.problem.assembly.size
    way = (recording.poses[-1] - recording.poses[0])[0] * size
    time = recording.times[-1] * math.sqrt(size)
    rate = math.sin(angle) - mu * math.cos(angle)
    assert np.hypot(*way[:2]) == pytest.approx(rate * time**2 / 2, rel=1e-7)
    assert math.atan2(way[1], way[0]) == pytest.approx(math.radians(30), abs=1e-7)
    assert np.abs(way[2:]).max() < 1e-7


def rocked(step: float) -> float:
    """How far from its equation a block is that turns about an edge, at its last moment."""
    tall, wide = 2.0, 0.5
    solids = [Solid(parts=(GROUND,), fixed=True)]
    solids.append(Solid(parts=(box((0, 0, 0), (wide, 1, tall)),)))
    problem = problem_of(solids, 3.0).tilted(1.05 * math.atan2(wide, tall))
    recording = blocksim.simulate(
        problem, method="direct", duration=1.5, settings={"step": step}
    )
    arm, lean = math.hypot(wide, tall) / 2, math.atan2(wide, tall)

    def rate(_: float, state: np.ndarray) -> list[float]:
        # Housner 1963: moment of inertia 4/3 R^2, turning about the corner.
        return [state[1], 0.75 / arm * math.sin(0.05 * lean + state[0])]

    times = recording.times * math.sqrt(problem.assembly.size)
    known = solve_ivp(rate, (0, times[-1]), [0.0, 0.0], rtol=1e-12, atol=1e-14).y[0, -1]
    return abs(float(np.linalg.norm(recording.poses[-1, 0, 3:])) - float(known))


def test_a_block_that_turns_follows_its_equation_to_second_order() -> None:
    """Halving the step leaves a quarter of the error, which is small as it is."""
    coarse, fine = rocked(0.05), rocked(0.025)
    assert fine < 2e-5
    assert 3.0 < coarse / fine < 5.5


PORTAL = {
    "friction": 0.7,
    "blocks": [
        {"id": "ground", "vertices": [[-3, -1], [4, -1], [4, 0], [-3, 0]], "fixed": True},
        {"id": "left", "vertices": [[0, 0], [0.3, 0], [0.3, 2], [0, 2]]},
        {"id": "right", "vertices": [[1.2, 0], [1.5, 0], [1.5, 2], [1.2, 2]]},
        {"id": "lintel", "vertices": [[0, 2], [1.5, 2], [1.5, 2.3], [0, 2.3]]},
    ],
}


def portals_apart(step: float) -> float:
    """How far a portal that falls is from itself as prisms, before anything meets anew [m]."""
    plane = blocksim.structure_of(PORTAL).tilted(math.radians(12))
    solid = extruded(plane)
    ratio = math.sqrt(solid.assembly.size / plane.assembly.size)
    flat, space = (
        blocksim.simulate(
            each, method="direct", duration=0.5 * by, settings={"step": step * by}
        )
        for each, by in ((plane, ratio), (solid, 1.0))
    )
    there = (flat.poses[-1] - flat.poses[0])[:, :2] * plane.assembly.size
    here = (space.poses[-1] - space.poses[0])[:, [0, 2]] * solid.assembly.size
    assert flat.times[-1] == pytest.approx(space.times[-1] * ratio)
    assert np.abs(there).max() > 0.01
    return float(np.abs(there - here).max())


def test_blocks_fall_in_space_as_in_the_plane() -> None:
    """A portal that tilts, by two programmes of two geometries."""
    assert portals_apart(0.0125) < 1e-6


def test_a_thin_bar_that_falls_on_its_edge_turns_about_it() -> None:
    """What an impact takes in a moment was taken for the acceleration of the step after it."""
    wide, tall, lean = 0.04, 0.01, 0.55
    corners = np.array(known_motions.box(0, 0, wide, tall)) @ [1, 1j] * np.exp(-1j * lean)
    # It has turned for a while at the last frame, and lies on its edge alone.
    arm = corners.mean() - corners[np.argmin(corners.imag)]
    size, until, since = 0.5, 1.0, 0.015
    fell = size * (until - since) ** 2 / 2
    corners += 1j * (fell - corners.imag.min())
    made = known_motions.blocks(
        3.0, np.column_stack([corners.real, corners.imag]).tolist(), free=True
    )
    recording = blocksim.simulate(extruded(made), method="direct", duration=until)
    assert recording.assembly.size == size
    assert recording.times[-1] == pytest.approx(until)
    # About the edge angular momentum stays.
    about = abs(arm) ** 2 + (wide**2 + tall**2) / 12
    spin = arm.real * math.sqrt(2 * fell) / about
    turned = np.linalg.norm(recording.poses[-1, 0, 3:])
    assert turned == pytest.approx(abs(spin) * since * math.sqrt(size), rel=0.05)
    assert recording.quality.gain < 1e-3


def tumbling(step: float) -> tuple[float, float]:
    """How far spin and energy drift of a box that turns freely about its middle axis."""
    solids = [Solid(parts=(GROUND,), fixed=True)]
    solids.append(Solid(parts=(box((0, 0, 0), (0.3, 0.8, 0.2)),)))
    stepping = SolidBlocks(problem_of(solids, 0.5), USUAL)
    bodies = stepping.bodies
    stepping._place = stepping._place.moved(np.array([[0.0, 0, 50, 0, 0, 0]]))
    stepping._velocities = np.array([[0.0, 0, 0, 0.02, 2.0, 0.01]])

    def spin() -> np.ndarray:
        return stepping._place.turns[0] @ (bodies.inertia[0, 3:] * stepping._velocities[0, 3:])

    def energy() -> float:
        return bodies.potential(stepping._place) + bodies.kinetic(stepping._velocities)

    before = spin(), energy()
    for _ in range(round(1 / step)):
        stepping._move(step)
    after = spin(), energy()
    return float(np.linalg.norm(after[0] - before[0])), abs(after[1] - before[1])


def test_what_turns_freely_keeps_its_spin_to_second_order() -> None:
    """Euler's equations: angular momentum in space stays what it is."""
    (coarse, _), (fine, energy) = tumbling(0.02), tumbling(0.01)
    assert 3.0 < coarse / fine < 5.0
    assert energy < 1e-2


@pytest.mark.long
def test_a_dome_that_is_too_thin_falls_to_the_ground() -> None:
    """No block is thrown, none passes another, and no energy is gained."""
    dome = Dome(lunes=8, courses=4, thickness=0.03, friction=0.7)
    recording = blocksim.simulate(dome.problem(), method="direct", duration=3.0)
    quality, problem = recording.quality, recording.problem
    # Newton's method alone left a step in which wedges jam at 0.5.
    assert quality.residual is not None
    assert quality.residual < 1e-5
    assert quality.gain < 1e-3
    # Overlap that only came about in a step went unseen: 1e-4 to 3e-3 by the last digit.
    assert quality.penetration < 1e-5
    heights = recording.poses[:, :, 2] * problem.assembly.size
    assert (heights.max(axis=1) <= heights[0].max() + 1e-6).all()
    assert heights[-1].max() < 0.5 * heights[0].max()
    # The springing has a radius of 1: nothing is flung away from it.
    assert np.abs(recording.poses[-1, :, :2]).max() * problem.assembly.size < 1.5


@pytest.mark.parametrize("seed", range(3))
def test_blocks_that_overlap_are_pushed_apart_though_others_are_in_the_way(seed: int) -> None:
    """One push of a dome's blocks presses them into others, and leaves nine tenths."""
    dome = Dome(lunes=8, courses=4, thickness=0.03, friction=0.7)
    stepping = SolidBlocks(dome.problem(), USUAL)
    way = np.zeros_like(stepping._velocities)
    way[:, :3] = 1e-3 * np.random.default_rng(seed).normal(size=(len(way), 3))
    stepping._place = stepping._place.moved(way)
    assert depth(stepping._points(stepping._place, 0.0)[0].gaps) > 2e-3
    stepping._push_apart(stepping._points(stepping._place, 0.0))
    assert depth(stepping._points(stepping._place, 0.0)[0].gaps) < 1e-6
    # Edges that share no joint are rounded.
    assert (
        stepping.quality().penetration < 1e-6 + ROUNDED * stepping.bodies.hulls.thickness.max()
    )


@pytest.mark.parametrize("share", np.arange(0.05, 1, 0.1))
def test_blocks_that_hit_at_their_corners_hit_wherever_in_a_step_they_do(share: float) -> None:
    """Two free cubes, one of which passes the other's side: it takes velocity of it."""
    solids = [Solid(parts=(GROUND,), fixed=True)]
    solids += [Solid(parts=(box((x, 0, 0), (x + 1, 1, 1)),)) for x in (0, 2)]
    stepping = SolidBlocks(problem_of(solids, 0.0), USUAL)
    size, step = stepping.bodies.problem.assembly.size, USUAL.step
    cube, speed, aside = 1 / size, 0.6, 0.1
    way, hit = np.zeros_like(stepping._velocities), (1 + share) * step
    way[:, 2] = 5.0
    # Sides overlap a fifth of a step before the faces meet, which is the impact.
    way[1, 0] = -cube + speed * hit
    way[1, 1] = cube + aside * (hit - step / 5)
    stepping._place = stepping._place.moved(way)
    stepping._velocities[1, :2] = -speed, -aside
    stepping.advance(2)
    # One impulse at the corners, with moments of inertia of cubes, to first order in the step.
    arm, spin = cube / 2, cube**2 / 6
    taken = speed / (2 * (1 + arm**2 / spin))
    assert stepping._velocities[0, 0] == pytest.approx(-taken, rel=0.18)


@pytest.mark.parametrize(("wide", "height"), [(0.002, 2.0), (0.01, 2.3)])
def test_what_falls_fast_does_not_pass_through_a_thin_plate(wide: float, height: float) -> None:
    """A bar on a plate as thick as it is, both far thinner than the way in a step."""
    drawn = {"floor": [-9, -9, 18, 1], "plate": [-0.5, -wide, 1, wide]}
    blocks = [
        {"id": name, "fixed": True, "vertices": known_motions.box(*sides)}
        for name, sides in drawn.items()
    ]
    bar = {"id": "bar", "free": True, "vertices": known_motions.box(0, height, wide, wide)}
    problem = extruded(blocksim.structure_of({"friction": 0.5, "blocks": [*blocks, bar]}))
    fall = height / problem.assembly.size
    recording = blocksim.simulate(problem, method="direct", duration=math.sqrt(2 * fall) + 0.3)
    way = recording.poses[-1, 0, :3] - recording.poses[0, 0, :3]
    assert way == pytest.approx([0, 0, -fall], abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_edges_meet_where_they_cross(seed: int) -> None:
    """Of two cubes, turned by 45 degrees each: any of four parallel edges was taken."""
    random = np.random.default_rng(seed)
    solids = [Solid(parts=(GROUND,), fixed=True)]
    solids += [Solid(parts=(box((x, 0, 0), (x + 1, 1, 1)),)) for x in (0, 2)]
    stepping = SolidBlocks(problem_of(solids, 0.5), USUAL)
    cube, built = 1 / stepping.bodies.problem.assembly.size, stepping._place
    # Ridges along x and y cross above the centre of the lower cube, and 0.02 deep.
    aside = random.uniform(-0.4, 0.4, 2) * cube
    upper = np.array([*aside, (math.sqrt(2) - 0.02) * cube])
    whole = Rotation.random(random_state=seed)
    turns = [whole * Rotation.from_euler(axis, 45, degrees=True) for axis in "xy"]
    centres, turned = built.centres.copy(), built.turns.copy()
    high = np.array([0.0, 0, 9])
    centres[:2] = [high, high + whole.apply(upper)]
    turned[:2] = [each.as_matrix() for each in turns]
    points = stepping._points(built._replace(centres=centres, turns=turned), 0.0).points
    crossing = high + whole.apply([aside[0], 0, math.sqrt(0.5) * cube])
    assert points.gaps == pytest.approx([-0.02 * cube])
    assert np.linalg.norm(points.places - crossing) < 0.021 * cube


def falling_tower() -> Problem[Any]:
    """A case that topples at once."""
    return structure_of(case("tower_113")["scene"])


def test_a_film_keeps_all_blocks_in_frame_and_says_whether_they_move() -> None:
    """Corners in pixels, at ten moments."""
    recording = blocksim.simulate(falling_tower(), method="direct", duration=1.0)
    film = Film([recording], height=180)
    stage, view, *_ = film.shots[0]
    for share in np.linspace(0, 1, 10):
        seconds = float(share) * film.seconds
        places = view.places(stage.corners_at(seconds / recording.problem.seconds))
        x, y = (view.centre + film.share(seconds) * (places - view.centre)).T
        assert 0 < x.min() < x.max() < film.width
        assert 0 < y.min() < y.max() < film.height
    # A scale bar is before all that stands, and its words are in the picture.
    bar, (words,) = view.scale_bar(0.5, "0.5 m", film.height / 720)
    box = np.concatenate([view.places(hull.corners @ UPRIGHT.T / stage.assembly.size)
                          for hull in stage.supports])  # fmt: skip
    for strip in bar:
        assert not Delaunay(box).find_simplex(strip.points).max() >= 0
    assert 0 < words.y < film.height
    first, last = film.frame(0), film.frame(film.count - 1)
    assert first.shape == (180, 320, 4)
    assert (first != last).any()
    assert film.speed > 0


def test_a_film_of_what_stands_is_at_rest() -> None:
    """Every frame is as the first, but for the clock."""
    problem = structure_of(case("tower_103")["scene"])
    recording = blocksim.simulate(problem, method="direct", duration=0.5)
    film = Film([recording], height=180)
    assert film.speed == 0
    assert (film.frame(0)[:150] == film.frame(film.count - 1)[:150]).all()


def test_a_film_ends_when_nothing_is_seen_to_move_any_more() -> None:
    """A box slides, and trembles by less than a pixel for ten times as long."""
    problem = structure_of(case("tower_103")["scene"])
    times = np.linspace(0, 11, 111)
    rest = blocksim.simulate(problem, method="direct", duration=0.05)
    poses = np.repeat(rest.poses[:1], len(times), axis=0)
    poses[:, -1, 0] += 0.1 * np.minimum(times, 1) + 1e-3 * np.sin(times) * (times > 1)
    film = Film([replace(rest, times=times, poses=poses)], height=180)
    assert film.seconds == pytest.approx(problem.seconds, rel=0.1)
    assert film.count / film.rate > 6


ENGINES = ("pybullet", "mujoco")
QUICK = ("block_topples_20", "plate_slides_25", "tower_102", "tower_113", "harmonic_4_out")
"""Of each kind one that is answered at once: turning, sliding, rest, a fall."""


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("case", QUICK)
def test_a_case_is_told_by_onset_test_and_moving_run(case: str, name: str) -> None:
    pytest.importorskip(name, exc_type=ImportError)
    for problem, verdict in asked(case, 0.01):
        answer = blocksim.check(problem, method=name)
        assert answer.verdict is verdict
        assert [each.test for each in answer.evidence][:2] == ["onset test", "moving run"]


@pytest.mark.long
@pytest.mark.parametrize(
    ("case", "side", "name"),
    [
        ("arch_15_skew_30_aslant", 1, "mujoco"),
        ("arch_15_skew_30_crown", 0, "mujoco"),
        ("dome_8_5_pushed", 1, "mujoco"),
        ("arch_15_skew_30_crown", 0, "pybullet"),
        ("dome_8_5_loaded", 0, "pybullet"),
        ("dome_8_5_stands", 0, "pybullet"),
        ("tower_108_pushed", 0, "pybullet"),
    ],
)
def test_what_slides_and_what_rests_on_given_forces_is_told(
    case: str, side: int, name: str
) -> None:
    pytest.importorskip(name, exc_type=ImportError)
    problem, verdict = list(asked(case, 0.01))[side]
    assert blocksim.check(problem, method=name).verdict is verdict


FEW = (
    *("arch_15_skew_0_crown", "arch_15_skew_30_across", "column_4_4_30", "dome_8_5_falls"),
    *("dome_8_5_stands", "jenga_8_falls", "three_posts_shared", "tower_102_pushed", "twist_4"),
    *("twist_6", "wall_6_4_2_0_-1_0"),
)
"""Of each shape and load one; the study `space_cases` asks about all 55."""


@pytest.mark.long
@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("case", FEW)
def test_no_case_is_told_falsely(case: str, name: str) -> None:
    """What an engine does not find is open, never false; by the onset test."""
    pytest.importorskip(name, exc_type=ImportError)
    for problem, verdict in asked(case, 0.01):
        seen = observe(problem, name, moving=False)
        assert seen.verdict in (verdict, Verdict.UNDECIDED)


@pytest.mark.parametrize("case", ["tower_102", "twist_6", "arch_15_skew_30_crown"])
def test_bullet_finds_one_contact_at_each_corner(case: str) -> None:
    """Where limit analysis has its points."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    from blocksim.engines.bulletsolids import Spatial
    from blocksim.engines.bulletspace import Space

    (problem, _), *_ = asked(case, 0.5)
    parts = Spatial(problem)
    space = Space(parts.frame, parts.breaking)
    parts.linked(space)
    space.find_contacts()
    found = np.array([each.place for each in space.contacts()])
    joints = problem.assembly.joints
    known = np.concatenate([each.points for each in joints]) / problem.assembly.size
    assert len(found) == len(known)
    apart = np.linalg.norm(found[:, None] - known, axis=2)
    assert apart.min(axis=0).max() < 2e-6
    assert apart.min(axis=1).max() < 2e-6


@pytest.mark.parametrize("turn", [0.02, 0.1])
def test_bullet_tells_how_deep_thin_blocks_reach_into_each_other(turn: float) -> None:
    """A slab on a slab, turned about an edge of its bed: the other edge is as deep as it turns.

    Where points of contact are merged over more than the bed is wide, that edge is lost.
    """
    pytest.importorskip("pybullet", exc_type=ImportError)
    from blocksim.engines.bulletsolids import Spatial
    from blocksim.engines.bulletspace import Space, State

    wide = 0.04
    slabs = box((0, 0, 0), (1, wide, 0.6)), box((0, 0, 0.6), (1, wide, 1.2))
    solids = [Solid(parts=(each,), fixed=not at) for at, each in enumerate((GROUND, *slabs))]
    problem = problem_of(solids, 0.7)
    parts, size = Spatial(problem), problem.assembly.size
    turned, edge = Rotation.from_euler("x", -turn), np.array([0.5, 0.0, 0.6])
    centre = edge + turned.apply(problem.assembly.centres[1] - edge)
    upper = turned * Rotation.from_quat(parts.states[1].turn)
    space = Space(parts.frame, parts.breaking)
    states = [parts.states[0], State((centre / size).tolist(), upper.as_quat().tolist())]
    parts.solid(space, states)
    space.find_contacts()
    assert space.overlap() * size == pytest.approx(wide * math.sin(turn), rel=0.01)


@pytest.mark.parametrize("case", ["twist_6", "arch_15_skew_30_crown"])
def test_bullet_keeps_forces_given_within_round_cones(case: str) -> None:
    """What it ends with holds the blocks; no point rubs by more than mu times its pressure."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    (problem, _), *_ = asked(case, 0.01)
    _, forces = Looking(problem).equilibrium()
    world: Any = Simulation.of(problem, "pybullet").world()
    world.begin(forces)
    for sweeps in (1000, 500, 1000, 2500, 5000):
        accelerations = world.hold(sweeps)
    assembly = problem.assembly
    assert assembly.displacement(accelerations) < 1e-5
    joint = np.repeat(np.arange(len(assembly.joints)), [len(j.points) for j in assembly.joints])
    seen = list(world._space.contacts())
    assert len(seen) == len(joint)
    used = list[float]()
    for contact in seen:
        places = assembly.points / assembly.size - contact.place
        at = joint[np.linalg.norm(places, axis=1).argmin()]
        normal = assembly.joints[at].normal
        push = abs(float(contact.force @ normal))
        rubs = float(np.linalg.norm(np.cross(contact.force, normal)))
        assert rubs <= problem.friction[at] * push + 1e-5
        used.append(rubs / (problem.friction[at] * push))
    assert max(used) > 0.98


def test_what_a_point_bore_goes_on_to_the_nearest_of_the_same_two_bodies() -> None:
    """The push of one body on the other stays what it was, whichever has the face."""
    draw = np.random.default_rng(0)
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0]])
    hulls, places = np.array([0, 0, 0]), np.diag([0.0, 1.0, 0.0])
    places[2] = 0.0, 0.8, 0.0
    last = Points(hulls, hulls + 1, places, normals, np.zeros(3), np.array([1, 2, 3]))
    forces = draw.uniform(0.1, 1.0, (3, 3))
    # The second point is there still; the first is now on the other's face, the third nowhere.
    here, there = np.array([1, 0, 0]), np.array([0, 1, 2])
    turned = normals * [[-1.0], [1.0], [1.0]]
    now = Points(here, there, places + 1e-3, turned, np.zeros(3), np.array([7, 2, 9]))
    found = Borne(last, forces).at(now, np.array([0, 1, 2]))
    pushes = np.einsum("pi,pij->pj", forces, last.axes)
    again = np.einsum("pi,pij->pj", found, now.axes)
    assert again[0] == pytest.approx(-pushes[0])
    assert again[1] == pytest.approx(pushes[1] + pushes[2])
    assert not found[2].any()


def test_what_a_point_bore_stays_where_rounding_turns_its_ways_across() -> None:
    """Seen along z no way across is nearer than another: in domes the last digit chose."""
    hull, place = np.array([0]), np.zeros((1, 3))
    last, now = (
        Points(hull, hull + 1, place, np.array([[tiny, 0.0, 1.0]]), np.zeros(1), np.array([1]))
        for tiny in (0.0, 1e-17)
    )
    assert np.abs(last.axes - now.axes).max() > 0.5
    forces = np.array([[1.0, 0.3, 0.2]])
    found = Borne(last, forces).at(now, np.array([0, 1]))
    pushes = np.einsum("pi,pij->pj", found, now.axes)
    assert pushes == pytest.approx(np.einsum("pi,pij->pj", forces, last.axes))


def test_a_dome_whose_lunes_slide_past_each_others_edges_is_told_by_its_motion() -> None:
    """Blocks on both sides of a corner of four joints touch along an edge and wedge nothing."""
    dome = Dome(thickness=0.146, eye_deg=19.6, lunes=6, courses=2, friction=0.248).problem()
    blocks = tuple(range(len(dome.assembly.blocks)))
    push = Load(force=np.array([1.0, 0, 0]), blocks=blocks, per_weight=True)
    problem = replace(dome, live=(push,))
    most = blocksim.collapse(problem).load_factor
    for share, verdict in ((0.999, Verdict.STANDS), (1.01, Verdict.COLLAPSES)):
        seen = blocksim.check(problem.with_load(share * most), method="direct")
        assert seen.verdict is verdict


def within(one: np.ndarray, other: np.ndarray) -> float:
    """How deep two hulls of corners are within each other, along whichever way is the least."""
    sides = [np.array([b - a for a, b in combinations(each, 2)]) for each in (one, other)]
    ways = [ConvexHull(each).equations[:, :3] for each in (one, other)]
    across = np.cross(sides[0][:, None], sides[1][None]).reshape(-1, 3)
    long = np.linalg.norm(across, axis=1)
    ways = np.concatenate([*ways, across[long > 1e-6] / long[long > 1e-6, None]])
    a, b = one @ ways.T, other @ ways.T
    return float(np.minimum(a.max(0) - b.min(0), b.max(0) - a.min(0)).min())


def test_how_deep_edges_slide_into_each_other_is_told() -> None:
    """A pushed dome: they are rounded, by less than a hundredth of a block."""
    dome = Dome(radius=16, thickness=1.88, eye_deg=5.9, lunes=6, courses=3, friction=0.464)
    blocks = tuple(range(18))
    push = Load(force=np.array([0.3623, 0, 0]), blocks=blocks, per_weight=True)
    problem = replace(dome.problem(), dead=(push,))
    recording = blocksim.check(problem, method="direct").recording
    assert recording is not None
    size, deepest = problem.assembly.size, 0.0
    for poses in recording.poses[-4:]:
        turns = Rotation.from_rotvec(poses[:, 3:])
        corners = [
            turns[at].apply((block.hulls[0].corners - block.centre) / size) + poses[at, :3]
            for at, block in enumerate(problem.assembly.blocks)
        ]
        deepest = max(deepest, *(within(*each) for each in combinations(corners, 2)))
    assert 1e-4 < deepest < 0.01 * 1.88 / size
    assert recording.quality.penetration == pytest.approx(deepest, rel=1e-3)


@pytest.mark.long
def test_a_loaded_dome_that_slides_is_told_by_its_motion() -> None:
    """Corners slide over faces from the first step on."""
    for problem, verdict in asked("dome_8_5_loaded", 0.01):
        answer = blocksim.check(problem, method="direct")
        assert answer.verdict is verdict
        assert answer.recording is not None
        assert answer.recording.quality.residual < 1e-5
