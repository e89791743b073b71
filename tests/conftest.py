"""One profile for all properties, and what several files of tests compare with."""

import gc
import os
import shutil
import sys
from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from running import ENGINES
from sweeps import SIMULATED, Rows, rows_of, swept
from windows import PATIENCE, Windows

from blocksim import MissingPart

# Compiled once, not in every run and by every process that tests start.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# The same examples in every run, time not asserted, nor how long a machine that is busy takes
# to draw them; tests of numbers that cost little ask for more.
settings.register_profile(
    "blocksim",
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=15,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("blocksim")


# What is loaded when all tests are collected stays to the end: the collector of garbage need
# not go through it, neither while it grows nor later.
gc.disable()


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000, 20, 20)


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call() -> Generator[None, object, object]:
    """Skip what asks an engine that is not here: pybullet has no wheels for newer Pythons."""
    try:
        return (yield)
    except MissingPart as missing:
        if missing.part in ENGINES:
            pytest.skip(str(missing))
        raise


@pytest.fixture(scope="session")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    """Rows of `SIMULATED` as one sweep writes them."""
    folder = tmp_path_factory.mktemp("uninterrupted")
    swept(SIMULATED, folder)
    rows = rows_of(folder)
    assert len(rows) == 40
    assert all(row["error"] is None for row in rows.values())
    return rows


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sweep without other processes: they take seconds to start, and have their own tests."""
    monkeypatch.setattr(
        "blocksim.common.processes.ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1)
    )


@pytest.fixture(params=["direct", "pymunk", "pybullet"])
def engine(request: pytest.FixtureRequest) -> str:
    """Engines that tell what joints carry."""
    return request.param


@pytest.fixture
def wide_window(monkeypatch: pytest.MonkeyPatch) -> None:
    """No line of what a command says within this process is folded."""
    monkeypatch.setenv("COLUMNS", "10000")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium, where it is installed; without windows it takes two thirds of the time."""
    playwright = pytest.importorskip("playwright.sync_api")
    names = (
        "chromium-headless-shell",
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    )
    chromium = next((path for path in map(shutil.which, names) if path), None)
    if chromium is None:
        pytest.skip("no Chromium here (apt-get install chromium-headless-shell)")
    playwright.expect.set_options(timeout=1000 * PATIENCE)
    with playwright.sync_playwright() as engine:
        # Chromium's sandbox refuses to work for root.
        arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
        found = engine.chromium.launch(
            executable_path=chromium, args=arguments, timeout=1000 * PATIENCE
        )
        yield found
        found.close()


@pytest.fixture(scope="session")
def shared_windows(browser: Any) -> Windows:
    return Windows(browser)


@pytest.fixture
def windows(shared_windows: Windows) -> Iterator[Windows]:
    """Windows of the browser, left when the test ends."""
    yield shared_windows
    shared_windows.leave()
