"""The studies of theory and of the sector weight run, and hold their numbers."""

from pathlib import Path

import pytest
from test_analysis import study


@pytest.mark.long
def test_sector_map(tmp_path: Path) -> None:
    result = study("sector_map").main(tmp_path, quick=True)
    assert result["largest_difference"] <= 1e-7
    assert (tmp_path / "sector_map.png").stat().st_size > 0


@pytest.mark.long
def test_theory_against_limit(tmp_path: Path) -> None:
    result = study("theory_against_limit").main(tmp_path, quick=True)
    assert result["largest_difference"] <= 1e-6
    assert result["standing_differs"] == 0
    assert result["modes_differ"] == 0
