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
from blocksim.arch.circular import Weight
from blocksim.arch.modes import Mode
from blocksim.arch.theory import least_thicknesses
from blocksim.arch.theory.critical import CROWN_ETA
from blocksim.blocks.assembly import Array
from blocksim.common.words import printed
from blocksim.view.explorer.results import Result
from blocksim.view.mapshapes import ISO_DEGREES, LARGEST_MU, iso_line, map_shapes
from blocksim.view.style import (
    FRICTION,
    JOINTS,
    MECHANISM,
    MISS,
    MODES,
    THRUST,
    UNNAMED,
    VERDICTS,
)

HERE = Path(__file__).parent
SCRIPTS = (
    "theory.js", "built.js", "mechanism.js", "svg.js", "map.js", "arch.js", "words.js",
    "address.js", "export.js", "page.js",
)  # fmt: skip
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
    return (
        environment_of("blocksim.view.explorer")
        .get_template("page.html")
        .render(
            data=_data(results),
            source=source,
            style=(HERE / "style.css").read_text(encoding="utf-8"),
            scripts=[(HERE / name).read_text(encoding="utf-8") for name in SCRIPTS],
            version=blocksim.__version__,
        )
    )


def environment_of(package: str) -> Environment:
    """Return templates of a package, which escape what they are given."""
    environment = Environment(
        loader=PackageLoader(package, ""),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=printed,
        trim_blocks=True,
    )
    # JSON has no infinity; modes keep the order of the paper.
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False}
    return environment


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
            "mechanism": MECHANISM,
            **{state.value: colour for state, colour in JOINTS.items()},
            **{verdict.value: colour for verdict, colour in VERDICTS.items()},
        },
        "largestMu": LARGEST_MU,
        "maps": {"centreline": _map("centreline"), "sector": _map("sector")},
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
                "mu": part.mu.round(5).tolist(),
                "bottom": part.bottom.round(5).tolist(),
                "top": part.top.round(5).tolist(),
            }
            for part in shapes.regions
        ],
        "lines": [
            {"name": name, "points": _points(line.mu, line.eta)} for name, line in lines.items()
        ],
        "iso": _iso_lines(weight),
        "overturning": CROWN_ETA[weight],
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
