# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""Speed against accuracy, log-log, one panel for each arch."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from blocksim.view.style import FONT, METHODS, QUIET, UNNAMED
from blocksim.workprec import Point, front


def chart_figure(points: Sequence[Point]) -> Figure:
    """Draw error against time; every repeat, medians joined, the front in the background.

    Parameters
    ----------
    points : sequence of Point

    Returns
    -------
    Figure
    """
    names = list(dict.fromkeys(point.case for point in points))
    methods = list(dict.fromkeys(point.method for point in points))
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(2.9 * len(names) + 1.0, 4.0), layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
        for axes, name in zip(panels, names, strict=True):
            here = [p for p in points if p.case == name and math.isfinite(p.error)]
            best = front(here)
            axes.loglog(
                [p.wall_s for p in best],
                [p.error for p in best],
                color=QUIET,
                lw=7,
                alpha=0.25,
                solid_capstyle="round",
                label="the front",
            )
            for method in methods:
                own = [p for p in here if p.method == method]
                style = METHODS.get(method, UNNAMED)
                axes.loglog(
                    [p.wall_s for p in own],
                    [p.error for p in own],
                    style.marker + "-",
                    color=style.colour,
                    ms=5,
                    label=method,
                )
                axes.loglog(
                    [second for p in own for second in p.seconds],
                    [p.error for p in own for _ in p.seconds],
                    ".",
                    color=style.colour,
                    ms=3,
                    alpha=0.6,
                )
            title, _, rest = name.partition(": ")
            axes.set_title(f"{title}\n{rest}", fontsize=9)
            axes.set_xlabel("time of a bracket [s]")
            axes.grid(alpha=0.3)
        panels[0].set_ylabel("error of least thickness, relative")
        panels[0].legend(frameon=False, fontsize=8)
    return figure
