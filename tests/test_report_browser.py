"""The report in a real browser: it plays, fits narrow windows, and complains of nothing."""

from dataclasses import replace
from itertools import product

import pytest
from matplotlib.colors import to_rgb
from report_rows import ROW, rows
from vision import shown, shown_contrast
from windows import Windows, hold_clock, tick, wait_until

from blocksim import Mode
from blocksim.kinds.loading import load_known
from blocksim.report.tables import write_results
from blocksim.studies.validate import validate
from blocksim.view.style import MODES

playwright = pytest.importorskip("playwright.sync_api")

LONG = replace(
    ROW,
    structure="fig17_low_sliding_rotational_125",
    modes_published=(Mode.RRR, Mode.SRR, Mode.RRS, Mode.SS),
    published="0.0310704",
    expected=0.0309421,
    low=0.03092123,
    high=0.03095212,
)
"""As wide as rows of the shipped scenarios are."""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("report")
    known = [load_known("oppenheim_7"), load_known("box2d_tilted_stack")]
    built = validate(known, ("direct",), workers=1)
    write_results([*rows(), LONG, replace(LONG, method="pybullet"), *built], folder)
    return (folder / "report.html").as_uri()


@pytest.fixture
def page(windows: Windows, address: str):
    return windows.open(address, 1280, 900, reduced_motion="no-preference")


@pytest.mark.parametrize("case", ["#case-1", "#case-4"])
def test_the_slider_moves_the_blocks(page, windows: Windows, case: str) -> None:
    """Of an arch, and of a structure."""
    figure = page.locator(f"{case} .motion").first
    piece, slider = figure.locator(".piece").nth(5), figure.locator("input")
    moved = piece.get_attribute("transform")
    slider.focus()
    slider.press("Home")
    assert piece.get_attribute("transform").startswith("translate(0 0) rotate(0 ")
    slider.press("End")
    assert piece.get_attribute("transform") == moved
    if case == "#case-1":
        # Half of the way is half of the motion, which is straight down here.
        slider.fill("0.5")
        assert piece.get_attribute("transform").startswith("translate(0 6.5) rotate(0 ")
    assert windows.wrong("file:") == []


def test_it_plays_to_the_end_and_can_be_stopped(page, windows: Windows) -> None:
    figure = page.locator(".motion").first
    button, slider = figure.locator("button"), figure.locator("input")
    hold_clock(page)

    def seen(*now: float) -> tuple[str, float]:
        for each in now:
            tick(page, each)
        return button.inner_text(), float(slider.input_value())

    button.focus()
    page.keyboard.press("Enter")
    # It stands at its end before, and takes three seconds.
    assert seen(1000) == ("Stop", 0)
    assert seen(2500) == ("Stop", 0.5)
    page.keyboard.press("Enter")
    assert seen(2600, 2700) == ("Play", 0.5)
    page.keyboard.press("Enter")
    assert seen(5000) == ("Stop", 0.5)
    assert seen(6200) == ("Stop", 0.9)
    assert seen(6600, 6700) == ("Play", 1)
    assert windows.wrong("file:") == []


def test_it_fits_the_window(page) -> None:
    for width, scheme in product((375, 768, 1280), ("light", "dark")):
        page.set_viewport_size({"width": width, "height": 800})
        page.emulate_media(color_scheme=scheme)
        assert page.evaluate("document.documentElement.scrollWidth") == width
        paper, ink = page.evaluate(
            "(() => { const look = getComputedStyle(document.body);"
            " return [look.backgroundColor, look.color]; })()"
        )
        brightness = [sum(map(int, each[4:-1].split(","))) for each in (paper, ink)]
        assert (brightness[0] > brightness[1]) is (scheme == "light")
        heights = """() => [...document.querySelectorAll("button")].map(
          (button) => button.getBoundingClientRect().height)"""
        assert min(page.evaluate(heights)) >= 24


def test_a_structure_can_be_seen(page, windows: Windows) -> None:
    figure = page.locator("#case-4 .motion")
    figure.locator("input").fill("1")
    # Stone, support and the arrow of the load all stand out from the card.
    look = "getComputedStyle(document.querySelector('article')).backgroundColor"
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        shares = [*lightness(page, "#case-4 .stone")[:1]]
        shares += lightness(page, "#case-4 .footing")[:1]
        ground = sum(map(int, page.evaluate(look)[4:-1].split(","))) / 765
        assert min(abs(share - ground) for share in shares) > 0.1
    # Nothing drawn is cut off: the svg holds all its blocks and its arrow.
    over = figure.evaluate("""(figure) => {
      const frame = figure.querySelector("svg").getBoundingClientRect();
      return [...figure.querySelectorAll(".piece, .arrow, .footing")].filter((drawn) => {
        const box = drawn.getBoundingClientRect();
        return box.left < frame.left || box.right > frame.right
          || box.top < frame.top || box.bottom > frame.bottom; }).length; }""")
    assert over == 0
    assert windows.wrong("file:") == []


def test_it_is_light_on_paper(page) -> None:
    page.emulate_media(media="print", color_scheme="dark")
    look = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(look) == "rgb(255, 255, 255)"
    assert not page.locator(".controls").first.is_visible()


def test_no_column_is_clipped(page) -> None:
    tables = page.locator(".wide:has(table)").all()
    assert len(tables) == 1
    for width, table in product((1280, 1440), tables):
        page.set_viewport_size({"width": width, "height": 900})
        frame = table.bounding_box()
        last = table.locator("thead th").last
        assert last.inner_text() == "agrees"
        box = last.bounding_box()
        assert box["x"] + box["width"] <= frame["x"] + frame["width"]
    assert page.locator(".sideways:visible").count() == 0


def test_a_phone_is_told_what_scrolls(page) -> None:
    page.set_viewport_size({"width": 375, "height": 812})
    hints = page.locator(".sideways")
    for index in range(2):
        playwright.expect(hints.nth(index)).to_be_visible()
        assert "sideways" in hints.nth(index).inner_text()
    page.emulate_media(media="print")
    assert page.locator(".sideways:visible").count() == 0


FILLS = """(selector) => [...document.querySelectorAll(selector)].map((element) =>
  getComputedStyle(element).fill.match(/\\d+/g).slice(0, 3).map(Number))"""


def lightness(page, selector: str) -> list[float]:
    return [sum(colour) / 765 for colour in page.evaluate(FILLS, selector)]


PAPERS, REGIONS = "#patch_1 path, #patch_2 path", "[id^=region] use, [id^=strip] use"


def test_the_map_is_dark_in_the_dark(page) -> None:
    """Paper and regions, and the words on them, by their colours in the browser."""
    for scheme in ("light", "dark"):
        page.emulate_media(media="screen", color_scheme=scheme)
        if scheme == "light":
            # Six modes at finite friction; an arch of unbounded friction adds a strip of two.
            tints = [to_rgb(MODES[mode].tint) for mode in [*Mode, Mode.RRR]]
            seen = page.evaluate(FILLS, REGIONS)
            wanted = [[round(255 * part) for part in tint] for tint in tints]
            assert sorted(seen) == sorted(wanted)
        papers, regions = lightness(page, PAPERS), lightness(page, REGIONS)
        assert (len(papers), len(regions)) == (2, 8)  # paper of the page and of the axes
        words = lightness(page, '[id^="matplotlib.axis"] [id^=text_] use')
        assert len(words) > 10
        if scheme == "light":
            assert min(papers + regions) > 0.8
            assert max(words) < 0.2
        else:
            assert max(papers + regions) < 0.35
            assert min(words) > 0.8
        page.emulate_media(media="print")
        assert min(lightness(page, PAPERS)) == 1


def test_names_of_modes_can_be_read(page) -> None:
    """On ground as light as the page's, by the contrast of words that WCAG asks for."""
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        looks = page.evaluate("""() => [...document.querySelectorAll("td .mode")]
          .map((name) => getComputedStyle(name))
          .map((look) => [look.color, look.backgroundColor])""")
        assert len(looks) > 3
        for ink, ground in looks:
            assert (sum(shown(page, ground)) / 765 > 0.5) is (scheme == "light")
            assert shown_contrast(page, ink, ground) > 4.5


def test_points_of_the_map_lead_to_their_rows(page, windows: Windows) -> None:
    page.locator('.map a[href="#row-3"]').last.click()
    wait_until(page, lambda: page.url.endswith("report.html#row-3"))
    assert len(page.context.pages) == 1
    row = page.locator("#row-3")
    assert "fig17_low_sliding_rotational_125" in row.inner_text()
    playwright.expect(row).to_be_in_viewport()
    assert windows.wrong("file:") == []


def test_the_line_of_thrust_is_gone_when_blocks_have_moved(page) -> None:
    """It belongs to the arch at rest."""
    figure = page.locator(".motion").first
    shown = "e => Number(getComputedStyle(e).opacity)"
    statics, slider = figure.locator(".statics"), figure.locator("input")
    assert statics.locator("polyline").count() > 0
    assert statics.evaluate(shown) == 0
    for share, opacity in (("0", 1), ("0.05", 0.5), ("0.2", 0), ("1", 0)):
        slider.fill(share)
        assert statics.evaluate(shown) == pytest.approx(opacity)
