"""Every study runs, and its headline numbers hold."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

STUDIES = Path(__file__).parent.parent / "analysis"


def study(name: str) -> ModuleType:
    """Import a study from the checkout; studies are no part of the package."""
    spec = importlib.util.spec_from_file_location(f"analysis_{name}", STUDIES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_random_arches_have_no_false_answer_and_small_error(tmp_path: Path) -> None:
    result = study("random_arches").main(tmp_path, quick=True)
    assert result.arches == 4
    assert result.false == 0
    assert result.worst_error < 0.002
    assert (tmp_path / "random_arches.png").stat().st_size > 0


def test_what_limits_pybullet(tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    result = study("pybullet_settings").main(tmp_path, quick=True)
    as_built = result.accelerations["as built"]
    # Losing contacts or starting apart is not a matter of sweeps.
    assert as_built["thin"] < 1e-3 < result.accelerations["breaking 0.02"]["thin"]
    assert as_built["semicircle"] < 3e-3 < result.accelerations["slop 5e-5"]["semicircle"]
    assert result.moved[0.1] < result.moved[0.01] / 30


def test_every_method_is_charted(tmp_path: Path) -> None:
    """What the figures are depends on the machine; `test_workprec` has the errors."""
    result = study("speed_accuracy").main(tmp_path, quick=True)
    assert len(result.over_pymunk) == 2
    assert (tmp_path / "chart.png").stat().st_size > 0


def test_where_engines_stop_working(tmp_path: Path) -> None:
    """By the rules' settings nothing is wrong or open; with far too few sweeps it is open."""
    rows = study("stability").main(tmp_path, quick=True, engines=("direct", "pymunk"))
    assert {row.part for row in rows} == {
        "released",
        "held",
        "lines",
        "energy",
        "away",
        "lasting",
    }
    ruled = [
        row
        for row in rows
        if row.at.get("step", 1) == row.at.get("sweeps", 1) == 1
        and row.at.get("allowed") in (None, row.at.get("rule"))
        and row.at.get("distance", 1) == 1
    ]
    assert {row.outcome for row in ruled} == {"right"}
    few = [row for row in rows if row.engine == "pymunk" and row.at.get("allowed") == 3]
    assert {row.outcome for row in few} == {"undecided"}
    assert (tmp_path / "stability.png").stat().st_size > 0


def test_every_study_is_listed_with_its_claim() -> None:
    listed = (STUDIES / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in STUDIES.glob("*.py") if path.name not in listed] == []


def test_random_arches_by_direct_are_exact(tmp_path: Path) -> None:
    result = study("direct_arches").main(tmp_path, quick=True)
    assert result.arches == result.confirmed == 3
    assert result.false == result.unsure == 0
    assert result.worst_error < 1e-8
    assert (tmp_path / "direct_arches.png").stat().st_size > 0
