"""The map explorer, opened in a browser."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from blocksim.view.explorer import explorer_page, read_results


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("explorer")
    row = {
        "engine": "pymunk", "weight": "centreline", "voussoirs": 27, "mode_observed": "rrr",
        "miss": "", "eta_low": 0.106, "eta_high": 0.107, "half_angle_deg": 90.0, "mu": 0.7,
    }  # fmt: skip
    rows = [
        {**row, "scenario": "semicircle"},
        {**row, "scenario": "unbounded", "mu": "inf", "mode_observed": None, "miss": "mode"},
        {**row, "scenario": "much", "mu": 10.0, "eta_low": 0.85, "eta_high": 0.86},
        {**row, "scenario": "sector", "weight": "sector", "half_angle_deg": 120.0,
         "eta_low": 0.3, "eta_high": 0.31, "mu": 1.5},
    ]  # fmt: skip
    results = folder / "validate.json"
    results.write_text(json.dumps({"rows": rows}), encoding="utf-8")
    page = folder / "map.html"
    page.write_text(explorer_page(read_results(results), "validate.json"), encoding="utf-8")
    return page.as_uri()


Open = Callable[..., Any]


def opened(browser: Any, address: str) -> Iterator[Open]:
    """Open the page in windows of their own; whatever it complains about fails the test.

    Still, if nothing else is asked for: else the browser draws all the time.
    """
    contexts, complaints = [], []

    def open_it(width: int = 1280, height: int = 800, **options: object) -> Any:
        options = {"reduced_motion": "reduce", **options}
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: complaints.append(request.url))
        page.goto(address)
        return page

    yield open_it
    for context in contexts:
        context.close()
    assert [line for line in complaints if line not in {address, "data:,"}] == []


@pytest.fixture
def open_page(browser: Any, address: str) -> Iterator[Open]:
    yield from opened(browser, address)


@pytest.fixture(scope="module")
def one_page(browser: Any, address: str) -> Iterator[Any]:
    """One for all tests of a file, which only ask what its functions return."""
    for open_it in opened(browser, address):
        yield open_it()


@pytest.fixture
def page(open_page: Open) -> Any:
    return open_page()
