"""The speed-accuracy chart as JSON and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from blocksim.files import make_folder
from blocksim.report.answers import plain
from blocksim.report.tables import as_json, machine, pictures, write_contents
from blocksim.view.chartfigure import chart_figure
from blocksim.workprec import Point, on_front


def write_chart(points: Sequence[Point], folder: Path) -> list[Path]:
    """Write chart.json, chart.png and chart.svg into a folder.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    make_folder(folder)
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
    return write_contents(
        folder, {"chart.json": as_json(document), **pictures("chart", chart_figure(points))}
    )
