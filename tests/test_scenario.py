"""Shipped scenarios say what theory says; wrong files are refused in one line."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest

from blocksim.arch import limit, theory
from blocksim.arch.modes import Mode
from blocksim.common.errors import InputError
from blocksim.kinds.scenarios import LARGEST_FILE, load_scenario, shipped
from blocksim.simulation.verdict import Verdict
from blocksim.studies.validate import scenarios

GOOD = """\
title = "A semicircle"
source = "none"
[arch]
half_angle_deg = 90
voussoirs = 27
eta = 0.12
[contact]
mu = 0.7
[expect]
modes = ["rrr"]
eta = 0.1
"""


ACROSS_THE_LINE = {
    "fig20_junction_point": {Mode.RRS},
    "fig25_low_overturning_152": {Mode.RRR},
}
"""Where a region ends, voussoirs show the mode of the next: they see a hinge half a joint
spacing off, here farther than the region is wide."""


def written(folder: Path, text: str) -> str:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


LEANING = [name for name in shipped() if load_scenario(name).lean]


@pytest.mark.parametrize("name", LEANING)
def test_leaning_scenarios_claim_what_statics_says(name: str) -> None:
    """A rigid body on its springings overturns as the weight leaves their depth."""
    scenario = load_scenario(name)
    assert scenario.expected_modes == ()
    arch = scenario.maker.shape
    assert arch is not None
    blocks = arch.assembly().blocks
    height = np.mean([block.centre[1] for block in blocks])
    height -= arch.radius * math.cos(arch.half_angle)
    overturns = math.tan(scenario.lean) > arch.depth / 2 / height
    assert scenario.mu > math.tan(scenario.lean)
    expected = Verdict.COLLAPSES if overturns else Verdict.STANDS
    assert scenario.expected_verdict is expected


@pytest.mark.parametrize("name", sorted({*shipped()} - {*LEANING}))
def test_shipped_scenarios_agree_with_theory(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.title
    assert scenario.source
    arch = scenario.arch(1.0)
    found = theory.least_thickness(arch.half_angle, scenario.mu, arch.weight)
    if scenario.expected_eta is None:
        assert found.eta is None
    else:
        assert found.eta == pytest.approx(scenario.expected_eta, rel=1e-12)
    modes = set(scenario.expected_modes)
    assert modes <= set(found.modes)
    # What ties beyond the caption is its line's other mode; away from lines, nothing.
    assert found.modes if len(modes) > 1 else set(found.modes) == modes


@pytest.mark.parametrize("name", sorted({*shipped()} - {*LEANING}))
def test_shipped_voussoirs_show_a_published_mode(name: str) -> None:
    scenario = load_scenario(name)
    arch = scenario.arch(1.0)
    built = limit.least_thickness(arch.half_angle, scenario.mu, arch.voussoirs, arch.weight)
    assert built.mode in {*scenario.expected_modes, *ACROSS_THE_LINE.get(name, ())}
    assert (built.eta is None) <= (Mode.SS in scenario.expected_modes)


def test_scenarios_cover_the_map() -> None:
    every = scenarios(quick=False)
    assert {mode for scenario in every for mode in scenario.expected_modes} == set(Mode)
    arches = [scenario.arch(1.0) for scenario in every]
    assert {arch.weight for arch in arches} == {"centreline", "sector"}
    assert {arch.voussoirs % 2 for arch in arches} == {0, 1}
    quick = scenarios(quick=True)
    assert 0 < len(quick) < len(every)
    assert {scenario.name for scenario in quick} < {scenario.name for scenario in every}


def test_a_file_becomes_an_arch(tmp_path: Path) -> None:
    scenario = load_scenario(written(tmp_path, GOOD))
    assert scenario.name == "scene"
    arch = scenario.maker.shape
    assert arch is not None
    assert arch.half_angle == math.pi / 2
    assert (arch.eta, arch.voussoirs, arch.weight) == (0.12, 27, "centreline")
    assert (arch.radius, arch.depth, arch.specific_weight) == (1.0, 1.0, 20_000.0)
    assert scenario.expected_modes == (Mode.RRR,)
    unbounded = load_scenario(written(tmp_path, GOOD.replace("mu = 0.7", "mu = inf")))
    assert unbounded.mu == math.inf


@pytest.mark.parametrize(
    ("old", "new", "field", "shown", "allowed"),
    [
        (
            "half_angle_deg = 90",
            "half_angle_deg = 180",
            "arch.half_angle_deg",
            "180",
            "below 180",
        ),
        ("half_angle_deg = 90", "half_angle_deg = 0", "arch.half_angle_deg", "0", "0.06 to"),
        (
            "half_angle_deg = 90",
            'half_angle_deg = "90"',
            "arch.half_angle_deg",
            "'90'",
            "0.06 to below 180 deg",
        ),
        (
            "half_angle_deg = 90",
            "half_angle_deg = nan",
            "arch.half_angle_deg",
            "nan",
            "must be",
        ),
        ("half_angle_deg = 90\n", "", "arch.half_angle_deg", "is missing", "given"),
        ("voussoirs = 27", "voussoirs = 2", "arch.voussoirs", "2", "3"),
        ("voussoirs = 27", "voussoirs = 10001", "arch.voussoirs", "10001", "10000"),
        ("voussoirs = 27", "voussoirs = 9.0", "arch.voussoirs", "9.0", "whole number"),
        ("eta = 0.12", "eta = 2.5", "arch.eta", "2.5", "2"),
        ("eta = 0.12", "eta = 0", "arch.eta", "0", "1e-15 to 2"),
        ("eta = 0.12", 'weight = "mean"', "arch.weight", "'mean'", "'sector'"),
        ("eta = 0.12", "radius = inf", "arch.radius", "inf", "1e-06 to 1e+06 m"),
        ("eta = 0.12", "radius = 1e308", "arch.radius", "1e+308", "1e-06 to 1e+06 m"),
        ("eta = 0.12", "depth = -1", "arch.depth", "-1", "1e-06 to 1e+06 m"),
        ("eta = 0.12", "depth = 1e-320", "arch.depth", "1e-320", "1e-06 to 1e+06 m"),
        (
            "eta = 0.12",
            "specific_weight = 1e308",
            "arch.specific_weight",
            "1e+308",
            "1e-06 to 1e+09 N/m3",
        ),
        ("mu = 0.7", "mu = 1e-320", "contact.mu", "1e-320", "1e-06 to 1e+06 (or inf)"),
        ("mu = 0.7", "mu = 1e308", "contact.mu", "1e+308", "1e-06 to 1e+06 (or inf)"),
        ("eta = 0.12", "thickness = 1", "arch.thickness", "1", "no such key"),
        ("mu = 0.7", "mu = 0", "contact.mu", "0", "1e-06 to 1e+06 (or inf)"),
        ("mu = 0.7", "mu = true", "contact.mu", "True", "1e-06 to"),
        ("mu = 0.7", "friction = 0.7", "contact.friction", "0.7", "no such key"),
        ('["rrr"]', "[]", "expect.modes", "[]", "at least 1"),
        ('["rrr"]', '["rrq"]', "expect.modes[0]", "'rrq'", "'rrr'"),
        ("eta = 0.1\n", "eta = 3\n", "expect.eta", "3", "2"),
        ('title = "A semicircle"', 'title = ""', "title", "''", "1"),
        ('title = "A semicircle"', 'title = "A"\nquick = 1', "quick", "1", "boolean"),
        ("[contact]\nmu = 0.7\n", "", "contact", "is missing", "given"),
        ("[arch]", "[arch", "file", "", "valid TOML"),
    ],
)
def test_wrong_files_are_named_in_one_line(
    tmp_path: Path, old: str, new: str, field: str, shown: str, allowed: str
) -> None:
    assert old in GOOD
    name = written(tmp_path, GOOD.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_scenario(name)
    message = str(caught.value)
    assert message.startswith((f"{name}: {field} = ", f"{name}: {field} is missing: "))
    assert "\n" not in message
    assert shown in message
    assert allowed in message.partition("must be")[2] or allowed == "must be"


def test_file_that_is_not_there_or_too_large(tmp_path: Path) -> None:
    for name in ("no_such_scenario", str(tmp_path / "none.toml"), str(tmp_path), ""):
        with pytest.raises(InputError, match=r"an existing \.toml file"):
            load_scenario(name)
    padding = "#" * (LARGEST_FILE - len(GOOD))
    assert load_scenario(written(tmp_path, GOOD + padding)).given["voussoirs"] == 27
    with pytest.raises(InputError, match="at most 65536 bytes"):
        load_scenario(written(tmp_path, GOOD + padding + "#"))


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\xfe\x00",
        b"a = " + b"[" * 30_000 + b"]" * 30_000,
        b"a = 9" + b"9" * 5000,
    ],
)
def test_file_that_is_no_text_or_beyond_all_bounds(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match="valid TOML"):
        load_scenario(str(path))


@pytest.mark.parametrize("value", ['"' + "x" * 50_000 + '"', "[" + "1, " * 15_000 + "]"])
def test_of_a_long_value_the_beginning_is_shown(tmp_path: Path, value: str) -> None:
    with pytest.raises(InputError, match=r"^.*: extra = .*: must be left out") as caught:
        load_scenario(written(tmp_path, f"extra = {value}\n{GOOD}"))
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize("depth", [33, 30_000])
@pytest.mark.parametrize("form", ["[{}]", "{} = 1", "a = {{ {} = 1 }}"])
def test_a_key_of_many_parts_is_not_read(tmp_path: Path, depth: int, form: str) -> None:
    key = form.format(" . ".join(["a"] * min(depth, LARGEST_FILE // 5)))
    with pytest.raises(InputError, match="file = 'a key of more than 32 parts'"):
        load_scenario(written(tmp_path, f"{GOOD}\n{key}\n"))


def test_a_value_may_be_nested(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^.*: a = .*: must be left out"):
        load_scenario(written(tmp_path, f"{GOOD}\n[{'.'.join('a' * 32)}]\n"))


def test_a_key_with_lines_is_said_in_one(tmp_path: Path) -> None:
    key = '"a\\nb\\u001b[31m' + "x" * 1000 + '"'
    with pytest.raises(InputError) as caught:
        load_scenario(written(tmp_path, f"{key} = 1\n{GOOD}"))
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 600


@pytest.mark.parametrize("digits", ["0x" + "f" * 5_000, "0b" + "1" * 60_000, "9" * 300])
@pytest.mark.parametrize("old", ["voussoirs = 27", "eta = 0.12", "mu = 0.7"])
def test_a_whole_number_has_an_end(tmp_path: Path, old: str, digits: str) -> None:
    changed = GOOD.replace(old, f"{old.partition('=')[0]}= {digits}", 1)
    with pytest.raises(InputError, match=r"file = 'a whole number of \d+ bits'"):
        load_scenario(written(tmp_path, changed))


def test_a_name_too_long_for_a_file(tmp_path: Path) -> None:
    for name in ("x" * 5000, str(tmp_path / f"{'x' * 300}.toml")):
        with pytest.raises(InputError, match=r"an existing \.toml file .*File name too long"):
            load_scenario(name)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read(tmp_path: Path) -> None:
    name = written(tmp_path, GOOD)
    Path(name).chmod(0)
    with pytest.raises(InputError, match="Permission denied"):
        load_scenario(name)
