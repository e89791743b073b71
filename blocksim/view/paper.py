"""Every figure of Cocchetti and Rizzi (2024), by its number."""

from __future__ import annotations

from typing import NamedTuple

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from blocksim.arch.modes import Mode
from blocksim.common.checks import require
from blocksim.studies.paper import ARCHES, FIGURES
from blocksim.view.drawing import new_figure
from blocksim.view.linemap import line_map_figure
from blocksim.view.mapregions import (
    CENTRAL,
    STRIP,
    WHOLE,
    draw_asymptote,
    draw_regions,
    draw_unbounded,
)
from blocksim.view.paperarches import paper_arch_figure
from blocksim.view.papercurves import curve_figure
from blocksim.view.papersketches import sketch_figure
from blocksim.view.style import FONT, MODES

SKETCHES = (1, 2, 12)
CURVES = (3, 4, 5)
SPANS = {6: (0.0, 2.0), 7: (0.0, 1.0), 8: (0.6, 2.0)}
"""Thickness ratios of the map's three pictures as lines."""


class Note(NamedTuple):
    """Equations of a region, where they stand, and where a line to it ends [mu, eta]."""

    text: str
    at: tuple[float, float]
    target: tuple[float, float] | None = None


NOTES = {
    Mode.RRR: Note(r"$h=h_L=h_U=h_2=h_e$", (2.3, 0.27)),
    Mode.SS: Note(r"$\mu=\mu_{ss}=\mu_{is}$", (0.75, 1.26)),
    Mode.SRR: Note(r"$\mu=\mu_{ss}$, $h=h_L=h_e$", (0.42, 0.72), (0.8, 0.42)),
    Mode.RRS: Note(
        r"$\mu=\mu_{is}$, $h=h_U=h_e$, $\beta_r\geq\beta_s$", (2.75, 0.55), (2.6, 0.86)
    ),
    Mode.RSR: Note(
        r"$\mu=\mu_{is}$, $h=h_U=h_e$, $\beta_r\leq\beta_s$", (3.4, 1.26)
    ),
    Mode.RS: Note(r"$\mu=\mu_{is}$, $h=h_U$, $\beta_r=0$", (3.4, 1.52)),
    Mode.R: Note(r"$h=h_2=0$", (sum(STRIP) / 2, 1.25)),
}  # fmt: skip
"""What holds in each: h_L (1), h_U (2), h_2 (3), h_e (4), mu_ss (8), mu_is (9)."""


def paper_figure(number: int) -> Figure:
    """Draw a figure of the paper.

    `number`: 1 to 25.
    """
    require(number in FIGURES, "figure", number, "from 1 to 25")
    with mpl.rc_context(FONT):
        if number in SKETCHES:
            figure = sketch_figure(number)
        elif number in CURVES:
            figure = curve_figure(number)
        elif number in SPANS:
            figure = line_map_figure(SPANS[number])
        elif number in ARCHES:
            figure = paper_arch_figure(number)
        else:
            figure = _filled(number)
        return figure


def _filled(number: int) -> Figure:
    """Draw the regions: Fig. 9 with equations, Fig. 10 without, Fig. 11 the middle."""
    figure = new_figure((8.6, 7.0))
    axes = figure.add_subplot()
    draw_regions(axes, CENTRAL if number == 11 else WHOLE)
    if number == 9:
        draw_unbounded(axes)
        draw_asymptote(axes)
        _draw_equations(axes)
        return figure
    # These two have no words within; the colours are told below.
    names = {mode.value for mode in MODES}
    for text in axes.texts:
        text.set_visible(text.get_text() not in names)
    fills = {str(each.get_gid()).removeprefix("region-"): each for each in axes.collections}
    handles = [
        Patch(fc=style.tint, ec=style.colour, label=f"{mode.value}  {mode.description}")
        for mode, style in MODES.items()
        if mode.value in fills
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _draw_equations(axes: Axes) -> None:
    """Write into each region of the whole map which equations rule there."""
    for mode, note in NOTES.items():
        colour = MODES[mode].ink
        leads = None
        if note.target is not None:
            leads = {"arrowstyle": "-", "color": colour, "lw": 0.9}
        axes.annotate(
            note.text,
            note.target or note.at,
            xytext=note.at,
            ha="center",
            va="center",
            fontsize=8.5,
            color=colour,
            rotation=90 if mode is Mode.R else 0,
            arrowprops=leads,
            gid=f"equations {mode}",
        )
