"""Shipped arches say what theory says; files of arches as they were once are read."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from arches import least
from running import answered, inside

from blocksim import Mode, load
from blocksim.kinds.files import shipped_structures
from blocksim.kinds.loading import Known, load_known
from blocksim.studies.validate import structures

EVERY = {name: load_known(name) for name in shipped_structures()}
ARCHES = {name: known for name, known in EVERY.items() if known.expect[0].modes}
LEANING = {
    name: known
    for name, known in EVERY.items()
    if not (known.problem.in_space or known.problem.is_planar)
}
ACROSS_THE_LINE = {"fig20_junction_point": {Mode.RRS}, "fig25_low_overturning_152": {Mode.RRR}}
"""Where a region ends, voussoirs show the mode of the next: they see a hinge half a joint
spacing off, here farther than the region is wide."""


@pytest.mark.parametrize("known", LEANING.values(), ids=LEANING)
def test_leaning_arches_claim_what_statics_says(known: Known) -> None:
    """A rigid body on its springings overturns as the weight leaves their depth."""
    problem, arch = known.problem, known.problem.maker.shape
    height = np.mean([block.centre[1] for block in arch.assembly().blocks])
    height -= arch.radius * math.cos(arch.half_angle)
    slope = problem.gravity[2] / -problem.gravity[1]
    assert problem.mu > slope
    falls = slope > arch.depth / 2 / height
    assert known.expect[0].verdict == ("collapses" if falls else "stands")


def test_a_lean_takes_the_place_of_another() -> None:
    """So it does under another gravity: its strength stays."""
    upright = ARCHES["semicircle"].problem.under(1.62)
    twice = upright.leaning(0.5).leaning(0.2)
    assert twice.gravity == pytest.approx(upright.leaning(0.2).gravity, rel=1e-15)
    assert np.linalg.norm(twice.gravity) == pytest.approx(1.62 / 9.81, rel=1e-15)


@pytest.mark.parametrize("known", ARCHES.values(), ids=ARCHES)
def test_shipped_arches_agree_with_theory(known: Known) -> None:
    problem, (expected,) = known.problem, known.expect
    assert problem.title
    assert problem.source
    arch = problem.maker.shape
    found = least(arch.half_angle, problem.mu, weight=arch.weight)
    if expected.eta is None:
        assert found.eta_theory is None
    else:
        assert found.eta_theory == pytest.approx(expected.eta, rel=1e-12)
    modes = {Mode(each) for each in expected.modes}
    assert modes <= set(found.modes_theory)
    # What ties beyond the caption is its line's other mode; away from lines, nothing.
    assert len(modes) > 1 or set(found.modes_theory) == modes


@pytest.mark.parametrize("known", ARCHES.values(), ids=ARCHES)
def test_shipped_voussoirs_show_a_published_mode(known: Known) -> None:
    arch, (expected,) = known.problem.maker.shape, known.expect
    built = least(arch.half_angle, known.problem.mu, arch.voussoirs, arch.weight)
    assert built.mode_limit in {*expected.modes, *ACROSS_THE_LINE.get(known.name, ())}
    assert (built.eta_limit is None) <= (Mode.SS in expected.modes)


def test_arches_cover_the_map() -> None:
    assert {mode for known in ARCHES.values() for mode in known.expect[0].modes} == set(Mode)
    arches = [known.problem.maker.shape for known in ARCHES.values()]
    assert {arch.weight for arch in arches} == {"centreline", "sector"}
    assert {arch.voussoirs % 2 for arch in arches} == {0, 1}
    quick = {known.name for known in structures(quick=True)} & ARCHES.keys()
    assert 10 <= len(quick) < len(ARCHES)
    modes = {mode for name in quick for mode in ARCHES[name].expect[0].modes}
    assert modes >= set(Mode) - {Mode.R}


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
    told = answered("check", str(path), code=1)["arch"]
    assert told["eta"] == pytest.approx(0.99 * told["eta_limit"], rel=1e-14)
    for wrong in ("mu = 0.7", 'mu = "x"'):
        path.write_text(f"{path.read_text()}{wrong}\n")
        done = inside("check", str(path))
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
