"""Ground that shakes, held against what is known of blocks that rock.

Truth: Housner's equation of a rocking block (`rocking`); the corpus (Makris and
Vassiliou's frame, pulses, rocking, sliding); Coulomb's law for a block that only slides.
"""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rocking import block, on_pulse, on_record, rocks
from running import answered, inside
from scipy.integrate import quad
from structure_cases import case, scenes
from sweeps import design_of, rows_of

from blocksim import (
    InputError,
    Problem,
    Verdict,
    bracket,
    check,
    fragility,
    load,
    load_recording,
    read_rows,
    structure_of,
    sweep,
)


def shaken(name: str, share: float) -> Problem:
    """A case of the corpus shaken for a share of the duration that overturns it."""
    amplitude = {"pulse_1x4_03": 0.3, "pulse_1x4_05": 0.5, "pulse_1x4_10": 1.0}.get(name, 0.4)
    duration = share * case(name)["expected"]["least_duration_s"]
    return on_pulse(structure_of(scenes(name)[0]), "constant", amplitude, duration)


def acceleration(shape: str, amplitude: float, duration: float, time: float) -> float:
    """Of the ground, by its closed form [g]."""
    if not 0 <= time <= duration:
        return 0.0
    share = math.pi * time / duration
    forms = {"constant": 1.0, "half-sine": math.sin(share), "full-sine": math.sin(2 * share)}
    return amplitude * forms[shape]


@pytest.mark.parametrize("shape", ["constant", "half-sine", "full-sine"])
def test_velocity_is_the_integral_of_the_acceleration(shape: str) -> None:
    shaking = on_pulse(block(), shape, 0.3, 0.8).shaking
    for start, end in ((0.0, 0.8), (0.1, 0.7), (0.55, 0.56)):
        wanted, _ = quad(lambda time: acceleration(shape, 0.3, 0.8, time), start, end)
        assert shaking.gained(start, end) == pytest.approx([wanted, 0], abs=1e-14)
    assert not shaking.gained(0.8, 5.0).any()


@pytest.mark.long
@pytest.mark.parametrize("name", ["pulse_1x4_03", "pulse_1x4_10"])
def test_a_pulse_overturns_a_block_from_its_known_duration_on(name: str) -> None:
    """Corpus: half a hundredth to either side of the duration, by `direct`."""
    assert check(shaken(name, 0.995), method="direct").verdict is Verdict.STANDS
    assert check(shaken(name, 1.005), method="direct").verdict is Verdict.COLLAPSES


def pushed(problem: Problem, amplitude: float) -> Any:
    """Push the ground with a constant acceleration for 3 s, by pymunk."""
    return check(on_pulse(problem, "constant", amplitude, 3.0), method="pymunk").shaken


def test_oppenheims_arch_falls_in_pymunk_where_statics_says() -> None:
    """0.37053 g by limit analysis."""
    arch = replace(load("oppenheim_7"), live=(), mu=0.8)
    stands, falls = (pushed(arch, 0.37053 * share) for share in (0.98, 1.02))
    assert stands.verdict is Verdict.STANDS
    assert stands.recording.displacement.max() < 1e-6
    assert falls.verdict is Verdict.COLLAPSES


@pytest.mark.long
@pytest.mark.parametrize("peak", [0.5, 0.8])
def test_records_rock_a_block_in_pymunk_as_housner_says(peak: float) -> None:
    """4,000 samples in 10 s; up to twenty impacts."""
    draw = np.random.default_rng(0)
    times = np.linspace(0.0, 4000 * 0.0025, 4000, endpoint=False)
    values = np.zeros(4000)
    for _ in range(12):
        phase = 2 * math.pi * draw.uniform(0.3, 4) * times + draw.uniform(0, 6.3)
        values += np.sin(phase) * draw.uniform(0.3, 1)
    values *= np.sqrt(np.sin(math.pi * times / times[-1]))
    values *= peak / np.abs(values).max()
    wanted = rocks(
        1.0, 4.0, lambda now: float(np.interp(now, times, values, 0.0, 0.0)),
        shaken=10.0, until=20.0, longest=0.005,
    )  # fmt: skip
    seen = check(on_record(block(), times, values), method="pymunk").shaken
    assert seen.verdict is (Verdict.COLLAPSES if wanted.overturns else Verdict.STANDS)
    if not wanted.overturns:
        assert seen.rocking.rotation == pytest.approx(wanted.largest, rel=0.02)


@pytest.mark.long
@pytest.mark.parametrize("name", ["frame_pulse_gamma20"])
def test_a_lintel_on_two_columns_overturns_with_them(name: str) -> None:
    """Makris and Vassiliou: a frame rocks like a larger block."""
    assert check(shaken(name, 0.99), method="direct").verdict is Verdict.STANDS
    assert check(shaken(name, 1.01), method="direct").verdict is Verdict.COLLAPSES


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
    pulse = (shape, 0.45, 0.5)
    wanted = rocks(1.0, 4.0, lambda now: acceleration(*pulse, now), shaken=0.5).largest
    seen = check(on_pulse(block(), *pulse), method=engine).shaken
    assert seen.rocking.rotation == pytest.approx(wanted, rel=0.015)


def test_below_the_static_limit_nothing_moves_and_above_it_rocks() -> None:
    """The block lifts off where a > g b/h."""
    for engine in ("direct", "pymunk"):
        turned = [
            check(
                on_pulse(block(), "constant", 0.25 * share, 0.5), method=engine
            ).shaken.rocking.rotation
            for share in (0.99, 1.05)
        ]
        assert turned[0] < 3e-4
        assert turned[1] > 1e-3


def written(folder: Path, **more: object) -> str:
    """A structure file of a block."""
    floor = {"id": "floor", "vertices": [[-3, -1], [4, -1], [4, 0], [-3, 0]], "fixed": True}
    corners = [[0, 0], [1, 0], [1, 4], [0, 4]]
    table = {"friction": 2.0, "blocks": [floor, {"id": "drum", "vertices": corners}], **more}
    (folder / "block.json").write_text(json.dumps(table))
    return str(folder / "block.json")


PULSE = {"shape": "half-sine", "amplitude_g": 0.4, "duration_s": 0.3}


def test_file_and_options_ask_the_same(tmp_path: Path) -> None:
    asked = inside("check", written(tmp_path, shake=PULSE), "--method", "direct", "--json")
    options = ["--shake", "half-sine", "--amplitude", "0.4", "--duration", "0.3"]
    given = inside("check", written(tmp_path), *options, "--method", "direct", "--json")
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
        "check", written(tmp_path, shake=PULSE), "--amplitude", "1.5", "--method", "direct"
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
    shaking = load_recording(out).problem.shaking
    assert shaking is not None
    record = load_recording(out).problem.to_dict()["shake"]
    assert record.keys() == table.keys()
    for key, value in table.items():
        assert record[key] == (value if key == "shape" else pytest.approx(value))


@pytest.mark.parametrize(
    ("method", "confirm"),
    [("direct", False), pytest.param("pymunk", True, marks=pytest.mark.long)],
)
def test_an_amplitude_is_bracketed(method: str, confirm: bool) -> None:
    """Corpus: a pulse of 0.5 g has to last 0.3677 s, so one of that duration 0.5 g."""
    problem = shaken("pulse_1x4_05", 1.0)
    asked = {"over": "amplitude", "method": method, "tol": 0.05, "confirm": confirm}
    found = bracket(problem, **asked)
    assert found.confirmed is (True if confirm else None)
    assert found.low < 0.5 * 1.005
    assert found.high > 0.5 * 0.995
    assert found.high / found.low < 1.06
    assert (found.stands, found.limit) == ("low", None)
    # A range in which it stands all over, although it starts with 0.5 g.
    less = bracket(problem, over="amplitude", method="pymunk", within=(0.0, 1e-4))
    assert (less.low, less.high) == (1e-4, None)


@pytest.mark.usefixtures("in_this_process")
def test_a_sweep_maps_amplitude_against_duration(tmp_path: Path) -> None:
    text = (
        'kind = "column"\ndrums = 1\ndrum_height = 4.0\nwidth = 1.0\nmu = 2.0\n'
        'shake = "constant"\namplitude_g = [0.2, 0.5]\nduration_s = [0.42]\n'
        'method = "pymunk"\n'
    )
    sweep(design_of(tmp_path, text), tmp_path / "rows", workers=1)
    rows = rows_of(tmp_path / "rows").values()
    found = {(row["amplitude_g"], row["duration_s"]): row["verdict"] for row in rows}
    assert found == {(0.2, 0.42): "stands", (0.5, 0.42): "collapses"}
    turned = {row["amplitude_g"]: float(str(row["largest_rotation_deg"])) for row in rows}
    assert turned[0.2] < 0.1
    assert turned[0.5] > 14.04


def test_an_arch_that_falls_anyway_falls_on_ground_that_shakes() -> None:
    thin = structure_of({"kind": "circular-arch", "friction": 0.7, "thickness": 0.09})
    assert check(on_pulse(thin, "half-sine", 0.01, 0.1)).verdict is Verdict.COLLAPSES


NAME = "pulse_1x4_05"
LEAST = float(case(NAME)["expected"]["least_duration_s"])
"""Of a pulse of 0.5 g that overturns the block, in closed form."""


def pulse(duration: float) -> Any:
    """A constant acceleration, as a record."""
    return on_record(structure_of(scenes(NAME)[0]), np.array([0, duration]), np.ones(2)).shaking


def test_a_curve_and_a_table_are_written(tmp_path: Path) -> None:
    record, table, curve = (tmp_path / name for name in ("a.csv", "out.csv", "out.svg"))
    record.write_text("time_s,acceleration_g\n0,1\n0.5,1\n")
    block = ("column", "--mu", "2", "--with", "drums=1", "--with", "drum_height=4")
    asked = ("fragility", *block, "--method", "direct", "--record", str(record))
    wide = ("--amplitudes", "0.1", "4", "2")
    done = inside(*asked, *wide, "--out", str(table), "--out", str(curve))
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [(row["amplitude_g"], row["falls"]) for row in rows] == [
        ("0.1", "0.0"),
        ("4.0", "1.0"),
    ]
    assert 'id="falls"' in curve.read_text()
    kept = ("--rows", str(tmp_path / "rows"), "--workers", "1")
    said = answered(*asked, *wide, *kept)
    assert len(list(read_rows(tmp_path / "rows"))) == 2
    assert [each["falls"] for each in said["rows"]] == [0.0, 1.0]
    assert said["verdicts"] == {str(record): ["stands", "collapses"]}


def test_the_share_that_falls_is_that_of_pulses_long_enough_and_a_folder_keeps_it(
    tmp_path: Path,
) -> None:
    """Below 0.25 g nothing starts to rock. What the folder has is not asked again."""
    problem = replace(structure_of(scenes(NAME)[0]), shaking=None)
    records = {f"{share:g}": pulse(share * LEAST) for share in (0.9, 1.05)}
    asked = {"method": "direct", "folder": tmp_path}
    fragility(problem, {"1.05": records["1.05"]}, [0.2], **asked)
    (row,) = read_rows(tmp_path)
    assert (row["verdict"], row["amplitude_g"]) == ("stands", 0.2)
    found = fragility(problem, records, [0.2, 0.5], **asked, workers=1)
    assert found.records == ("0.9", "1.05")
    verdicts = [[each.value for each in row] for row in found.verdicts]
    assert verdicts == [["stands", "stands"], ["stands", "collapses"]]
    rows = list(read_rows(tmp_path))
    assert len(rows) == 4
    assert row in rows
    # Other settings are another question.
    finer = {"accuracy": 1e-4}
    fragility(problem, {"1.05": records["1.05"]}, [0.2], **asked, settings=finer)
    assert len(list(read_rows(tmp_path))) == 5


def test_amplitudes_have_to_grow() -> None:
    with pytest.raises(InputError, match="growing"):
        fragility(structure_of(scenes(NAME)[0]), {"a": pulse(1.0)}, [0.2, 0.1])


def test_a_block_that_rolls_onto_its_foot_again_has_fallen() -> None:
    """Housner's equation overturns it; it goes round once and stands still, 8 m away."""
    problem = on_pulse(block(1.0, 2.0, 3.0), "half-sine", 2.400149081624057, 1.488760602650338)
    seen = check(problem, method="direct")
    assert seen.shaken.rocking.rotation > 2 * math.pi
    assert seen.verdict is Verdict.COLLAPSES
