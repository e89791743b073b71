"""Pictures of a first visit to the explorer, six clicks long: `python docs/explorer.py`."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from blocksim.view.explorer import explorer_page

OUT = Path(__file__).parent / "explorer"
SIZE = {"width": 1120, "height": 780}


def visit(page: Any) -> None:
    """Make six clicks, and keep what is seen after the second, the fourth and the last."""
    page.click("#map", position={"x": 330, "y": 330})
    page.click("#scrub", position={"x": 330, "y": 10})
    _keep(page, "1-an-arch-falls")
    page.click("#to-own")
    page.click("#load", position={"x": 21, "y": 10})
    _keep(page, "2-a-portal-bears-a-load")
    page.click("#load", position={"x": 38, "y": 10})
    page.click("#fall", position={"x": 400, "y": 10})
    _keep(page, "3-a-larger-one-brings-it-down")


def _keep(page: Any, name: str) -> None:
    page.mouse.wheel(0, -1000)
    page.wait_for_timeout(300)
    page.screenshot(path=OUT / f"{name}.png")


def main() -> None:
    """Open the page in Chromium and take the pictures."""
    OUT.mkdir(exist_ok=True)
    chromium = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as engine:
        file = Path(folder) / "map.html"
        file.write_text(explorer_page(), encoding="utf-8")
        browser = engine.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport=SIZE, reduced_motion="reduce")
        page.goto(file.as_uri())
        visit(page)
        browser.close()


if __name__ == "__main__":
    main()
