"""Oppenheim's arch on ground that shakes: engines against one equation with impacts.

Question: how does the arch of seven voussoirs rock under pulses and a record, by `direct`, by
pymunk, and by the equation of three links on four hinges (`tests/four_links.py`, after
Oppenheim 1992, and De Lorenzis, DeJong and Ochsendorf 2007)?

Expected: `direct` follows the equation to 0.1 % while a push lasts that sets the four hinges
turning (below 0.44 g). Beyond that it does not: the equation keeps its four hinges where the
ground lets go, or pushes harder, and an impact there leaves the mirror image, with 42 % of the
energy. `direct` lets any joint open. Its impacts leave the nearest motion, with 56 %.

    python -m analysis.oppenheim OUT [--quick]
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from analysis.rows import FIGURES, read_kept, write_rows
from analysis.shaking import ARCH
from blocksim import structure_of
from blocksim.blocks.assembly import Array
from blocksim.blocks.shaking import Shaking, table_of
from blocksim.engines import get_engine
from blocksim.simulation.shaken import shake
from blocksim.view.style import FONT
from tests.four_links import Arch

MU, LONGEST, STEP = 2.0, 4.0, 0.01
"""Friction that lets nothing slip, the time watched [s], and steps of the record [s]."""
ENGINES = ("direct", "pymunk")
DRAWN = 6.0
"""Angle up to which is drawn [deg]."""


def record() -> tuple[Array, Array]:
    """Return times [s] and accelerations [g] of some sines, of 0.6 g at most."""
    draw, times = np.random.default_rng(7), np.arange(0.0, 3.0, STEP)
    sines = [
        draw.uniform(0.3, 1) * np.sin(2 * np.pi * draw.uniform(0.3, 2.5) * times + phase)
        for phase in draw.uniform(0, 6.3, 6)
    ]
    values = np.sum(sines, axis=0) * np.sin(np.pi * times / times[-1])
    return times, 0.6 * values / np.abs(values).max()


RECORD = record()


def motions() -> dict[str, Shaking]:
    """Return what the ground does."""

    def constant(amplitude: float, duration: float) -> Shaking:
        return Shaking(shape="constant", amplitude=amplitude, duration=duration)

    return {
        "0.4 g for 1.3 s": constant(0.4, 1.3),
        "0.4 g for 0.8 s": constant(0.4, 0.8),
        "0.5 g for 0.4 s": constant(0.5, 0.4),
        "a record of 0.6 g": table_of(*RECORD),
    }


def followed(name: str, ground: Shaking) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Follow a motion by the equation and by every engine: a row, and angles in time."""
    arch, problem = Arch(), replace(structure_of({**ARCH, "friction": MU}), shaking=ground)

    def accelerates(time: float) -> float:
        if ground.shape == "constant":
            return arch.gravity * ground.amplitude * (time < ground.duration)
        return arch.gravity * float(np.interp(time, *RECORD, right=0.0))

    found = arch.rocks(accelerates, LONGEST, STEP)
    row: dict[str, Any] = {
        "motion": name,
        "equation_falls": found.falls,
        "equation_largest_rad": float(np.abs(found.angles).max()),
        "equation_impact_s": found.impacts[0] if found.impacts else None,
    }
    times = np.arange(0.0, LONGEST, 2 * STEP)
    ways = {"equation": (found.times, found.angles)}
    for engine in ENGINES:
        seen = shake(problem, engine, until=LONGEST / problem.seconds, repeat=False)
        turned = _first_links(seen.recording.poses)
        ways[engine] = (seen.recording.times * problem.seconds, turned)
        row |= {
            f"{engine}_verdict": seen.verdict.value,
            f"{engine}_largest_rad": float(np.abs(turned).max()),
            f"{engine}_impact_s": seen.first_impact_s,
        }
    last = min(ground.duration, found.times[-1], *found.impacts[:1])
    for engine in ENGINES:
        at, turned = (each[ways[engine][0] < last] for each in ways[engine])
        truth = np.interp(at, *ways["equation"])
        off = np.abs(turned - truth).max() / np.abs(truth).max()
        row[f"{engine}_off_while_pushed"] = float(off)
    paths = [
        {
            "motion": name,
            "time_s": round(time, 3),
            **{
                f"{each}_rad": float(np.interp(time, *way)) if time <= way[0][-1] else None
                for each, way in ways.items()
            },
        }
        for time in times.tolist()
    ]
    return row, paths


def _first_links(poses: Array) -> Array:
    """Return the turn of what the equation calls the first link, of its mirror image below 0.

    Pushed to the left the first voussoir turns to the left; pushed to the right the last one
    to the right.
    """
    turned = poses[:, :, 2] - poses[0, :, 2]
    left, right = np.maximum(turned[:, 0], 0.0), np.minimum(turned[:, -1], 0.0)
    return np.where(left > -right, left, right)


def main(out: Path, *, quick: bool = False) -> list[dict[str, Any]]:
    """Follow every motion, write rows and the figure, and return what each came to."""
    asked = list(motions().items())
    told = [followed(*each) for each in (asked[1:2] if quick else asked)]
    rows = [row for row, _ in told]
    paths = [each for _, path in told for each in path]
    write_rows(out / "oppenheim.csv", rows)
    write_rows(out / "oppenheim_paths.csv.gz", paths)
    _figure(paths, out / "oppenheim.png")
    return rows


def drawn_again(path: Path) -> None:
    """Draw the rows that are kept."""
    _figure(read_kept(FIGURES / "oppenheim_paths.csv.gz"), path)


def _figure(paths: list[dict[str, Any]], path: Path) -> None:
    names = list(dict.fromkeys(each["motion"] for each in paths))
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(10, 6.4), layout="constrained")
        grid = figure.subplots(-(-len(names) // 2), 2, squeeze=False).ravel()
        for axes, name in zip(grid, names, strict=False):
            rows = [each for each in paths if each["motion"] == name]
            for way, line in _lines().items():
                values = [each[f"{way}_rad"] for each in rows]
                angles = np.degrees([np.nan if each is None else each for each in values])
                axes.plot([each["time_s"] for each in rows], angles, label=way, **line)
            axes.set_ylim(max(-DRAWN, axes.get_ylim()[0]), min(DRAWN, axes.get_ylim()[1]))
            axes.set_title(name)
            axes.set_xlabel("time [s]")
            axes.set_ylabel("turn of the end [deg]")
        grid[0].legend(frameon=False)
        figure.savefig(path, dpi=150)


def _lines() -> Mapping[str, Mapping[str, Any]]:
    """Return how each way is drawn."""
    drawn = {each: {"color": get_engine(each).colour, "lw": 1.4} for each in reversed(ENGINES)}
    return {**drawn, "equation": {"color": "black", "lw": 1.0, "ls": "--"}}


if __name__ == "__main__":
    run(main, lambda rows: "\n".join(map(str, rows)))
