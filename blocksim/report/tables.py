"""Results of `validate` and of the chart as JSON, CSV, pictures and a page."""

from __future__ import annotations

import math
import platform
from collections.abc import Sequence
from dataclasses import asdict, fields, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import blocksim
from blocksim.ask.methods import METHODS
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, json_bytes, json_of, read_file, write_folder
from blocksim.common.sheets import sheet_of
from blocksim.common.tables import as_said
from blocksim.common.words import printable
from blocksim.engines import ENGINES, NAMES, engine_named
from blocksim.report.inlinemap import PAGE
from blocksim.report.page import report_page
from blocksim.studies.agreement import Row, Unasked, disagreements, numbered, parted
from blocksim.studies.chart import Point, on_front
from blocksim.studies.questions import NEAR, SLOWLY
from blocksim.studies.refinement import REFINEMENTS
from blocksim.studies.thickness import ASIDE, ERROR_BOUND
from blocksim.view.chartfigure import chart_figures
from blocksim.view.drawing import figure_bytes
from blocksim.view.mapfigure import MapPoint, map_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LISTS = {"modes_published": "/", "modes_theory": "/", "expected_hinges": " ", "hinges": " "}
"""Lists, and what stands between their members in a text."""


def as_record(row: Row) -> dict[str, object]:
    """Return a row for JSON and CSV: its angle in degrees, lists as texts, nothing drawn."""
    record: dict[str, object] = {}
    for name in (each.name for each in fields(row)):
        value: Any = getattr(row, name)
        if name == "half_angle":
            record["half_angle_deg"] = None if value is None else math.degrees(value)
        elif name in LISTS:
            record[name] = LISTS[name].join(map(str, value))
        elif name not in {"recording", "drawn"}:
            record[name] = value
    return record


def machine() -> dict[str, str]:
    """Tell what the figures were measured on."""
    engines = [ENGINES[name] for name in NAMES if "arches" in ENGINES[name].validates]
    installed = [engine.name for engine in engines if engine.missing is None]
    return {
        "processor": processor(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "blocksim": blocksim.__version__,
        **{name: version(name) for name in ("numpy", "scipy", *installed)},
    }


def processor() -> str:
    """Model of the processor, as far as the system tells."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"


def write_results(
    found: Sequence[Row], folder: AnyPath, unasked: Sequence[Unasked] = ()
) -> list[Path]:
    """Write report.html, validate.json, validate.csv, map.png and map.svg into a folder.

    `unasked`: What was not asked, and why; said in the page and in the JSON.
    """
    arches, _ = parted(found)
    records = [as_record(row) for row in found]
    engines = [ENGINES[name] for name in NAMES]
    asked = dict.fromkeys(row.method for row in found)
    engines += [engine_named(name) for name in asked if name not in METHODS]
    document = {
        "machine": machine(),
        "settings": {
            "tol": {engine.name: engine.validated_to for engine in engines},
            "error_bound": ERROR_BOUND,
            "arches_aside": ASIDE,
            "aside": {engine.name: engine.aside for engine in engines},
            "near": NEAR,
            "slowly": SLOWLY,
        },
        "rows": records,
        "disagreements": disagreements(arches),
        "not_asked": list(unasked),
    }
    figure = map_figure(_points(arches), title="Simulated arches on the analytical mode map")
    drawn = pictures("map", figure)
    page = report_page(found, drawn["map.svg"], machine(), unasked)
    contents = {
        PAGE: page.encode(),
        "validate.json": json_bytes(document),
        "validate.csv": _sheet(records),
    }
    return write_folder(folder, {**contents, **drawn})


def _sheet(records: Sequence[dict[str, object]]) -> bytes:
    """Return records, all with the same keys, as the content of a CSV file."""
    columns = list(records[0]) if records else []
    return sheet_of(columns, (list(each.values()) for each in records))


def pictures(name: str, figure: Figure) -> dict[str, bytes]:
    """Return a figure as the contents of a .png and an .svg file of that name."""
    return {f"{name}.{kind}": figure_bytes(figure, kind) for kind in ("png", "svg")}


def _points(rows: Sequence[Row]) -> list[MapPoint]:
    """Place each arch at the middle of its bracket, or at eta = 2 where none stands."""
    points: list[MapPoint] = []
    numbers = numbered(rows)
    first = next((row.method for row in rows), "")
    for row in rows:
        high = row.high if row.high is not None else row.low
        if high is None or row.low is None:
            continue
        points.append(
            MapPoint(
                mu=row.mu,
                eta=(row.low + high) / 2,
                mode=row.mode,
                label=str(numbers[row.structure]) if row.method == first else "",
                engine=row.method,
                outline=row.method != first,
                miss=bool(row.miss),
                note=row.structure,
                none_stands=row.high is None,
                link=f"{PAGE}#row-{numbers[row.structure]}",
            )
        )
    return points


WRITTEN = "a file written by blocksim chart, or like it"
LARGEST_FILE = 1 << 24
"""Bytes; a larger file of points is not opened."""


def write_chart(points: Sequence[Point], folder: AnyPath) -> list[Path]:
    """Write chart.json and the pictures of `chart_figures`, .png and .svg, into a folder."""
    contents = {"chart.json": _document(points)}
    for name, figure in chart_figures(points).items():
        contents |= pictures(name, figure)
    return write_folder(folder, contents)


def _document(points: Sequence[Point]) -> bytes:
    by_time, by_work = on_front(points), on_front(points, "work")
    records = [
        {
            **asdict(point),
            "against": point.against,
            "on_front": point in by_time,
            "on_front_of_work": point in by_work,
        }
        for point in points
    ]
    knobs = {name: REFINEMENTS[name].words for name in dict.fromkeys(p.knob for p in points)}
    drawn = {p.method for p in points}
    document = {
        "machine": machine(),
        "libraries": {
            name: engine.version
            for name, engine in ENGINES.items()
            if name in drawn and not engine.missing
        },
        "knobs": knobs,
        "points": records,
    }
    return json_bytes(document)


def read_points(path: AnyPath) -> list[Point]:
    """Read points of another run or program, written as in chart.json.

    The ends of brackets need not be told.
    """
    text = read_file(path, "points", WRITTEN, LARGEST_FILE)
    try:
        return [_point(record) for record in json_of(text)["points"]]
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError, InputError):
        raise InputError("points", str(path), WRITTEN) from None


def _point(record: dict[str, Any]) -> Point:
    """Return a record as a point; `KeyError`, `TypeError` or `InputError` if it is none."""
    found = as_said(Point, record)
    if found.knob not in REFINEMENTS or not found.processor_s:
        raise KeyError(found.knob)
    return replace(found, case=printable(found.case), method=printable(found.method))
