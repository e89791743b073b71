"""Fragility, held against pulses whose least duration that overturns is known."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rocking import on_record
from running import inside
from structure_cases import case, scenes

from blocksim import InputError, Verdict, fragility, structure_of
from blocksim.blocks.shaking import Shaking
from blocksim.sweeps import read_rows
from blocksim.view.style import VERDICTS

NAME = "pulse_1x4_05"
LEAST = float(case(NAME)["expected"]["least_duration_s"])
"""Of a pulse of 0.5 g that overturns the block, in closed form."""


def pulse(duration: float) -> Shaking:
    """A constant acceleration, as a record."""
    found = on_record(
        structure_of(scenes(NAME)[0]), np.array([0, duration]), np.ones(2)
    ).shaking
    assert found is not None
    return found


def test_the_share_that_falls_is_that_of_pulses_long_enough() -> None:
    problem = replace(structure_of(scenes(NAME)[0]), shaking=None)
    shares = (0.9, 1.05)
    records = {f"{share:g}": pulse(share * LEAST) for share in shares}
    # Below 0.25 g nothing starts to rock.
    found = fragility(problem, records, [0.2, 0.5], method="direct")
    assert found.records == ("0.9", "1.05")
    verdicts = [[each.value for each in row] for row in found.verdicts]
    assert verdicts == [["stands", "stands"], ["stands", "collapses"]]


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
    assert VERDICTS[Verdict.COLLAPSES] in curve.read_text()  # the colour of what falls
    kept = ("--rows", str(tmp_path / "rows"), "--workers", "1")
    said = json.loads(inside(*asked, *wide, *kept, "--json").stdout)
    assert len(list(read_rows(tmp_path / "rows"))) == 2
    assert [each["falls"] for each in said["rows"]] == [0.0, 1.0]
    assert said["verdicts"] == {str(record): ["stands", "collapses"]}


def test_a_folder_keeps_answers_and_processes_share_the_work(tmp_path: Path) -> None:
    """Both ends of what is known are the same; the second run asks about one amplitude only."""
    problem = replace(structure_of(scenes(NAME)[0]), shaking=None)
    records = {"long": pulse(1.05 * LEAST)}
    first = fragility(problem, records, [0.2], method="direct", folder=tmp_path)
    (row,) = read_rows(tmp_path)
    assert (row["verdict"], row["amplitude_g"]) == ("stands", 0.2)
    both = fragility(problem, records, [0.2, 0.5], method="direct", folder=tmp_path, workers=2)
    rows = sorted(read_rows(tmp_path), key=lambda each: float(str(each["amplitude_g"])))
    assert rows[0] == row
    assert [each["verdict"] for each in rows] == ["stands", "collapses"]
    assert both.verdicts[0][:1] == first.verdicts[0]
    # Other settings are another question.
    finer = {"accuracy": 1e-4}
    fragility(problem, records, [0.2], method="direct", folder=tmp_path, settings=finer)
    assert len(list(read_rows(tmp_path))) == 3


def test_what_cannot_shake_is_refused_before_anything_is_asked(tmp_path: Path) -> None:
    block = structure_of(scenes(NAME)[0])
    with pytest.raises(InputError, match="pybullet"):
        fragility(block, {"a": pulse(1.0)}, [0.2], method="pybullet", folder=tmp_path)
    assert not list(tmp_path.iterdir())


def test_amplitudes_have_to_grow() -> None:
    with pytest.raises(InputError, match="growing"):
        fragility(
            structure_of(scenes(NAME)[0]),
            {"a": pulse(1.0)},
            [0.2, 0.1],
        )
