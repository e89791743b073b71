"""The map explorer: the mode map and its arches in one page that computes in the browser."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import blocksim
from blocksim.arch.circular import WEIGHTS, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.theory import least_thicknesses
from blocksim.arch.theory.critical import CROWN_ETA
from blocksim.blocks.assembly import Array
from blocksim.blocks.maker import Maker
from blocksim.blocks.problem import Problem
from blocksim.common.checks import VOUSSOIRS, is_number
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, json_of, read_file
from blocksim.common.words import printable
from blocksim.kinds.arcade import Arcade
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.column import Column
from blocksim.kinds.files import load_structure
from blocksim.kinds.openings import Opening
from blocksim.kinds.portal import Portal
from blocksim.kinds.wall import Wall
from blocksim.view.mapshapes import ISO_DEGREES, LARGEST_MU, iso_line, map_shapes
from blocksim.view.style import (
    FRICTION,
    JOINTS,
    LIVE,
    MECHANISM,
    MISS,
    MODES,
    THRUST,
    UNNAMED,
    VERDICTS,
)
from blocksim.view.templates import template_of

HERE = Path(__file__).parent
SCRIPTS = (
    "theory.js", "built.js", "mechanism.js", "svg.js", "map.js", "arch.js", "words.js",
    "address.js", "export.js", "lesson.js", "programme.js", "loaded.js", "blocks.js",
    "ownpicture.js", "own.js", "knowing.js", "zooming.js", "page.js",
)  # fmt: skip
STRUCTURES: dict[str, Maker] = {
    "portal": Portal(
        arch=CircularArch(voussoirs=11, eta=0.2), pier_courses=2, pier_height=1.2, friction=0.6
    ),
    "arcade": Arcade(arch=CircularArch(voussoirs=9, eta=0.25), pier_height=1.0, friction=0.6),
    "wall": Wall(
        openings=(Opening(left=0.8, right=1.2, from_course=1, to_course=3),), friction=0.6
    ),
    "column": Column(drums=5, drum_height=0.6, width=1.0, friction=0.6),
}
SHIPPED = ("box2d_arch", "ferris_tinloi_3", "gable", "harmonic_5")
LETTERS = {"T": (-10, -2), "S": (-11, -9), "J": (-7, 9), "B": (11, -11)}
"""Place of each landmark's letter, from the landmark, to the right and up [pixels]."""


def explorer_page(results: Sequence[Mapping[str, Any]] = (), source: str = "") -> str:
    """Return the page as HTML, complete in itself, with results and their source."""
    return template_of("blocksim.view.explorer", "page.html").render(
        data=_data(results),
        source=source,
        style=(HERE / "style.css").read_text(encoding="utf-8"),
        scripts=[(HERE / name).read_text(encoding="utf-8") for name in SCRIPTS],
        version=blocksim.__version__,
    )


def _data(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
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
            "load": LIVE,
            **{state.value: colour for state, colour in JOINTS.items()},
            **{verdict.value: colour for verdict, colour in VERDICTS.items()},
        },
        "largestMu": LARGEST_MU,
        "maps": {"centreline": _map("centreline"), "sector": _map("sector")},
        "structures": [
            *(_blocks(name, maker.problem()) for name, maker in STRUCTURES.items()),
            *(_blocks(name, load_structure(name)) for name in SHIPPED),
        ],
        "results": list(results),
    }


def _blocks(name: str, problem: Problem) -> dict[str, Any]:
    """Return a structure of convex blocks that weigh as much as their area."""
    assembly = problem.assembly
    supports = [polygon for support in assembly.supports for polygon in support.polygons]
    return {
        "name": name,
        "mu": problem.mu if math.isfinite(problem.mu) else None,
        "blocks": [
            {"corners": corners.round(9).tolist(), "fixed": at >= len(assembly.blocks)}
            for at, corners in enumerate([*(b.vertices for b in assembly.blocks), *supports])
        ],
    }


def _map(weight: Weight) -> dict[str, Any]:
    shapes = map_shapes(weight)
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
            {"name": name, "points": _points(line.mu, line.eta)}
            for name, line in shapes.lines.items()
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
    """Return points to a hundredth of a pixel. Level stretches keep only their ends."""
    points = np.round(np.column_stack([mu, eta]), 5)
    steps = np.diff(points, axis=0)
    level = (steps[1:, 1] == 0) & (steps[:-1, 1] == 0)
    return points[np.concatenate([[True], ~level, [True]])[: len(points)]].tolist()


LARGEST_FILE = 20_000_000
"""Bytes: some 20,000 rows."""
WRITTEN = "validate.json as `blocksim validate` writes it"


def read_results(path: AnyPath) -> list[dict[str, Any]]:
    """Read the rows of a validate.json on arches that have a bracket."""
    text = read_file(path, "--results", f"an existing {WRITTEN}", LARGEST_FILE)
    try:
        rows = json_of(text)["rows"]
        found = [_result(row) for row in rows if row["modes_published"]]
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        raise InputError("--results", str(path), WRITTEN) from None
    return [result for result in found if result is not None]


def _result(row: dict[str, Any]) -> dict[str, Any] | None:
    """Check a row, and return what the page shows of it, or None without a bracket."""
    low, high = row["low"], row["high"]
    if low is None:
        return None
    # Where nothing stands, the bracket ends at the thickest arch there is.
    eta = low if high is None else (low + high) / 2
    mu, alpha = float(row["mu"]), row["half_angle_deg"]
    mode = None if row["mode"] is None else Mode(row["mode"]).value
    sound = (
        is_number(eta, 0, 2)
        and is_number(alpha, 0, math.nextafter(180, 0))
        and is_number(mu, 0, math.inf)
        and VOUSSOIRS.has(row["blocks"])
        and row["weight"] in WEIGHTS
    )
    if not sound:
        raise ValueError
    name = "a mode without a name" if mode is None else f"mode {mode}"
    least = "no thickness stands" if high is None else f"least η from {low:.6g} to {high:.6g}"
    return {
        "scenario": printable(str(row["structure"])),
        "engine": printable(str(row["method"])),
        "weight": row["weight"],
        "alpha": alpha,
        "mu": None if math.isinf(mu) else mu,
        "voussoirs": row["blocks"],
        "eta": eta,
        "nothing_stands": high is None,
        "mode": mode,
        "miss": printable(str(row["miss"])),
        "found": f"{least}, {name}",
    }
