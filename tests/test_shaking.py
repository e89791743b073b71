# pyright: basic
"""Ground that shakes, held against what is known of blocks that rock.

Truth: Housner's equation of a rocking block, integrated here by scipy; the corpus (Makris and
Vassiliou's frame, pulses, rocking, sliding); Coulomb's law for a block that only slides.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running import inside
from scipy.integrate import quad, solve_ivp
from structure_cases import case, scenes, tipped

from blocksim.ask.bracket import bracket
from blocksim.ask.check import check
from blocksim.ask.families import family_of
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import SHAPES, Shaking, read_table, table_of
from blocksim.blocks.structure import structure_record
from blocksim.common.errors import InputError
from blocksim.kinds.files import structure_of
from blocksim.kinds.known import load_known
from blocksim.simulation.recording import read_recording
from blocksim.simulation.shaken import Shaken, rocking_of, shake
from blocksim.simulation.verdict import Verdict
from blocksim.sweeps import load_design, read_rows, sweep

G = 9.81


def shaken(name: str, share: float) -> Problem:
    """A case of the corpus shaken for a share of the duration that overturns it."""
    amplitude = {"pulse_1x4_03": 0.3, "pulse_1x4_05": 0.5, "pulse_1x4_10": 1.0}.get(name, 0.4)
    duration = share * case(name)["expected"]["least_duration_s"]
    shaking = Shaking(shape="constant", amplitude=amplitude, duration=duration)
    return replace(structure_of(scenes(name)[0]), shaking=shaking)


def block(width: float = 1.0, height: float = 4.0, mu: float = 2.0) -> Problem:
    """A block on a floor."""
    floor = {"id": 0, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
    corners = [[0, 0], [width, 0], [width, height], [0, height]]
    return structure_of({"friction": mu, "blocks": [floor, {"id": 1, "vertices": corners}]})


def as_housner_says(shaking: Shaking, width: float, height: float) -> float:
    """Largest rotation of a block that never falls back on its base, or nan if it overturns.

    About one corner and, after each impact, about the other, keeping 1 - 1.5 sin^2 alpha of
    its angular velocity; of the block of `block`.
    """
    alpha, radius = math.atan2(width, height), math.hypot(width, height) / 2
    squared = 3 * G / (4 * radius)
    kept = 1 - 1.5 * math.sin(alpha) ** 2
    step = shaking.duration / 2000

    def pushed(time: float) -> float:
        return shaking.gained(time, time + step) / step

    time, angle, speed, largest = 0.0, 0.0, 0.0, 0.0
    # To the left (above 0) where the ground goes to the right.
    while time < shaking.duration + 10:
        sense = math.copysign(1.0, angle if abs(angle) > 1e-9 else speed or 1.0)

        def motion(now: float, state: np.ndarray, sense: float = sense) -> list[float]:
            tilt = sense * alpha - state[0]
            return [
                state[1],
                squared * (-math.sin(tilt) + pushed(now) * math.cos(tilt)),
            ]

        if angle == 0 == speed and motion(time, np.zeros(2))[1] <= 0:
            time += step
            if time > shaking.duration:
                return largest
            continue

        def lands(
            now: float, state: np.ndarray, begun: float = time, sense: float = sense
        ) -> float:
            return float(state[0]) if now > begun + 1e-6 else sense * 1e-9

        def falls(_: float, state: np.ndarray) -> float:
            return 1.2 - abs(float(state[0]))

        lands.terminal = falls.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            motion,
            (time, shaking.duration + 20),
            [angle, speed],
            events=[lands, falls],
            rtol=1e-9,
            atol=1e-12,
            max_step=shaking.duration / 20,
        )
        largest = max(largest, float(np.abs(found.y[0]).max()))
        assert found.t_events is not None
        if len(found.t_events[1]):
            return math.nan
        time = float(found.t[-1])
        angle, speed = 0.0, kept * float(found.y[1, -1])
        if abs(speed) < 1e-2:
            return largest
    return largest


@pytest.mark.parametrize("shape", SHAPES)
def test_velocity_is_the_integral_of_the_acceleration(shape: str) -> None:
    shaking = Shaking(shape=shape, amplitude=0.3, duration=0.8)
    forms = {
        "constant": lambda _: 0.3,
        "half-sine": lambda time: 0.3 * math.sin(math.pi * time / 0.8),
        "full-sine": lambda time: 0.3 * math.sin(2 * math.pi * time / 0.8),
    }
    for start, end in ((0.0, 0.8), (0.1, 0.7), (0.55, 0.56)):
        wanted, _ = quad(forms[shape], start, end)
        assert shaking.gained(start, end) == pytest.approx(wanted, abs=1e-14)
    assert shaking.gained(0.8, 5.0) == 0.0


@given(
    st.lists(st.floats(-5, 5), min_size=2, max_size=30),
    st.floats(-1, 40),
    st.floats(0, 10),
    st.integers(0, 2**31),
)
def test_a_table_is_followed_along_straight_lines(
    values: list[float], start: float, length: float, seed: int
) -> None:
    times = np.cumsum(np.random.default_rng(seed).uniform(0.01, 1, len(values)))
    shaking = table_of(times, np.array(values))
    fine = np.unique(np.r_[np.linspace(start, start + length, 20_001), times - times[0]])
    fine = fine[(fine >= start) & (fine <= start + length)]
    inside = (fine >= 0) & (fine <= times[-1] - times[0])
    level = np.where(inside, np.interp(fine, times - times[0], values), 0.0)
    # Beyond its ends there is none: the steps there are left out of the sum.
    both = inside[1:] & inside[:-1]
    wanted = float((np.diff(fine) * (level[1:] + level[:-1]) / 2)[both].sum())
    assert shaking.gained(start, start + length) == pytest.approx(wanted, abs=2e-2)


@pytest.mark.long
@pytest.mark.parametrize("name", ["pulse_1x4_03", "pulse_1x4_05", "pulse_1x4_10"])
def test_a_pulse_overturns_a_block_from_its_known_duration_on(name: str) -> None:
    """Corpus: half a hundredth to either side of the duration, by `direct`."""
    assert shake(shaken(name, 0.995), "direct").verdict is Verdict.STANDS
    assert shake(shaken(name, 1.005), "direct").verdict is Verdict.COLLAPSES


@pytest.mark.long
@pytest.mark.parametrize("name", ["pulse_1x4_05"])
def test_pymunk_sees_the_same_pulses(name: str) -> None:
    assert shake(shaken(name, 0.99), "pymunk").verdict is Verdict.STANDS
    assert shake(shaken(name, 1.01), "pymunk").verdict is Verdict.COLLAPSES


def pushed(problem: Problem, amplitude: float) -> Shaken:
    """Push the ground with a constant acceleration for 3 s, by pymunk."""
    shaking = Shaking(shape="constant", amplitude=amplitude, duration=3.0)
    return shake(replace(problem, shaking=shaking), "pymunk")


@pytest.mark.long
@pytest.mark.parametrize(("share", "verdict"), [(0.98, "stands"), (1.02, "collapses")])
def test_a_push_moves_an_arch_in_pymunk_where_statics_says(share: float, verdict: str) -> None:
    """0.14510 g by limit analysis; 0.0976 g where steps end before forces are found."""
    table = {"kind": "circular-arch", "voussoirs": 27, "thickness": 0.15, "friction": 0.7}
    seen = pushed(structure_of(table), 0.14510 * share)
    assert seen.verdict.value == verdict
    if share < 1:
        assert seen.recording.displacement.max() < 1e-6


def test_oppenheims_arch_falls_in_pymunk_where_statics_says() -> None:
    """0.37053 g by limit analysis."""
    arch = replace(load_known("oppenheim_7").problem, live=(), mu=0.8)
    stands, falls = (pushed(arch, 0.37053 * share) for share in (0.98, 1.02))
    assert stands.verdict is Verdict.STANDS
    assert stands.recording.displacement.max() < 1e-6
    assert falls.verdict is Verdict.COLLAPSES


def tilted_block(angle: float) -> Problem:
    """A block of 1 by 4 m on the floor that leans about its right-hand corner."""
    turn = np.exp(-1j * angle)
    corners = [1 + turn * (x - 1 + 1j * y) for x, y in ((0, 0), (1, 0), (1, 4), (0, 4))]
    floor = {"id": 0, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
    leaning = {"id": 1, "vertices": [[each.real, each.imag] for each in corners]}
    return structure_of({"friction": 2.0, "blocks": [floor, leaning]})


@pytest.mark.parametrize(
    ("step", "error"), [(0.01, 0.015), pytest.param(0.001, 0.006, marks=pytest.mark.long)]
)
def test_free_rocking_in_pymunk_keeps_what_housner_says(step: float, error: float) -> None:
    """Let go at 0.15 rad; each impact leaves (1 - 1.5 sin^2 alpha)^2 of the energy."""
    alpha = math.atan2(1.0, 4.0)
    kept = (1 - 1.5 * math.sin(alpha) ** 2) ** 2
    fallen = math.cos(alpha - 0.15) - math.cos(alpha)
    wanted = alpha - math.acos(math.cos(alpha) + kept * fallen)
    problem = tilted_block(0.15)
    still = Shaking(shape="constant", amplitude=0.0, duration=2.0)
    until = 2.0 / problem.seconds
    seen = shake(
        replace(problem, shaking=still), "pymunk", until=until, settings={"step": step}
    )
    assert seen.recording.poses[:, 0, 2].max() - 0.15 == pytest.approx(wanted, rel=error)


def rocked(times: np.ndarray, values: np.ndarray, step: float = 4e-4) -> float:
    """Largest rotation of the block of 1 by 4 m under a record, inf where it overturns.

    Housner's equation by Runge and Kutta's method, with an event at each impact.
    """
    alpha, squared = math.atan2(1.0, 4.0), 3 * G / (2 * math.hypot(1.0, 4.0))
    kept = 1 - 1.5 * math.sin(alpha) ** 2
    pushes = np.interp(
        np.arange(0, times[-1] + 10, step / 2), times, values, right=0.0
    ).tolist()
    angle = speed = largest = 0.0
    sense = 0

    def gained(at: int, angle: float) -> float:
        lean = sense * alpha - angle
        return squared * (pushes[at] * math.cos(lean) - math.sin(lean))

    for at in range(0, len(pushes) - 2, 2):
        if sense == 0:
            sense = int(math.copysign(1, pushes[at])) if abs(pushes[at]) > 0.25 else 0
        if sense == 0:
            continue
        first = gained(at, angle)
        second = gained(at + 1, angle + step / 2 * speed)
        third = gained(at + 1, angle + step / 2 * speed + step**2 / 4 * first)
        last = gained(at + 2, angle + step * speed + step**2 / 2 * second)
        angle += step * speed + step**2 / 6 * (first + second + third)
        speed += step / 6 * (first + 2 * second + 2 * third + last)
        if sense * angle < 0:
            angle, speed, sense = 0.0, kept * speed, -sense
            if abs(speed) < 1e-4:
                speed, sense = 0.0, 0
        largest = max(largest, abs(angle))
        if largest > 1.3:
            return math.inf
    return largest


@pytest.mark.long
@pytest.mark.parametrize("peak", [0.5, 0.8])
@pytest.mark.parametrize("seed", range(3))
def test_records_rock_a_block_in_pymunk_as_housner_says(peak: float, seed: int) -> None:
    """4,000 samples in 10 s; up to twenty impacts."""
    draw = np.random.default_rng(seed)
    times = np.linspace(0.0, 4000 * 0.0025, 4000, endpoint=False)
    values = np.zeros(4000)
    for _ in range(12):
        phase = 2 * math.pi * draw.uniform(0.3, 4) * times + draw.uniform(0, 6.3)
        values += np.sin(phase) * draw.uniform(0.3, 1)
    values *= np.sqrt(np.sin(math.pi * times / times[-1]))
    values *= peak / np.abs(values).max()
    wanted = rocked(times, values)
    seen = shake(replace(block(), shaking=table_of(times, values)), "pymunk")
    falls = math.isinf(wanted)
    assert seen.verdict is (Verdict.COLLAPSES if falls else Verdict.STANDS)
    if not falls:
        assert seen.rocking.rotation == pytest.approx(wanted, rel=0.02)


@pytest.mark.long
@pytest.mark.parametrize("name", ["frame_pulse_gamma05", "frame_pulse_gamma20"])
def test_a_lintel_on_two_columns_overturns_with_them(name: str) -> None:
    """Makris and Vassiliou: a frame rocks like a larger block."""
    assert shake(shaken(name, 0.99), "direct").verdict is Verdict.STANDS
    assert shake(shaken(name, 1.01), "direct").verdict is Verdict.COLLAPSES


@pytest.mark.parametrize(
    ("shape", "engine"),
    [
        ("half-sine", "direct"),
        ("full-sine", "pymunk"),
        pytest.param("full-sine", "direct", marks=pytest.mark.long),
        pytest.param("half-sine", "pymunk", marks=pytest.mark.long),
    ],
)
def test_blocks_turn_as_far_as_housner_says(shape: str, engine: str) -> None:
    """Through impacts, of which each keeps what contact alone leaves."""
    shaking = Shaking(shape=shape, amplitude=0.45, duration=0.5)
    wanted = as_housner_says(shaking, 1.0, 4.0)
    fine = {"step": 0.0025} if engine == "direct" else {}
    seen = shake(replace(block(), shaking=shaking), engine, settings=fine, until=3.0)
    assert seen.rocking.rotation == pytest.approx(wanted, rel=0.015)


def test_below_the_static_limit_nothing_moves_and_above_it_rocks() -> None:
    """The block lifts off where a > g b/h."""
    for engine in ("direct", "pymunk"):
        turned = [
            shake(
                replace(
                    block(),
                    shaking=Shaking(shape="constant", amplitude=0.25 * share, duration=0.5),
                ),
                engine,
            ).rocking.rotation
            for share in (0.99, 1.05)
        ]
        assert turned[0] < 3e-4
        assert turned[1] > 1e-3


def test_a_flat_block_slides_as_coulomb_says() -> None:
    """It is left behind by (a - mu g) t^2 / 2, then slows down by mu g."""
    mu, amplitude, duration = 0.3, 0.5, 0.4
    shaking = Shaking(shape="constant", amplitude=amplitude, duration=duration)
    problem = replace(block(2.0, 0.4, mu), shaking=shaking)
    speed = (amplitude - mu) * G * duration
    wanted = speed * duration / 2 + speed**2 / (2 * mu * G)
    seen = shake(problem, "direct", settings={"step": 0.01})
    assert seen.verdict is Verdict.STANDS
    way = seen.recording.poses[0, 0, 0] - seen.recording.poses[-1, 0, 0]
    assert way * problem.assembly.size == pytest.approx(wanted, rel=2e-5)
    assert seen.rocking.impact is None


def test_mirrored_ground_moves_blocks_the_other_way() -> None:
    times = np.linspace(0, 0.6, 2001)
    there = Shaking(shape="full-sine", amplitude=0.5, duration=0.6)
    back = table_of(times, -0.5 * np.sin(2 * math.pi * times / 0.6))
    one, two = (
        shake(
            replace(block(), shaking=each), "direct", until=3.0, settings={"step": 0.01}
        ).recording.poses[:, 0, 2]
        for each in (there, back)
    )
    assert np.abs(one).max() > 0.05
    assert two == pytest.approx(-one, abs=1e-4)


@pytest.mark.parametrize(
    "name", ["rocking_1x4_5", pytest.param("rocking_0_5x4_5", marks=pytest.mark.long)]
)
def test_time_to_the_first_impact_converges_to_housners(name: str) -> None:
    """Errors fall as the step squared, and the usual step's is less than 3e-5."""
    known, problem = case(name), structure_of(tipped(name))
    wanted = known["expected"]["time_to_first_impact_s"]
    errors: list[float] = []
    for step in (0.05, 0.025, 0.0125):
        # On ground that shakes by nothing `direct` takes its own steps from the first.
        nothing = Shaking(shape="constant", amplitude=0.0, duration=1.1 * wanted)
        recording = shake(
            replace(problem, shaking=nothing),
            "direct",
            until=1.1 * wanted / problem.seconds,
            settings={"step": step},
        ).recording
        impact = rocking_of(recording).impact
        assert impact is not None
        errors.append(impact * problem.seconds / wanted - 1)
    one, two = np.diff(errors)
    assert one / two == pytest.approx(4, rel=0.25)
    assert np.abs(errors).max() < 3e-5


def written(folder: Path, **more: object) -> str:
    """A structure file of a block."""
    floor = {"id": "floor", "vertices": [[-3, -1], [4, -1], [4, 0], [-3, 0]], "fixed": True}
    corners = [[0, 0], [1, 0], [1, 4], [0, 4]]
    table = {"friction": 2.0, "blocks": [floor, {"id": "drum", "vertices": corners}], **more}
    (folder / "block.json").write_text(json.dumps(table))
    return str(folder / "block.json")


PULSE = {"shape": "half-sine", "amplitude_g": 0.4, "duration_s": 0.3}


def test_file_and_options_ask_the_same(tmp_path: Path) -> None:
    asked = inside("check", written(tmp_path, shake=PULSE), "--method", "pymunk", "--json")
    options = ["--shake", "half-sine", "--amplitude", "0.4", "--duration", "0.3"]
    given = inside("check", written(tmp_path), *options, "--method", "pymunk", "--json")
    both = [json.loads(each.stdout) for each in (asked, given)]
    assert both[0]["state_hash"] == both[1]["state_hash"]
    assert both[0]["problem"]["shake"] == PULSE
    assert both[0]["shaken"] == both[1]["shaken"]
    assert both[0]["shaken"]["block"] == "drum"
    assert 0 < both[0]["shaken"]["largest_rotation_deg"] < 14.04
    assert 0.3 < both[0]["shaken"]["first_impact_s"] < 3
    assert (asked.returncode, both[0]["verdict"]) == (0, "stands")
    assert both[0]["rest"] is None
    stronger = inside(
        "check", written(tmp_path, shake=PULSE), "--amplitude", "1.5", "--method", "pymunk"
    )
    assert stronger.returncode == 1
    assert "ground shakes: half sine of 1.5 g for 0.3 s" in stronger.stdout
    assert "a block sank by" in stronger.stdout


TABLE = {"times_s": [0, 0.2, 0.3], "accelerations_g": [0.4, 0.5, -0.2]}


@pytest.mark.parametrize(
    ("table", "words"), [(TABLE, "a record of 0.5 g"), (PULSE, "half sine of 0.4 g")]
)
def test_a_recording_carries_its_shaking_and_says_what_rocked(
    tmp_path: Path, table: dict[str, object], words: str
) -> None:
    out = tmp_path / "run.npz"
    said = inside(
        "simulate", written(tmp_path, shake=table), "--method", "pymunk",
        "--seconds", "3", "--out", str(out),
    )  # fmt: skip
    assert said.returncode == 0, said.stderr
    assert f"ground shakes: {words} for 0.3 s, block drum turned by" in said.stdout
    assert "a joint first closed again after" in said.stdout
    # The ground does work: energy says nothing of the engine.
    assert "energy" not in said.stdout
    shaking = read_recording(out).problem.shaking
    assert shaking is not None
    record = structure_record(read_recording(out).problem)["shake"]
    assert record.keys() == table.keys()
    for key, value in table.items():
        assert record[key] == (value if key == "shape" else pytest.approx(value))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,g\n0,1\n", "first line = 'time,g': must be time_s,acceleration_g"),
        ("time_s,acceleration_g\n", "times_s = '0 rows': must be 2 to 1000000 rows"),
        ("time_s,acceleration_g\n0,1\n0,1\n", "times_s[1] = 0.0: must be each later than"),
        ("time_s,acceleration_g\n0,1\n1,x\n", "must be a CSV table of numbers"),
        ("time_s,acceleration_g\n0,1\n1,nan\n", "must be finite numbers in every row"),
        ("time_s,acceleration_g\n0,1,2\n1,2,3\n", "columns = 3: must be 2"),
        ("time_s,acceleration_g\n0,1\n1,200\n", "amplitude = 200.0: must be 0 to 100 g"),
    ],
)
def test_wrong_tables_are_refused_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "ground.csv"
    path.write_text(text)
    ended = inside("check", written(tmp_path), "--shake", str(path))
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert said in ended.stderr
    with pytest.raises(InputError):
        read_table(path)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--amplitude", "1"], "the ground is at rest"),
        (["--shake", "constant"], "--amplitude and --duration are missing"),
        (["--shake", "wobble", "--amplitude", "1", "--duration", "1"], "one of constant"),
        (["--shake", "none.csv"], "an existing .csv file"),
        (["--shake", "constant", "--amplitude", "-1", "--duration", "1"], "0 to 100 g"),
        (["--shake", "constant", "--amplitude", "1", "--duration", "0"], "to 600 s"),
        (
            ["--shake", "constant", "--amplitude", "1", "--duration", "1", "--method", "limit"],
            "one of direct, pymunk: limit knows no ground that shakes",
        ),
    ],
)
def test_wrong_options_are_refused_in_one_line(
    tmp_path: Path, options: list[str], said: str
) -> None:
    ended = inside("check", written(tmp_path), *options)
    assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
    assert said in ended.stderr


@pytest.mark.parametrize(
    "confirm", [False, pytest.param(True, marks=pytest.mark.long)], ids=["once", "confirmed"]
)
def test_an_amplitude_is_bracketed(confirm: bool) -> None:
    """Corpus: a pulse of 0.5 g has to last 0.3677 s, so one of that duration 0.5 g."""
    problem = shaken("pulse_1x4_05", 1.0)
    family = family_of(problem, "amplitude")
    found = bracket(family, method="pymunk", tol=0.05, confirm=confirm)
    assert found.confirmed is (True if confirm else None)
    assert found.low is not None
    assert found.high is not None
    assert found.low < 0.5 * 1.005
    assert found.high > 0.5 * 0.995
    assert found.high / found.low < 1.06
    assert (found.stands, found.limit) == ("low", None)
    # A range in which it stands all over, although it starts with 0.5 g.
    less = bracket(family, method="pymunk", within=(0.0, 1e-4))
    assert (less.low, less.high) == (1e-4, None)
    still = structure_of(scenes("pulse_1x4_05")[0])
    with pytest.raises(InputError, match="the ground is at rest"):
        family_of(still, "amplitude")


@pytest.mark.usefixtures("in_this_process")
def test_a_sweep_maps_amplitude_against_duration(tmp_path: Path) -> None:
    (tmp_path / "map.toml").write_text(
        'kind = "column"\ndrums = 1\ndrum_height = 4.0\nwidth = 1.0\nmu = 2.0\n'
        'shake = "constant"\namplitude_g = [0.2, 0.5]\nduration_s = [0.42]\n'
        'method = "pymunk"\n'
    )
    sweep(load_design(tmp_path / "map.toml"), tmp_path / "rows", workers=1)
    rows = list(read_rows(tmp_path / "rows"))
    found = {(row["amplitude_g"], row["duration_s"]): row["verdict"] for row in rows}
    assert found == {(0.2, 0.42): "stands", (0.5, 0.42): "collapses"}
    turned = {row["amplitude_g"]: float(str(row["largest_rotation_deg"])) for row in rows}
    assert turned[0.2] < 0.1
    assert turned[0.5] > 14.04
    for line, said in (
        ('shake = "wobble"', "shake = 'wobble': must be one of constant"),
        ("", "amplitude_g = 'given': must be left out: no shake"),
    ):
        text = (tmp_path / "map.toml").read_text().replace('shake = "constant"', line)
        (tmp_path / "wrong.toml").write_text(text)
        with pytest.raises(InputError, match=said):
            load_design(tmp_path / "wrong.toml")


def test_an_arch_that_falls_anyway_falls_on_ground_that_shakes() -> None:
    thin = structure_of({"kind": "circular-arch", "friction": 0.7, "thickness": 0.09})
    shaking = Shaking(shape="half-sine", amplitude=0.01, duration=0.1)
    assert check(replace(thin, shaking=shaking)).verdict is Verdict.COLLAPSES
