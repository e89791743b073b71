"""How right a motion by `direct` is, at its usual step and finer.

Truth: blocks that rock from impact to impact (`rocking`), integrated to 1e-10.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from four_links import Arch
from recorded import drawn_words
from rocking import G, block, on_pulse, on_record, rocks
from scipy.integrate import solve_ivp
from worlds import DIRECT, Blocks, Simulation

from analysis import housner, known_motions, oppenheim, random_pulses
from analysis.rows import FIGURES, read_kept
from analysis.shaking import ARCH
from blocksim import (
    Assembly,
    Block,
    CircularArch,
    Joint,
    Problem,
    Verdict,
    check,
    extruded,
    simulate,
    structure_of,
)
from blocksim.report.recordings import recording_lines
from blocksim.view.film import Film

LONG = pytest.mark.long


def pushed(problem: Problem, width: float, height: float, spin: float, step: float) -> Blocks:
    """A block that begins to turn about its lower left corner, with a velocity [rad/s]."""
    world = Blocks(problem, replace(DIRECT.rule(problem.assembly), step=step))
    world.hold(1)
    turn = spin * problem.seconds
    half = np.array([width, height]) / 2 / problem.assembly.size
    world.push(np.array([[-turn * half[1], turn * half[0], turn]]))
    return world


@pytest.mark.parametrize(
    ("duration", "amplitude"),
    [
        (0.8, 0.475),
        pytest.param(1.0, 0.3766, marks=pytest.mark.long),
        pytest.param(0.8, 1.3, marks=pytest.mark.long),
    ],
)
def test_a_sine_that_overturns_is_said_to(duration: float, amplitude: float) -> None:
    def ground(time: float) -> float:
        inside = 0 <= time <= duration
        return amplitude * math.sin(2 * math.pi * time / duration) if inside else 0.0

    assert rocks(1.0, 4.0, ground, shaken=duration).overturns
    seen = check(on_pulse(block(), "full-sine", amplitude, duration), method="direct")
    assert seen.verdict is not Verdict.STANDS


def record(peak: float) -> tuple[np.ndarray, np.ndarray]:
    """Ten seconds in 4,000 samples."""
    random, times = np.random.default_rng(1), np.linspace(0.0, 10.0, 4000)
    found = np.zeros_like(times)
    for often in np.linspace(0.5, 8.0, 40):
        size, phase = random.normal(), random.uniform(0, 6.28)
        found += size * np.sin(2 * math.pi * often * times + phase)
    found *= np.sin(math.pi * times / 10.0) ** 0.5
    return times, found * peak / np.abs(found).max()


@LONG
def test_a_record_rocks_a_block_as_far_as_housner_says() -> None:
    times, ground = record(0.35)
    wanted = rocks(
        1.0,
        4.0,
        lambda now: float(np.interp(now, times, ground, 0.0, 0.0)),
        shaken=10.0,
        until=12.0,
        longest=0.005,
    )
    seen = check(on_record(block(), times, ground), method="direct").shaken
    assert len(wanted.impacts) > 50
    assert seen.rocking.rotation == pytest.approx(wanted.largest, rel=0.03)


@pytest.mark.parametrize(
    "motion",
    [
        known_motions.stopped(),
        pytest.param(known_motions.rocking(3), marks=pytest.mark.long),
        known_motions.hinged(),
        known_motions.toppling(),
        pytest.param(known_motions.framed(1), marks=pytest.mark.long),
    ],
    ids=lambda motion: motion.name,
)
def test_errors_fall_as_the_step_squared(motion: known_motions.Motion) -> None:
    """Closed forms, and equations of motion integrated from event to event."""
    coarse, fine = (abs(motion.seen(step) / motion.truth - 1) for step in (0.05, 0.0125))
    assert coarse < 5e-4
    assert fine < coarse / 5


@pytest.mark.parametrize(
    ("motion", "engine", "in_space", "error"),
    [
        (known_motions.falling(), "direct", True, 1e-9),
        (known_motions.falling(), "pymunk", False, 1e-9),
        (known_motions.falling(), "pybullet", False, 1e-9),
        (known_motions.falling(), "pybullet", True, 1e-9),
        (known_motions.falling(), "mujoco", False, 1e-9),
        (known_motions.falling(), "mujoco", True, 1e-9),
        (known_motions.thrown(), "pymunk", False, 1e-9),
        (known_motions.stopped(), "pymunk", False, 1e-6),
        (known_motions.sliding(), "pymunk", False, 1e-9),
        (known_motions.sliding(), "mujoco", False, 2e-5),
        (known_motions.sliding(), "mujoco", True, 2e-5),
        pytest.param(known_motions.rocking(1), "direct", True, 2e-3, marks=LONG),
    ],
)
def test_every_engine_begins_on_time_and_hits_when_it_does(
    motion: known_motions.Motion, engine: str, in_space: bool, error: float
) -> None:
    """Half a step too early or too late, fall and slide are off by a hundredth."""
    _, step = known_motions.world(motion.problem, engine, in_space=in_space)
    assert motion.seen(step, engine, in_space=in_space) == pytest.approx(motion.truth, error)


def test_a_block_topples_past_half_a_right_angle() -> None:
    """There another of its edges looks at the floor; eight steps meet that at any moment."""
    width, height, spin = 1.0, 2.0, 1.9
    alpha, squared = math.atan2(width, height), 3 * G / (2 * math.hypot(width, height))
    for step in np.linspace(0.045, 0.055, 8).tolist():
        world = pushed(block(width, height), width, height, spin, step)
        count = int(2.0 / step)
        world.advance(count)
        turned = solve_ivp(
            lambda _, state: [state[1], -squared * math.sin(alpha - state[0])],
            (0.0, count * step * block(width, height).seconds),
            [0.0, spin],
            rtol=1e-10,
            atol=1e-10,
        ).y[0, -1]
        assert turned > math.pi / 4
        assert float(world.poses()[0, 2]) == pytest.approx(turned, rel=1e-4)


def sine(amplitude: float) -> Problem:
    """A block under one period of a second; from 0.37286 g on it overturns."""
    return on_pulse(block(), "full-sine", amplitude, 1.0)


@pytest.mark.parametrize(
    ("amplitude", "verdict"),
    [
        (0.3735, Verdict.UNDECIDED),
        pytest.param(0.376, Verdict.COLLAPSES, marks=pytest.mark.long),
    ],
)
def test_what_hangs_on_the_step_is_undecided(amplitude: float, verdict: Verdict) -> None:
    """At a step of 0.1 it overturns from 0.37386 g on, at twice the step from 0.37683 g."""
    seen = check(sine(amplitude), method="direct", settings={"step": 0.1})
    assert seen.verdict is verdict
    if verdict is Verdict.UNDECIDED:
        assert "collapses at a step of 0.05" in seen.reason
        assert "stands at 0.1" in seen.reason


@pytest.mark.parametrize(
    ("height", "shape", "duration", "amplitude", "method"),
    [
        (3.0, "half-sine", 0.366, 0.744, "direct"),
        pytest.param(2.0, "half-sine", 0.343, 1.123, "direct", marks=LONG),
        pytest.param(2.0, "full-sine", 0.225, 0.722, "pymunk", marks=LONG),
        pytest.param(4.0, "full-sine", 0.240, 0.414, "pymunk", marks=LONG),
    ],
)
def test_short_pulses_lift_blocks_when_they_do(
    height: float, shape: str, duration: float, amplitude: float, method: str
) -> None:
    """Begun in the wrong part of a step, a rotation is off by more than is told."""
    rate = (2 if shape == "full-sine" else 1) * math.pi / duration

    def ground(time: float) -> float:
        return amplitude * math.sin(rate * time) if 0 <= time <= duration else 0.0

    wanted = rocks(1.0, height, ground, shaken=duration)
    problem = on_pulse(block(1.0, height), shape, amplitude, duration)
    answer = check(problem, method=method)
    seen = answer.shaken
    off = abs(seen.rocking.rotation - wanted.largest)
    assert off <= seen.rocking.off
    assert off < (1e-4 if method == "direct" else 1e-2) * wanted.largest
    assert seen.first_impact_s == pytest.approx(wanted.impacts[0], abs=1e-3 * problem.seconds)


@LONG
def test_a_shaken_block_says_how_right_it_is() -> None:
    """Estimates are no less than the errors, by the integrator, and of their size."""
    amplitude = 0.3

    def ground(time: float) -> float:
        return amplitude * math.sin(2 * math.pi * time) if 0 <= time <= 1 else 0.0

    wanted = rocks(1.0, 4.0, ground, shaken=1.0)
    problem = sine(amplitude)
    answer = check(problem, method="direct")
    seen, told = answer.shaken, answer.to_dict()["shaken"]
    turned, late_most = told["largest_rotation_error_deg"], told["first_impact_error_s"]
    assert turned is not None
    off = abs(seen.rocking.rotation - wanted.largest)
    late = abs(seen.first_impact_s - wanted.impacts[0])
    assert off <= math.radians(turned) < 0.01 * wanted.largest
    assert late <= late_most < 1e-3


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-4])
def test_the_first_impact_is_as_right_as_asked(accuracy: float) -> None:
    """Of a block let go at 0.15 rad, by the time from the top to the ground."""
    problem, radius = block(), math.hypot(1.0, 4.0) / 2
    alpha, squared = math.atan2(1.0, 4.0), 3 * G / (4 * radius)
    spin = math.sqrt(2 * squared * (math.cos(alpha - 0.15) - math.cos(alpha)))
    simulation = Simulation.of(problem, "direct", settings={"accuracy": accuracy})
    step = simulation.settings.step
    world = Blocks(problem, simulation.settings)
    world.hold(1)
    turn, half = spin * problem.seconds, np.array([1.0, 4.0]) / 2 / problem.assembly.size
    world.push(np.array([[-turn * half[1], turn * half[0], turn]]))
    turns = [0.0]
    while len(turns) < 4 or turns[-1] > 1e-6:
        world.advance(1)
        turns.append(float(world.poses()[0, 2]))
    # The parabola through the last ends of steps before the impact.
    times = step * np.arange(len(turns))
    a, b, c = np.polyfit(times[-4:-1] - times[-2], turns[-4:-1], 2)
    lands = times[-2] + (-b - math.sqrt(b * b - 4 * a * c)) / (2 * a)
    # It comes down as it went up.
    wanted = 2 * rocks(1.0, 4.0, angle=0.15, most=1).impacts[0]
    assert lands * problem.seconds == pytest.approx(wanted, rel=accuracy)


def test_a_recording_says_how_long_it_is_known() -> None:
    """A collapse to the ground: the error at half the step is within what was said."""
    arch = CircularArch(half_angle_deg=65, eta=0.02, friction=0.35, voussoirs=7)
    recording = simulate(arch, method="direct", duration=2.0)
    finer = simulate(arch, method="direct", duration=2.0, settings={"accuracy": 1e-5})
    kept = recording.quality
    until = recording.times[-1] if kept.known is None else kept.known
    at = np.isclose(finer.times[:, None], recording.times[recording.times <= until]).any(axis=1)
    there = recording.times <= until
    off = recording.assembly.displacement(finer.poses[at] - recording.poses[there])
    assert off.max() <= kept.error <= 0.01
    assert 0 < recording.overlap_share < 0.01
    assert any("another step" in line for line in recording_lines(recording, "r"))
    assert not any("not found" in line for line in recording_lines(recording, "r"))
    for left, words in ((1e-2, "not found, but to 0.01 g"), (math.inf, "not found: what")):
        stopped = replace(recording, quality=replace(kept, residual=left))
        assert words in "".join(recording_lines(stopped, "r"))
        assert any("contact forces not found" in word for word in drawn_words(Film([stopped])))


def test_what_is_thrown_is_known_as_long_as_it_flies() -> None:
    """A parabola: frames of runs at other steps are at the same times."""
    kept = simulate(known_motions.thrown().problem, method="pymunk", duration=1.0).quality
    assert kept.known is None
    assert kept.error < 1e-9


@pytest.mark.parametrize("engine", ["direct", "pymunk"])
@pytest.mark.parametrize(
    ("gap", "speed"), [(0.2, 2.7), (0.23, 0.61), (0.289, 2.43), (0.2, 90.0)]
)
def test_a_thrown_block_hits_another_when_it_is_there(
    engine: str, gap: float, speed: float
) -> None:
    """Two equal ones high above the ground: both go on at half the speed."""
    boxes = known_motions.box(0, 9, 1, 1), known_motions.box(1 + gap, 9, 1, 1)
    problem = known_motions.blocks(0.5, *boxes, free=True)
    problem = known_motions.moving(problem, [0.0, 0, 0], [-speed, 0, 0])
    recording = simulate(problem, method=engine, duration=gap / speed + 0.2)
    since = recording.times[-1] - gap / (speed * problem.assembly.size)
    kept, went = recording.quality, recording.poses[-1, 0, 0] - recording.poses[0, 0, 0]
    assert kept.known is None
    assert abs(went + speed / 2 * since) <= kept.error


def test_an_impact_is_within_the_error_that_is_told() -> None:
    """Where in a step it falls is chance for Bullet, and two runs may agree by chance."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    motion = known_motions.rocking(1)
    recording = simulate(motion.problem, method="pybullet", duration=motion.until)
    # The top after the impact is flat: it does not matter that the last frame is beside it.
    turn = motion.since + float(recording.poses[-1, 0, 2] - recording.poses[0, 0, 2])
    assert abs(abs(turn) - motion.truth) <= recording.quality.error < 0.01


@pytest.mark.parametrize("method", ["direct", "pymunk", "pybullet", "mujoco"])
@pytest.mark.parametrize("in_space", [False, True])
def test_the_error_that_a_recording_tells_is_not_less_than_it_has(
    method: str, in_space: bool
) -> None:
    """A block slides down as Coulomb says."""
    if in_space and method == "pymunk":
        return
    shapes = ([[-60, -1], [60, -1], [60, 0], [-60, 0]], [[0, 0], [1, 0], [1, 0.4], [0, 0.4]])
    blocks = [{"id": at, "vertices": each, "fixed": not at} for at, each in enumerate(shapes)]
    problem = structure_of({"friction": 0.4, "blocks": blocks})
    problem = extruded(problem) if in_space else problem
    angle = math.radians(30)
    recording = simulate(problem.tilted(angle), method=method, duration=1.0)
    kept, times = recording.quality, recording.times
    until = times[-1] if kept.known is None else kept.known
    rate = math.sin(angle) - 0.4 * math.cos(angle)
    way = np.hypot(*(recording.poses[:, 0, :2] - recording.poses[0, 0, :2]).T)
    off = np.abs(way - rate * times**2 / 2)[times <= until]
    assert off.max() <= kept.error + 1e-9
    assert kept.error < 0.01
    # Between two frames it is on its way.
    late = abs(np.interp(math.sqrt(0.02 / rate), times, way) - 0.01) / math.sqrt(0.02 * rate)
    assert late <= kept.late + np.diff(times).max() ** 2 / 8 * rate / math.sqrt(0.02 * rate)
    assert kept.gain < 1e-3
    share = recording.overlap_share
    assert share is None or share < 1e-3
    blind = replace(recording, quality=replace(kept, penetration=None))
    assert f"{method} does not tell how deep" in "".join(recording_lines(blind, "L"))


def test_the_integrator_changes_its_mind_about_a_sine_once() -> None:
    """At 0.372861 g, as another integrator in steps of 4 ms that end at impacts said, too."""
    said = [housner.overturned(4.0, "full-sine", 1.0, each) for each in (0.37285, 0.37287)]
    assert said == [False, True]


@LONG
@pytest.mark.parametrize("engine", ["direct", "pymunk"])
def test_engines_say_of_sines_what_the_equation_says(tmp_path: Path, engine: str) -> None:
    told = housner.main(tmp_path, quick=True, engine=engine)
    assert [row["differ"] for row in told] == [0] * 4
    assert [row["open"] for row in told] == [0] * 4
    assert all(row["overturn"] not in (0, row["pulses"]) for row in told)


@LONG
def test_verdicts_on_random_pulses_are_those_at_a_finer_accuracy(tmp_path: Path) -> None:
    rows = random_pulses.main(tmp_path, quick=True)
    assert len(rows) == 3
    assert all(row["verdict"] == row["fine"] for row in rows)
    # The largest rotations say by how much the usual steps are off.
    for row in rows:
        turned, wanted = (float(str(row[key])) for key in ("rotation", "fine_rotation"))
        assert turned == pytest.approx(wanted, rel=0.02, abs=1e-4)


STEPS = (0.02, 0.01, 0.005, 0.0025)


def world_of(assembly, mu, step):
    settings = replace(DIRECT.rule(assembly), step=step)
    return Blocks(Problem(assembly=assembly, mu=mu), settings)


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
        system = [[ty, 1.0, -mu], [-fx, 0.0, -1.0], [inertia, -ty, -(fx - mu * fy)]]
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


def test_the_equation_starts_as_published_and_keeps_energy() -> None:
    arch = Arch()
    # 0.37 g, hinges at joints 0, 3, 5 and 7 where the arch is pushed to the right.
    assert arch.starts == pytest.approx(0.37, abs=0.005)
    assert [joint for joint, _ in arch.hinges] == [7 - each for each in (7, 5, 3, 0)]
    end = 0.8
    found = arch.rocks(lambda time: 0.4 * arch.gravity * (time < end), 1.2, 0.005)
    later = np.flatnonzero(found.times > end + 0.01)
    assert not found.impacts
    moving, weights, _ = (curve(found.angles[later]) for curve in arch._curves)
    spin = np.gradient(found.angles[later], found.times[later])
    steps = np.diff(found.angles[later]) * (weights[1:] + weights[:-1]) / 2
    kinetic = moving * spin**2 / 2
    lifted = np.append(0.0, np.cumsum(steps))
    assert np.ptp((kinetic + lifted)[5:-5]) < 2e-3 * kinetic.max()


@pytest.mark.parametrize("mu", [0.8, 3.0])
def test_an_impact_of_the_arch_loses_as_little_as_contacts_allow(mu: float) -> None:
    arch = Arch()
    least, turned = arch.least_loss
    assert turned > 0.3
    assert least == pytest.approx(0.5592, abs=1e-4)
    assert arch.kept**2 < least - 0.1
    problem = structure_of({**ARCH, "friction": mu})
    speed, spin = arch.velocities()
    each = problem.seconds / problem.assembly.size
    start = -0.05 * np.stack(
        [speed.real * each, speed.imag * each, spin * problem.seconds], axis=1
    )
    made = Blocks(problem, replace(DIRECT.rule(problem.assembly), step=1e-5))
    made.push(start)
    made.advance(1)
    masses = problem.assembly.masses
    left = (masses * made.velocities**2).sum() / (masses * start**2).sum()
    assert left == pytest.approx(least, rel=1e-3)


def test_a_push_turns_the_arch_as_the_equation_says() -> None:
    name = "0.4 g for 1.3 s"
    ground = oppenheim.motions()[name]
    problem = replace(structure_of({**ARCH, "friction": oppenheim.MU}), shaking=ground)
    until = ground.duration / problem.seconds
    seen = simulate(problem, method="direct", duration=until)
    arch = Arch()
    truth = arch.rocks(lambda _: 0.4 * arch.gravity, 1.4, 0.01)
    wanted = np.interp(seen.times * problem.seconds, truth.times, truth.angles)
    turned = seen.poses[:, 0, 2] - seen.poses[0, 0, 2]
    assert np.abs(turned - wanted).max() < 2e-4 * wanted.max()


@pytest.mark.long
@pytest.mark.parametrize("name", list(oppenheim.motions()))
def test_motions_of_the_arch_are_those_of_the_rows(name: str) -> None:
    row, _ = oppenheim.followed(name, oppenheim.motions()[name])
    kept = next(each for each in read_kept(FIGURES / "oppenheim.csv") if each["motion"] == name)
    for key, value in row.items():
        wanted = pytest.approx(kept[key], rel=1e-3) if isinstance(value, float) else kept[key]
        assert value == wanted
    assert row["equation_falls"] == (row["direct_verdict"] == "collapses")
    pulse = name.startswith("0.4 g")
    for engine, off in (("direct", 2e-4), ("pymunk", 2e-3)):
        assert row[f"{engine}_off_while_pushed"] < (off if pulse else 0.1)
