# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""The mode map: thickness-to-radius ratio against friction (Figs 6-11)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from blocksim.arch import theory
from blocksim.arch.modes import Mode
from blocksim.view.mapshapes import LARGEST_MU, map_shapes
from blocksim.view.style import FONT, INK, MISS, MODES, UNNAMED


class Section(NamedTuple):
    """A part of the map to draw.

    Parameters
    ----------
    mu, eta : (float, float)
        Friction and thickness shown.
    names : dict of Mode to (float, float)
        Where each mode is named.
    thin : two of (float, float), optional
        Where a line to the thin region rsr ends, and where it is named.
    """

    mu: tuple[float, float]
    eta: tuple[float, float]
    names: dict[Mode, tuple[float, float]]
    thin: tuple[tuple[float, float], tuple[float, float]] | None = None

    def shows(self, mu: float, eta: float) -> bool:
        """Tell whether a point is in it."""
        return self.mu[0] <= mu <= self.mu[1] and self.eta[0] <= eta <= self.eta[1]


WHOLE = Section(
    (0.0, LARGEST_MU),
    (0.0, 2.0),
    {
        Mode.RRR: (2.3, 0.35),
        Mode.SS: (0.75, 1.35),
        Mode.SRR: (0.72, 0.355),
        Mode.RRS: (2.45, 0.885),
        Mode.RS: (3.4, 1.6),
    },
    ((3.4, 0.987), (3.4, 1.16)),
)
CENTRAL = Section(
    (1.2, 2.4),
    (0.6, 1.2),
    {
        Mode.RRR: (2.0, 0.66),
        Mode.SS: (1.45, 1.0),
        Mode.SRR: (1.235, 0.618),
        Mode.RRS: (2.1, 0.87),
        Mode.RS: (2.15, 1.1),
    },
    ((2.2, 0.972), (2.24, 1.02)),
)
"""Where most regions meet (Fig. 11)."""
NEAR = Section(
    (1.70, 1.90),
    (0.92, 1.02),
    {
        Mode.SS: (1.735, 0.99),
        Mode.RRS: (1.865, 0.935),
        Mode.RS: (1.865, 1.0),
        Mode.RSR: (1.868, 0.9625),
    },
)
"""What is enlarged where arches crowd: the points S and J, and the thin region rsr."""
INSET = (0.045, 0.535, 0.31, 0.39)
"""Where the enlarged part is, in shares of the map: where only ss is."""
BESIDE_INSET = (0.5, 0.82)
"""Where ss is named then."""
STRIP = (4.12, 4.30)
"""Where unbounded friction is drawn, beyond the largest that is drawn to scale."""
LETTERS = {"T": (-13, 4), "S": (-19, -12), "J": (-17, 6), "B": (13, -9)}
"""Where the letter of each landmark begins, in points from it."""
POINTS_ACROSS, POINTS_UP = 440.0, 400.0
"""Size of the map beside a legend in typographic points, about."""
NONE = ": no thickness stands"


@dataclass(frozen=True, kw_only=True)
class MapPoint:
    """An arch on the map.

    Parameters
    ----------
    mu, eta : float
        Unbounded friction has a strip of its own.
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
    none_stands : bool
        Whether no thickness stands: then it is drawn at the upper frame, with an arrow.
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
    none_stands: bool = False
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
        figure = Figure(figsize=(10.4, 6.9) if points else (8.6, 7.0), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        crowded = [point for point in points if NEAR.shows(point.mu, point.eta)]
        section = CENTRAL if central else WHOLE
        if crowded:
            section = section._replace(names={**section.names, Mode.SS: BESIDE_INSET})
        draw_regions(axes, section)
        # Room for the arrow of what never stands.
        pad = 26 if any(point.none_stands for point in points) else 12
        axes.set_title(
            title or "Least thickness and collapse modes of circular arches", pad=pad
        )
        if any(math.isinf(point.mu) for point in points):
            _draw_unbounded(axes)
        if points:
            _draw_points(axes, section, points, unnamed=crowded)
            _legend(figure, points)
        if crowded:
            near = axes.inset_axes(INSET)
            draw_regions(near, NEAR)
            near.set(xlabel="", ylabel="", xticks=[1.7, 1.8, 1.9], yticks=[0.92, 0.97, 1.02])
            near.tick_params(labelsize=7.5)
            near.spines[:].set_visible(True)
            _draw_points(near, NEAR, crowded)
            axes.indicate_inset_zoom(near, edgecolor=INK, alpha=0.6)
    return figure


def draw_regions(axes: Axes, section: Section = WHOLE) -> None:
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
    _name_regions(axes, section)
    for mark in shapes.landmarks.values():
        if not section.shows(mark.mu, mark.eta):
            continue
        axes.plot(mark.mu, mark.eta, "o", ms=5, mfc="white", mec=INK, zorder=4, clip_on=False)
        axes.annotate(
            mark.name,
            (mark.mu, mark.eta),
            xytext=LETTERS[mark.name],
            textcoords="offset points",
            fontweight="bold",
            annotation_clip=False,
        )
    axes.set(xlim=section.mu, ylim=section.eta)
    axes.set_xlabel(r"friction coefficient $\mu$")
    axes.set_ylabel(r"thickness-to-radius ratio $\eta = t/r$")


def _draw_unbounded(axes: Axes) -> None:
    """Draw the far end of the map, unbounded friction, as a strip beyond a gap."""
    for mode, (low, high) in ((Mode.RRR, (0.0, 1.0)), (Mode.R, (1.0, 2.0))):
        axes.fill_between(STRIP, low, high, color=MODES[mode].tint, lw=0)
    axes.plot(STRIP, (1.0, 1.0), color=INK, lw=1.1)
    middle = sum(STRIP) / 2
    axes.text(middle, 1.5, Mode.R.value, color=MODES[Mode.R].colour, fontweight="bold",
              fontsize=13, ha="center", va="center")  # fmt: skip
    axes.set_xlim(0.0, STRIP[1])
    ticks = np.arange(0.0, LARGEST_MU + 0.1, 0.5).tolist()
    axes.set_xticks([*ticks, middle], [*(f"{tick:g}" for tick in ticks), "∞"])
    gap = ((LARGEST_MU + 0.005, -0.03), STRIP[0] - LARGEST_MU - 0.01, 0.06)
    axes.add_patch(Rectangle(*gap, fc="white", ec="none", clip_on=False, zorder=3))


def _name_regions(axes: Axes, section: Section) -> None:
    """Write each mode into its region; the thin one gets a line to its name."""
    for mode, (x, y) in section.names.items():
        size = 10 if mode in {Mode.SRR, Mode.RSR} else 13
        style: dict[str, Any] = {
            "color": MODES[mode].colour,
            "fontweight": "bold",
            "fontsize": size,
        }
        axes.text(x, y, mode.value, ha="center", va="center", **style)
    if section.thin is None:
        return
    target, words = section.thin
    axes.annotate(
        Mode.RSR.value,
        target,
        xytext=words,
        ha="center",
        color=MODES[Mode.RSR].colour,
        fontweight="bold",
        fontsize=11,
        arrowprops={"arrowstyle": "-", "color": MODES[Mode.RSR].colour, "lw": 1.2},
    )


def _place(point: MapPoint) -> tuple[float, float]:
    """Where a point is drawn: unbounded friction in its strip."""
    return sum(STRIP) / 2 if math.isinf(point.mu) else min(point.mu, LARGEST_MU), point.eta


def _draw_points(
    axes: Axes,
    section: Section,
    points: Sequence[MapPoint],
    unnamed: Sequence[MapPoint] = (),
) -> None:
    """Draw points and their labels; those without a name small, they are elsewhere, too."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    # Of the map on its page; the enlarged part covers fewer points across and up.
    inset = INSET[2:] if section is NEAR else (1.0, 1.0)
    grain = (
        (right - left) / (POINTS_ACROSS * inset[0]),
        (high - low) / (POINTS_UP * inset[1]),
    )
    marks = [_place(point) for point in points if not point.outline and point not in unnamed]
    taken = list(section.names.values())
    for name, mark in theory.landmarks().items():
        x, y = LETTERS[name]
        taken.append((mark.mu + (x + 4) * grain[0], mark.eta + (y + 4) * grain[1]))
    for point in points:
        style = MODES[point.mode] if point.mode else UNNAMED
        edge = style.colour if point.outline else "white"
        size = 0.5 if point in unnamed else 1.0
        x, y = _place(point)
        axes.plot(
            x,
            y,
            style.marker,
            ms=(12 if point.outline else 8) * size,
            mfc="none" if point.outline else style.colour,
            mec=MISS if point.miss else edge,
            mew=1.8 * size if point.miss else 0.8,
            zorder=5,
            clip_on=False,
            url=point.link or None,
        )
        if point.miss:
            axes.plot(x, y, "o", ms=16 * size, mfc="none", mec=MISS, mew=1.4 * size, zorder=5,
                      clip_on=False)  # fmt: skip
        if point.none_stands and not point.outline:
            axes.annotate("", (x, y), xytext=(0, 20), textcoords="offset points", zorder=6,
                          annotation_clip=False,
                          arrowprops={"arrowstyle": "<|-", "color": style.colour})  # fmt: skip
        if point.outline or point in unnamed:
            continue
        away = _free_place((x, y), marks, taken, grain, low)
        taken.append((x + away[0] * grain[0], y + away[1] * grain[1]))
        axes.annotate(
            point.label,
            (x, y),
            xytext=away,
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=8,
            zorder=6,
            annotation_clip=False,
            url=point.link or None,
        )


def _free_place(
    start: tuple[float, float],
    marks: Sequence[tuple[float, float]],
    taken: Sequence[tuple[float, float]],
    grain: tuple[float, float],
    low: float,
) -> tuple[float, float]:
    """Choose where beside a mark its label is over no other words, and nearest to it.

    Everything is on the map, but for the place, which is in points from the mark; `grain` is
    what a point covers, `low` the axis below, which a label keeps off.
    """
    here = np.array(start)
    others = [np.array(mark) for mark in marks if mark != start]
    for distance in (15.0, 18.0, 22.0, 28.0, 37.0):
        for turn in (0, 1, 15, 2, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8):
            angle = turn * math.pi / 8
            place = distance * np.array([math.cos(angle), math.sin(angle)])
            marked = [(here - mark) / grain + place for mark in others]
            written = [np.abs((here - words) / grain + place) for words in taken]
            above = (start[1] - low) / grain[1] + place[1]
            free = all(across > 13 or up > 10 for across, up in written)
            if above > 7 and free and all(math.hypot(*way) > 1.15 * distance for way in marked):
                return float(place[0]), float(place[1])
    return 15.0, 0.0


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
        Line2D([], [], ls="", label=f"{p.label:>2}  {p.note}{NONE if p.none_stands else ''}")
        for p in points
        if not p.outline
    ]
    figure.legend(
        handles=handles,
        loc="outside right upper",
        frameon=False,
        fontsize=8,
        title="Mode observed; each mark is halfway between the\n"
        "largest thickness that fell and the smallest that stood",
        title_fontsize=8,
        alignment="left",
        handletextpad=0.4,
    )
