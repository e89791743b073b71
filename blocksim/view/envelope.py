# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""A vehicle that crosses: load factor over its place, above how it falls at the worst one."""

from __future__ import annotations

import math

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from blocksim.ask.crossing import HEADINGS, Crossing
from blocksim.blocks.road import road_of
from blocksim.common.words import printable
from blocksim.view.arrows import draw_loads
from blocksim.view.drawing import literal
from blocksim.view.sheet import title_of
from blocksim.view.structure import draw_blocks, draw_mechanism, draw_supports, edge_width
from blocksim.view.style import FONT, INK, LIVE, MODES, QUIET

HIGHEST = 5.0
"""Load factor over the least one, up to which the curve is shown."""
COLOURS = tuple(style.colour for style in MODES.values())
DASHES = ("-", (0, (5, 2)))
SIZE = (7.6, 7.2)
"""[inches]"""


def envelope_figure(answer: Crossing) -> Figure:
    """Draw load factors over the middle of the axles, and the worst place below.

    Artists have a `gid`: `factor-right`, `factor-left`, `thrust-min-right`, `thrust-max-right`,
    `worst`, and those of `problem_figure`.

    Parameters
    ----------
    answer : Crossing

    Returns
    -------
    Figure
    """
    with mpl.rc_context(FONT):
        figure = Figure(figsize=SIZE, layout=ConstrainedLayoutEngine(h_pad=0.1))
        FigureCanvasAgg(figure)
        rows = figure.subplots(3, 1, sharex=True, height_ratios=(2, 1.3, 2))
        factors, thrusts, drawn = rows.ravel().tolist()
        _factors(factors, answer)
        _thrusts(thrusts, answer)
        _structure(drawn, answer)
        drawn.set_xlabel("middle of the axles [m]")
        title = f"{title_of(answer.problem)}: {printable(answer.vehicle.words)}"
        figure.suptitle(literal(title), x=0.02, ha="left", fontsize=10)
    return figure


def _middle(axles: tuple[float, ...]) -> float:
    return (min(axles) + max(axles)) / 2


def _factors(axes: Axes, answer: Crossing) -> None:
    for heading, dashes in zip(HEADINGS, DASHES, strict=True):
        mine = [place for place in answer.places if place.heading == heading]
        if mine:
            x = [_middle(place.axles) for place in mine]
            axes.plot(x, [place.load_factor for place in mine], color=INK, ls=dashes, lw=1.1,
                      label=f"heading {heading}", gid=f"factor-{heading}")  # fmt: skip
    least = answer.load_factor
    if math.isfinite(least):
        axes.set_ylim(0, HIGHEST * least)
        at = _middle(answer.worst.axles)
        axes.plot(at, least, "o", color=LIVE, ms=5, gid="worst", label=f"least {least:.6g}")
    axes.set_ylabel("load factor")
    axes.legend(frameon=False, ncols=3, loc="upper center")


def _thrusts(axes: Axes, answer: Crossing) -> None:
    for heading, dashes in zip(HEADINGS, DASHES, strict=True):
        found = [
            (_middle(place.axles), ends[0] / 1e3, ends[1] / 1e3)
            for place, ends in zip(answer.places, answer.thrusts, strict=True)
            if place.heading == heading and ends is not None and math.isfinite(ends[1])
        ]
        if not found:
            continue
        x, least, most = np.array(found).T
        for name, values, colour in (("min", least, COLOURS[0]), ("max", most, COLOURS[5])):
            axes.plot(x, values, color=colour, ls=dashes, lw=1.1,
                      label=f"{'least' if name == 'min' else 'greatest'}, heading {heading}",
                      gid=f"thrust-{name}-{heading}")  # fmt: skip
    axes.set_ylabel("thrust at the crown [kN]")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, ncols=2, fontsize=7)
    else:
        axes.text(0.5, 0.5, "it falls, or thrust has no meaning, at every place", color=QUIET,
                  ha="center", transform=axes.transAxes)  # fmt: skip


def _structure(axes: Axes, answer: Crossing) -> None:
    problem = answer.problem
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    extent = float(np.ptp(corners, axis=0).max())
    draw_supports(axes, problem)
    draw_blocks(axes, problem, edge_width(problem, extent))
    if answer.mechanism is not None:
        draw_mechanism(axes, problem, answer.mechanism, extent)
    draw_loads(axes, problem, extent)
    road = road_of(problem)
    height = float(corners[:, 1].max()) if road is None else road
    axes.axhline(height, color=QUIET, lw=0.8, ls=(0, (6, 3)), gid="road")
    axes.plot(answer.worst.axles, [height] * len(answer.worst.axles), "v", color=LIVE, ms=7,
              gid="axles", zorder=10)  # fmt: skip
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_ylabel("height [m]")
