"""The pages as a site: built without a broken link, drawn in Chromium without the network."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock

pytest.importorskip("mkdocs", reason="the extra docs is not installed")
ROOT = Path(__file__).parent.parent
SEEN = (
    "index",
    "theory/arch",
    "guide/formats",
    "methods/limits",
    "validation",
    "api",
    "examples",
)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    own = tmp_path_factory.getbasetemp()
    # Built once for all workers, whose folders lie beside each other.
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "site"
    with FileLock(f"{folder}.lock"):
        if not folder.exists():
            build(folder)
    return folder


def build(folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_links_are_of_the_site_and_formulas_are_drawn(site: Path) -> None:
    home = (site / "index.html").read_text(encoding="utf-8")
    assert 'href="tutorial/arch.html"' in home
    assert 'src="figures/engines.png"' in home
    assert ".venv/bin/blocksim" in home
    theory = (site / "theory" / "arch.html").read_text(encoding="utf-8")
    assert theory.count('class="formula"') > 15
    assert "<mfrac>" in theory
    assert "arithmatex" not in theory
    for number in range(1, 17):
        assert f"<span>({number})</span>" in theory
    api = (site / "api.html").read_text(encoding="utf-8")
    assert "Half-angle of embrace alpha" in api
    # Not broken after a dash; blocks of code to be copied stay as they are.
    paper = (site / "theory" / "paper.html").read_text(encoding="utf-8")
    assert '<code><span class="option">--weight</span> sector</code>' in paper
    assert "map --phi --out map.png" in re.sub("<[^>]+>", "", paper)


@pytest.mark.parametrize(
    ("width", "scheme"),
    [
        (1280, "light"),
        (390, "dark"),
        pytest.param(1280, "dark", marks=pytest.mark.long),
        pytest.param(390, "light", marks=pytest.mark.long),
    ],
)
def test_pages_fit_the_screen_and_ask_nothing_of_the_network(
    site: Path, browser: Any, width: int, scheme: str
) -> None:
    context = browser.new_context(viewport={"width": width, "height": 800}, color_scheme=scheme)
    page = context.new_page()
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    grounds = set()
    for name in SEEN:
        page.goto(f"{(site / name).as_uri()}.html")
        assert page.evaluate("document.documentElement.scrollWidth") <= width, name
        broken = "[...document.images].filter(i => i.complete && !i.naturalWidth).length"
        assert page.evaluate(broken) == 0, name
        assert page.locator("h1").count() == 1, name
        grounds.add(page.evaluate("getComputedStyle(document.body).backgroundColor"))
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    (ground,) = grounds
    level = sum(int(part) for part in ground.strip("rgba()").split(",")[:3])
    assert (level < 200) == (scheme == "dark")
    context.close()
