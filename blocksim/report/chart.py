"""The speed-accuracy chart as JSON and pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from blocksim.errors import InputError
from blocksim.files import make_folder, write_whole
from blocksim.report.answers import plain
from blocksim.report.tables import machine
from blocksim.view.chartfigure import chart_figure
from blocksim.view.mapfigure import save_figure
from blocksim.workprec import Point, front

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
    figure = chart_figure(points)
    made = [folder / name for name in ("chart.json", "chart.png", "chart.svg")]
    write_points(points, made[0])
    write_whole(made[1], lambda file: save_figure(figure, file, "png"))
    write_whole(made[2], lambda file: save_figure(figure, file, "svg"))
    return made


def write_points(points: Sequence[Point], path: Path) -> None:
    """Write points as JSON, as `read_points` takes them.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    make_folder(path.parent)
    best = {
        point
        for name in dict.fromkeys(point.case for point in points)
        for point in front([p for p in points if p.case == name])
    }
    records = [
        {
            **{key: plain(value) for key, value in asdict(point).items() if key != "seconds"},
            "seconds": list(point.seconds),
            "on_front": point in best,
        }
        for point in points
    ]
    document = {"machine": machine(), "points": records}
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    write_whole(path, lambda file: file.write(text.encode()))


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
