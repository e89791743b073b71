"""The speed-accuracy chart as JSON and pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from blocksim.files import make_folder, write_whole
from blocksim.report.answers import plain
from blocksim.report.tables import machine
from blocksim.view.chartfigure import chart_figure
from blocksim.view.mapfigure import save_figure
from blocksim.workprec import Point, front


def write_chart(points: Sequence[Point], folder: Path) -> list[Path]:
    """Write chart.json, chart.png and chart.svg into a folder.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    make_folder(folder)
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
    figure = chart_figure(points)
    made = [folder / name for name in ("chart.json", "chart.png", "chart.svg")]
    write_whole(made[0], lambda file: file.write(text.encode()))
    write_whole(made[1], lambda file: save_figure(figure, file, "png"))
    write_whole(made[2], lambda file: save_figure(figure, file, "svg"))
    return made
