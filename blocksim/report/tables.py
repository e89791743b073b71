"""Results of `validate` as JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
import math
import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

import blocksim
from blocksim.files import make_folder, write_whole
from blocksim.report.answers import plain
from blocksim.validate import ASIDE, ERROR_BOUND, TOLS, Row, disagreements, installed, numbered
from blocksim.view.mapfigure import LARGEST_MU, MapPoint, map_figure, save_figure


def as_record(row: Row) -> dict[str, object]:
    """Return a row with its angles in degrees."""
    record = {key: plain(value) for key, value in asdict(row).items() if key != "half_angle"}
    record["modes_published"] = "/".join(row.modes_published)
    return {"scenario": row.scenario, "half_angle_deg": math.degrees(row.half_angle), **record}


def machine() -> dict[str, str]:
    """Tell what the figures were measured on."""
    return {
        "processor": _processor(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "blocksim": blocksim.__version__,
        **{name: version(name) for name in ("numpy", "scipy", *installed())},
    }


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"


def write_results(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write validate.json, validate.csv, map.png and map.svg into a folder.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    make_folder(folder)
    records = [as_record(row) for row in rows]
    settings = {"tol": TOLS, "error_bound": ERROR_BOUND, "aside": ASIDE}
    document = {
        "machine": machine(),
        "settings": settings,
        "rows": records,
        "disagreements": disagreements(rows),
    }
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    sheet = io.StringIO()
    writer = csv.DictWriter(sheet, fieldnames=list(records[0]), lineterminator="\n")
    writer.writeheader()
    for record in records:
        writer.writerow(record)
    figure = map_figure(_points(rows), title="Simulated arches on the analytical mode map")
    made = [folder / name for name in ("validate.json", "validate.csv", "map.png", "map.svg")]
    write_whole(made[0], lambda file: file.write(text.encode()))
    write_whole(made[1], lambda file: file.write(sheet.getvalue().encode()))
    write_whole(made[2], lambda file: save_figure(figure, file, "png"))
    write_whole(made[3], lambda file: save_figure(figure, file, "svg"))
    return made


def _points(rows: Sequence[Row]) -> list[MapPoint]:
    """Place each arch at its bracket; what never stands, at the divide's side, eta = 2."""
    points: list[MapPoint] = []
    numbers = numbered(rows)
    first = next((row.engine for row in rows), "")
    for row in rows:
        high = row.eta_high if row.eta_high is not None else row.eta_low
        if high is None or row.eta_low is None:
            continue
        points.append(
            MapPoint(
                mu=min(row.mu, LARGEST_MU),
                eta=(row.eta_low + high) / 2,
                mode=row.mode_observed,
                label=str(numbers[row.scenario]) if row.engine == first else "",
                engine=row.engine,
                outline=row.engine != first,
                miss=bool(row.miss),
                note=row.scenario,
            )
        )
    return points
