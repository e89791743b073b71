"""The pages as a site: built without a broken link, drawn in Chromium without the network."""

import os
import re
import subprocess
import sys
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from windows import new_page, wait_until

pytest.importorskip("mkdocs", reason="the extra docs is not installed")
ROOT = Path(__file__).parent.parent
SEEN = (
    "index", "theory/arch", "guide/formats", "methods/limits", "validation", "api", "examples",
)  # fmt: skip


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


def is_dark(page: Any) -> bool:
    """Tell whether its ground is, of which scripts decide that go on once it is loaded."""
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    return sum(int(part) for part in ground.strip("rgba()").split(",")[:3]) < 200


@pytest.mark.parametrize(
    ("widths", "schemes", "names"),
    [
        # Formulas, tables, code and pictures.
        ((390, 1280), ("dark", "light"), SEEN[1::2]),
        *(
            pytest.param(widths, schemes, SEEN, marks=pytest.mark.long)
            for widths in ((390, 1280), (1280, 390))
            for schemes in (("dark", "light"), ("light", "dark"))
        ),
    ],
)
def test_pages_fit_the_screen_and_ask_nothing_of_the_network(
    site: Path,
    browser: Any,
    widths: tuple[int, int],
    schemes: tuple[str, str],
    names: tuple[str, ...],
) -> None:
    """Each in a window of one width and then of the other, in one of the schemes by turns."""
    pages = {each: new_page(browser, color_scheme=each) for each in schemes}
    asked: list[str] = []
    for page in pages.values():
        page.on("request", lambda request: asked.append(request.url))
    for name, (scheme, page) in zip(names, cycle(pages.items())):
        page.set_viewport_size({"width": widths[0], "height": 800})
        page.goto(f"{(site / name).as_uri()}.html")
        for width in widths:
            page.set_viewport_size({"width": width, "height": 800})
            assert page.evaluate("document.documentElement.scrollWidth") <= width, name
        broken = "[...document.images].filter(i => i.complete && !i.naturalWidth).length"
        assert page.evaluate(broken) == 0, name
        assert page.locator("h1").count() == 1, name
        wait_until(page, lambda page=page, scheme=scheme: is_dark(page) == (scheme == "dark"))
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    for page in pages.values():
        page.context.close()
