"""The map explorer, opened in a browser."""

import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from running import ran
from windows import Windows


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("explorer")
    row = {
        "method": "pymunk", "weight": "centreline", "blocks": 27, "mode": "rrr",
        "modes_published": "rrr",
        "miss": "", "low": 0.106, "high": 0.107, "half_angle_deg": 90.0, "mu": 0.7,
    }  # fmt: skip
    rows = [
        {**row, "structure": "semicircle"},
        {**row, "structure": "unbounded", "mu": "inf", "mode": None, "miss": "mode"},
        {**row, "structure": "much", "mu": 10.0, "low": 0.85, "high": 0.86},
        {**row, "structure": "sector", "weight": "sector", "half_angle_deg": 120.0,
         "low": 0.3, "high": 0.31, "mu": 1.5},
    ]  # fmt: skip
    results = folder / "validate.json"
    results.write_text(json.dumps({"rows": rows}), encoding="utf-8")
    ran("map", "--out", "map.html", "--results", "validate.json", cwd=folder)
    return (folder / "map.html").as_uri()


Open = Callable[..., Any]


@pytest.fixture
def open_page(windows: Windows, address: str) -> Iterator[Open]:
    """Open the page in windows; whatever it complains about fails the test."""

    def open_it(width: int = 1280, height: int = 800, **options: object) -> Any:
        return windows.open(address, width, height, **options)

    yield open_it
    assert windows.wrong(address) == []


@pytest.fixture(scope="module")
def one_page(browser: Any, address: str) -> Iterator[Any]:
    """One for all tests of a file, which only ask what its functions return."""
    windows = Windows(browser)
    yield windows.open(address, 1280, 800)
    assert windows.wrong(address) == []


@pytest.fixture
def page(open_page: Open) -> Any:
    return open_page()
