"""Blocks that begin in motion, bounce, and fall otherwise than on Earth, and ground that also
goes up and down, held against closed forms.

Ballistics; heights after impacts with restitution (e^2 each), and the one impulse of a corner
that hits; Coulomb's law for what slides; periods that go with 1/sqrt(g); and the least friction
of a block on ground that falls away.
"""

import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from rocking import on_shaking_ground
from running import answered, inside
from scipy.optimize import brentq

from blocksim import (
    Problem,
    Recording,
    Verdict,
    check,
    extruded,
    load_recording,
    simulate,
    structure_of,
)

G = 9.81
BOTH = pytest.mark.parametrize("method", ["direct", "pymunk"])
DIRECT = pytest.mark.parametrize(
    "method", ["direct", pytest.param("pymunk", marks=pytest.mark.long)]
)
"""Of what slides on ground that shakes `pymunk` is asked as briefly."""


def block(
    low: float = 0.0,
    wide: float = 1.0,
    tall: float = 1.0,
    mu: float = 0.5,
    count: int = 1,
    **given: Any,
) -> Problem:
    """A block above a floor, 1 m the unit of length, or a stack of such blocks."""
    floor = {"id": 0, "vertices": [[-99, -1], [99, -1], [99, 0], [-99, 0]], "fixed": True}
    blocks = [floor]
    for row in range(count):
        foot, top = low + row * tall, low + (row + 1) * tall
        corners = [[0, foot], [wide, foot], [wide, top], [0, top]]
        free = low > 0 and row == 0
        blocks.append({"id": 1 + row, "vertices": corners, "free": free, **given})
    return structure_of({"friction": mu, "size": 1, "blocks": blocks})


def way(recording: Recording) -> np.ndarray:
    """How the block went: across and up [m], turned [rad]."""
    return recording.poses[:, 0] - recording.poses[0, 0]


@BOTH
@settings(max_examples=4)
@given(
    across=st.floats(-20, 20),
    up=st.floats(-5, 20),
    spin=st.floats(-900, 900),
    gravity=st.sampled_from([1.62, 9.81, 25.0]),
)
def test_what_is_thrown_goes_along_a_parabola(
    method: str, across: float, up: float, spin: float, gravity: float
) -> None:
    problem = block(20.0, velocity=(across, up), spin_deg_s=spin).under(gravity)
    if not problem.is_moving:
        return
    recording = simulate(problem, method=method, duration=1.0)
    time = recording.times * problem.seconds
    wanted = [across * time, up * time - gravity * time**2 / 2, math.radians(spin) * time]
    assert np.allclose(way(recording), np.transpose(wanted), atol=1e-8)


@settings(max_examples=4)
@example(share=0.0, gravity=9.81, wide=1.0, tall=1.0, low=1.0, count=1)
@example(share=0.8, gravity=1.62, wide=1.0, tall=1.0, low=1.0, count=1)
@example(share=1.0, gravity=9.81, wide=1.0, tall=1.0, low=1.0, count=1)
@given(
    # A bounce that is shorter than a step is the last.
    share=st.floats(0.2, 1),
    gravity=st.sampled_from([1.62, 9.81, 25.0]),
    wide=st.floats(0.3, 2),
    tall=st.floats(0.2, 1),
    low=st.floats(0.2, 2),
    count=st.integers(1, 3),
)
def test_what_bounces_comes_back_to_the_square_of_the_restitution(
    share: float, gravity: float, wide: float, tall: float, low: float, count: int
) -> None:
    """A stack that falls as one bounces as one: with it each block keeps its share."""
    problem = block(low, wide, tall, count=count, velocity=(0, 1e-9)).under(gravity)
    fall = math.sqrt(2 * low / gravity)
    until = fall * (1 + 2 * share + 1.8 * share**2)
    recording = simulate(
        problem, method="direct", duration=until / problem.seconds,
        settings={"restitution": share},
    )  # fmt: skip
    time, poses = recording.times * problem.seconds, recording.poses
    wanted, since, rises = low - gravity * time**2 / 2, fall, gravity * fall
    for _ in range(2):
        rises *= share
        later = time - since
        wanted = np.where(later > 0, rises * later - gravity * later**2 / 2, wanted)
        since += 2 * rises / gravity
    near = wanted > 0
    for heights in (poses[:, :, 1] - poses[0, :, 1] + low).T:
        assert np.allclose(heights[near], wanted[near], atol=1e-8)
        assert heights.min() > -1e-9
    assert np.abs(poses[:, :, 2]).max() < 1e-9


@settings(max_examples=8)
@given(
    share=st.floats(0.1, 1),
    mu=st.sampled_from([0.0, 0.1, 0.5, 2.0]),
    wide=st.floats(0.5, 2),
    tall=st.floats(0.5, 2),
    across=st.floats(-2, 2),
    spin=st.floats(10, 90),
    sense=st.sampled_from([-1, 1]),
)
def test_a_corner_that_hits_parts_with_its_share_of_the_velocity(
    share: float, mu: float, wide: float, tall: float, across: float, spin: float, sense: int
) -> None:
    """Newton's restitution and Coulomb's friction of one impulse, in closed form."""
    rate, low = math.radians(sense * spin), 1.0
    half = np.array([[-wide, -tall], [wide, -tall]]) / 2 @ [1, 1j]

    def lowest(turn: float) -> complex:
        turned = np.concatenate([half, -half]) * np.exp(1j * turn)
        return complex(turned[turned.imag.argmin()])

    height = low + tall / 2
    hit = brentq(
        lambda now: height - G * now**2 / 2 + lowest(rate * now).imag,
        1e-3,
        math.sqrt(2 * height / G),
    )
    arm = lowest(rate * hit)
    lever, inertia = np.array([-arm.imag, arm.real]), (wide**2 + tall**2) / 12
    before = np.array([across, -G * hit]) + rate * lever
    gives, away = np.eye(2) + np.outer(lever, lever) / inertia, -share * before[1]
    sticks = np.linalg.solve(gives, [-before[0], away - before[1]])
    impulses = [sticks] if abs(sticks[0]) <= mu * sticks[1] else []
    for slip in (1.0, -1.0):
        along = np.array([-slip * mu, 1.0])
        slides = (away - before[1]) / (gives @ along)[1] * along
        if slides[1] > 0 and slip * (before + gives @ slides)[0] > 0:
            impulses.append(slides)
    spun = rate + np.array([lever @ each for each in impulses]) / inertia
    (shift, up), after = impulses[0] + [across, -G * hit], spun[0]
    # Until another corner hits.
    later = np.linspace(1e-3, 1.0, 1000)
    clear = [
        -arm.imag + up * each - G * each**2 / 2 + lowest(rate * hit + after * each).imag > 0
        for each in later.tolist()
    ]
    assume(len(impulses) == 1 and clear[20])
    until = hit + 0.9 * later[clear.index(False) if False in clear else -1]
    problem = block(low, wide, tall, mu, velocity=(across, 0), spin_deg_s=sense * spin)
    assume(problem.is_moving)
    recording = simulate(
        problem, method="direct", duration=until / problem.seconds,
        settings={"restitution": share},
    )  # fmt: skip
    time = recording.times * problem.seconds
    early, late = np.minimum(time, hit), np.maximum(time - hit, 0.0)
    wanted = [
        across * early + shift * late,
        -G * early**2 / 2 + up * late - G * late**2 / 2,
        rate * early + after * late,
    ]
    assert (late > 0).any()
    assert np.allclose(
        way(recording)[time < until], np.transpose(wanted)[time < until], atol=1e-8
    )


@BOTH
@settings(max_examples=6)
@example(speed=6.0, angle=45.0, clear=0.01, start=0.04, side=0.02)
@given(
    speed=st.floats(0.5, 30),
    angle=st.floats(10, 80),
    clear=st.floats(1e-3, 0.1),
    start=st.floats(0.01, 0.3),
    side=st.floats(1e-3, 0.1),
)
def test_what_passes_beside_a_corner_flies_on(
    method: str, speed: float, angle: float, clear: float, start: float, side: float
) -> None:
    """Of two blocks that fall one passes the other's upper right corner, up and to the left."""
    way = np.exp(1j * math.radians(180 - angle))
    centre = -start * way + (clear + side / math.sqrt(2)) * way / 1j
    assume(centre.real > side / 2)
    low, left = 20.5 + centre.imag - side / 2, 0.5 + centre.real - side / 2
    corners, low_left = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), np.array([left, low])
    blocks = [
        {"id": 0, "vertices": [[-99, -1], [99, -1], [99, 0], [-99, 0]], "fixed": True},
        {"id": 1, "vertices": (corners + np.array([-0.5, 19.5])).tolist(), "free": True},
        {
            "id": 2,
            "vertices": (side * corners + low_left).tolist(),
            "free": True,
            "velocity": [speed * way.real, speed * way.imag],
        },
    ]
    problem = structure_of({"friction": 0.5, "size": 1, "blocks": blocks})
    recording = simulate(problem, method=method, duration=3 * start / speed / problem.seconds)
    time = recording.times * problem.seconds
    went = recording.poses[:, 1] - recording.poses[0, 1]
    wanted = [speed * way.real * time, speed * way.imag * time - G * time**2 / 2, 0 * time]
    assert np.allclose(went, np.transpose(wanted), atol=1e-9)


@DIRECT
def test_what_is_pushed_off_stops_as_friction_says(method: str) -> None:
    gravity = 3.71
    problem = block(wide=4, mu=0.3, velocity=(2.0, 0.0)).under(gravity)
    seen = check(problem, method=method).shaken
    assert seen.verdict is Verdict.STANDS
    assert way(seen.recording)[-1, 0] == pytest.approx(4 / (2 * 0.3 * gravity), rel=4e-3)
    assert check(problem, method=method).evidence[0].test == "motion"


@pytest.mark.parametrize(
    ("method", "up"),
    [
        *(("direct", up) for up in (-0.4, 0.0, 0.5)),
        ("pymunk", -0.4),
        *(pytest.param("pymunk", up, marks=pytest.mark.long) for up in (0.0, 0.5)),
    ],
)
def test_a_block_slides_as_ground_that_rises_or_falls_lets_it(method: str, up: float) -> None:
    # Ground goes by 0.5 g across and by `up` for a while, then at constant speed.
    mu, across, end = 0.3, 0.5, 0.6
    times = [0, end, end + 1e-9]
    ground = {"accelerations_g": [across, across, 0], "verticals_g": [up, up, 0]}
    problem = on_shaking_ground(block(wide=6, mu=mu), times_s=times, **ground)
    seen = check(problem, method=method).shaken
    gains = (across - mu * (1 + up)) * G
    wanted = gains * end**2 / 2 + (gains * end) ** 2 / (2 * mu * G)
    assert way(seen.recording)[-1, 0] == pytest.approx(-wanted, rel=5e-3)


@BOTH
@pytest.mark.parametrize("up", [-0.5, 0.5])
def test_least_friction_on_ground_that_rises_or_falls(method: str, up: float) -> None:
    # It holds what slides with mu = across / (1 + up).
    for share, rests in ((0.98, False), (1.02, True)):
        mu = share * 0.2 / (1 + up)
        ground = {"accelerations_g": [0.2, 0.2], "verticals_g": [up, up]}
        problem = on_shaking_ground(block(wide=6, mu=mu), times_s=[0, 1], **ground)
        seen = check(problem, method=method).shaken
        moved = abs(way(seen.recording)[:, 0]).max()
        assert moved < 1e-5 if rests else moved > 1e-3


def test_rocking_takes_as_long_as_gravity_says() -> None:
    # Tilted by a quarter turn rate, it rises and falls back: times go with 1/sqrt(g) where
    # velocities go with sqrt(g).
    impacts = list[float]()
    for gravity in (9.81, 1.62, 30.0):
        spin = 20 * math.sqrt(gravity / G)
        turn = math.radians(spin)
        # About its right-hand corner, clockwise.
        velocity = (turn, turn * 0.5)
        problem = block(wide=1, tall=2, mu=5, velocity=velocity, spin_deg_s=-spin)
        rocks = check(problem.under(gravity), method="direct").shaken
        first = rocks.first_impact_s
        impacts.append(first * math.sqrt(gravity))
    assert np.ptp(impacts) < 1e-3 * impacts[0]


@given(
    st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=2, max_size=9),
    st.floats(0.01, 3),
)
def test_a_record_with_a_vertical_part_is_read_and_written(
    values: list[tuple[float, float]], step: float
) -> None:
    times = (step * np.arange(len(values))).tolist()
    across, up = map(list, zip(*values, strict=True))
    ground = {"times_s": times, "accelerations_g": across, "verticals_g": up}
    problem = on_shaking_ground(block(), **ground)
    table, again = problem.shaking, structure_of(problem.to_dict()).shaking
    for start, end in ((0.0, times[-1]), (step / 3, 1.5 * step)):
        fine = np.linspace(start, min(end, times[-1]), 4001)
        wanted = [np.trapezoid(np.interp(fine, times, each), fine) for each in (across, up)]
        assert table.gained(start, end) == pytest.approx(wanted, abs=1e-2 * step)
        assert again.gained(start, end) == pytest.approx(table.gained(start, end), abs=1e-9)


def test_a_record_of_three_columns(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text("time_s,acceleration_g,vertical_g\n0,0.2,0.1\n2,0.2,0.1\n")
    asked = ("check", "column", "--mu", "0.7", "--shake", str(path), "--method", "direct")
    told = answered(*asked)["problem"]["shake"]
    assert told == {
        "times_s": [0, 2], "accelerations_g": [0.2, 0.2], "verticals_g": [0.1, 0.1]
    }  # fmt: skip
    twice = answered(*asked, "--amplitude", "0.4", code=1)["problem"]["shake"]
    assert twice["accelerations_g"] == pytest.approx([0.4, 0.4])
    assert twice["verticals_g"] == pytest.approx([0.2, 0.2])
    assert "0.1 g upwards" in inside(*asked).stdout


def test_what_begins_in_motion_is_written_and_read(tmp_path: Path) -> None:
    problem = block(2.0, velocity=(1.0, -2.0), spin_deg_s=30.0).under(3.71)
    again = structure_of(json.loads(json.dumps(problem.to_dict())))
    assert np.allclose(again.velocities, problem.velocities, atol=1e-14)
    assert np.allclose(again.gravity, problem.gravity)
    out = tmp_path / "thrown.npz"
    recording = simulate(problem, method="direct", duration=0.5)
    recording.save(out)
    assert np.array_equal(load_recording(out).problem.velocities, problem.velocities)


def test_gravity_is_an_option_and_is_told(tmp_path: Path) -> None:
    path, out, poses = (tmp_path / name for name in ("thrown.json", "run.npz", "run.json"))
    path.write_text(json.dumps(block(5.0, velocity=(1.0, 0.0)).to_dict()))
    inside("simulate", path, "--gravity", "1.62", "--seconds", "0.5", "--out", out)
    inside("render", out, "--out", poses)
    assert json.loads(poses.read_text())["gravity_m_s2"] == pytest.approx([0, -1.62, 0])
    said = inside("check", path, "--gravity", "1.62", "--json")
    problem = json.loads(said.stdout)["problem"]
    assert problem["gravity_m_s2"] == pytest.approx([0, -1.62, 0])
    assert "gravity 1.62 m/s2" in inside("check", path, "--gravity", "1.62").stdout


@pytest.mark.parametrize(
    ("method", "in_space"),
    [
        ("pymunk", False),
        *itertools.product(("direct", "pybullet", "mujoco"), (False, True)),
    ],
)
def test_what_falls_beside_blocks_that_rest_falls(method: str, in_space: bool) -> None:
    """No joint moves: the round-off of those at rest was taken for blocks that overlap."""
    if method != "direct":
        pytest.importorskip(method, exc_type=ImportError)
    stands = {"id": 1, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}
    above = {
        "id": 2,
        "vertices": [[0.2, 1.47], [1.2, 1.47], [1.2, 2.47], [0.2, 2.47]],
        "free": True,
    }
    floor = {"id": 0, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
    problem: Problem[Any] = structure_of(
        {"friction": 0.5, "size": 1, "blocks": [floor, stands, above]}
    )
    problem = extruded(problem) if in_space else problem
    assert check(problem, method=method).verdict is Verdict.COLLAPSES
    ends = simulate(problem, method=method, duration=1.5).poses[-1]
    heights = ends[:, 2 if in_space else 1] * problem.assembly.size
    assert heights == pytest.approx([0.5, 1.5], abs=2e-3)


@pytest.mark.long
def test_a_heap_whose_impact_cannot_be_solved_ends_there() -> None:
    heap = structure_of({"kind": "rubble", "stones": 60, "friction": 0.6})
    recording = simulate(heap.tilted(math.radians(35)), method="direct", duration=15.0)
    assert len(recording.times) > 50
