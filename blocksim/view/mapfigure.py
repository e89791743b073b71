"""The mode map with arches on it: marks, labels that hide nothing, legend (Figs 9-11)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from blocksim.arch import theory
from blocksim.arch.circular import Weight
from blocksim.arch.modes import Mode
from blocksim.blocks.assembly import Array
from blocksim.view.drawing import new_figure
from blocksim.view.mapregions import (
    LETTERS,
    NEAR,
    STRIP,
    Section,
    draw_regions,
    draw_unbounded,
    section_of,
)
from blocksim.view.mapshapes import COEFFICIENT, LARGEST_MU, FrictionAxis, map_shapes
from blocksim.view.style import FONT, INK, MISS, MODES, UNNAMED

INSET = (0.08, 0.535, 0.27, 0.39)
"""Box of the enlarged part, in shares of the map. Only ss is there."""
BESIDE_INSET = (0.5, 0.82)
"""Place of the name ss beside the enlarged part [mu, eta]."""
POINTS_ACROSS, POINTS_UP = 440.0, 400.0
"""Size of the map beside a legend in typographic points, about."""
NONE = ": no thickness stands"
OF: dict[Weight, str] = {"centreline": "", "sector": ", weight of sectors"}
"""Words of a title on the weight."""


@dataclass(frozen=True, kw_only=True)
class MapPoint:
    """An arch on the map.

    `mu`, `eta`: Unbounded friction has a strip of its own.
    `mode`: As observed.
    `label`: Number or letter written beside it.
    `miss`: Whether something disagrees.
    `note`: Line of the legend that explains the label.
    `engine`: Which one observed it.
    `outline`: Drawn as an outline, around the point of another engine; without a label.
    `none_stands`: Whether no thickness stands: then it is drawn at the upper frame, with an
        arrow.
    `link`: Where a click on it leads, in SVG; nowhere if empty.
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
    points: Sequence[MapPoint] = (),
    *,
    title: str = "",
    central: bool = False,
    weight: Weight = "centreline",
    friction: FrictionAxis = COEFFICIENT,
) -> Figure:
    """Draw the regions of the map (Fig. 9), with points in front.

    `central`: Only the middle, where most regions meet (Fig. 11).
    `friction`: The coefficient; without points the friction angle is possible, too.
    """
    with mpl.rc_context(FONT):
        figure = new_figure((10.4, 6.9) if points else (8.6, 7.0))
        axes = figure.add_subplot()
        crowded = [point for point in points if NEAR.shows(point.mu, point.eta)]
        section = section_of(weight, central=central)
        if crowded:
            section = section._replace(names={**section.names, Mode.SS: BESIDE_INSET})
        draw_regions(axes, section, weight, friction)
        # Room for the arrow of what never stands.
        pad = 26 if any(point.none_stands for point in points) else 12
        axes.set_title(
            title or f"Least thickness and collapse modes of circular arches{OF[weight]}",
            pad=pad,
        )
        if any(math.isinf(point.mu) for point in points) or (friction.angle and not central):
            draw_unbounded(axes, weight, friction)
        if points:
            _draw_points(axes, section, points, unnamed=crowded)
            _legend(figure, points)
        if crowded:
            _draw_near(axes, crowded, weight)
    return figure


def _draw_near(axes: Axes, crowded: Sequence[MapPoint], weight: Weight) -> None:
    """Draw the part where arches crowd enlarged, within the map."""
    near = axes.inset_axes(INSET)
    draw_regions(near, NEAR, weight)
    near.set(xlabel="", ylabel="", xticks=[1.7, 1.8, 1.9], yticks=[0.92, 0.97, 1.02])
    near.tick_params(labelsize=8)
    near.spines[:].set_visible(True)
    _draw_points(near, NEAR, crowded)
    axes.indicate_inset_zoom(near, edgecolor=INK, alpha=0.6)


def _place(point: MapPoint) -> tuple[float, float]:
    """Return the place of a point. Unbounded friction is in its strip."""
    return sum(STRIP) / 2 if math.isinf(point.mu) else min(point.mu, LARGEST_MU), point.eta


def _draw_points(
    axes: Axes,
    section: Section,
    points: Sequence[MapPoint],
    unnamed: Sequence[MapPoint] = (),
) -> None:
    """Draw points and their labels. Unnamed ones are small, as the enlarged part names them."""
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
    lines = _lines(section)
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
        away = _free_place((x, y), len(point.label), marks, taken, lines / grain, grain, low)
        taken.append((x + away[0] * grain[0], y + away[1] * grain[1]))
        axes.annotate(
            point.label,
            (x, y),
            xytext=away,
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=8.5,
            zorder=6,
            annotation_clip=False,
            url=point.link or None,
        )


def _lines(section: Section) -> Array:
    """Points on the lines of the map, as dense as its page has them, (k, 2)."""
    found: list[Array] = []
    for curve in map_shapes().lines.values():
        first = max(section.mu[0], float(curve.mu.min()))
        mu = np.linspace(first, min(section.mu[1], float(curve.mu.max())), 400)
        order = np.argsort(curve.mu)
        found.append(np.column_stack([mu, np.interp(mu, curve.mu[order], curve.eta[order])]))
    return np.concatenate(found)


def _free_place(
    start: tuple[float, float],
    letters: int,
    marks: Sequence[tuple[float, float]],
    taken: Sequence[tuple[float, float]],
    lines: Array,
    grain: tuple[float, float],
    low: float,
) -> tuple[float, float]:
    """Choose where beside a mark its label is over no other words or line, and nearest to it.

    Everything is on the map, but for the place, which is in points from the mark, and the
    lines, which are in points; `grain` is what a point covers, `low` the axis below, which a
    label keeps off.
    """
    here = np.array(start)
    others = [np.array(mark) for mark in marks if mark != start]
    # Half of the label and a hair; where none fits between the lines, it lies on one.
    box = 2.8 * letters + 1.5, 4.5
    tries = [(distance, lines) for distance in (15.0, 18.0, 22.0, 28.0, 37.0)]
    tries += [(distance, lines[:0]) for distance, _ in tries]
    for distance, near in tries:
        for turn in (0, 1, 15, 2, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8):
            angle = turn * math.pi / 8
            place = distance * np.array([math.cos(angle), math.sin(angle)])
            marked = [(here - mark) / grain + place for mark in others]
            written = [np.abs((here - words) / grain + place) for words in taken]
            above = (start[1] - low) / grain[1] + place[1]
            free = all(across > 13 or up > 10 for across, up in written)
            crossed = (np.abs(here / grain + place - near) < box).all(axis=1).any()
            own = all(math.hypot(*way) > 1.15 * distance for way in marked)
            if above > 7 and free and own and not crossed:
                return float(place[0]), float(place[1])
    return 15.0, 0.0


def _legend(figure: Figure, points: Sequence[MapPoint]) -> None:
    """Tell modes by colour and shape, and number the arches, beside the picture."""
    seen = sorted({p.mode for p in points if p.mode}, key=list(Mode).index)
    marks = [
        (f"{m.value}  {m.description.split(' (')[0]}", MODES[m].marker, MODES[m].colour,
         "white", 8)
        for m in seen
    ]  # fmt: skip
    if any(point.mode is None for point in points):
        marks.append(("mode unnamed", "*", "k", "k", 9))
    if any(point.miss for point in points):
        marks.append(("a miss", "o", "none", MISS, 11))
    for outline, fill, size in ((False, "k", 8), (True, "none", 11)):
        engine = next((p.engine for p in points if p.outline is outline and p.engine), None)
        marks += [(engine, "o", fill, "k", size)] if engine else []
    marks += [
        (f"{p.label:>2}  {p.note}{NONE if p.none_stands else ''}", "", "k", "k", 0)
        for p in points
        if not p.outline
    ]
    handles = [
        Line2D([], [], ls="", label=label, marker=marker, mfc=fill, mec=edge, ms=size)
        for label, marker, fill, edge, size in marks
    ]
    figure.legend(
        handles=handles,
        loc="outside right upper",
        frameon=False,
        fontsize=8.5,
        title="Mode observed; each mark is halfway between the\n"
        "largest thickness that fell and the smallest that stood",
        title_fontsize=8.5,
        alignment="left",
        handletextpad=0.4,
    )
