"""The report on one structure: what it says is true, is escaped, and fits the page."""

import html
import json
import math
import re
from pathlib import Path

import pytest
from arches import ENGINEERS
from arches import least as least_of
from running import ran
from windows import Windows

from blocksim import CircularArch, check

ASKED = ("--span", "8", "--rise", "3", "--thickness", "0.45", "--voussoirs", "31")
FRICTION = ("--friction-angle", "35")
EVIL = '<script>alert("1")</script> & "wall"'
PUSHED = {
    "title": EVIL,
    "source": "<b>nowhere</b>",
    "friction": 0.6,
    "density": 24000.0,
    "blocks": [
        {"id": "ground", "vertices": [[-2, -1], [4, -1], [4, 0], [-2, 0]], "fixed": True},
        {"id": "<i>low</i>", "vertices": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]},
        {"id": "top", "vertices": [[0, 0.5], [1, 0.5], [1, 2.5], [0, 2.5]]},
    ],
    "live": [{"block": "top", "point": [0, 2.5], "force": [1000, 0]}],
}
INNER = (8**2 / 4 + 3**2) / 6


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("reports")
    (folder / "pushed.json").write_text(json.dumps(PUSHED))
    for name, asked, code in (
        ("arch", (*ASKED, *FRICTION), 0),
        ("thin", (*(each.replace("0.45", "0.2") for each in ASKED), *FRICTION), 1),
        ("pushed", (str(folder / "pushed.json"), "--method", "direct"), 0),
        ("wall", ("wall", "--mu", "0.6"), 0),
        ("road", (*ASKED, *FRICTION, "--fill", "0.5", "--point-load", "1", "20"), 0),
        ("skew", ("skew_arch_crown", "--load", "5"), 0),
    ):
        ran("report", *asked, "--out", folder / f"{name}.html", code=code)
    return folder


def rows_of(page: Path) -> dict[str, str]:
    """First cell of each row, and the others as text."""
    found: dict[str, str] = {}
    for row in re.findall(r"<tr[^>]*>(.*?)</tr>", page.read_text(encoding="utf-8"), re.DOTALL):
        cells = re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL)
        plain = [html.unescape(re.sub(r"<[^>]+>", "", each)).strip() for each in cells]
        if plain[0] in found:
            plain[0] += " again"
        found[plain[0]] = " | ".join(plain[1:])
    return found


def value(text: str) -> float:
    match = re.search(r"-?\d+\.?\d*", text)
    return float(match[0])


def test_figures_of_an_arch_are_those_of_limit_analysis(pages: Path) -> None:
    said = rows_of(pages / "arch.html")
    arch, mu = ENGINEERS, math.tan(math.radians(35))
    problem = CircularArch.of(arch, mu).problem()
    assert said["span"] == "8.000 m | intrados"
    assert said["rise"] == "3.000 m | intrados"
    assert said["thickness"].startswith("0.450 m")
    assert said["friction coefficient"] == f"μ = {mu:.4g} | friction angle 35°"
    assert said["by limit analysis"].startswith("stands")
    # The whole weight, from the area of the sector.
    weight = 20 * 0.45 * arch.radius * 2 * arch.half_angle
    assert value(said["weight of all blocks"]) == pytest.approx(weight, rel=5e-4)
    built = least_of(arch.half_angle, mu, 31, "sector").eta_limit
    assert value(said["least thickness"]) == pytest.approx(built * arch.radius, abs=5e-4)
    factor = value(said["geometrical factor of safety"])
    assert factor == pytest.approx(arch.eta / built, rel=1e-4)
    told = check(problem, method="limit").to_dict()
    ends = [told["thrust_min_kN"], told["thrust_max_kN"]]
    assert value(said["least thrust"]) == pytest.approx(ends[0], rel=5e-4)
    assert value(said["greatest thrust"]) == pytest.approx(ends[1], rel=5e-4)
    assert "kN/m" in said["least thrust"]
    # Each support bears half the weight in every state, and the thrust.
    left = [float(each) for each in said["left"].split(" | ")]
    assert left[1::2] == pytest.approx([weight / 2] * 3, rel=5e-4)
    assert left[0:4:2] == pytest.approx(ends, rel=5e-4)
    assert left[4] == pytest.approx(told["reactions"][0]["horizontal_kN"], rel=5e-4)


def test_every_joint_is_in_the_table(pages: Path) -> None:
    said = rows_of(pages / "arch.html")
    joints = [name for name in said if re.fullmatch(r"(support|\d+)-(support|\d+)", name)]
    assert len(joints) == 32
    springing = said["support-1"].split(" | ")
    # Square to the springing: H sin alpha + V cos alpha by hand, of the safest state.
    left = [float(each) for each in said["left"].split(" | ")]
    alpha = ENGINEERS.half_angle
    normal = left[4] * math.cos(alpha) + left[5] * math.sin(alpha)
    assert float(springing[0]) == pytest.approx(normal, rel=5e-4)
    # Eccentricity in mm over half the thickness is the share of width.
    assert value(springing[3]) == pytest.approx(100 * abs(value(springing[2])) / 225, abs=0.4)
    text = (pages / "arch.html").read_text(encoding="utf-8")
    assert text.count('class="worst"') == 1


def test_what_falls_says_how_and_carries_nothing(pages: Path) -> None:
    text = (pages / "thin.html").read_text(encoding="utf-8")
    said = rows_of(pages / "thin.html")
    assert said["by limit analysis"].startswith("collapses")
    assert "It falls in mode <b>rrr</b>" in text
    assert 'id="mechanism"' in text
    assert "how it starts to fall, by limit, enlarged" in text
    assert 'id="joints"' not in text
    assert "left" not in said
    assert value(said["geometrical factor of safety"]) < 1


def test_loads_and_the_method_asked_for(pages: Path) -> None:
    said = rows_of(pages / "pushed.html")
    text = (pages / "pushed.html").read_text(encoding="utf-8")
    assert said["by limit analysis"].startswith("stands")
    assert said["by direct"].startswith("stands")
    # The upper block, 48 kN on 1 m of base and 2 m tall, tips about its edge.
    assert value(said["load factor"]) == pytest.approx(48 * 0.5 / 2.0, rel=1e-5)
    assert "1 live load, not on it: the load factor is 0." in text
    assert "how it would start to fall at load factor 12" in text
    assert value(said["unit weight"]) == pytest.approx(24.0)


def test_supports_bear_blocks_fill_and_loads(pages: Path) -> None:
    """The fill by hand: 20 kN/m3 below a level 0.5 m over the extrados, above it."""
    said = rows_of(pages / "road.html")
    assert said["unit weight"].startswith("20 kN/m")
    borne = [float(said[name].split(" | ")[1]) for name in ("left", "right")]
    outer = INNER + 0.45
    reach = outer * 4 / INNER
    level = outer + 0.5
    circle = outer**2 * math.asin(reach / outer) + reach * math.sqrt(outer**2 - reach**2)
    fill = 20 * (2 * reach * level - circle)
    assert value(said["dead loads"]) == pytest.approx(fill, rel=1e-3)
    assert said["live loads"] == "20.00 kN/m | together, times 1, the load factor"
    weight = value(said["weight of all blocks"])
    assert sum(borne) == pytest.approx(weight + fill + 20, rel=1e-3)


def test_the_most_that_joints_use_is_in_their_table(tmp_path: Path) -> None:
    """Of blocks that crush the state that presses them least is shown: it was of another."""
    page = tmp_path / "crushes.html"
    load = ("--fill", "0.5", "--point-load", "2", "20", "--strength", "5")
    ran("report", *ASKED, *FRICTION, *load, "--out", page)
    rows = rows_of(page)
    joints = [row.split(" | ") for name, row in rows.items() if re.fullmatch(r"\w+-\w+", name)]
    used = [float(cell.rstrip("\xa0%")) for row in joints for cell in row if "%" in cell]
    assert len(used) == 2 * 32
    assert rows["joints used"].startswith(f"{max(used):.1f}\xa0%")


def test_weights_that_were_not_given_are_no_kilonewtons(pages: Path) -> None:
    text = (pages / "wall.html").read_text(encoding="utf-8")
    assert "weights are for 1 N/m³: no unit weight was given" in text
    assert "kN" not in re.sub(r"<style>.*?</style>|<svg.*?</svg>", "", text, flags=re.DOTALL)


def test_names_are_escaped_and_nothing_is_loaded(pages: Path) -> None:
    for page in pages.glob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r'(?:src|href)\s*=\s*"(?!#)', text)
        assert "@import" not in text
        assert "url(http" not in text
        assert "default-src 'none'" in text
    text = (pages / "pushed.html").read_text(encoding="utf-8")
    assert "alert(" in text
    assert "<script>alert" not in text
    assert "<b>nowhere" not in text
    assert "<i>low" not in text
    assert "blocksim report" in re.sub(r"<[^>]+>", "", text)


def test_a_thickness_that_is_a_share_of_the_least_is_told(tmp_path: Path) -> None:
    out = tmp_path / "semicircle.html"
    ran("report", "semicircle", "--out", out, code=1)
    text = out.read_text(encoding="utf-8")
    assert "0.99" in text
    assert "thickness over the least one that stands, as built" in text


SPANS = """
kind = "arcade"
friction = 0.6
density = 20e3
spans = 2
pier_width = 1.4
pier_height = 2.5
each_span = [{}, { span = 4.0, rise = 2.0, thickness = 0.4, voussoirs = 14 }]
arch = { kind = "circular-arch", span = 6.0, rise = 3.0, thickness = 0.5, fill = 0.5 }
"""


def test_what_is_given_and_what_has_moved_is_told(tmp_path: Path) -> None:
    """Spans of their own, fill in kN/m3, a push by its name, hinges of what has spread."""
    (tmp_path / "spans.toml").write_text(SPANS)
    spread = ("--span", "8", "--rise", "3", "--thickness", "0.6", "--voussoirs", "14")
    asks = {
        "spans": (str(tmp_path / "spans.toml"),),
        "pushed": ("column", "--mu", "0.7", "--unit-weight", "20", "--push", "0.15"),
        "spread": (*spread, "--mu", "0.7", "--unit-weight", "20", "--spread", "0.02"),
    }
    said: dict[str, dict[str, str]] = {}
    for name, asked in asks.items():
        page = tmp_path / f"{name}.html"
        ran("report", *asked, "--out", page)
        said[name] = rows_of(page)
    spans = said["spans"]
    told = [spans[f"each_span 2: {each}"].split(" | ")[0] for each in ("span", "voussoirs")]
    assert told == ["4 m", "14"]
    assert spans["unit weight of fill"] == "20 kN/m\N{SUPERSCRIPT THREE} | "
    # Six drums of 0.6 m, 1 m wide: 72 kN, of which 0.15 push.
    assert said["pushed"]["push"] == "10.80 kN/m | 0.15 of each weight to the right"
    hinged = [
        name for name, cells in said["spread"].items() if cells.split(" | ")[3:4] == ["hinge"]
    ]
    assert len(hinged) == 3
    assert "least thrust" not in said["spread"]
    assert "statics alone say it" in said["spread"]["thrust"]
    assert len(said["spread"]["left"].split(" | ")) == 2


PAPER = (182, 273)
"""What is printed on of A4, less the margins of the page [mm]."""
MM = 96 / 25.4


@pytest.mark.parametrize(
    "name",
    [
        "arch",
        "road",
        "skew",
        *(pytest.param(each, marks=pytest.mark.long) for each in ("thin", "wall", "pushed")),
    ],
)
def test_it_fits_the_paper(windows: Windows, pages: Path, name: str) -> None:
    page = windows.open((pages / f"{name}.html").as_uri(), round(PAPER[0] * MM), 900)
    page.emulate_media(media="print", color_scheme="dark")
    over = page.evaluate("""() => [...document.querySelectorAll("body *")].filter((each) =>
      each.getBoundingClientRect().right > innerWidth + 1 && !each.parentElement.closest("svg")
      && !each.closest(".unseen")).length""")
    assert over == 0
    # Parts of the page keep apart.
    apart = page.evaluate("""() => {
      const above = document.querySelector(".columns").previousElementSibling;
      const edge = (each) => each.getBoundingClientRect();
      return edge(document.querySelector(".columns h2")).top - edge(above).bottom;
    }""")
    assert apart > 1.5 * MM
    # The drawing is as wide as it says: its scale is true.
    box = page.locator("#drawing svg.sheet").bounding_box()
    assert box["width"] == pytest.approx(PAPER[0] * MM, abs=1.0)
    tall = "e => e.viewBox.baseVal.height / e.viewBox.baseVal.width"
    share = page.locator("#drawing svg.sheet").evaluate(tall)
    assert box["height"] == pytest.approx(share * box["width"], abs=1.0)
    # What may not be cut is no taller than a page.
    heights = page.evaluate("""() => [...document.querySelectorAll(
      "table, figure, section:not(#joints)")].map((each) =>
      each.getBoundingClientRect().height)""")
    assert max(heights) < PAPER[1] * MM
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == "rgb(255, 255, 255)"
    assert not page.locator(".controls").first.is_visible()
    printed = page.pdf(prefer_css_page_size=True, print_background=True)
    assert b"/MediaBox [0 0 594" in printed or b"/MediaBox [0 0 595" in printed
    assert len(re.findall(rb"/Type /Page\b", printed)) <= (3 if name == "wall" else 2)


@pytest.mark.parametrize("scheme", [pytest.param("light", marks=pytest.mark.long), "dark"])
def test_it_moves_and_can_be_seen_on_a_screen(
    windows: Windows, pages: Path, scheme: str
) -> None:
    page = windows.open((pages / "thin.html").as_uri(), 1100, 900, color_scheme=scheme)
    slider = page.locator("#mechanism input")
    piece = page.locator("#mechanism .piece").nth(15)
    slider.fill("0")
    assert piece.get_attribute("transform").startswith("translate(0 0) rotate(0 ")
    slider.fill("1")
    assert not piece.get_attribute("transform").startswith("translate(0 0)")
    tones = """([shapes, kind]) => [...document.querySelectorAll(shapes)].map((each) =>
      getComputedStyle(each)[kind])"""
    for shapes, kind, least, is_ground in (
        ("body, svg.sheet", "backgroundColor", 2, True),
        ("svg.sheet [id^=text] use", "fill", 21, False),
        ("svg.sheet pattern rect", "fill", 1, True),
    ):
        found = page.evaluate(tones, [shapes, kind])
        assert len(found) >= least
        for each in found:
            light = sum(int(part) for part in re.findall(r"\d+", each)[:3]) / 765
            assert (light > 0.5) is ((scheme == "light") == is_ground)
    assert windows.wrong("file:") == []
