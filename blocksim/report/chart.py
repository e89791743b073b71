"""The speed-accuracy chart as JSON and pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from blocksim.errors import InputError
from blocksim.files import make_folder, write_whole
from blocksim.report.answers import plain
from blocksim.report.tables import as_json, machine, pictures, write_contents
from blocksim.view.chartfigure import chart_figure
from blocksim.workprec import Point, on_front

LARGEST_FILE = 1 << 24
"""Bytes; a larger file of points is not opened."""


def write_chart(points: Sequence[Point], folder: Path) -> list[Path]:
    """Write chart.json, chart.png and chart.svg into a folder.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    make_folder(folder)
    made = [folder / "chart.json"]
    write_points(points, made[0])
    return made + write_contents(folder, pictures("chart", chart_figure(points)))


def write_points(points: Sequence[Point], path: Path) -> None:
    """Write points as JSON, as `read_points` takes them.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    make_folder(path.parent)
    best = on_front(points)
    records = [
        {
            **{key: plain(value) for key, value in asdict(point).items() if key != "seconds"},
            "seconds": list(point.seconds),
            "on_front": point in best,
        }
        for point in points
    ]
    document = {"machine": machine(), "points": records}
    write_whole(path, lambda file: file.write(as_json(document)))


def read_points(path: Path) -> list[Point]:
    """Read points of another run or program, written by `write_points`.

    Raises
    ------
    InputError
        If the file is missing, too large, or holds no points.
    """
    where = str(path)
    if not path.is_file() or path.stat().st_size > LARGEST_FILE:
        raise InputError("points", where, f"a file of at most {LARGEST_FILE} bytes")
    try:
        records = json.loads(path.read_text(encoding="utf-8"))["points"]
        return [
            Point(
                case=str(record["case"]),
                method=str(record["method"]),
                tol=float(record["tol"]),
                error=float(record["error"]),
                undecided=int(record["undecided"]),
                work=float(record["work"]),
                seconds=tuple(float(each) for each in record["seconds"]),
            )
            for record in records
        ]
    except (KeyError, TypeError, ValueError, RecursionError):
        raise InputError("points", where, "written by blocksim chart, or like it") from None
