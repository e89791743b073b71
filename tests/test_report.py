"""The report is one page that loads nothing, hides nothing and cannot be broken into."""

import json
import re
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from report_rows import ARCH, ROW, Page, rows, sliding
from running import csv_rows

from blocksim import Verdict
from blocksim.report.motion import KEYS, SHOWN, UNIT, joints_of, recorded_drawing
from blocksim.report.page import report_page
from blocksim.report.rowwords import summary
from blocksim.report.tables import write_results

MAP = (
    b'<?xml version="1.0"?><svg width="9pt" viewBox="0 0 90 60"><style>*{fill:red}</style>'
    b'<a xlink:href="report.html#row-2" target="_blank">'
    b'<path style="fill: #cfe3f0; stroke: #222222"/></a>'
    b'<a xlink:href="report.html#row-2"><path style="fill: #ffffff"/></a></svg>'
)


@pytest.fixture(scope="module")
def text() -> str:
    return report_page(rows(), MAP, {"blocksim": "0.1", "python": "3.11"})


def test_nothing_is_loaded(text: str) -> None:
    page = Page(text)
    assert not page.all("link")
    assert not page.all("iframe")
    assert all("src" not in attributes for attributes in page.all("script"))
    assert not re.search(r"url\(|@import|https?://", text)


def test_input_is_escaped(text: str) -> None:
    page = Page(text)
    assert len(page.all("script")) == 1
    assert page.all("img") == []
    assert all(not name.startswith("on") for _, a in page.elements for name in a)
    words = "".join(page.words)
    assert '<img src=x onerror="alert(1)"> & co' in words
    assert "second<script>alert(1)</script>" in words


def test_every_row_is_told(text: str) -> None:
    page = Page(text)
    words = " ".join(" ".join(page.words).split())
    for told in (
        "error +0.40 %", "Slack.", "no bracket; nothing tried 1 % below", "none up to 2",
        "not tried", "unnamed", "∞", "No moving run was made by pybullet.", "-0.050 %",
    ):  # fmt: skip
        assert told in words
    assert len(page.all("article")) == 2
    assert len(page.all("svg")) == 4
    # Cells that engines share span their rows; with them, all rows are equally wide.
    body = text[text.index('<tbody id="row-1">') : text.index("</table>")]
    lines = re.findall(r"<tr>.*?</tr>", body, re.DOTALL)
    assert [len(re.findall("<t[dh]", line)) for line in lines] == [9, 4, 9, 4]
    assert body.count('rowspan="2"') == 10


def test_page_can_be_read_without_seeing_it(text: str) -> None:
    page = Page(text)
    assert page.all("html")[0]["lang"] == "en"
    assert page.all("svg")[0]["aria-labelledby"] == "map-words"
    ids = Counter(attributes["id"] for _, attributes in page.elements if "id" in attributes)
    assert max(ids.values()) == 1
    for picture in page.all("svg"):
        assert picture["role"] == ("group" if picture.get("class") == "map" else "img")
        assert all(name in ids for name in (picture["aria-labelledby"] or "").split())
    assert all(slider["aria-label"] for slider in page.all("input"))
    targets = [(a["href"] or "")[1:] for a in page.all("a")]
    assert all(target in ids for target in targets)
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch("h[1-6]", tag)]
    assert all(later - earlier <= 1 for earlier, later in pairwise(levels))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "All 1 simulated arches agree"),
        ({"miss": "x"}, "0 of 1 simulated arches agree"),
        ({}, "off by 0.050\xa0% at most"),
        ({}, "of 2 verdicts 1\xa0% to either side of it none is false and none is undecided."),
        ({"at_high": Verdict.COLLAPSES}, "1 is false and none is undecided."),
        ({"at_low": Verdict.STANDS}, "1 is false and none is undecided."),
        ({"at_low": Verdict.UNDECIDED}, "none is false and 1 is undecided."),
        ({"at_high": None}, "of 1 verdicts"),
    ],
)
def test_sentence_counts(changes: dict[str, object], words: str) -> None:
    assert words in summary([replace(ROW, **changes)])


def test_drawing_enlarges_the_motion_recorded() -> None:
    """Sliding down by 0.02 r, evenly in displacement: pose k of 12 is k/12 of 0.13 r."""
    made = recorded_drawing(sliding())
    frames = np.array(json.loads(made.frames))
    assert frames.shape == (KEYS + 1, 8, 3)
    assert np.abs(frames[:, :4]).max() == 0
    expected = np.arange(KEYS + 1) / KEYS * SHOWN * UNIT
    # Between frames of the recording the motion is linear, not quadratic.
    np.testing.assert_allclose(frames[:, 4:, 1], expected[:, None].repeat(4, 1), atol=0.011)
    assert made.enlarged == pytest.approx(SHOWN / 0.02)
    states = [joint.state.value for joint in joints_of(sliding())]
    assert [each for each in states if each != "closed"] == ["slides"]


def test_the_map_is_part_of_the_page(text: str) -> None:
    """Its colours are the page's to change, its style touches nothing else, its links work."""
    drawn = text[text.index('<svg class="map"') : text.index("</svg>")]
    assert "fill:red" not in text
    assert 'style="fill: var(--map-cfe3f0); stroke: var(--map-222222)"' in drawn
    assert "--map-cfe3f0: #cfe3f0;" in text
    links = Page(drawn).all("a")
    assert "target" not in drawn
    assert [link["href"] for link in links] == ["#row-2", "#row-2"]
    assert links[0]["aria-label"] == "2, second<script>alert(1)</script>"
    assert [link.get("tabindex") for link in links] == [None, "-1"]


def test_what_has_no_least_thickness_is_given_none(text: str) -> None:
    """Where nothing stands no verdict is said to be aside of a least thickness."""
    page = text[text.index('<tbody id="row-2"') :]
    row = page[: page.index("</tr>")]
    assert re.sub(r"<[^>]+>|\s+", " ", row[row.index("pymunk") :]).split() == [
        "pymunk", "ss", "none", "up", "to", "2", "-", "yes"]  # fmt: skip
    card = text[text.index('<article id="case-2"') :]
    words = " ".join(re.sub(r"<[^>]+>", " ", card).split())
    assert "η = 0.105, the thickest arch there is; motion enlarged" in words
    assert "ss none up to 2, collapses at η = 2" in words
    first = text[text.index('<article id="case-1"') : text.index('<article id="case-2"')]
    assert "η = 0.105, 1\xa0% below the bracket&#39;s centre" in first


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (-4e-7, "0.000\xa0%"),
        (4e-7, "0.000\xa0%"),
        (-0.0005, "-0.050\xa0%"),
        (0.004, "+0.400\xa0%"),
    ],
)
def test_no_number_is_minus_nothing(error: float, said: str) -> None:
    page = report_page([replace(ROW, error=error)], MAP, {"blocksim": "0.1"})
    assert f'<td class="number">{said}</td>' in page


def test_drawing_of_what_stands() -> None:
    still = replace(sliding(), poses=np.repeat(sliding().poses[:1], 11, axis=0))
    made = recorded_drawing(still)
    assert made.enlarged is None
    assert {joint.state.value for joint in joints_of(still)} == {"closed"}
    assert np.abs(np.array(json.loads(made.frames))).max() == 0
    text = report_page([replace(ROW, recording=still)], MAP, {"blocksim": "0.1"})
    assert "nothing moved in" in text
    assert "<button" not in text


def test_written_with_the_rest(tmp_path: Path) -> None:
    tmp_path = tmp_path / "deep" / "out"
    made = write_results([ROW], tmp_path)
    names = {"report.html", "validate.json", "validate.csv", "map.png", "map.svg"}
    assert {path.name for path in made} == {path.name for path in tmp_path.iterdir()} == names
    (line,) = csv_rows(tmp_path / "validate.csv")
    assert (line["expected"], line["miss"]) == (str(ROW.expected), "")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    links = re.findall(r'<a href="#row-1" aria-label="1, semicircle"', page)
    assert len(links) == 2  # the point and its label
    alone = (tmp_path / "map.svg").read_text(encoding="utf-8")
    assert alone.count('xlink:href="report.html#row-1"') == 2
    assert len(page) < 1_500_000
    record = json.loads((tmp_path / "validate.json").read_text())["rows"][0]
    assert "recording" not in record
    assert record["title"] == "The semicircular arch"
    assert ARCH.voussoirs == record["blocks"]
