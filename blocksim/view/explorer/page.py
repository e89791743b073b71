"""Build the page: template, style, scripts and data in one file that needs no network."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

import blocksim
from blocksim.arch import Weight
from blocksim.assembly import Array
from blocksim.modes import Mode
from blocksim.theory import least_thicknesses
from blocksim.theory.critical import CROWN_ETA
from blocksim.view.explorer.results import Result
from blocksim.view.mapshapes import ISO_DEGREES, LARGEST_MU, iso_line, map_shapes
from blocksim.view.style import FRICTION, MISS, MODES, THRUST, UNNAMED, VERDICTS

HERE = Path(__file__).parent
SCRIPTS = ("theory.js", "mechanism.js", "draw.js", "page.js")
Label = tuple[Mode, float | None, float, tuple[float, float] | None]
LABELS: dict[Weight, tuple[Label, ...]] = {
    "centreline": (
        (Mode.RRR, 2.3, 0.35, None),
        (Mode.SS, 0.75, 1.35, None),
        (Mode.SRR, 0.72, 0.33, None),
        (Mode.RRS, 2.6, 0.88, None),
        (Mode.RSR, 3.35, 1.17, (3.35, 0.987)),
        (Mode.RS, 3.1, 1.5, None),
        (Mode.R, None, 1.5, None),
    ),
    "sector": (
        (Mode.RRR, 2.3, 0.35, None),
        (Mode.SS, 0.75, 1.35, None),
        (Mode.SRR, 0.72, 0.33, None),
        (Mode.RRS, 2.5, 0.81, None),
        (Mode.RSR, 3.35, 1.1, (3.35, 0.92)),
        (Mode.RS, 2.9, 1.45, None),
        (Mode.R, None, 1.45, None),
    ),
}
"""Where each mode's name stands: friction (None is unbounded), thickness, and for a region
too thin for it the point its line leads to."""
LETTERS = {"T": (-10, -2), "S": (-11, -9), "J": (-7, 9), "B": (11, -11)}
"""Where the letter of each landmark stands, in pixels from it, up and to the right."""


def explorer_page(results: Sequence[Result] = (), source: str = "") -> str:
    """Build the page.

    Parameters
    ----------
    results : sequence of Result
        Simulated arches to show on the map.
    source : str
        Where they come from.

    Returns
    -------
    str
        HTML, complete in itself.
    """
    loader = PackageLoader("blocksim.view.explorer", "")
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    # JSON has no infinity; modes keep the order of the paper.
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False}
    return environment.get_template("page.html").render(
        data=_data(results),
        source=source,
        style=(HERE / "style.css").read_text(encoding="utf-8"),
        scripts=[(HERE / name).read_text(encoding="utf-8") for name in SCRIPTS],
        version=blocksim.__version__,
    )


def _data(results: Sequence[Result]) -> dict[str, Any]:
    """Collect what the scripts are given: style, shapes of the maps, results."""
    return {
        "modes": {
            mode.value: {"description": mode.description, **MODES[mode]._asdict()}
            for mode in Mode
        },
        "unnamed": UNNAMED._asdict(),
        "colours": {
            "thrust": THRUST,
            "friction": FRICTION,
            "wrong": MISS,
            **{verdict.value: colour for verdict, colour in VERDICTS.items()},
        },
        "largestMu": LARGEST_MU,
        "maps": {weight: _map(weight) for weight in LABELS},
        "results": [asdict(result) for result in results],
    }


def _map(weight: Weight) -> dict[str, Any]:
    shapes = map_shapes(weight)
    lines = {
        "divide": shapes.divide,
        "first": shapes.first,
        "equal": shapes.equal,
        "crown": shapes.crown,
    }
    return {
        "regions": [
            {
                "mode": part.mode.value,
                "points": [
                    *_points(part.mu, part.bottom),
                    *_points(part.mu[::-1], part.top[::-1]),
                ],
            }
            for part in shapes.regions
        ],
        "lines": [
            {"name": name, "points": _points(line.mu, line.eta)} for name, line in lines.items()
        ],
        "iso": _iso_lines(weight),
        "overturning": CROWN_ETA[weight],
        "labels": [
            {"mode": mode.value, "mu": mu, "eta": eta, "target": target}
            for mode, mu, eta, target in LABELS[weight]
        ],
        "landmarks": [
            {"name": mark.name, "mu": mark.mu, "eta": mark.eta, "shift": LETTERS[mark.name]}
            for mark in shapes.landmarks.values()
        ],
    }


def _iso_lines(weight: Weight) -> list[dict[str, Any]]:
    """Lines of equal half-angle, with where they end at unbounded friction."""
    found: list[dict[str, Any]] = []
    for degrees in ISO_DEGREES:
        half_angle = math.radians(degrees)
        unbounded = float(least_thicknesses(half_angle, math.inf, weight).eta)
        if not math.isnan(unbounded):
            line = iso_line(half_angle, weight)
            points = _points(line.mu, line.eta)
            found.append({"degrees": degrees, "points": points, "unbounded": unbounded})
    return found


def _points(mu: Array, eta: Array) -> list[list[float]]:
    """Points to draw, to a hundredth of a pixel; level stretches keep their ends."""
    points = np.round(np.column_stack([mu, eta]), 5)
    steps = np.diff(points, axis=0)
    level = (steps[1:, 1] == 0) & (steps[:-1, 1] == 0)
    return points[np.concatenate([[True], ~level, [True]])[: len(points)]].tolist()
