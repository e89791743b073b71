"""Validation rows say what was found and mark misses; what people give and are told."""

import importlib
import json
import math
import re
import zipfile
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from report_rows import ARCH, ROW, sliding
from running import answered
from running import inside as blocksim
from test_scenario import ARCHES, LEANING, SAID

from blocksim import CircularArch, Mode, Verdict, load_design, load_recording, load_structure
from blocksim.cli.studies import answer_table
from blocksim.cli.terminal import show
from blocksim.kinds.loading import load_known
from blocksim.studies.agreement import disagreements, parted
from blocksim.studies.questions import answer
from blocksim.studies.thickness import thinnest
from blocksim.studies.validate import unasked, validate


def test_rows_agree_with_limit_analysis() -> None:
    chosen = [load_known(name) for name in ("semicircle", "semicircle_sliding")]
    rows = validate(chosen, ("pymunk",), workers=1)
    first, second = rows
    assert abs(first.error or 1) < 0.002
    assert (first.at_low, first.at_high) == (Verdict.COLLAPSES, Verdict.STANDS)
    assert first.mode is Mode.RRR
    assert second.high is None
    assert second.mode is Mode.SS
    assert [row.miss for row in rows] == ["", ""]


def test_a_wrong_engine_would_be_a_miss(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shift the exact value by 1 %: the row must say so."""
    module = importlib.import_module("blocksim.kinds.archoffers")
    real = module.limit.least_thickness

    def shifted(*arguments: object) -> object:
        state = real(*arguments)
        return replace(state, eta=state.eta * 1.01, mode=Mode.SRR)

    monkeypatch.setattr(module.limit, "least_thickness", shifted)
    known = load_known("semicircle")
    row = answer(known, known.expect[0], "pymunk")
    assert "error -1.0" in row.miss or "error -0.9" in row.miss
    assert "mode rrr, limit says srr" in row.miss


def test_modes_that_coincide_on_a_line_of_the_map_are_both_right() -> None:
    """Fig. 22 prints both modes; where friction is 1e-4 more theory has but one of them.

    In a wide bracket `direct` sees rrr at the lower end; at the limit they are rrs.
    """
    known = load_known("fig22_first_sliding_149")
    on_it = thinnest(replace(ROW, method="direct"), known, known.expect[0], tol=4e-3)
    assert (on_it.mode, on_it.mode_limit) == (Mode.RRR, Mode.RRS)
    assert on_it.miss == ""
    assert on_it.note.startswith("on a line of the map")
    rougher = known.problem.maker.but(friction=1.0001 * known.problem.mu).problem()
    aside = replace(known, problem=rougher)
    beside = thinnest(replace(ROW, method="direct"), aside, known.expect[0], tol=4e-3)
    assert (beside.mode, beside.mode_limit) == (Mode.RRR, Mode.RRS)
    assert beside.miss == "mode rrr, limit says rrs"


@pytest.mark.parametrize(
    ("coincide", "seen", "places"),
    [
        ((Mode.RRR, Mode.RRS), Mode.RRS, 0),
        ((Mode.RRR,), Mode.RRS, 1),
        ((Mode.RRR, Mode.RRS), Mode.SRR, 1),
        ((Mode.RRR, Mode.RRS), None, 1),
    ],
)
def test_engines_that_see_modes_that_coincide_do_not_disagree(
    coincide: tuple[Mode, ...], seen: Mode | None, places: int
) -> None:
    one = replace(ROW, modes_theory=coincide)
    other = replace(one, method="pybullet", mode=seen)
    assert len(disagreements([one, other])) == places


def test_paths_may_be_texts_and_the_header_is_strict_json(tmp_path: Path) -> None:
    path = str(tmp_path / "a.npz")
    recording = replace(sliding(), problem=CircularArch.of(ARCH, math.inf).problem())
    recording.save(path)
    with np.load(path) as inside:
        header = json.loads(str(inside["header"]), parse_constant=pytest.fail)
    assert header["problem"]["mu"] == "inf"
    again = load_recording(path)
    assert (again.mu, again.settings) == (math.inf, recording.settings)
    assert zipfile.is_zipfile(path)


def test_infinite_friction_may_be_a_text_in_files(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    for said in ("inf", '"inf"'):
        path.write_text(f'kind = "circular-arch"\nfriction = {said}\n')
        assert load_structure(path).mu == math.inf
    path.write_text('half_angle_deg = 90\nmu = ["inf", 1]\n')
    assert load_design(str(path)).axes["mu"].values == (math.inf, 1.0)


def test_a_ratio_is_of_the_least_as_built_and_depth_is_told() -> None:
    asked = ("check", "semicircle", "--depth", "2.5")
    answer = answered(*asked, "--ratio", "0.999", code=1)
    arch = answer["arch"]
    assert arch["eta"] == pytest.approx(0.999 * arch["eta_limit"], rel=1e-14)
    assert (arch["depth"], answer["verdict"]) == (2.5, "collapses")
    assert answer["problem"]["lean_deg"] == 0.0
    assert answered(*asked, "--ratio", "1.001")["verdict"] == "stands"


# That it overturns is said with its picture, in test_video.
DRAWN = "semicircle_tilted_overturns"


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.long] if name == DRAWN else [])
        for name in (*ARCHES, *LEANING)
    ],
)
def test_every_shipped_arch_can_be_checked(name: str) -> None:
    answer = answered("check", name, code=None)
    assert answer["verdict"] == SAID[name]["expect"][0].get("verdict", "collapses")


def test_what_was_not_asked_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = [load_known(name) for name in ("semicircle", "semicircle_tilted_stands")]
    plane, *others = unasked(chosen)
    assert (plane.engine, plane.scenarios) == ("pymunk", ("semicircle_tilted_stands",))
    monkeypatch.setattr("blocksim.engines.base.Engine.missing", "get it")
    found = unasked(chosen)
    assert {each.engine: each.scenarios for each in found} == {
        "direct": ("semicircle_tilted_stands",),
        "pymunk": ("semicircle", "semicircle_tilted_stands"),
        "pybullet": ("semicircle",),
    }
    assert all("get it" in each.words for each in found)
    assert not others or others[0].why.startswith("not here")


def test_scenarios_and_doctor_list_figures() -> None:
    lines = blocksim("scenarios").stdout.splitlines()
    at = next(k for k, line in enumerate(lines) if "semicircle_tilted_s" in line)
    assert lines[at].split()[1:3] == ["15", "3"]
    assert lines[at + 1].startswith("    known: stands")
    said = blocksim("doctor").stdout
    assert re.search(r"blocksim \S+, Python 3\.\d+", said)
    assert re.search(r"numpy \d", said)


def test_answers_stand_below_the_row_they_are_of(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also below rows that fold, where no window says how wide it is."""
    monkeypatch.delenv("COLUMNS", raising=False)
    names = ("fig22_first_sliding_149", "semicircle", "tower_offset", "column_six_drums")
    chosen = [load_known(name) for name in names]
    rows = validate(chosen, ("pymunk",), workers=1)
    assert {row.method for row in parted(rows)[1]} >= {"limit", "pymunk"}
    show(answer_table(rows))
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    shown = ("22_first", "semicircle ", "tower_offset", "column_six")
    at = [next(k for k, line in enumerate(lines) if name in line) for name in shown]
    assert at == sorted(at)
    for place, after in pairwise([*at, len(lines)]):
        begins = "    pymunk: " if place < at[2] else "    limit: "
        assert any(line.startswith(begins) for line in lines[place:after])
