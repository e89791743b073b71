"""The report in a real browser: it plays, fits narrow windows, and complains of nothing."""

from __future__ import annotations

from collections.abc import Generator

import pytest
from report_rows import rows

from blocksim.report.page import report_page

playwright = pytest.importorskip("playwright.sync_api")
MAP = b'<svg xmlns="http://www.w3.org/2000/svg" width="90" height="60"/>'


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(report_page(rows(), MAP, {"blocksim": "0.1"}), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def complaints() -> list[str]:
    return []


@pytest.fixture
def page(browser, address: str, complaints: list[str]) -> Generator:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on(
        "request",
        lambda request: (
            request.url.startswith(("file:", "data:")) or complaints.append(request.url)
        ),
    )
    page.goto(address)
    yield page
    context.close()


def test_the_slider_moves_the_blocks(page, complaints: list[str]) -> None:
    figure = page.locator(".motion").first
    piece = figure.locator(".piece").nth(5)
    moved = piece.get_attribute("transform")
    slider = figure.locator("input")
    slider.focus()
    slider.press("Home")
    assert piece.get_attribute("transform").startswith("translate(0 0) rotate(0 ")
    slider.press("End")
    assert piece.get_attribute("transform") == moved
    # Half of the way is half of the motion, which is straight down here.
    slider.fill("0.5")
    assert piece.get_attribute("transform").startswith("translate(0 6.5) rotate(0 ")
    assert complaints == []


def test_it_plays_to_the_end_and_can_be_stopped(page, complaints: list[str]) -> None:
    figure = page.locator(".motion").first
    button, slider = figure.locator("button"), figure.locator("input")
    button.focus()
    page.keyboard.press("Enter")
    page.wait_for_timeout(300)
    assert button.inner_text() == "Stop"
    page.keyboard.press("Enter")
    stopped = float(slider.input_value())
    assert 0 < stopped < 1
    page.wait_for_timeout(200)
    assert float(slider.input_value()) == stopped
    page.keyboard.press("Enter")
    playwright.expect(slider).to_have_value("1", timeout=10_000)
    playwright.expect(button).to_have_text("Play")
    assert complaints == []


@pytest.mark.parametrize("width", [375, 768, 1280])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_the_window(page, width: int, scheme: str) -> None:
    page.set_viewport_size({"width": width, "height": 800})
    page.emulate_media(color_scheme=scheme)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    paper, ink = page.evaluate(
        "(() => { const look = getComputedStyle(document.body);"
        " return [look.backgroundColor, look.color]; })()"
    )
    brightness = [sum(map(int, each[4:-1].split(","))) for each in (paper, ink)]
    assert (brightness[0] > brightness[1]) is (scheme == "light")
    for button in page.locator("button").all():
        assert button.bounding_box()["height"] >= 24


def test_it_is_light_on_paper(page) -> None:
    page.emulate_media(media="print", color_scheme="dark")
    look = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(look) == "rgb(255, 255, 255)"
    assert not page.locator(".controls").first.is_visible()
