"""The map explorer in use in a browser."""

import itertools
import math
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np
import pytest
from arches import least as least_of
from matplotlib.colors import to_rgb
from vision import shown_contrast
from windows import hold_clock, settle, tick, wait_until

from blocksim import CircularArch, Mode, check

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

Open = Callable[..., playwright.Page]


def text(page: playwright.Page, name: str) -> str:
    """Words of an element, once what was done is drawn."""
    settle(page)
    return page.locator(name).inner_text()


def verdict(page: playwright.Page) -> str:
    return text(page, "#verdict")


def number(page: playwright.Page, name: str) -> float:
    settle(page)
    return float(page.input_value(f"#{name}-number"))


def look_at(page: playwright.Page, address: str) -> None:
    """Change the part of the address after #, and wait until the page has heard of it."""
    page.evaluate(
        """(address) => new Promise((done) => {
          addEventListener("hashchange", () => done(), { once: true });
          location.hash = address; })""",
        address,
    )
    settle(page)


def set_arch(page: playwright.Page, **values: float) -> None:
    for name, value in values.items():
        page.fill(f"#{name}-number", str(value))
    settle(page)


def place(page: playwright.Page, mu: float, eta: float) -> tuple[float, float]:
    """Where on the screen a point of the map is, from the positions of its ticks."""
    ticks = page.evaluate(
        """() => [...document.querySelectorAll("#map .tick-label")].map((label) => {
          const box = label.getBoundingClientRect();
          return [label.textContent, label.classList.contains("end"),
                  box.x + box.width / 2, box.y + box.height / 2]; })"""
    )
    across = {name: x for name, side, x, _ in ticks if not side}
    up = {name: y for name, side, _, y in ticks if side}
    x = across["∞"] if math.isinf(mu) else np.interp(mu, [0, 4], [across["0"], across["4"]])
    return float(x), float(np.interp(eta, [0, 2], [up["0"], up["2"]]))


def test_one_small_file_that_tells_as_soon_as_it_has_loaded(page: playwright.Page) -> None:
    """What takes time is counted, for a clock would tell of the machine and its other work."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    page.reload()
    assert page.title().startswith("Does the arch stand?")
    assert verdict(page) == "On the verge: the least thickness of the continuous arch"
    assert page.get_attribute("#verdict", "class") == "verdict undecided"
    metrics = session.send("Performance.getMetrics")["metrics"]
    counts = {each["name"]: each["value"] for each in metrics}
    # Laid out 4 to 6 times; each time that something is measured between changes is another.
    assert 0 < counts["LayoutCount"] <= 12
    assert page.evaluate("performance.getEntriesByType('resource').length") == 0
    # The file, without what it draws of itself.
    assert Path(page.url.removeprefix("file://")).stat().st_size < 420_000


def test_sliders_tell_at_once_whether_it_stands_and_why(page: playwright.Page) -> None:
    set_arch(page, alpha=90, mu=0.7, eta=0.12)
    least = least_of(math.pi / 2, 0.7)
    assert verdict(page) == "Stands: 12 % above the least thickness of the continuous arch"
    assert float(text(page, "#continuous-eta")) == pytest.approx(least.eta_theory, rel=1e-5)
    assert float(text(page, "#continuous-h")) == pytest.approx(least.thrust, rel=1e-5)
    assert text(page, "#continuous-r") == f"{math.degrees(least.beta_r):.2f}°"
    page.locator("#eta").focus()
    for _ in range(25):
        page.keyboard.press("ArrowLeft")
    assert verdict(page) == "Collapses: 12 % below the least thickness of the continuous arch"
    assert "mode rrr, purely rotational" in text(page, "#because")
    set_arch(page, mu=0.3)
    said = "Collapses: too little friction for any thickness of the continuous arch"
    assert verdict(page) == said
    assert "nothing stands below μ = 0.3092" in text(page, "#because")
    page.check("#unbounded")
    page.click("#least")
    assert verdict(page) == "On the verge: the least thickness of the continuous arch"
    assert page.get_attribute("#verdict", "class") == "verdict undecided"
    set_arch(page, alpha=165, eta=2)
    said = "Collapses: no thickness of the continuous arch will do, up to η = 2"
    assert verdict(page) == said


@pytest.mark.parametrize(
    ("mu", "eta", "mode"),
    [
        pytest.param(2.0, 0.3, "rrr", marks=pytest.mark.long),
        (math.inf, 1.4, "r"),
        (1.79, 0.963, "rsr"),
        pytest.param(0.6, 0.3, "srr", marks=pytest.mark.long),
        pytest.param(2.5, 0.85, "rrs", marks=pytest.mark.long),
        pytest.param(3.0, 1.4, "rs", marks=pytest.mark.long),
        pytest.param(1.0, 1.5, "ss", marks=pytest.mark.long),
    ],
)
def test_hovering_and_clicking_the_map(
    page: playwright.Page, mu: float, eta: float, mode: str
) -> None:
    page.mouse.move(*place(page, mu, eta))
    tip = text(page, "#tip")
    if mode != "rsr":  # a region of a few pixels
        assert f"\n{mode} " in tip
    assert re.match(r"η [\d.]+  μ ([\d.]+|∞)\n. [\d.]+°  h [\d.e-]+\n", tip)
    page.mouse.click(*place(page, mu, eta))
    assert verdict(page).startswith("On the verge")
    chosen = number(page, "eta")
    assert chosen == pytest.approx(eta, abs=0.01)
    if mode != "rsr":
        assert text(page, "#continuous-mode") == mode
    half_angle = number(page, "alpha")
    friction = math.inf if math.isinf(mu) else number(page, "mu")
    found = (
        least_of(math.radians(half_angle + by), friction).eta_theory for by in (-0.05, 0.05)
    )
    low, high = (each or 2.0 for each in found)
    assert low < chosen < high


def test_the_mechanism_moves_until_paused(open_page: Open) -> None:
    page = open_page(reduced_motion="no-preference")
    assert page.inner_text("#play") == "Pause"
    hold_clock(page)
    page.click("#play")
    page.click("#play")  # it begins anew

    def poses(now: float) -> str:
        tick(page, now)
        return page.evaluate("""() => [...document.querySelectorAll("#arch .stone")].map(
          (stone) => stone.parentNode.getAttribute("transform")).join()""")

    seen = [poses(now) for now in (0, 500, 1000)]
    assert len({*seen}) == 3
    page.click("#play")
    assert page.inner_text("#play") == "Play"
    assert poses(1500) == poses(2000) == seen[-1]
    # An arch that stands does not move.
    page.fill("#eta-number", "0.6")
    tick(page, 2500)
    assert page.locator("#play").is_disabled()


def test_who_prefers_it_still_gets_it_still(open_page: Open) -> None:
    page = open_page(reduced_motion="reduce")
    assert text(page, "#play") == "Play"
    before = page.locator("#arch").inner_html()
    hold_clock(page)
    for now in (0, 500, 1000):
        tick(page, now)
        assert page.locator("#arch").inner_html() == before


def test_the_map_by_keyboard(page: playwright.Page) -> None:
    page.locator("#map").focus()
    page.keyboard.press("Shift+ArrowUp")
    page.keyboard.press("ArrowRight")
    assert number(page, "eta") == pytest.approx(0.4)
    assert number(page, "mu") == pytest.approx(1.22)
    for _ in range(14):
        page.keyboard.press("Shift+ArrowRight")
    settle(page)
    assert page.is_checked("#unbounded")


@pytest.mark.parametrize("half", [6, pytest.param(24, marks=pytest.mark.long)])
def test_never_says_nonsense(page: playwright.Page, half: int) -> None:
    """Anywhere in the ranges, both weights: no error, no NaN, and the verdict of theory."""
    random = np.random.default_rng(7)
    for weight, at in itertools.product(("centreline", "sector"), range(half)):
        bounded = at < half * 7 // 8
        mu = float(f"{10 ** random.uniform(-3, 3):.4g}") if bounded else math.inf
        alpha = float(f"{random.uniform(1, 178):.4g}")
        eta = float(f"{10 ** random.uniform(-6, 0.3):.4g}")
        look_at(page, f"alpha={alpha}&mu={mu}&eta={eta}&weight={weight}")
        assert number(page, "eta") == eta
        everything = page.inner_text("body") + page.inner_html("#arch")
        assert not re.search(r"NaN|undefined|Infinity|null", everything), (alpha, mu, eta)
        known = least_of(math.radians(alpha), mu, 27, weight)
        stands = known.eta_theory is not None and eta >= known.eta_theory
        assert verdict(page).startswith("Stands" if stands else "Collapses")
        looks = "stands" if stands else "collapses"
        assert page.get_attribute("#verdict", "class") == f"verdict {looks}"
        stands = known.eta_limit is not None and eta >= known.eta_limit
        assert text(page, "#built-verdict").startswith("stands" if stands else "collapses")


def test_a_finger_on_the_map_moves_the_point_and_beside_it_scrolls(open_page: Open) -> None:
    page = open_page(375, 500, has_touch=True, is_mobile=True)
    fingers = page.context.new_cdp_session(page)

    def swipe(start: tuple[float, float], end: tuple[float, float]) -> None:
        for kind, share in (("touchStart", 0), ("touchMove", 0.4), ("touchMove", 1)):
            x, y = (a + share * (b - a) for a, b in zip(start, end, strict=True))
            touch = {"type": kind, "touchPoints": [{"x": x, "y": y}]}
            fingers.send("Input.dispatchTouchEvent", touch)
        fingers.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        settle(page)

    # From the point, and from anywhere else: up and down, too, which would scroll.
    for start, end in (((1.2, 0.3), (2.5, 0.7)), ((1.0, 0.5), (1.0, 0.9))):
        swipe(place(page, *start), place(page, *end))
        # A finger's way may be heard of after it has left.
        for name, value, near in (("eta", end[1], 0.03), ("mu", end[0], 0.05)):
            wait_until(
                page,
                lambda name=name, value=value, near=near: (
                    abs(number(page, name) - value) < near
                ),
            )
        assert page.evaluate("scrollY") == 0
        assert not page.locator("#tip").is_visible()
    held = page.input_value("#eta-number")
    box = page.locator("#map").bounding_box()
    swipe((box["x"] + 5, box["y"] + 300), (box["x"] + 5, box["y"] + 60))
    wait_until(page, lambda: page.evaluate("scrollY") > 50)
    assert page.input_value("#eta-number") == held


def test_results_are_shown_and_chosen(page: playwright.Page) -> None:
    drawn = page.locator("#map .marker")
    assert drawn.count() == 3
    assert page.locator("#map .miss").count() == 1
    page.mouse.move(*place(page, 0.7, 0.1065))
    assert text(page, "#tip") == (
        "semicircle, pymunk, n = 27\nleast η from 0.106 to 0.107, mode rrr"
    )
    page.mouse.click(*place(page, 0.7, 0.1065))
    assert number(page, "alpha") == 90
    borders = """() => [...document.querySelectorAll("#map .landmark")]
      .map((landmark) => landmark.getAttribute("cx"))"""
    centreline = page.evaluate(borders)
    page.get_by_role("button", name="sector").click()
    settle(page)
    assert page.input_value("#weight") == "sector"
    assert page.evaluate(borders) != centreline
    assert drawn.count() == 1
    assert number(page, "alpha") == 120


def test_a_simulated_point_is_judged_as_built(page: playwright.Page) -> None:
    """At 0.1 % above its least thickness 27 voussoirs stand; continuous, they would not."""
    least = least_of(math.pi / 2, 0.7).eta_limit
    page.mouse.click(*place(page, 0.7, 0.1065))
    settle(page)
    share = f"{(1 - 0.1065 / least) * 100:.2g} %"
    assert verdict(page) == (
        f"Collapses: {share} below the least thickness of 27 voussoirs as built"
    )
    assert text(page, "#simulated") == (
        "Simulated: semicircle, by pymunk, n = 27: least η from 0.106 to 0.107, mode rrr."
    )
    set_arch(page, eta=0.10684)
    assert verdict(page) == "Stands: 0.10 % above the least thickness of 27 voussoirs as built"
    assert text(page, "#built-verdict") == "stands, 0.10 % to spare"
    assert text(page, "#continuous-verdict") == "collapses, 0.55 % short"
    assert float(text(page, "#built-eta")) == pytest.approx(least, rel=1e-5)
    assert not page.locator("#simulated").is_visible()
    assert page.locator("#play").is_disabled()
    assert page.locator("#arch .stone").count() == 27
    page.check("#continuous")
    assert verdict(page) == "Collapses: 0.55 % below the least thickness of the continuous arch"
    assert page.locator("#play").is_enabled()


BOXES = """(selector) => [...document.querySelectorAll(selector)].map((element) => {
  const box = element.getBoundingClientRect();
  return [element.textContent, box.left, box.top, box.right, box.bottom]; })"""


@pytest.mark.parametrize(
    "size", [(1440, 900), (390, 844), pytest.param((844, 390), marks=pytest.mark.long)]
)
def test_words_on_the_map_are_whole_and_apart(open_page: Open, size: tuple[int, int]) -> None:
    page = open_page(*size)
    _, *whole = page.evaluate(BOXES, "#map")[0]
    words = page.evaluate(BOXES, "#map text")
    assert "149.156°" in [text for text, *_ in words]
    for text, left, top, right, bottom in words:
        assert whole[0] <= left < right <= whole[2], text
        assert whole[1] <= top < bottom <= whole[3], text
    names = page.evaluate(BOXES, "#map .region-label")
    assert {text for text, *_ in names} == set(Mode)
    others = page.evaluate(BOXES, "#map .landmark-label, #map .marker")
    for index, (text, left, top, right, bottom) in enumerate(names):
        # A line of words is higher than its letters, which are a few pixels inside.
        for other, *box in names[index + 1 :] + others:
            apart = box[0] > right or box[2] < left or box[1] + 4 > bottom or box[3] - 4 < top
            assert apart, (text, other)


@pytest.mark.parametrize(("width", "told"), [(390, True), (1280, False)])
def test_a_table_wider_than_the_window_says_so(open_page: Open, width: int, told: bool) -> None:
    page = open_page(width, 800)
    wide = page.locator(".scroll").evaluate("e => e.scrollWidth > e.clientWidth")
    assert wide is told
    playwright.expect(page.locator("#sideways")).to_be_visible(visible=told)
    assert page.evaluate("document.documentElement.scrollWidth") == width


def test_the_point_is_in_the_address(page: playwright.Page, open_page: Open) -> None:
    set_arch(page, alpha=145, mu=1.6, eta=0.76)
    page.select_option("#weight", "sector")
    page.fill("#voussoirs", "30")
    page.select_option("#view", "middle")
    wait_until(page, lambda: "middle" in page.url)
    told = page.inner_text(".arch-pane")
    address = page.url
    page.reload()
    assert page.inner_text(".arch-pane") == told
    other = open_page()
    other.goto("about:blank")
    other.goto(address)
    assert other.inner_text(".arch-pane") == told
    assert other.input_value("#view") == "middle"
    # An address that is changed by hand; what it says wrongly is left out.
    look_at(other, "#alpha=90&mu=inf&eta=99&n=2&arch=built&weight=lead")
    assert number(other, "alpha") == 90
    assert other.is_checked("#unbounded")
    assert number(other, "eta") == 0.3
    assert other.input_value("#voussoirs") == "27"
    assert other.input_value("#weight") == "centreline"


@pytest.mark.parametrize(
    ("view", "mu", "eta", "turned"),
    [
        ("thin", 0.5, 0.6, -90),
        ("whole", 7, 0.3, 0),
        pytest.param("thin", 3, 0.1, 0, marks=pytest.mark.long),
        pytest.param("middle", 0.6, 0.7, 180, marks=pytest.mark.long),
    ],
)
def test_a_point_off_the_zoom_is_marked_as_off(
    page: playwright.Page, view: str, mu: float, eta: float, turned: float
) -> None:
    page.select_option("#view", view)
    set_arch(page, mu=mu, eta=eta)
    assert page.locator("#map .ring").count() == 0
    arrow = page.locator("#map .off")
    assert arrow.get_attribute("transform").endswith(f"rotate({turned})")
    assert f"at μ = {mu} and η = {eta}, lies outside" in text(page, "#off-view")
    if view == "whole":
        assert not page.locator("#whole").is_visible()
        return
    page.click("#whole")
    settle(page)
    assert page.locator("#map .ring").count() == 1
    assert not page.locator("#off-view").is_visible()


LOOKS = """(shapes) => [...document.querySelectorAll(shapes)].flatMap((each) => {
  const { fill, stroke } = getComputedStyle(each);
  return [fill, stroke]; })"""


def rgb(tone: str) -> list[float]:
    """A colour, however a file or a browser says it; nothing of none."""
    if tone.startswith("#"):
        return [255 * part for part in to_rgb(tone)]
    unit = 255 if tone.startswith("color(srgb") else 1
    return [unit * float(part) for part in re.findall(r"[\d.]+", tone)]


@pytest.mark.parametrize("picture", ["map", "arch"])
def test_pictures_are_saved_as_files(open_page: Open, tmp_path: Path, picture: str) -> None:
    """Light from a dark page; what is drawn on the page is in the file, without its style."""
    page = open_page(color_scheme="light")
    set_arch(page, alpha=125, mu=0.9, eta=0.45)  # it stands: lines are not faded
    page.check("#built")
    settle(page)
    # What lies in the corner, to be dragged from there, is no part of the picture.
    looks = page.evaluate(LOOKS, f"#{picture} :is(path:not(.idle path), circle:not(.grip))")
    page.emulate_media(color_scheme="dark")
    settle(page)
    saved = {}
    for kind in ("svg", "png"):
        with page.expect_download() as download:
            page.click(f'[data-save="{picture}"][data-kind="{kind}"]')
        saved[kind] = tmp_path / download.value.suggested_filename
        assert saved[kind].name == f"{picture}.{kind}"
        download.value.save_as(saved[kind])
    root = ElementTree.parse(saved["svg"]).getroot()  # noqa: S314 - our own
    words = "".join(root.itertext())
    assert verdict(page) in words
    assert "= 125.00°, μ = 0.9, η = 0.45, 27 voussoirs as built" in words
    shapes = [each.attrib for each in root.iter() if each.tag.endswith(("path", "circle"))]
    drawn = [each[name] for each in shapes for name in ("fill", "stroke")]
    for mine, seen in zip(drawn, looks, strict=True):
        assert rgb(mine) == pytest.approx(rgb(seen), abs=1.0), (mine, seen)
    assert re.findall(r"var\(|light-dark|color\(|NaN", saved["svg"].read_text("utf-8")) == []
    image = plt.imread(saved["png"])
    assert image.shape[1] >= 3 * 600
    np.testing.assert_array_equal(image[5, 5, :3], 1)
    # A colour that is there in many pixels.
    tone = next(rgb(each) for each in looks if each not in {"none", "rgb(255, 255, 255)"})
    assert (np.abs(255 * image[..., :3] - tone).max(axis=2) < 2.6).sum() > 500


def test_words_say_what_moves(page: playwright.Page) -> None:
    """Nothing that just stands is shown falling without a word."""
    least = least_of(math.radians(125), 0.9, 26).eta_limit
    page.fill("#voussoirs", "26")
    for share, first in ((1, "On"), (0.99, "Collapses:"), (1.01, "Stands:")):
        set_arch(page, alpha=125, mu=0.9, eta=least * share)
        told = text(page, "#because")
        assert "mode srr, sliding-rotational" in told
        assert ("Any thinner, it falls as shown" in told) is (share == 1)
        assert verdict(page).split()[0] == first
        assert verdict(page).endswith("of 26 voussoirs as built")
        assert text(page, "#joints").startswith(
            "Mechanism of 26 voussoirs as built at the least thickness: "
            "each springing slides outwards"
        )
        assert page.locator("#play").is_disabled() is (share > 1)


def test_a_phone_on_its_side_shows_map_verdict_and_arch(open_page: Open) -> None:
    page = open_page(812, 375, has_touch=True, is_mobile=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 812
    for name in ("#map .frame", "#verdict", "#arch"):
        box = page.locator(name).first.bounding_box()
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= 375, name
        assert box["height"] > 20
    assert page.locator("#arch").bounding_box()["height"] > 140


INKS = """() => {
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = getComputedStyle(e).backgroundColor;
      if (colour !== "rgba(0, 0, 0, 0)") return colour;
    }
  };
  const found = [];
  for (const element of document.querySelectorAll("body *:not(script)")) {
    const words = [...element.childNodes].filter((n) => n.nodeType === 3 && n.data.trim());
    if (!words.length || element.disabled || !element.getClientRects().length) continue;
    const style = getComputedStyle(element);
    const drawn = element.namespaceURI.endsWith("svg");
    // Names of regions have a rim of the region's colour.
    const rim = drawn && style.paintOrder.startsWith("stroke");
    found.push([drawn ? style.fill : style.color, rim ? style.stroke : behind(element),
                element.textContent.trim().slice(0, 30)]);
  }
  return found;
}"""


def test_texts_have_contrast(page: playwright.Page) -> None:
    """4.5 to 1 for every text of the page (WCAG AA)."""
    set_arch(page, eta=0.28)
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        texts = {tuple(tones): words for *tones, words in page.evaluate(INKS)}
        found = [(shown_contrast(page, *tones), words) for tones, words in texts.items()]
        assert min(found)[0] >= 4.5, min(found)


def test_controls_and_pictures_have_names(page: playwright.Page) -> None:
    nameless = page.evaluate(
        """() => [...document.querySelectorAll("input, select, button, svg:not([aria-hidden])")]
          .filter((e) => !(e.labels?.length || e.ariaLabel || e.textContent.trim()))
          .map((e) => e.outerHTML)"""
    )
    assert nameless == []
    assert page.get_attribute("html", "lang") == "en"
    assert "turns about its intrados" in page.get_attribute("#arch", "aria-label")


@pytest.mark.parametrize(
    "width", [320, *(pytest.param(each, marks=pytest.mark.long) for each in (375, 768)), 1280]
)
def test_works_at_any_width(open_page: Open, width: int, tmp_path: Path) -> None:
    page = open_page(width, 812, has_touch=width < 800)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    target = place(page, 2.0, 0.5)
    page.locator("#map").scroll_into_view_if_needed()
    if width < 800:
        page.touchscreen.tap(*target)
    else:
        page.mouse.click(*target)
    assert number(page, "eta") == pytest.approx(0.5, abs=0.01)
    assert verdict(page).startswith("On the verge")
    shot = tmp_path / "page.png"
    page.screenshot(path=shot, full_page=True)
    assert shot.stat().st_size > 20_000


def test_prints_on_paper(page: playwright.Page) -> None:
    page.emulate_media(media="print", color_scheme="dark")
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert paper == "rgb(255, 255, 255)"
    assert not page.locator("#alpha").is_visible()
    assert page.locator("#arch .stone").first.is_visible()
    assert page.pdf(format="A4").startswith(b"%PDF")


def none_stands(count: int) -> list[tuple[float, float, int, float]]:
    """Half-angle [deg], friction, voussoirs and thickness of arches that no thickness saves."""
    random, found = np.random.default_rng(40), []
    while len(found) < count:
        degrees, mu = random.uniform(90, 175), math.tan(random.uniform(0.05, 1.5))
        voussoirs, eta = int(random.integers(3, 40)), random.uniform(0.02, 2)
        if least_of(math.radians(degrees), mu, voussoirs).eta_limit is None:
            found.append((degrees, mu, voussoirs, eta))
    return found


def test_the_mode_said_is_that_of_the_thickness_it_is_said_of(page: playwright.Page) -> None:
    """Where none stands, a thinner arch may fall in another mode than the thickest."""
    others = 0
    for degrees, mu, voussoirs, eta in none_stands(12):
        fields = {"alpha": degrees, "mu": mu, "eta": eta, "n": voussoirs, "arch": "built"}
        look_at(page, "&".join(f"{key}={value}" for key, value in fields.items()))
        here, thickest = (
            check(
                CircularArch(
                    half_angle_deg=degrees, friction=mu, eta=each, voussoirs=voussoirs,
                    weight="centreline",
                ),
                method="limit",
            )
            for each in (eta, 2.0)
        )  # fmt: skip
        others += here.arch.mode is not thickest.arch.mode
        said = re.search(r"Even at η = 2 it falls, in mode (\w+)", text(page, "#because"))
        mode = thickest.arch.mode_limit
        assert (said and said[1]) == (mode and mode.value)
        shown = "\N{EN DASH}" if mode is None else f"{mode.value} at η = 2"
        assert text(page, "#built-mode") == shown
    assert others > 0


def test_few_voussoirs_are_not_said_to_stand_any_number_of_times(page: playwright.Page) -> None:
    """What stands at any thickness has no least one to be compared with."""
    compared = 0
    for voussoirs, degrees in itertools.product((3, 4, 5), (20, 90, 120)):
        fields = f"alpha={degrees}&mu=2&eta=0.3&n={voussoirs}&arch=built"
        look_at(page, fields)
        exact = least_of(math.radians(degrees), 2.0, voussoirs).eta_limit
        head = verdict(page)
        assert ("stand at any thickness" in head) == (exact < 1e-9)
        times = re.search(r"(\S+) times the least", head)
        if times:
            assert float(times[1]) == pytest.approx(0.3 / exact, rel=0.1)
            compared += 1
    assert compared > 1


def part_in(address: str) -> list[float]:
    view = re.search(r"view=([^&\"]+)", address)[1]  # type: ignore[index]
    whole = {"whole": [0.0, 4.0, 0.0, 2.0]}
    return whole.get(view) or [float(each) for each in view.replace("%2C", ",").split(",")]


def shown(page: playwright.Page) -> list[float]:
    """Part of the map that is shown, from the text to embed it, which is drawn with it."""
    settle(page)
    return part_in(page.input_value("#code"))


def test_the_wheel_and_the_keys_enlarge_the_map_about_a_point(page: playwright.Page) -> None:
    """What is under the pointer stays there; the map is never left; 0 shows all of it."""
    x, y = place(page, 1.0, 0.5)
    page.mouse.move(x, y)
    page.mouse.wheel(0, -600)
    low, high, bottom, top = shown(page)
    assert high - low == pytest.approx(1.0, rel=1e-3)
    assert top - bottom == pytest.approx(0.5, rel=1e-3)
    assert (low, high) == (pytest.approx(0.75, abs=0.02), pytest.approx(1.75, abs=0.02))
    page.mouse.click(x, y)
    assert number(page, "mu") == pytest.approx(1.0, abs=0.01)
    assert number(page, "eta") == pytest.approx(0.5, abs=0.005)
    # Far back again, and beyond: the whole map, and the wheel is the page's.
    page.mouse.wheel(0, 5000)
    assert shown(page) == [0, 4, 0, 2]
    x, y = place(page, 3.0, 1.0)
    page.dispatch_event("#map", "dblclick", {"clientX": x, "clientY": y})
    low, high, *_ = shown(page)
    assert high - low == pytest.approx(4 / 1.6, rel=1e-3)
    page.focus("#map")
    page.keyboard.press("+")
    assert np.diff(shown(page)[:2])[0] == pytest.approx(4 / 1.6**2, rel=1e-3)
    # The address comes a little later.
    wait_until(page, lambda: part_in(page.url) == shown(page))
    address = page.evaluate("location.hash")
    page.keyboard.press("0")
    assert shown(page) == [0, 4, 0, 2]
    wait_until(page, lambda: "view=whole" in page.url)
    look_at(page, address)
    assert np.diff(shown(page)[:2])[0] == pytest.approx(4 / 1.6**2, rel=1e-3)
    assert page.input_value("#view") == "part"
    for _ in range(12):
        page.click("#nearer", force=True) if page.is_enabled("#nearer") else None
    assert np.diff(shown(page)[:2])[0] == pytest.approx(4 / 16, rel=1e-2)


def test_the_right_button_shifts_the_map_and_leaves_the_arch(page: playwright.Page) -> None:
    x, y = place(page, 2.0, 1.0)
    page.mouse.move(x, y)
    page.mouse.wheel(0, -600)
    before, arch = shown(page), page.input_value("#mu-number")
    page.mouse.down(button="right")
    page.mouse.move(x + 60, y - 40, steps=6)
    page.mouse.up(button="right")
    after = shown(page)
    assert after[0] < before[0] - 0.05
    assert after[2] < before[2] - 0.02
    assert after[1] - after[0] == pytest.approx(before[1] - before[0], rel=1e-3)
    assert after[3] - after[2] == pytest.approx(before[3] - before[2], rel=1e-3)
    assert page.input_value("#mu-number") == arch


def test_two_fingers_enlarge_the_map(open_page: Open) -> None:
    page = open_page(390, 780, has_touch=True, is_mobile=True)
    page.locator("#map").scroll_into_view_if_needed()
    x, y = place(page, 2.0, 1.0)
    session = page.context.new_cdp_session(page)

    def touch(kind: str, *apart: float) -> None:
        points = [{"x": x + way, "y": y, "id": at} for at, way in enumerate(apart)]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", -20, 20)
    for way in (30, 40, 50, 60, 70, 80):
        touch("touchMove", -way, way)
        settle(page)
    touch("touchEnd")
    low, high, *_ = shown(page)
    assert high - low == pytest.approx(1.0, rel=0.15)
    assert (low + high) / 2 == pytest.approx(2.0, abs=0.15)


def test_one_slider_thins_the_arch_to_its_least_and_lets_it_fall(page: playwright.Page) -> None:
    """Map point, words and picture follow; the address brings the very moment back."""
    set_arch(page, alpha=90, mu=1, eta=0.5)
    slid = """(value) => { const slider = document.getElementById("scrub");
      slider.value = value; slider.dispatchEvent(new Event("input")); }"""
    least = least_of(math.pi / 2, 1).eta_theory
    moved = """[...document.querySelectorAll('#arch g[transform^=matrix]')]
      .map((g) => g.getAttribute('transform')).join()"""
    page.focus("#scrub")
    seen = []
    for value, share in ((0, 2), (0.25, 1.5), (0.5, 1), (0.75, 1), (1, 1)):
        eta = share * least
        page.evaluate(slid, value)
        assert number(page, "eta") == pytest.approx(eta, rel=1e-4)
        assert ("On the verge" in verdict(page)) == (value >= 0.5)
        assert float(page.input_value("#scrub")) == pytest.approx(value, abs=0.005)
        ring = page.locator(".handle .ring").bounding_box()
        assert ring is not None
        assert ring["y"] + ring["height"] / 2 == pytest.approx(place(page, 1, eta)[1], abs=1.5)
        seen.append(page.evaluate(moved))
    assert seen[0] == seen[1] == ""
    assert len(set(seen[2:])) == 3
    wait_until(page, lambda: "at=1&" in page.url)
    page.reload()
    settle(page)
    # The address has twelve digits.
    again, before = (
        [float(each) for each in re.findall(r"-?[\d.]+(?:e-?\d+)?", said)]
        for said in (page.evaluate(moved), seen[-1])
    )
    assert again == pytest.approx(before, abs=1e-6)


def test_the_lesson_asks_six_questions_and_says_what_theory_says(page: playwright.Page) -> None:
    """Its right answers against Python; each is shown, and the address holds the step."""
    asked = {1: (90, 1.0), 3: (45, 1.0), 4: (90, 0.35)}
    said = {step: least_of(math.radians(a), mu).eta_theory for step, (a, mu) in asked.items()}
    page.click("#learn")
    for step in range(1, 7):
        assert text(page, "#lesson h2").startswith(f"{step} of 6")
        wait_until(page, lambda step=step: f"lesson={step}" in page.url)
        choices = page.locator("#lesson p button:not(.ways button)")
        assert choices.count() == 3
        for place_of in range(3):
            choices.nth(place_of).click()
        settle(page)
        # The right one is elsewhere each time.
        right = page.locator("#lesson .right")
        assert right.count() == 1
        assert choices.nth((3 - step) % 3).get_attribute("class") == "right"
        why = text(page, "#lesson [role=status]")
        if step in said:
            assert f"{100 * said[step]:.3g} %" in why or f"{100 * said[step]:.4g} %" in why
        if step == 2:
            assert page.locator("#arch .hinge").count() == 5
        if step == 5:
            few = least_of(math.pi / 2, 1.0, 5).eta_limit
            assert f"{100 * few:.3g} %" in why
            assert verdict(page).startswith("Collapses")
        page.click(".ways button:last-child" if step == 6 else ".ways button:text('Next')")
    wait_until(page, page.locator("#lesson").is_hidden)
    assert least_of(math.pi / 2, 0.3).eta_theory is None


def test_the_frame_for_other_pages_shows_this_arch_alone(page: playwright.Page) -> None:
    set_arch(page, alpha=60, mu=0.8, eta=0.04)
    # Written later, the page's own address would take the place of the one gone to.
    wait_until(page, lambda: "eta=0.04" in page.url)
    page.click(".save summary")
    code = page.input_value("#code")
    found = re.fullmatch(r'<iframe src="([^"]+)" [^>]*></iframe>', code)
    assert found
    page.goto("about:blank")  # so that nothing of the page before writes its address later
    page.goto(found[1])
    assert number(page, "alpha") == 60
    for hidden in ("header", "footer", ".legend-pane", "#lesson", ".save"):
        assert page.locator(hidden).first.is_hidden(), hidden
    assert page.locator("#map").is_visible()
