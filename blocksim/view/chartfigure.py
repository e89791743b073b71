"""Speed against accuracy, log-log: a column for each arch, a row for each two quantities."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any, NamedTuple

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from blocksim.studies.chart import Cost, Point, front
from blocksim.view.drawing import literal, new_figure
from blocksim.view.style import FONT, QUIET, style_of_method


class _Quantity(NamedTuple):
    """A quantity of points that is drawn along an axis."""

    label: str
    of: Callable[[Point], float]
    cost: Cost | None = None


TIME = _Quantity("processor time [s]", attrgetter("time"), "time")
WORK = _Quantity("contact solves", attrgetter("work"), "work")
NUMBER = _Quantity("voussoirs", attrgetter("value"))
ALLOWED = _Quantity("sweeps allowed", attrgetter("value"))
ERROR = _Quantity("error of least thickness", attrgetter("error"))


class _Row(NamedTuple):
    """Panels side by side, one for each arch."""

    points: Sequence[Point]
    x: _Quantity
    y: _Quantity = ERROR


DASHED = {"sweeps"}
"""Knobs told from another in the same panel by their line."""
FRONT: dict[str, Any] = {"color": QUIET, "lw": 7, "alpha": 0.25, "solid_capstyle": "round"}
DOT: dict[str, Any] = {"ls": "", "marker": ".", "ms": 3}
CROSS: dict[str, Any] = {"ls": "", "marker": "x", "ms": 5}
BAND = 0.14
"""Share of a panel's height, above what has an error, for brackets that were not found."""
WIDTH, HEIGHT, NARROWEST = 2.2, 2.1, 4
"""Sizes of a panel [inch], and the least number of panels abreast."""
MOST_ABREAST = 7
"""Entries in a line of the legend."""


def chart_figures(points: Sequence[Point]) -> dict[str, Figure]:
    """Draw what was measured: each repeat, medians joined, the front in the background.

    Returns: By name, those for which there are points: `chart`, methods at their best, by
        tolerance or by what else another program has, and one picture for each other way to set
        them. The front in a panel is that of all points of its arch with the same reference,
        those of other pictures too.
    """
    by_tolerance = {p.method for p in points if p.knob == "tolerance"}
    as_built = [p for p in points if p.against == "limit"]
    best = [p for p in as_built if p.knob == "tolerance" or p.method not in by_tolerance]
    others = [p for p in as_built if p not in best]
    let_go = [p for p in others if p.knob in {"step", "sweeps"}]
    cut_short = [p for p in others if p.knob == "hold_sweeps"]
    counted = [p for p in points if p.against == "theory"]
    wanted = {
        "chart": ("Methods at their best", [_Row(best, TIME), _Row(best, WORK)]),
        "chart_let_go": (
            "Moving runs alone, let go at once",
            [_Row(let_go, TIME), _Row(let_go, WORK)],
        ),
        "chart_cut_short": (
            "Onset tests alone, cut short",
            [_Row(cut_short, ALLOWED), _Row(cut_short, TIME), _Row(cut_short, WORK)],
        ),
        "chart_voussoirs": (
            "Arches of more and more voussoirs, against the continuous one",
            [_Row(counted, NUMBER), _Row(counted, TIME), _Row(counted, NUMBER, TIME)],
        ),
    }
    return {
        name: _figure(title, rows, points)
        for name, (title, rows) in wanted.items()
        if rows[0].points
    }


@mpl.rc_context(FONT)
def _figure(title: str, rows: Sequence[_Row], everything: Sequence[Point]) -> Figure:
    """Draw a column of panels for each arch there are points of."""
    shown = rows[0].points
    names = list(dict.fromkeys(point.case for point in shown))
    figure = new_figure((WIDTH * max(len(names), NARROWEST), HEIGHT * len(rows) + 1.1))
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
    panels = figure.subplots(len(rows), len(names), sharex="row", sharey="row", squeeze=False)
    for row, line in zip(rows, panels, strict=True):
        for axes, name in zip(line, names, strict=True):
            _draw_panel(axes, row, name, [p for p in everything if p.case == name])
        line[0].set_ylabel(row.y.label)
    for axes, name in zip(panels[0], names, strict=True):
        words = literal(name).replace(": ", "\n")
        if rows[0].x is NUMBER:
            words = words.partition(", n ")[0]
        axes.set_title(words, fontsize=9, fontweight="normal")
    handles = _legend(shown)
    ncols = math.ceil(len(handles) / math.ceil(len(handles) / MOST_ABREAST))
    figure.legend(handles=handles, loc="outside lower center", ncols=ncols, frameon=False)
    return figure


def _draw_panel(axes: Axes, row: _Row, name: str, peers: Sequence[Point]) -> None:
    """Draw the points of one arch, over the front of all that share their reference."""
    low, high = _range(row)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.set_xlabel(row.x.label)
    axes.grid(alpha=0.3)
    own = [p for p in row.points if p.case == name]
    if own and row.x.cost:
        best = front([p for p in peers if p.against == own[0].against], row.x.cost)
        axes.plot([row.x.of(p) for p in best], [p.error for p in best], **FRONT, scalex=False)
    for method, knob in dict.fromkeys((p.method, p.knob) for p in own):
        line = [p for p in own if (p.method, p.knob) == (method, knob)]
        found = [p for p in line if math.isfinite(p.error)]
        missing = [p for p in line if p not in found]
        style = style_of_method(method)
        dashes, fill = ("--", "white") if knob in DASHED else ("-", style.colour)
        axes.plot([row.x.of(p) for p in found], [row.y.of(p) for p in found], dashes,
                  marker=style.marker, color=style.colour, ms=4.5, lw=1.2,
                  mfc=fill)  # fmt: skip
        top = [high / (high / low) ** (BAND / 2)] * len(missing)
        axes.plot([row.x.of(p) for p in missing], top, color=style.colour, **CROSS)
        repeats = [(p, seconds) for p in found for seconds in p.processor_s]
        if TIME in {row.x, row.y}:
            axes.plot(
                [seconds if row.x is TIME else row.x.of(p) for p, seconds in repeats],
                [seconds if row.y is TIME else row.y.of(p) for p, seconds in repeats],
                color=style.colour,
                alpha=0.6,
                **DOT,
            )


def _range(row: _Row) -> tuple[float, float]:
    """Return the ends of a row's upward axis, with room for brackets that were not found."""
    values = [row.y.of(p) for p in row.points]
    finite = [value for value in values if math.isfinite(value)] or [1.0]
    low, high = min(finite) / 2, max(finite) * 2
    missing = len(finite) < len(values)
    return low, high * (high / low) ** (BAND / (1 - BAND)) if missing else high


def _legend(points: Sequence[Point]) -> list[Line2D]:
    """Tell methods, knobs and marks apart."""
    styles = {literal(p.method): style_of_method(p.method) for p in points}
    handles = [
        Line2D([], [], color=style.colour, marker=style.marker, ms=4.5, lw=1.2, label=method)
        for method, style in styles.items()
    ]
    if any(p.knob in DASHED for p in points):
        line: dict[str, Any] = {"color": QUIET, "marker": "o", "ms": 4.5}
        handles.append(Line2D([], [], label="finer steps", **line))
        handles.append(Line2D([], [], label="more sweeps", ls="--", mfc="white", **line))
    handles.append(Line2D([], [], color=QUIET, label="each repeat", **DOT))
    if not all(math.isfinite(p.error) for p in points):
        handles.append(Line2D([], [], color=QUIET, label="no bracket", **CROSS))
    return [*handles, Line2D([], [], label="the front", **FRONT)]
