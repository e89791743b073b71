# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""The mode map: thickness-to-radius ratio against friction (Figs 6-11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from blocksim import theory
from blocksim.modes import Mode
from blocksim.view.mapshapes import LARGEST_MU, map_shapes
from blocksim.view.style import FONT, INK, MISS, MODES, UNNAMED

CENTRAL = ((1.2, 2.4), (0.6, 1.2))
"""Friction and thickness shown by the central zoom (Fig. 11)."""
NAMES = {
    Mode.RRR: (2.3, 0.35),
    Mode.SS: (0.75, 1.35),
    Mode.SRR: (0.72, 0.355),
    Mode.RRS: (2.45, 0.885),
    Mode.RS: (3.2, 1.45),
}
CENTRAL_NAMES = {
    Mode.RRR: (2.0, 0.66),
    Mode.SS: (1.45, 1.0),
    Mode.SRR: (1.235, 0.618),
    Mode.RRS: (2.1, 0.87),
    Mode.RS: (2.15, 1.1),
}
LETTERS = {"T": (-13, 4), "S": (-19, -12), "J": (-17, 6), "B": (13, -9)}
"""Where the letter of each landmark begins, in points from it."""
POINT = (0.009, 0.0052)
"""Friction and thickness that a typographic point covers on the whole map, about."""


@dataclass(frozen=True, kw_only=True)
class MapPoint:
    """An arch on the map.

    Parameters
    ----------
    mu, eta : float
    mode : Mode or None
        As observed.
    label : str
        Number or letter written beside it.
    miss : bool
        Whether something disagrees.
    note : str
        Line of the legend that explains the label.
    engine : str
        Which one observed it.
    outline : bool
        Drawn as an outline, around the point of another engine; without a label.
    link : str
        Where a click on it leads, in SVG; nowhere if empty.
    """

    mu: float
    eta: float
    mode: Mode | None
    label: str
    miss: bool
    note: str
    engine: str = ""
    outline: bool = False
    link: str = ""


def map_figure(
    points: Sequence[MapPoint] = (), *, title: str = "", central: bool = False
) -> Figure:
    """Draw the regions of the map (Fig. 9), with points in front.

    Parameters
    ----------
    points : sequence of MapPoint
    title : str
    central : bool
        Only the middle, where most regions meet (Fig. 11).

    Returns
    -------
    Figure
    """
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(11.0, 7.2) if points else (8.6, 7.0), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        draw_regions(axes, central=central)
        _draw_points(axes, points)
        axes.set_title(title or "Least thickness and collapse modes of circular arches", pad=12)
        if points:
            _legend(figure, points)
    return figure


def draw_regions(axes: Axes, *, central: bool = False) -> None:
    """Fill the regions of the six modes at finite friction, and name them (Figs 9-11)."""
    shapes = map_shapes()
    for part in shapes.regions:
        tint = MODES[part.mode].tint
        axes.fill_between(part.mu, part.bottom, part.top, color=tint, lw=0)
    lines = (
        (shapes.divide, "-"),
        (shapes.first, "-"),
        (shapes.equal, ":"),
        (shapes.crown, "--"),
    )
    for curve, style in lines:
        axes.plot(curve.mu, curve.eta, style, color=INK, lw=1.1)
    _name_regions(axes, central=central)
    for mark in shapes.landmarks.values():
        if central and mark.name == "B":
            continue
        axes.plot(mark.mu, mark.eta, "o", ms=5, mfc="white", mec=INK, zorder=4)
        axes.annotate(
            mark.name,
            (mark.mu, mark.eta),
            xytext=LETTERS[mark.name],
            textcoords="offset points",
            fontweight="bold",
            annotation_clip=False,
        )
    across, up = CENTRAL if central else ((0.0, LARGEST_MU), (0.0, 2.0))
    axes.set(xlim=across, ylim=up)
    axes.set_xlabel(r"friction coefficient $\mu$")
    axes.set_ylabel(r"thickness-to-radius ratio $\eta = t/r$")


def _name_regions(axes: Axes, *, central: bool) -> None:
    """Write each mode into its region; the thin one gets a line to its name."""
    places = CENTRAL_NAMES if central else NAMES
    for mode, (x, y) in places.items():
        size = 10 if mode is Mode.SRR else 13
        style: dict[str, Any] = {
            "color": MODES[mode].colour,
            "fontweight": "bold",
            "fontsize": size,
        }
        axes.text(x, y, mode.value, ha="center", va="center", **style)
    target, words = ((2.2, 0.972), (2.24, 1.02)) if central else ((3.4, 0.987), (3.4, 1.16))
    axes.annotate(
        Mode.RSR.value,
        target,
        xytext=words,
        ha="center",
        color=MODES[Mode.RSR].colour,
        fontweight="bold",
        arrowprops={"arrowstyle": "-", "color": MODES[Mode.RSR].colour, "lw": 0.8},
    )


def _draw_points(axes: Axes, points: Sequence[MapPoint]) -> None:
    taken = [(point.mu, point.eta) for point in points]
    for name, mark in theory.landmarks().items():
        x, y = LETTERS[name]
        taken.append((mark.mu + (x + 4) * POINT[0], mark.eta + (y + 4) * POINT[1]))
    for point in points:
        style = MODES[point.mode] if point.mode else UNNAMED
        edge = style.colour if point.outline else "white"
        axes.plot(
            point.mu,
            point.eta,
            style.marker,
            ms=12 if point.outline else 8,
            mfc="none" if point.outline else style.colour,
            mec=MISS if point.miss else edge,
            mew=1.8 if point.miss else 0.8,
            zorder=5,
            clip_on=False,
            url=point.link or None,
        )
        if point.miss:
            axes.plot(point.mu, point.eta, "o", ms=16, mfc="none", mec=MISS, mew=1.4, zorder=5)
        if point.outline:
            continue
        axes.annotate(
            point.label,
            (point.mu, point.eta),
            xytext=_free_place(point, taken),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=8,
            zorder=6,
            annotation_clip=False,
            url=point.link or None,
        )


def _free_place(point: MapPoint, taken: list[tuple[float, float]]) -> tuple[float, float]:
    """Choose where beside a point its label hides nothing, and take that place.

    Offsets are in points.
    """
    across, up = POINT
    for distance in (13.0, 20.0, 28.0, 37.0):
        for turn in (0, 1, 7, 2, 6, 3, 5, 4):
            x, y = distance * np.cos(turn * np.pi / 4), distance * np.sin(turn * np.pi / 4)
            place = point.mu + x * across, point.eta + y * up
            if place[1] < 2.0 and all(
                abs(place[0] - mu) > 11 * across or abs(place[1] - eta) > 10 * up
                for mu, eta in taken
                if (mu, eta) != (point.mu, point.eta)
            ):
                taken.append(place)
                return float(x), float(y)
    return 13.0, 0.0


def _legend(figure: Figure, points: Sequence[MapPoint]) -> None:
    """Tell modes by colour and shape, and number the arches, beside the picture."""
    seen = sorted({p.mode for p in points if p.mode}, key=list(Mode).index)
    handles = [
        Line2D([], [], ls="", marker=MODES[m].marker, mfc=MODES[m].colour, mec="white", ms=8,
               label=f"{m.value}  {m.description.split(' (')[0]}")
        for m in seen
    ]  # fmt: skip
    if any(point.mode is None for point in points):
        handles.append(Line2D([], [], ls="", marker="*", mfc="k", ms=9, label="mode unnamed"))
    if any(point.miss for point in points):
        ring = Line2D([], [], ls="", marker="o", mfc="none", mec=MISS, ms=11, label="a miss")
        handles.append(ring)
    for outline in (False, True):
        engine = next((p.engine for p in points if p.outline is outline and p.engine), None)
        if engine:
            fill, size = ("none", 11) if outline else ("k", 8)
            shape = Line2D([], [], ls="", marker="o", mec="k", mfc=fill, ms=size, label=engine)
            handles.append(shape)
    handles += [
        Line2D([], [], ls="", label=f"{p.label:>2}  {p.note}") for p in points if not p.outline
    ]
    figure.legend(
        handles=handles,
        loc="outside right upper",
        frameon=False,
        fontsize=8,
        title="Observed mode, drawn at the bracket",
        alignment="left",
        handletextpad=0.4,
    )


def save_figure(figure: Figure, file: BinaryIO, kind: str) -> None:
    """Write a figure as png or svg, without the date, so that equal figures are equal."""
    with mpl.rc_context(FONT):
        metadata = {"Date": None} if kind == "svg" else {"Software": "blocksim"}
        figure.savefig(file, format=kind, dpi=150, metadata=metadata)
