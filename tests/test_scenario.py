"""Shipped arches say what theory says; files of arches as they were once are read."""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arches import least
from running import answered, refused

from blocksim import Mode, load

FILES = Path(__file__).parents[1] / "scenarios" / "structures"
SAID: dict[str, dict[str, Any]] = {
    path.stem: tomllib.loads(path.read_text("utf-8")) for path in sorted(FILES.glob("*.toml"))
}
"""Shipped files by name."""
EVERY = {name: load(name) for name in SAID}
ARCHES = [name for name, said in SAID.items() if "modes" in said["expect"][0]]
LEANING = [
    name for name, problem in EVERY.items() if not (problem.in_space or problem.is_planar)
]
ACROSS_THE_LINE = {"fig20_junction_point": {Mode.RRS}, "fig25_low_overturning_152": {Mode.RRR}}
"""Where a region ends, voussoirs show the mode of the next: they see a hinge half a joint
spacing off, here farther than the region is wide."""


@pytest.mark.parametrize("name", LEANING)
def test_leaning_arches_claim_what_statics_says(name: str) -> None:
    """A rigid body on its springings overturns as the weight leaves their depth."""
    problem, arch = EVERY[name], EVERY[name].maker.shape
    height = np.mean([block.centre[1] for block in arch.assembly().blocks])
    height -= arch.radius * math.cos(arch.half_angle)
    slope = problem.gravity[2] / -problem.gravity[1]
    assert problem.mu > slope
    falls = slope > arch.depth / 2 / height
    assert SAID[name]["expect"][0]["verdict"] == ("collapses" if falls else "stands")


def test_a_lean_takes_the_place_of_another() -> None:
    """So it does under another gravity: its strength stays."""
    upright = EVERY["semicircle"].under(1.62)
    twice = upright.leaning(0.5).leaning(0.2)
    assert twice.gravity == pytest.approx(upright.leaning(0.2).gravity, rel=1e-15)
    assert np.linalg.norm(twice.gravity) == pytest.approx(1.62 / 9.81, rel=1e-15)


@pytest.mark.parametrize("name", ARCHES)
def test_shipped_arches_agree_with_theory(name: str) -> None:
    problem, (expected,) = EVERY[name], SAID[name]["expect"]
    assert problem.title
    assert problem.source
    arch = problem.maker.shape
    found = least(arch.half_angle, problem.mu, weight=arch.weight)
    if "eta" not in expected:
        assert found.eta_theory is None
    else:
        assert found.eta_theory == pytest.approx(expected["eta"], rel=1e-12)
    modes = {Mode(each) for each in expected["modes"]}
    assert modes <= set(found.modes_theory)
    # What ties beyond the caption is its line's other mode; away from lines, nothing.
    assert len(modes) > 1 or set(found.modes_theory) == modes


@pytest.mark.parametrize("name", ARCHES)
def test_shipped_voussoirs_show_a_published_mode(name: str) -> None:
    arch, (expected,) = EVERY[name].maker.shape, SAID[name]["expect"]
    built = least(arch.half_angle, EVERY[name].mu, arch.voussoirs, arch.weight)
    assert built.mode_limit in {*expected["modes"], *ACROSS_THE_LINE.get(name, ())}
    assert (built.eta_limit is None) <= (Mode.SS in expected["modes"])


def test_arches_cover_the_map() -> None:
    def modes(names: list[str]) -> set[str]:
        return {mode for name in names for mode in SAID[name]["expect"][0]["modes"]}

    arches = [EVERY[name].maker.shape for name in ARCHES]
    assert {arch.weight for arch in arches} == {"centreline", "sector"}
    assert {arch.voussoirs % 2 for arch in arches} == {0, 1}
    quick = [name for name in ARCHES if SAID[name].get("quick")]
    assert 10 <= len(quick) < len(ARCHES)
    assert modes(ARCHES) == set(Mode)
    assert modes(quick) >= set(Mode) - {Mode.R}


def test_a_file_of_tables_is_still_read(tmp_path: Path) -> None:
    """As files of arches were written before they were structure files."""
    path = tmp_path / "scene.toml"
    path.write_text(
        'title = "A"\nsource = "none"\n[arch]\nhalf_angle_deg = 90\nvoussoirs = 9\n'
        "eta = 0.12\n[contact]\nmu = inf\n[gravity]\nlean_deg = 2\n"
        '[expect]\nmodes = ["rrr"]\neta = 0.1\n'
    )
    problem = load(path)
    assert problem.mu == math.inf
    assert math.atan2(problem.gravity[2], -problem.gravity[1]) == pytest.approx(math.radians(2))
    arch = problem.maker.shape
    assert (arch.half_angle, arch.eta, arch.voussoirs) == (math.pi / 2, 0.12, 9)
    assert (arch.weight, arch.radius, arch.specific_weight) == ("centreline", 1.0, 20_000.0)
    path.write_text(
        'title = "A"\nsource = "none"\n[arch]\nspan_m = 8\nrise_m = 3\nvoussoirs = 31\n'
        "unit_weight_kN_per_m3 = 22\n[contact]\nfriction_angle_deg = 35\n"
    )
    told = answered("check", path, code=1)["arch"]
    assert told["eta"] == pytest.approx(0.99 * told["eta_limit"], rel=1e-14)
    for wrong in ("mu = 0.7", 'mu = "x"'):
        path.write_text(f"{path.read_text()}{wrong}\n")
        refused("check", path)
