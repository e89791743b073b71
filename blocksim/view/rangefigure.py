# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""A bracket over a parameter: the values at which it stands, and at which it falls."""

from __future__ import annotations

import math

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from blocksim.ask.bracket import Bracket
from blocksim.simulation.verdict import Verdict
from blocksim.view.style import FONT, INK, VERDICTS

BEYOND = 3.0
"""How far values are drawn beyond the bracket, in its widths, and at least a tenth of it."""


def range_figure(answer: Bracket) -> Figure:
    """Draw the values of a parameter as a line: standing, falling, and the exact value.

    Artists have a `gid`: `stands`, `collapses`, `limit`.
    """
    ends = [each for each in (answer.low, answer.high) if each is not None]
    exact = answer.limit if answer.limit is not None and math.isfinite(answer.limit) else None
    known = [*ends, *([] if exact is None else [exact])] or [0.0, 1.0]
    width = max(BEYOND * (max(known) - min(known)), 0.1 * abs(max(known, key=abs)), 1e-12)
    first, last = min(known) - width, max(known) + width
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(7.6, 1.7), layout=ConstrainedLayoutEngine(h_pad=0.1))
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        below, above = Verdict.COLLAPSES, Verdict.STANDS
        if answer.stands == "low":
            below, above = above, below
        if answer.low is not None:
            _draw(axes, below, first, answer.low)
        if answer.high is not None:
            _draw(axes, above, answer.high, last)
        if exact is not None:
            axes.axvline(exact, color=INK, lw=1.2, ls=(0, (4, 2)), gid="limit",
                         label="limit analysis")  # fmt: skip
        axes.set_ylim(-1, 1)
        axes.set_xlim(first, last)
        axes.set_yticks([])
        axes.spines["left"].set_visible(False)
        unit = f" [{answer.unit}]" if answer.unit else ""
        axes.set_xlabel(f"{answer.over}{unit}, by {answer.method}")
        if axes.get_legend_handles_labels()[0]:
            figure.legend(loc="outside upper center", ncols=3, frameon=False)
    return figure


def _draw(axes: Axes, verdict: Verdict, first: float, last: float) -> None:
    axes.plot([first, last], [0, 0], color=VERDICTS[verdict], lw=9, label=verdict.value,
              gid=verdict.value, solid_capstyle="butt")  # fmt: skip
