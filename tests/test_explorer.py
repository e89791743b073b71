"""The map explorer as a file: complete in itself, its data as computed, results as written."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from running import ran

from blocksim import theory
from blocksim.view.explorer import explorer_page, read_results
from blocksim.view.mapshapes import LARGEST_MU, map_shapes

ROW = {
    "structure": "semicircle",
    "modes_published": "rrr",
    "half_angle_deg": 90.0,
    "method": "pymunk",
    "mu": 0.7,
    "blocks": 27,
    "weight": "centreline",
    "low": 0.1066,
    "high": 0.1068,
    "mode": "rrr",
    "miss": "",
}


def embedded(page: str) -> dict:
    script = r'<script type="application/json" id="data">(.*?)</script>'
    found = re.search(script, page, re.DOTALL)
    assert found
    return json.loads(found[1])


def written(folder: Path, *rows: dict) -> Path:
    path = folder / "validate.json"
    path.write_text(json.dumps({"rows": [{**ROW, **row} for row in rows]}), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def page() -> str:
    return explorer_page()


def test_the_page_is_complete_in_itself(page: str) -> None:
    # The text to embed the page names where the page itself is.
    assert not re.search(r'(src|href)="(?!data:|#|\$\{location\.href)', page)
    assert not re.search(r"@import|url\((?!#)|fetch\(|XMLHttpRequest|import\(", page)
    # The one address is the name of SVG's elements, which nothing asks for.
    assert set(re.findall(r"https?://[^\"'\s]*", page)) == {"http://www.w3.org/2000/svg"}
    assert "default-src 'none'" in page
    assert "{{" not in page
    assert explorer_page() == page


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_shapes_are_the_regions_of_theory(weight: str) -> None:
    """In the middle of each region, between its sampled edges, theory names its mode."""
    for part in map_shapes(weight).regions:
        places = np.flatnonzero(part.top - part.bottom > 2e-3)[::60]
        middle = (part.bottom[places] + part.top[places]) / 2
        found = theory.at_points(middle, part.mu[places], weight).regions
        assert set(found) == {(part.mode,)}


@pytest.mark.parametrize("weight", ["centreline", "sector"])
def test_regions_cover_the_map_without_overlap(weight: str) -> None:
    def area(part: object) -> float:
        return float(np.trapezoid(part.top - part.bottom, part.mu))

    shapes = map_shapes(weight)
    assert all((part.top >= part.bottom).all() for part in shapes.regions)
    assert sum(map(area, shapes.regions)) == pytest.approx(2 * LARGEST_MU, rel=2e-3)
    # The line of first sliding leaves the map at its right edge.
    assert shapes.lines["first"].mu[-1] == pytest.approx(LARGEST_MU, rel=1e-9)


def test_results_as_validate_writes_them(tmp_path: Path) -> None:
    rows = read_results(
        written(
            tmp_path,
            {},
            {"mu": "inf", "mode": None, "miss": "mode unnamed"},
            {"low": 2.0, "high": None},
            {"low": None},
        )
    )
    assert [row["eta"] for row in rows] == [pytest.approx(0.1067), pytest.approx(0.1067), 2.0]
    assert [row["mu"] for row in rows] == [0.7, None, 0.7]
    assert [row["mode"] for row in rows] == ["rrr", None, "rrr"]
    assert [row["nothing_stands"] for row in rows] == [False, False, True]
    data = embedded(explorer_page(rows, "validate.json"))
    assert len(data["results"]) == 3


def test_names_from_elsewhere_are_text_never_markup(tmp_path: Path) -> None:
    evil = "</script><script>alert(1)</script>"
    page = explorer_page(read_results(written(tmp_path, {"structure": evil})), evil)
    assert evil not in page
    assert embedded(page)["results"][0]["scenario"] == evil


def test_the_command_writes_the_page_whole(tmp_path: Path) -> None:
    out = tmp_path / "map.html"
    results = written(tmp_path, {})
    ran("map", "--out", out, "--results", results)
    assert out.read_text(encoding="utf-8") == explorer_page(read_results(results), str(results))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.html", "validate.json"]
