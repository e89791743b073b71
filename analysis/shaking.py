"""Ground that shakes: pulses that overturn blocks, and a map of how strong against how long.

Question: which pulses of the ground does a structure survive? Blocks are let go on ground that
shakes, in `direct` and in pymunk, until they lie still. No restitution is put in.

Expected: pulses overturn a block, or a frame, from the amplitude on that Housner's equation
has (`tests/structures/cases/pulse_*`, `frame_pulse_*`), within 1 %. On the map a block stands
below the line of that equation, and an arch below the acceleration of its static limit.

    python -m analysis.shaking OUT [--quick]
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from analysis.command import run
from analysis.rows import FIGURES, read_kept, write_rows
from blocksim import bracket, read_rows, structure_of, sweep
from blocksim.ask.families import family_of
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.shaking import Shaking
from blocksim.view.style import FONT, VERDICTS
from tests.structure_cases import case, scenes

ENGINES = ("direct", "pymunk")
PULSES = {
    "pulse_1x4_03": 0.3,
    "pulse_1x4_05": 0.5,
    "pulse_1x4_10": 1.0,
    "frame_pulse_gamma05": 0.4,
    "frame_pulse_gamma20": 0.4,
}
"""Cases, and the amplitude of each [g]."""
TOL = 0.005
"""Relative width of the brackets."""
BLOCK = {"kind": "column", "drums": 1, "drum_height": 4.0, "width": 1.0}
ARCH = {
    "kind": "circular-arch",
    "radius": 10.0,
    "thickness": 1.5,
    "voussoirs": 7,
    "left_deg": 78.75,
    "right_deg": 78.75,
}
STATIC = {"block": 0.25, "arch": 0.3705338738135736}
"""Acceleration from which on they move at all [g]: width over height, and Oppenheim's."""
TOLD = (
    "mu",
    "method",
    "amplitude_g",
    "duration_s",
    "verdict",
    "largest_rotation_deg",
    "first_impact_s",
    "wall_s",
)
"""What rows of the map keep of a sweep's."""
COLOURS = {each.value: tone for each, tone in VERDICTS.items()}
MARKERS = {"stands": "o", "collapses": "x", "undecided": "?"}


@dataclass(frozen=True)
class Result:
    """Pulses, and the rows of the two maps."""

    pulses: tuple[dict[str, Any], ...]
    maps: dict[str, list[dict[str, Any]]]

    @property
    def worst(self) -> float:
        """Largest error of an end of a bracket."""
        return max(row["error"] for row in self.pulses)


def pulse(name: str, engine: str) -> dict[str, Any]:
    """Bracket the amplitude of a pulse of the case's duration [s].

    Returns: The least amplitude that is `known` to overturn, the largest that was survived and
        the least that was not [g], the `error` of the farther end, relative, and the processor
        time in `seconds`.
    """
    begin, known = time.process_time(), PULSES[name]
    duration = case(name)["expected"]["least_duration_s"]
    # The search begins away from what is known.
    shaking = Shaking(shape="constant", amplitude=0.8 * known, duration=duration)
    problem = replace(structure_of(scenes(name)[0]), shaking=shaking)
    found = bracket(family_of(problem, "amplitude"), method=engine, tol=TOL)
    ends = [end for end in (found.low, found.high) if end is not None]
    return {
        "name": name,
        "engine": engine,
        "duration": duration,
        "known": known,
        "low": found.low,
        "high": found.high,
        "error": max(abs(end / known - 1) for end in ends) if len(ends) > 1 else math.inf,
        "seconds": round(time.process_time() - begin, 1),
    }


def overturning(duration: float, width: float = 1.0, height: float = 4.0) -> float:
    """Least constant acceleration [g] that overturns a block without an impact, by its ODE."""
    alpha, radius = math.atan2(width, height), math.hypot(width, height) / 2
    squared = 3 * STANDARD_GRAVITY / (4 * radius)

    def passes(amplitude: float) -> float:
        """Energy left over at the top, once the ground keeps its speed."""

        def motion(_: float, state: Sequence[float]) -> list[float]:
            tilt = alpha - state[0]
            return [state[1], squared * (amplitude * math.cos(tilt) - math.sin(tilt))]

        def top(_: float, state: Sequence[float]) -> float:
            return alpha - state[0]

        top.terminal = True  # type: ignore[attr-defined]
        end = solve_ivp(
            motion, (0, duration), [0.0, 0.0], events=top, rtol=1e-10, atol=1e-13
        ).y[:, -1]
        return float(end[1] ** 2 / 2 - squared * (1 - math.cos(alpha - end[0])))

    return float(brentq(passes, math.tan(alpha) * (1 + 1e-9), 10.0))


def mapped(name: str, table: dict[str, Any], folder: Path, steps: int) -> list[dict[str, Any]]:
    """Shake a structure by half sines and constant pulses of many strengths and durations."""
    high, mu, method = (1.2, 2.0, "pymunk") if name == "block" else (2.0, 0.8, "direct")
    asked = {
        **table,
        "shake": "constant",
        "method": method,
        "mu": mu,
        "amplitude_g": {"low": 0.2, "high": high, "steps": steps},
        "duration_s": {"low": 0.1, "high": 1.0, "steps": steps},
    }
    sweep(asked, folder / f"shaking_{name}", workers=1)
    return list(map(dict, read_rows(folder / f"shaking_{name}")))


def main(out: Path, *, quick: bool = False) -> Result:
    """Run the study, write its tables and figure, and return its numbers."""
    out.mkdir(parents=True, exist_ok=True)
    asked = [("pulse_1x4_10", "pymunk")] if quick else [(n, e) for n in PULSES for e in ENGINES]
    pulses = [pulse(*each) for each in asked]
    maps = {
        name: mapped(name, table, out, 2 if quick else 12)
        for name, table in (("block", BLOCK), ("arch", ARCH))
    }
    result = Result(tuple(pulses), maps)
    write_rows(out / "shaking.csv", pulses)
    write_rows(
        out / "shaking_map.csv",
        [
            {"structure": name, **{key: row[key] for key in TOLD}}
            for name, rows in maps.items()
            for row in sorted(rows, key=lambda row: (row["amplitude_g"], row["duration_s"]))
        ],
    )
    _figure(result.maps, out / "shaking.png")
    return result


def drawn_again(path: Path) -> None:
    """Draw the maps of the rows that are kept."""
    rows = read_kept(FIGURES / "shaking_map.csv")
    names = dict.fromkeys(row["structure"] for row in rows)
    _figure({name: [row for row in rows if row["structure"] == name] for name in names}, path)


def _figure(maps: dict[str, list[dict[str, Any]]], path: Path) -> None:
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(10, 5.4), layout="constrained")
        for axes, name in zip(figure.subplots(1, 2), maps, strict=True):
            _map(axes, name, maps[name])
        figure.savefig(path, dpi=150)


def _map(axes: Axes, name: str, rows: list[dict[str, Any]]) -> None:
    for verdict, colour in COLOURS.items():
        chosen = [row for row in rows if row["verdict"] == verdict]
        if chosen:
            axes.plot(
                [row["duration_s"] for row in chosen],
                [row["amplitude_g"] for row in chosen],
                MARKERS[verdict] if verdict != "undecided" else "d",
                color=colour,
                markersize=6,
                label={"stands": "survives", "collapses": "falls"}.get(verdict, verdict),
            )
    axes.axhline(STATIC[name], color="#555555", ls="--", lw=1, label="moves from here on")
    if name == "block":
        durations = np.linspace(0.1, 1.0, 60)
        line = [overturning(float(each)) for each in durations]
        axes.plot(durations, line, color="black", lw=1.2, label="falls from here on (Housner)")
        title = "a block 1 by 4 m, by pymunk"
    else:
        title = "Oppenheim's arch of 7, r = 10 m, μ = 0.8, by direct"
    axes.set_title(title)
    axes.set_xlabel("duration of a constant acceleration of the ground [s]")
    axes.set_ylabel("acceleration [g]")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, frameon=False)


if __name__ == "__main__":
    run(main, show=lambda result: f"{result.worst:.2%}")
