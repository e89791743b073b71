"""The speed-accuracy chart as JSON and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, json_of, read_file, write_folder
from blocksim.common.tables import as_said
from blocksim.common.words import printable
from blocksim.engines import ENGINES
from blocksim.report.tables import as_json, machine, pictures
from blocksim.studies.chart import Point, on_front
from blocksim.studies.refinement import REFINEMENTS
from blocksim.view.chartfigure import chart_figures

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
    return as_json(document)


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
