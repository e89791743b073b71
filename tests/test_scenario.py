"""Shipped scenarios say what theory says; wrong files are refused in one line."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from arches import least

from blocksim import InputError, Mode, Verdict
from blocksim.kinds.scenarios import LARGEST_FILE, load_scenario, shipped
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
    found = least(arch.half_angle, scenario.mu, weight=arch.weight)
    if scenario.expected_eta is None:
        assert found.eta_theory is None
    else:
        assert found.eta_theory == pytest.approx(scenario.expected_eta, rel=1e-12)
    modes = set(scenario.expected_modes)
    assert modes <= set(found.modes_theory)
    # What ties beyond the caption is its line's other mode; away from lines, nothing.
    assert len(modes) > 1 or set(found.modes_theory) == modes


@pytest.mark.parametrize("name", sorted({*shipped()} - {*LEANING}))
def test_shipped_voussoirs_show_a_published_mode(name: str) -> None:
    scenario = load_scenario(name)
    arch = scenario.arch(1.0)
    built = least(arch.half_angle, scenario.mu, arch.voussoirs, arch.weight)
    assert built.mode_limit in {*scenario.expected_modes, *ACROSS_THE_LINE.get(name, ())}
    assert (built.eta_limit is None) <= (Mode.SS in scenario.expected_modes)


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
    assert arch.half_angle == math.pi / 2
    assert (arch.eta, arch.voussoirs, arch.weight) == (0.12, 27, "centreline")
    assert (arch.radius, arch.depth, arch.specific_weight) == (1.0, 1.0, 20_000.0)
    assert scenario.expected_modes == (Mode.RRR,)
    unbounded = load_scenario(written(tmp_path, GOOD.replace("mu = 0.7", "mu = inf")))
    assert unbounded.mu == math.inf


def test_file_that_is_not_there_or_too_large(tmp_path: Path) -> None:
    for name in ("no_such_scenario", str(tmp_path / "none.toml"), str(tmp_path), ""):
        with pytest.raises(InputError, match=r"an existing \.toml file"):
            load_scenario(name)
    padding = "#" * (LARGEST_FILE - len(GOOD))
    assert load_scenario(written(tmp_path, GOOD + padding)).given["voussoirs"] == 27
    with pytest.raises(InputError, match="at most 65536 bytes"):
        load_scenario(written(tmp_path, GOOD + padding + "#"))
