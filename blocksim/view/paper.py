# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""Every figure of Cocchetti and Rizzi (2024), by its number."""

from __future__ import annotations

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from blocksim.common.checks import require
from blocksim.studies.paper import ARCHES, FIGURES
from blocksim.view.linemap import line_map_figure
from blocksim.view.mapequations import draw_equations
from blocksim.view.mapregions import (
    CENTRAL,
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


def paper_figure(number: int) -> Figure:
    """Draw a figure of the paper.

    Parameters
    ----------
    number : int
        1 to 25.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there is no such figure.
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
        FigureCanvasAgg(figure)
        return figure


def _filled(number: int) -> Figure:
    """Draw the regions: Fig. 9 with equations, Fig. 10 without, Fig. 11 the middle."""
    figure = Figure(figsize=(8.6, 7.0), layout="constrained")
    axes = figure.add_subplot()
    draw_regions(axes, CENTRAL if number == 11 else WHOLE)
    if number == 9:
        draw_unbounded(axes)
        draw_asymptote(axes)
        draw_equations(axes)
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
