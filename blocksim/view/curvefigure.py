# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""Curves of a structure that moves: the push that is borne, or the thrust, over its way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from blocksim.common.words import printable
from blocksim.view.drawing import literal
from blocksim.view.style import FONT, INK, MODES

COLOURS = (INK, *(style.colour for style in MODES.values()))
DASHES = ("-", (0, (5, 2)))


class Line(NamedTuple):
    """A line of a diagram: its name, and its points."""

    name: str
    x: Sequence[float]
    y: Sequence[float]


def curve_figure(title: str, across: str, up: str, lines: Sequence[Line]) -> Figure:
    """Draw lines over a way; artists have their names as `gid`."""
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(7.6, 4.2), layout=ConstrainedLayoutEngine(h_pad=0.1))
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        for place, line in enumerate(lines):
            axes.plot(line.x, line.y, color=COLOURS[place], ls=DASHES[place % 2], lw=1.3,
                      label=line.name, gid=line.name)  # fmt: skip
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        axes.set_ylim(bottom=0)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False)
        figure.suptitle(literal(printable(title)), x=0.02, ha="left", fontsize=10)
    return figure
