"""Validation rows say what was found, mark misses as misses, and are written whole."""

from __future__ import annotations

import csv
import importlib
import json
from dataclasses import replace
from pathlib import Path

import pytest

from blocksim import InputError, Mode, Verdict
from blocksim.kinds.scenarios import load_scenario
from blocksim.report.tables import write_results
from blocksim.studies.agreement import disagreements
from blocksim.studies.validate import scenarios, validate, validate_one
from tests.report_rows import ROW


def test_quick_scenarios_are_spread_over_the_map() -> None:
    quick = scenarios(quick=True)
    modes = {mode for scenario in quick for mode in scenario.expected_modes}
    assert len(quick) >= 10
    assert modes >= {Mode.RRR, Mode.SS, Mode.SRR, Mode.RRS, Mode.RSR, Mode.RS}
    assert len(scenarios(quick=False)) > len(quick)


def test_rows_agree_with_limit_analysis_and_are_written(tmp_path: Path) -> None:
    chosen = [load_scenario(name) for name in ("semicircle", "semicircle_sliding")]
    rows = validate(chosen, ("pymunk",), workers=1)
    first, second = rows
    assert abs(first.error or 1) < 0.002
    assert (first.below, first.above) == (Verdict.COLLAPSES, Verdict.STANDS)
    assert first.mode_observed is Mode.RRR
    assert second.eta_high is None
    assert second.mode_observed is Mode.SS
    assert [row.miss for row in rows] == ["", ""]

    write_results(rows, tmp_path / "deep" / "out")
    folder = tmp_path / "deep" / "out"
    written = {path.name for path in folder.iterdir()}
    names = {"report.html", "validate.json", "validate.csv", "map.png", "map.svg"}
    assert written == names
    document = json.loads((folder / "validate.json").read_text(), parse_constant=pytest.fail)
    assert [row["scenario"] for row in document["rows"]] == ["semicircle", "semicircle_sliding"]
    assert document["machine"]["pymunk"]
    with (folder / "validate.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert lines[0]["eta_limit"] == str(rows[0].eta_limit)
    assert lines[1]["eta_high"] == ""


def test_a_wrong_engine_would_be_a_miss(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shift the exact value by 1 %: the row must say so."""
    module = importlib.import_module("blocksim.kinds.archoffers")
    real = module.limit.least_thickness

    def shifted(*arguments: object) -> object:
        state = real(*arguments)
        return replace(state, eta=state.eta * 1.01, mode=Mode.SRR)

    monkeypatch.setattr(module.limit, "least_thickness", shifted)
    row = validate_one(load_scenario("semicircle"), "pymunk")
    assert "error -1.0" in row.miss or "error -0.9" in row.miss
    assert "mode rrr, limit says srr" in row.miss


def test_modes_that_coincide_on_a_line_of_the_map_are_both_right() -> None:
    """Fig. 22 prints both modes; where friction is 1e-4 more theory has but one of them.

    In a wide bracket `direct` sees rrr at the lower end; at the limit they are rrs.
    """
    scenario = load_scenario("fig22_first_sliding_149")
    on_it = validate_one(scenario, "direct", tol=4e-3)
    assert (on_it.mode_observed, on_it.mode_limit) == (Mode.RRR, Mode.RRS)
    assert on_it.miss == ""
    assert on_it.note.startswith("on a line of the map")
    beside = validate_one(
        replace(scenario, given={**scenario.given, "friction": 1.0001 * scenario.mu}),
        "direct",
        tol=4e-3,
    )
    assert (beside.mode_observed, beside.mode_limit) == (Mode.RRR, Mode.RRS)
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
    other = replace(one, engine="pybullet", mode_observed=seen)
    assert len(disagreements([one, other])) == places


def test_results_in_a_folder_that_cannot_be_are_one_line() -> None:
    with pytest.raises(InputError, match="writable folder"):
        write_results([], Path("/proc/none"))
