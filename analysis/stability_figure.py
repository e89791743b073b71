"""The figures of `stability.py`: planes, lines and curves, one for each engine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from blocksim.engines.base import Settings
from blocksim.simulation.simulated import FEWER, LONGER
from blocksim.simulation.verdict import Verdict
from blocksim.view.style import FONT, INK, METHODS, MISS, QUIET, UNNAMED, VERDICTS

if TYPE_CHECKING:
    from analysis.stability import Row

STATES = {
    "right": {"marker": "o", "mfc": VERDICTS[Verdict.STANDS], "mec": VERDICTS[Verdict.STANDS]},
    "undecided": {"marker": "s", "mfc": "none", "mec": VERDICTS[Verdict.UNDECIDED]},
    "wrong": {"marker": "X", "mfc": MISS, "mec": MISS},
}
SMALL = 8.0
SIZE = (8.6, 8.0)
"""Of a figure [inch]: no wider than a page can show with its words legible."""
NONE = 1e-7
"""Height at which no gain is drawn."""
LINES = {"alpha": "alpha [deg]", "mu": "mu", "n": "voussoirs", "radius": "radius [m]"}


def worst(rows: Sequence[Row]) -> str:
    """Return the worst outcome among rows."""
    return max((row.outcome for row in rows), key=tuple(STATES).index)


def among(rows: Sequence[Row], part: str, engine: str) -> list[Row]:
    """Return the rows of a part of the study and an engine."""
    return [row for row in rows if (row.part, row.engine) == (part, engine)]


def values(rows: Sequence[Row], name: str) -> list[float]:
    """Return what a quantity was varied over, sorted."""
    return sorted({row.at[name] for row in rows})


def plane(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw outcomes of releases as cells over step and sweeps, both times the rule's."""
    steps, sweeps = values(rows, "step"), values(rows, "sweeps")
    for i, step in enumerate(steps):
        for j, share in enumerate(sweeps):
            here = [row for row in rows if (row.at["step"], row.at["sweeps"]) == (step, share)]
            state = worst(here)
            face = {"right": "#cfe3f0", "undecided": "#ffffff", "wrong": "#f4c6c6"}[state]
            hatch = {"right": None, "undecided": "////", "wrong": "xx"}[state]
            axes.add_patch(
                Rectangle((i - 0.5, j - 0.5), 1, 1, fc=face, ec="#b8b8b8", hatch=hatch, lw=0.6)
            )
            good = sum(row.outcome == "right" for row in here)
            words = {"ha": "center", "va": "center", "fontsize": SMALL, "color": INK}
            box = {"fc": "white", "ec": "none", "pad": 1.2, "alpha": 0.9}
            axes.text(i, j, f"{good}/{len(here)}", bbox=box, **words)
            if step <= LONGER and min(share, share * step) >= FEWER:
                axes.add_patch(
                    Rectangle(
                        (i - 0.45, j - 0.42), 0.9, 0.84, fc="none", ec=INK, lw=0.9, ls="--"
                    )
                )
            if step == share == 1:
                axes.add_patch(
                    Rectangle((i - 0.5, j - 0.5), 1, 1, fc="none", ec=INK, lw=2.2, zorder=5)
                )
    axes.set(xlim=(-0.5, len(steps) - 0.5), ylim=(-0.5, len(sweeps) - 0.5))
    axes.set_xticks(range(len(steps)), [f"{step:g}" for step in steps])
    axes.set_yticks(range(len(sweeps)), [fraction(share) for share in sweeps])
    axes.set_xlabel("time step, times the rule's")
    axes.set_ylabel("sweeps per time,\ntimes the rule's" if len(sweeps) > 1 else "")


def fraction(share: float) -> str:
    """Write a share as a fraction."""
    return f"{share:g}" if share >= 1 else f"1/{1 / share:g}"


def held(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw outcomes of onset tests over length of joints and sweeps allowed."""
    for state, style in STATES.items():
        points = [(r.at["length"], r.at["allowed"]) for r in rows if r.outcome == state]
        if points:
            axes.plot(*zip(*points, strict=True), ls="", ms=4, mew=0.8, **style)
    rules = sorted({(row.at["length"], row.at["rule"], row.case[2]) for row in rows})
    for n, dashes in zip(values_of_n(rows), ("-", "--", ":", "-."), strict=False):
        own = [(length, rule) for length, rule, count in rules if count == n]
        axes.plot(*zip(*own, strict=True), ls=dashes, color=INK, lw=1, label=f"rule, n = {n}")
    axes.set(xscale="log", yscale="log")
    axes.set_xlabel("length of the shortest joint [r]")
    axes.set_ylabel("sweeps allowed / n$^2$")
    axes.legend(edgecolor="none", framealpha=0.9, fontsize=SMALL)


def values_of_n(rows: Sequence[Row]) -> list[int]:
    """Return the numbers of voussoirs that occur."""
    return sorted({row.case[2] for row in rows})


def strips(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw outcomes along each line; four points a place, 2 % below to 2 % above."""
    for line, (name, title) in enumerate(LINES.items()):
        own = [row for row in rows if name in row.at]
        places = values(own, name)
        ratios = sorted({row.ratio for row in own})
        for row in own:
            x = places.index(row.at[name]) / max(1, len(places) - 1)
            y = -line + 0.11 * (ratios.index(row.ratio) - 1.5)
            axes.plot(x, y, ms=3.6, mew=0.8, **STATES[row.outcome])
        for i, place in enumerate(places):
            words = "inf" if math.isinf(place) else f"{place:g}"
            x = i / max(1, len(places) - 1)
            axes.text(
                x, -line - 0.27, words, ha="center", va="top", fontsize=SMALL - 1, color=QUIET
            )
        axes.text(-0.04, -line + 0.27, title, fontsize=SMALL, color=INK)
    axes.set(xlim=(-0.06, 1.06), ylim=(-len(LINES) + 0.45, 0.55), xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)


def away(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw how far accelerations are off, and outcomes, over the distance."""
    for row in rows:
        axes.plot(
            row.at["distance"], max(row.value, 1e-18), ms=4, mew=0.8, **STATES[row.outcome]
        )
    axes.axvline(Settings.farthest, color=INK, lw=1)
    axes.text(Settings.farthest * 1.3, 3e-18, "rule: not asked", fontsize=SMALL, color=INK)
    axes.set(xscale="log", yscale="log", ylim=(1e-18, 1e3))
    axes.set_xlabel("distance from the origin [r]")
    axes.set_ylabel("accelerations off by [g]")


def lasting(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw how far arches that stand have moved, over time."""
    for engine, style in METHODS.items():
        own = among(rows, "lasting", engine)
        for case, dashes in zip(
            sorted({row.case for row in own}), ("-", "--", ":"), strict=False
        ):
            points = sorted((r.at["time"], max(r.value, 1e-25)) for r in own if r.case == case)
            name = f"{engine}, {case[0]:g} deg, mu {case[1]:g}, n {case[2]}"
            axes.plot(
                *zip(*points, strict=True),
                marker=style.marker,
                ls=dashes,
                color=style.colour,
                ms=4,
                label=name,
            )
    axes.axhline(1e-5, color=INK, lw=0.8)
    axes.text(1.0, 1.6e-5, "rest of the impulse engines", fontsize=SMALL, color=INK)
    axes.set(xscale="log", yscale="log", ylim=(1e-25, 1e-3))
    axes.set_xlabel("time since release [$\\sqrt{r/g}$]")
    axes.set_ylabel("largest motion, 0.5 % above [r]")
    if own_labels(axes):
        place = {"loc": "center right", "bbox_to_anchor": (1.0, 0.38)}
        axes.legend(frameon=False, fontsize=SMALL, **place)


def energy(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw the energy that collapses gain, over the step."""
    for engine, style in METHODS.items():
        own = among(rows, "energy", engine)
        for case in sorted({row.case for row in own}):
            points = sorted((r.at["step"], max(r.value, NONE)) for r in own if r.case == case)
            label = engine if case == min(row.case for row in own) else None
            axes.plot(
                *zip(*points, strict=True),
                marker=style.marker,
                color=style.colour,
                ms=4,
                label=label,
            )
    axes.axvline(1.0, color=INK, lw=0.8)
    axes.text(1.03, 3e-2, "rule", fontsize=SMALL, color=INK)
    axes.set(xscale="log", yscale="log", xlim=(0.35, 18))
    axes.text(0.48, NONE, "none", fontsize=SMALL, color=INK, ha="right", va="center")
    axes.set_xlabel("time step, times the rule's")
    axes.set_ylabel("energy gained / given by the weight")
    if own_labels(axes):
        axes.legend(frameon=False, fontsize=SMALL)


def own_labels(axes: Axes) -> bool:
    """Tell whether anything in a panel has a name for the legend."""
    return bool(axes.get_legend_handles_labels()[0])


COLUMNS = (
    ("released", plane, "one release"),
    ("held", held, "onset test"),
    ("lines", strips, "along lines"),
    ("away", away, "far from the origin"),
)


def draw(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write a figure for each engine there are rows of, and one that compares them."""
    engines = [name for name in METHODS if any(row.engine == name for row in rows)]
    paths: list[Path] = []
    with mpl.rc_context(FONT):
        for engine in engines:
            paths.append(folder / f"stability_{engine}.png")
            draw_engine(rows, engine).savefig(paths[-1], dpi=110)
        paths.append(folder / "stability_long.png")
        figure = Figure(figsize=SIZE, layout="constrained")
        for place, (fill, title) in enumerate(
            (
                (lasting, "what stands, for a hundred times as long"),
                (energy, "energy of collapses, 10 % below"),
            )
        ):
            axes = figure.add_subplot(2, 1, place + 1)
            axes.set_title(title)
            fill(axes, rows)
        figure.savefig(paths[-1], dpi=110)
    return paths


@mpl.rc_context(FONT)
def draw_engine(rows: Sequence[Row], engine: str) -> Figure:
    """Draw the four panels of an engine, two by two: wide enough to be read."""
    figure = Figure(figsize=SIZE, layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1))
    for place, (part, fill, title) in enumerate(COLUMNS):
        own = among(rows, part, engine)
        axes = figure.add_subplot(grid[place // 2, place % 2])
        axes.set_title(f"{engine}: {title}", color=METHODS.get(engine, UNNAMED).colour)
        if own and not (part == "held" and engine == "direct"):
            fill(axes, own)
        else:
            axes.set_axis_off()
            words = "solved to its end:\nno sweeps to allow" if own else "not run"
            axes.text(0.5, 0.5, words, ha="center", transform=axes.transAxes)
    marks = [
        Line2D([], [], ls="", ms=5, label=state, **style) for state, style in STATES.items()
    ]
    frames = [
        Rectangle((0, 0), 1, 1, fc="none", ec=INK, lw=2, label="the rule's settings"),
        Rectangle((0, 0), 1, 1, fc="none", ec=INK, ls="--", label="others that are sure"),
    ]
    figure.legend(handles=[*marks, *frames], loc="outside upper center", ncols=5, frameon=False)
    return figure
