"""No name of a stranger is obeyed by a terminal, a page, a drawing, a sheet or a viewer."""

import csv
import io
import json
import re
import subprocess
import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import pytest
from drawn import square
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from report_rows import Page
from running import inside, ran

from blocksim import load_recording, load_structure, structure_of
from blocksim.common.files import json_text
from blocksim.common.sheets import sheet_of
from blocksim.common.words import printable
from blocksim.report.tables import read_points
from blocksim.studies.chart import Point
from blocksim.view.chartfigure import chart_figures
from blocksim.view.explorer import explorer_page

NASTY = (
    "wall\x1b[2J\x1b[HSTANDS", "\x1b]52;c;cm0gLXJmIC8=\x07", "a\nSTANDS  (limit, 0.01 s)\r\n",
    "\x00\x08\x7f\x80\x9b2J", "\u202eSDNATS\u2066", "<script>alert(1)</script>", "]]><!-- -->",
    "=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\uff1d1+1", "$\\frac{$", "$$", "%%d^J\\U+001B",
    "0\nSECTION", "[red]:smile:[/]", "{{ 7 * 7 }}", "a\u2028b\u0085c", "'\"&;`", "\ud7ff\ufffe",
)  # fmt: skip
TEXT = st.sampled_from(NASTY) | st.text(
    st.characters(exclude_categories=["Cs"])
    | st.sampled_from("\x1b\x07\r\n\x9b=+-@$%^\\<&\"'"),
    min_size=1,
    max_size=40,
)
PLAIN = "a"
# Fonts have no letters for most of it.
pytestmark = pytest.mark.filterwarnings("ignore:Glyph")
KEPT = {"suppress_health_check": list(HealthCheck), "deadline": None}


def table(text: str) -> dict[str, Any]:
    """A structure in which everything that has a name is called so."""
    return {
        "title": text, "source": text, "notes": [text], "friction": 0.6,
        "blocks": [
            {"id": f"{text}0", "fixed": True, "vertices": square(0, -1)},
            {"id": f"{text}1", "vertices": square(0, 0)},
            {"id": f"{text}2", "vertices": square(0, 1)},
        ],
    }  # fmt: skip


def written(folder: Path, text: str) -> Path:
    path = folder / "structure.json"
    path.write_text(json.dumps(table(text)))
    return path


def obeys(text: str) -> list[str]:
    """Characters that a terminal or a viewer would obey, without line ends."""
    return [c for c in text if not c.isprintable() and unicodedata.category(c) != "Zs"]


def require_plain(said: str) -> None:
    assert said.endswith("\n")
    assert not [line for line in said.split("\n") if obeys(line)]


WITHIN = {"path", "g", "use", "defs", "symbol", "rect", "clippath", "text", "tspan"}
"""Elements of pictures, of which letters are paths."""


def require_page(page: str, usual: str) -> None:
    assert not [line for line in page.split("\n") if obeys(line)]
    tags = [[tag for tag, _ in Page(each).elements] for each in (page, usual)]
    assert len({tuple(tag for tag in each if tag not in WITHIN) for each in tags}) == 1


def cells_of(sheet: str) -> Iterable[list[str]]:
    return csv.reader(io.StringIO(sheet, newline=""))


def require_sheet(sheet: str, rows: int) -> None:
    found = list(cells_of(sheet))
    assert len(found) == rows
    assert not [line for line in sheet.split("\n") if obeys(line)]
    for cell in (each for row in found for each in row):
        # \N{FULLWIDTH EQUALS SIGN} and its like are taken for their kin.
        if unicodedata.normalize("NFKC", cell).lstrip()[:1] in tuple("=+-@"):
            float(cell)


@given(text=st.text())
def test_printable_text_is_one_line_as_long_as_it_was(text: str) -> None:
    shown = printable(text)
    assert len(shown) == len(text)
    assert not obeys(shown)
    assert printable(shown) == shown
    kept = [a == b for a, b in zip(text, shown, strict=True) if a.isprintable()]
    assert all(kept)


@cache
def as_usual(folder: Path) -> subprocess.CompletedProcess[str]:
    return inside("check", written(folder, PLAIN))


@settings(max_examples=12, **KEPT)
@given(text=TEXT)
def test_lines(text: str, tmp_path: Path) -> None:
    usual = as_usual(tmp_path)
    done = inside("check", written(tmp_path, text))
    assert (done.returncode, done.stderr) == (usual.returncode, "")
    require_plain(done.stdout)
    # It neither adds lines, nor changes the first, which has the verdict.
    assert done.stdout.count("\n") == usual.stdout.count("\n")
    first, known = (
        re.sub(r"[\d.]+ s", "", each.stdout.split("\n")[0]) for each in (done, usual)
    )
    assert first == known


@settings(max_examples=8, **KEPT)
@given(text=TEXT)
def test_json(text: str, tmp_path: Path) -> None:
    done = inside("check", written(tmp_path, text), "--json")
    require_plain(done.stdout)
    assert json.loads(done.stdout)["problem"]["title"] == text


@cache
def made(folder: Path, name: str, called: str) -> bytes:
    """Return a report or a sheet of what is called like that."""
    kind = "report" if name.endswith("html") else "render"
    done = ran(kind, written(folder, called), "--out", folder / name)
    require_plain(done)
    return (folder / name).read_bytes()


@settings(max_examples=1, **KEPT)
@given(text=TEXT)
@example(text="$\\frac{$")
@example(text="%%d^J\\U+001B")
def test_sheets_and_reports(text: str, tmp_path: Path) -> None:
    svg = made(tmp_path, "a.svg", text).decode()
    ET.fromstring(svg)  # noqa: S314 - our own
    assert not obeys(svg.replace("\n", ""))
    require_page(*(made(tmp_path, "a.html", each).decode() for each in (text, PLAIN)))
    entities = []
    for called in (text, PLAIN):
        drawing = made(tmp_path, "a.dxf", called).decode()
        space = ezdxf.read(io.StringIO(drawing)).modelspace()
        entities.append([each.dxftype() for each in space])
        words = [each.dxf.text for each in space if each.dxftype() == "TEXT"]
        assert not obeys("".join(words))
        assert not [word for word in words if re.search(r"%%|\^[^ ]|\\", word)]
    assert entities[0] == entities[1]


@settings(max_examples=1, **KEPT)
@given(text=TEXT)
@example(text="$$ $x$ \x1b")
def test_recordings(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    words = ("--method", "direct", "--seconds", "0.05", "--out", str(path))
    done = ran("simulate", written(tmp_path, text), *words)
    require_plain(done)
    for kind in ("gltf", "csv", "json", "png"):
        out = tmp_path / f"a.{kind}"
        done = ran("render", path, "--out", out, *(
            ("--height", "200") if kind == "png" else ()
        ))  # fmt: skip
        require_plain(done)
    model = json.loads((tmp_path / "a.gltf").read_text())
    names = [each["name"] for each in model["nodes"]] + [model["extras"]["title"]]
    assert not obeys("".join(names))
    assert not obeys((tmp_path / "a.json").read_text().replace("\n", ""))
    frames = load_recording(path).times.size
    require_sheet((tmp_path / "a.csv").read_text(), 1 + 2 * frames)


@settings(max_examples=3, **KEPT)
@given(text=TEXT)
def test_notebooks(text: str) -> None:
    made = [structure_of(table(each)) for each in (text, PLAIN)]
    page, usual = (each._repr_html_() for each in made)
    require_page(page, usual)
    assert not obeys(repr(made[0]))


@given(cells=st.lists(TEXT | st.floats() | st.integers() | st.none(), min_size=1))
def test_sheets_of_cells(cells: list[Any]) -> None:
    found = list(cells_of(sheet_of(["a"] * len(cells), [cells, cells]).decode()))
    require_sheet(sheet_of(["a"] * len(cells), [cells]).decode(), 2)
    for cell, read in zip(cells, found[1], strict=True):
        if isinstance(cell, float):
            assert read == repr(cell)
        elif isinstance(cell, str):
            assert read.removeprefix("'") == printable(cell).removeprefix("'")
    assert found[1] == found[2]


@pytest.mark.usefixtures("wide_window")
@pytest.mark.parametrize("name", ["a\x1b[2Jb", "a\nwrote b", "\u202ea", "[red]", "=1"])
def test_names_of_files(name: str, tmp_path: Path) -> None:
    source = written(tmp_path, PLAIN)
    name = f"{name}.json"
    done = ran("convert", source, "--out", tmp_path / name)
    require_plain(done)
    first, note, *_ = done.split("\n")
    assert first.startswith(f"wrote {tmp_path}")
    assert first.endswith(".json: 2 blocks, 1 support, 2 joints")
    assert note == f"  {PLAIN}"
    assert load_structure(tmp_path / name).title == PLAIN


@settings(max_examples=1, **KEPT)
@given(text=TEXT)
@example(text="$\\frac{$")
def test_points_of_other_programs(text: str, tmp_path: Path) -> None:
    times = {"processor_s": (1.0,), "wall_s": (1.0,)}
    point = Point(
        case=text, method=text, knob="tolerance", value=0.1, error=0.1, low=None, high=None,
        undecided=0, work=1.0, **times,
    )  # fmt: skip
    path = tmp_path / "points.json"
    path.write_text(json_text({"points": [point]}))
    read = read_points(path)
    assert not obeys(read[0].case + read[0].method)
    for figure in chart_figures(read).values():
        figure.savefig(io.BytesIO(), format="svg")


def test_results_on_the_explorer() -> None:
    def page(text: str) -> str:
        result = {
            **dict.fromkeys(("scenario", "engine", "miss", "found"), text),
            "weight": "centreline", "alpha": 90.0, "mu": 0.7, "voussoirs": 9, "eta": 0.1,
            "nothing_stands": False, "mode": None,
        }  # fmt: skip
        return explorer_page([result], text)

    require_page(page("".join(NASTY)), page(PLAIN))


def test_a_crash_says_nothing_that_a_terminal_obeys(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: Any) -> None:
        raise RuntimeError("".join(NASTY))

    monkeypatch.setattr("blocksim.ask.doctor.cite", crash)
    done = inside("cite")
    assert done.returncode == 70
    require_plain(done.stderr)
    assert "Traceback" in done.stderr
