"""Blocks that begin in motion, bounce, and fall otherwise than on Earth, and ground that also
goes up and down, held against closed forms.

Ballistics; heights after impacts with restitution (e^2 each); Coulomb's law for what slides;
periods that go with 1/sqrt(g); and the least friction of a block on ground that falls away.
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rocking import on_shaking_ground
from running import answered, inside

from blocksim import Problem, Recording, Verdict, check, load_recording, simulate, structure_of

G = 9.81
BOTH = pytest.mark.parametrize("method", ["direct", "pymunk"])


def block(
    low: float = 0.0, wide: float = 1.0, tall: float = 1.0, mu: float = 0.5, **given: Any
) -> Problem:
    """A block above a floor, 1 m the unit of length."""
    corners = [[0, low], [wide, low], [wide, low + tall], [0, low + tall]]
    floor = {"id": 0, "vertices": [[-99, -1], [99, -1], [99, 0], [-99, 0]], "fixed": True}
    own = {"id": 1, "vertices": corners, "free": low > 0, **given}
    return structure_of({"friction": mu, "size": 1, "blocks": [floor, own]})


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


@pytest.mark.parametrize(("share", "gravity"), [(0.0, 9.81), (0.8, 1.62), (1.0, 9.81)])
def test_what_bounces_comes_back_to_the_square_of_the_restitution(
    share: float, gravity: float
) -> None:
    problem = block(1.0, velocity=(0, 1e-9)).under(gravity)
    fall = math.sqrt(2 / gravity)
    recording = simulate(
        problem, method="direct", duration=5.5 * fall / problem.seconds,
        settings={"restitution": share},
    )  # fmt: skip
    time, height = recording.times * problem.seconds, 1 + way(recording)[:, 1]
    assert height.min() > -1e-5
    tops = [
        (fall * (1 + 2 * sum(share**k for k in range(1, n)) + share**n), share ** (2 * n))
        for n in (1, 2)
    ]
    for when, high in tops:
        # Beside the top the height is that of the parabola.
        wanted = high - gravity * (time - when) ** 2 / 2
        near = wanted > high / 2
        assert share == 0 or near.any()
        assert np.allclose(height[near], wanted[near], atol=2e-4)


@BOTH
def test_what_is_pushed_off_stops_as_friction_says(method: str) -> None:
    gravity = 3.71
    problem = block(wide=4, mu=0.3, velocity=(2.0, 0.0)).under(gravity)
    seen = check(problem, method=method).shaken
    assert seen.verdict is Verdict.STANDS
    assert way(seen.recording)[-1, 0] == pytest.approx(4 / (2 * 0.3 * gravity), rel=4e-3)
    assert check(problem, method=method).evidence[0].test == "motion"


@BOTH
@pytest.mark.parametrize("up", [-0.4, 0.0, 0.5])
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
    inside("simulate", str(path), "--gravity", "1.62", "--seconds", "0.5", "--out", str(out))
    inside("render", str(out), "--out", str(poses))
    assert json.loads(poses.read_text())["gravity_m_s2"] == pytest.approx([0, -1.62, 0])
    said = inside("check", str(path), "--gravity", "1.62", "--json")
    problem = json.loads(said.stdout)["problem"]
    assert problem["gravity_m_s2"] == pytest.approx([0, -1.62, 0])
    assert "gravity 1.62 m/s2" in inside("check", str(path), "--gravity", "1.62").stdout


@pytest.mark.long
def test_a_heap_whose_impact_cannot_be_solved_ends_there() -> None:
    heap = structure_of({"kind": "rubble", "stones": 60, "friction": 0.6})
    recording = simulate(heap.tilted(math.radians(35)), method="direct", duration=15.0)
    assert len(recording.times) > 50
