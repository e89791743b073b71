"""Shipped structures: what sources say, asked by name, compared, shown in the report."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from kind_cases import KINDS
from report_rows import ROW, Page
from running import answered, csv_rows, inside, ran
from space_cases import NAMES as SPACE_NAMES
from space_cases import case as space_case
from structure_cases import case
from test_report import MAP
from test_scenario import ARCHES, EVERY, LEANING

from blocksim import InputError, JointState, Verdict, load_structure
from blocksim.ask.families import families_of
from blocksim.kinds.loading import load_known
from blocksim.report.page import report_page
from blocksim.report.tables import write_results
from blocksim.studies.agreement import Row
from blocksim.studies.questions import answer
from blocksim.studies.validate import structures, unasked, validate

CASES = {"gable": "gable_least_friction", "skew_arch_crown": "arch_15_skew_30_crown"}
"""Shipped structures that the corpus calls otherwise."""
PRINTED = {
    "oppenheim_7": "0.37",
    "semicircle_vertical_joints": "0.1095",
    "ferris_tinloi_3": "0.40369",
    "ferris_tinloi_5": "0.23964",
}
CLOSED_FORM = {
    "column_six_drums": math.degrees(math.atan(1 / 3.6)),
    "harmonic_5": (1 + 1 / 2 + 1 / 3 + 1 / 4 + 1 / 5) / 2,
    "gable": 6 / 13,
    "tower_offset": 1 / 5,
}
OWN = {"dome_8_5": 0.0373487032422, "tower_offset": 1 / 5}
"""Of an independent programme (`test_space`), and closed form."""
PULSES = {"pulse_1x4_05": ("pulse_1x4_05", 0.5), "frame_pulse": ("frame_pulse_gamma05", 0.4)}
"""Cases, and the amplitude of each: the corpus has the duration that overturns it."""


def corpus(name: str) -> dict[str, Any]:
    """A case of the plane, or in space."""
    return space_case(name) if name in SPACE_NAMES else case(name)


def known_value(name: str, over: str) -> float:
    """Of the corpus."""
    if name in OWN:
        return OWN[name]
    expected = corpus(CASES.get(name, name))["expected"]
    if over == "spread":
        return expected["of_span"]
    return expected["least_mu"] if name == "box2d_arch" else expected["value"]


@pytest.mark.parametrize("name", sorted({*EVERY} - {*ARCHES} - {*LEANING}))
def test_files_say_what_the_corpus_says(name: str) -> None:
    known = load_known(name)
    assert known.problem.title
    assert known.problem.source
    assert known.expect
    for each in known.expect:
        if each.verdict is not None:
            stands = corpus(name)["expected"]["value"]
            assert each.verdict == ("stands" if stands else "collapses")
            continue
        assert each.over in families_of(known.problem)
        if known.problem.shaking is not None:
            asked, amplitude = PULSES[name]
            wanted = case(asked)["expected"]["least_duration_s"]
            assert (each.over, each.value) == ("amplitude", amplitude)
            assert known.problem.shaking.duration == wanted
            assert known.problem.shaking.amplitude == amplitude
            continue
        assert each.value == known_value(name, str(each.over))
        if name in CLOSED_FORM:
            assert each.value == pytest.approx(CLOSED_FORM[name], rel=1e-12)
        assert each.published == PRINTED.get(name)


def test_every_kind_of_question_is_there_and_names_are_free() -> None:
    every = structures(quick=False)
    asked = {each.over or each.verdict for known in every for each in known.expect}
    assert asked >= {"thickness", "load", "tilt", "mu", "spread", "overhang", "pier_width"}
    assert asked >= {"stands", "collapses"}
    names = {known.name for known in every}
    assert (len(names), len(ARCHES), len(LEANING)) == (52, 22, 2)
    assert not names & set(KINDS)
    assert len(structures(quick=True)) == len(every) - 15


def test_a_structure_is_asked_by_its_name(tmp_path: Path) -> None:
    answer = answered("check", "oppenheim_7", "--load", "0.372", code=1)
    assert answer["verdict"] == "collapses"
    assert answer["load_factor"] == pytest.approx(0.3705338738135736, rel=1e-9)
    moves = [at for at, each in enumerate(answer["joints"]) if each["state"] != "closed"]
    assert moves == [0, 3, 5, 7]
    for over in ("mu", "friction"):
        found = answered("bracket", "gable", "--over", over)
        assert (found["over"], found["limit"]) == ("mu", pytest.approx(6 / 13, rel=1e-9))
    picture = tmp_path / "pointed.svg"
    ran("render", "pointed_e0_25", "--out", picture)
    assert "A pointed arch of two arcs" in re.sub(r"<!-- (.*?) -->", r"\1", picture.read_text())
    listed = inside("scenarios").stdout
    assert "oppenheim_7" in listed
    assert "--over load 0.370534" in listed
    with pytest.raises(InputError, match="or a shipped structure"):
        load_structure("oppenheim_8")


def test_only_arches_have_an_intrados() -> None:
    """A column turns about the right-hand end of its base; an arch says which edge stays."""
    told = answered("check", "column_six_drums", "--tilt", "16", code=1)
    base = told["joints"][0]
    assert base["state"] == "hinge"
    assert base["hinge"] == pytest.approx(max(base["ends"]))
    assert {joint["state"] for joint in told["joints"][1:]} == {"closed"}
    assert {joint["hinge"] and 1 for joint in told["joints"][1:]} == {None}
    lines = inside("check", "column_six_drums", "--tilt", "16").stdout
    assert re.search(r"joints +floor-drum 1 hinge\n", lines)
    arch = answered("check", "oppenheim_7", "--load", "0.372", code=1)
    states = [joint["state"] for joint in arch["joints"] if joint["state"] != "closed"]
    assert states == ["hinge-intrados", "hinge-extrados"] * 2
    assert arch["joints"][3]["hinge"] == arch["joints"][3]["ends"][1]


def test_events_of_spreading_are_told_in_json() -> None:
    found = answered("bracket", "spread_90_12_20", "--over", "spread")
    first, last = found["events"]
    assert (first["value"], first["what"]) == (0.0, "hinges")
    assert [joint["a"] for joint in first["joints"]] == ["4", "10", "16"]
    assert last["what"] == "collapse"
    assert last["value"] == pytest.approx(found["limit"]) == pytest.approx(0.0166808, rel=1e-5)
    other = answered("bracket", "oppenheim_7", "--over", "load")
    assert other["events"] is None


QUICK = ("oppenheim_7", "box2d_tilted_stack", "gable", "catenary")


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return validate([load_known(name) for name in QUICK], workers=1)


def test_answers_agree_with_their_sources(rows: list[Row]) -> None:
    assert [row.miss for row in rows] == [""] * len(rows)
    by = {(row.structure, row.method): row for row in rows}
    assert len(rows) == len(by) == 11  # pymunk is not asked about the catenary
    limit, direct = by["oppenheim_7", "limit"], by["oppenheim_7", "direct"]
    assert limit.value == pytest.approx(0.3705338738135736, rel=1e-9)
    assert limit.digits
    assert limit.hinges == direct.hinges == (0, 3, 5, 7)
    assert (direct.low, direct.high) == pytest.approx((0.3701633, 0.3709044), rel=1e-6)
    assert (direct.at_low, direct.at_high) == (Verdict.STANDS, Verdict.COLLAPSES)
    gable = by["gable", "pymunk"]
    assert (gable.at_low, gable.at_high) == (Verdict.COLLAPSES, Verdict.STANDS)
    assert by["box2d_tilted_stack", "pymunk"].verdict is Verdict.COLLAPSES
    thin = by["catenary", "direct"]
    assert (thin.low, thin.at_high) == (None, Verdict.STANDS)
    assert thin.high < 1e-3


def test_structures_in_space_agree_with_their_sources() -> None:
    """By limit analysis and `direct`, each with its row on the page."""
    chosen = [load_known(name) for name in ("tower_113", "skew_arch_crown")]
    found = validate(chosen, workers=1)
    assert [(row.structure, row.method, row.miss) for row in found] == [
        (known.name, method, "") for known in chosen for method in ("limit", "direct")
    ]
    left_out = {each.engine: each.scenarios for each in unasked(chosen)}
    assert left_out == {"pymunk": ("tower_113", "skew_arch_crown")}
    words = " ".join(
        " ".join(Page(report_page([ROW, *found], MAP, {"blocksim": "0.1"})).words).split()
    )
    assert "All 4 answers on 2 other structures agree with their sources." in words


@pytest.mark.parametrize(
    ("name", "changes", "method", "said"),
    [
        ("oppenheim_7", {"value": 0.3706}, "limit", "value off by -1.8e-04"),
        ("oppenheim_7", {"published": "0.38"}, "limit", "published is 0.38"),
        ("oppenheim_7", {"hinges": (0, 3, 5, 6)}, "limit", "opens at joints 0, 3, 5, 7"),
        ("oppenheim_7", {"value": 0.372}, "direct", "collapses at 0.371628"),
        ("gable", {"value": 0.47}, "direct", "stands at 0.46953"),
        (
            "box2d_tilted_stack",
            {"verdict": "stands"},
            "direct",
            "collapses, expected is stands",
        ),
    ],
)
def test_what_is_wrong_is_a_miss(
    name: str, changes: dict[str, object], method: str, said: str
) -> None:
    known = load_known(name)
    row = answer(known, replace(known.expect[0], **changes), method)
    assert said in row.miss


@pytest.fixture(scope="module")
def page(rows: list[Row]) -> str:
    # `rows` have no misses: one is made up, and one name is hostile.
    made = [
        replace(row, title="<b>bold</b>", miss="collapses at 0.3", note="slack")
        if (row.structure, row.method) == ("gable", "pymunk")
        else replace(row, title="<b>bold</b>")
        if row.structure == "gable"
        else row
        for row in rows
    ]
    return report_page([ROW, *made], MAP, {"blocksim": "0.1"})


def test_the_page_has_a_part_on_structures(page: str) -> None:
    read = Page(page)
    words = " ".join(" ".join(read.words).split())
    assert "10 of 11 answers on 4 other structures agree with their sources." in words
    assert "gable , pymunk: collapses at 0.3 . Slack." in words
    assert "<b>bold</b>" in words
    assert "0.37053387, which rounds to 0.37, joints 0, 3, 5, 7" in words
    assert "known load factor at collapse: 0.37053387, published as 0.37, opening at" in words
    assert "known it collapses" in words
    assert "how it starts to fall at load factor 0.370904, by direct, enlarged" in words
    # Two more pictures of structures than of arches move, but not the catenary, which stands.
    part = page[page.index('<article id="case-2">') : page.index('<section id="how">')]
    assert part.count("<svg") == 4
    assert part.count('type="range"') == 3
    body = page[page.index('<tbody id="row-2">') : page.index("</table>")]
    lines = re.findall(r"<tr>.*?</tr>", body, re.DOTALL)
    # Cells that methods share span their rows.
    assert [len(re.findall("<t[dh]", line)) for line in lines] == [9, 4, 4] * 3 + [9, 4]
    assert body.count(">yes<") == 10
    assert body.count(">no<") == 1
    assert "other structures" not in report_page([ROW], MAP, {"blocksim": "0.1"})


def test_pictures_are_of_the_mechanism(page: str, rows: list[Row]) -> None:
    start = page.index('<article id="case-2">')
    card = page[start : page.index("</article>", start)]
    assert card.count('class="stone"') == card.count('class="rest"') == 7
    for side in ("intrados", "extrados"):
        assert card.count(f'class="hinge hinge-{side}"') == 2
    assert card.count('class="arrow live"') == 1
    frames = json.loads(Page(card).all("figure")[0]["data-frames"] or "")
    assert len(frames) == 2
    assert not any(any(pose) for pose in frames[0])
    row = next(row for row in rows if row.structure == "oppenheim_7" and row.method == "direct")
    # Blocks turn as in the mechanism: one way, the other way, and back, seen from y downwards.
    turns = [pose[2] for pose in frames[1]]
    assert [math.copysign(1, -turn) for turn in turns] == [
        math.copysign(1, rate) for rate in row.drawn.rates[:, 2]
    ]
    assert [turn < 0 for turn in turns] == [False, False, False, True, True, False, False]
    hinges = [state for state in row.drawn.states if state is not JointState.CLOSED]
    assert len(hinges) == 4


def test_rows_are_written(tmp_path: Path, rows: list[Row]) -> None:
    write_results([ROW, *rows], tmp_path, unasked([load_known("catenary")]))
    document = json.loads((tmp_path / "validate.json").read_text(), parse_constant=pytest.fail)
    part = document["rows"][1:]
    assert [row["structure"] for row in part[::3]] == list(QUICK)
    assert part[0]["value"] == pytest.approx(0.3705338738135736)
    assert document["settings"]["aside"]["direct"] == 0.001
    assert document["not_asked"][0]["scenarios"] == ["catenary"]
    assert not {"drawn", "recording"} & part[0].keys()
    lines = csv_rows(tmp_path / "validate.csv")
    assert lines[0]["modes_published"] == "rrr"
    assert lines[2]["hinges"] == "0 3 5 7"
    assert lines[2]["at_high"] == "collapses"
    assert lines[1]["published"] == "0.37"
    assert set(lines[0]) == set(part[0])


@pytest.mark.parametrize(("arch", "structure"), [("", ""), ("x", ""), ("", "x")])
def test_the_exit_code_counts_both_parts(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, rows: list[Row], arch: str, structure: str
) -> None:
    code = int(bool(arch or structure))
    monkeypatch.setattr("blocksim.report.tables.write_results", lambda *_: [])
    told = [replace(ROW, miss=arch), replace(rows[0], miss=structure), *rows[1:]]
    monkeypatch.setattr("blocksim.cli.studies.run_validation", lambda *_, **__: told)
    said = ran("validate", "--quick", "--out", tmp_path, code=code)
    agree = "10 of 11" if structure else "All 11"
    assert f"{agree} answers on 4 other structures agree with their sources" in said
    assert "stands at 0.370163, falls at 0.370904" in said
