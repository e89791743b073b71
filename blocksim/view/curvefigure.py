"""Curves: what is borne as blocks move, where a vehicle stands, over a parameter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import fill
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from blocksim.ask.bracket import Bracket
from blocksim.ask.crossing import HEADINGS, Crossing
from blocksim.blocks.assembly import Array
from blocksim.blocks.road import road_of
from blocksim.common.words import printable
from blocksim.simulation.verdict import Verdict
from blocksim.view.drawing import literal, new_figure
from blocksim.view.sheet import title_of
from blocksim.view.structure import draw_structure
from blocksim.view.style import FONT, INK, LIVE, QUIET, THRUST, VERDICTS

DASHES = ("-", (0, (5, 2)))
HIGHEST = 5.0
"""Load factor over the least one, up to which the curve is shown."""
SIZE, CURVES, ASIDE, TALLEST = (7.6, 5.3), (2.0, 1.3), 0.6, 5.0
BROAD = 95
"""Width of an envelope, and height of its curves with their parts of it; room beside the
drawing below them, and its greatest height [inches]; characters in a line of its title."""
BEYOND = 3.0
"""How far values are drawn beyond the bracket, in its widths, and at least a tenth of it."""


class Line(NamedTuple):
    """A line of a diagram: its name, its points, and the colour of what it shows."""

    name: str
    x: Sequence[float]
    y: Sequence[float]
    colour: str = INK


def curve_figure(title: str, across: str, up: str, lines: Sequence[Line]) -> Figure:
    """Draw lines over a way; artists have their names as `gid`."""
    with mpl.rc_context(FONT):
        figure = new_figure((7.6, 4.2), pad=0.1)
        axes = figure.add_subplot()
        for place, line in enumerate(lines):
            axes.plot(line.x, line.y, color=line.colour, ls=DASHES[place % 2], lw=1.3,
                      label=line.name, gid=line.name)  # fmt: skip
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        axes.set_ylim(bottom=0)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False)
        figure.suptitle(literal(printable(title)), x=0.02, ha="left", fontsize=10)
    return figure


def envelope_figure(answer: Crossing) -> Figure:
    """Draw load factors over the middle of the axles, and the worst place below.

    Artists have a `gid`: `factor-right`, `factor-left`, `thrust-min-right`, `thrust-max-right`,
    `worst`, and those of `problem_figure`.
    """
    with mpl.rc_context(FONT):
        figure = new_figure(SIZE, pad=0.1)
        rows = figure.subplots(3, 1, sharex=True, height_ratios=(*CURVES, 2))
        factors, thrusts, drawn = rows.ravel().tolist()
        _factors(factors, answer)
        _thrusts(thrusts, answer)
        low, high = _structure(drawn, answer)
        # The drawing has the height it needs, as wide as the curves are.
        left, right = min(low[0], drawn.get_xlim()[0]), max(high[0], drawn.get_xlim()[1])
        wide, height = SIZE[0] - ASIDE, 1.08 * float(high[1] - low[1])
        spare = max(0.0, height * wide / TALLEST - (right - left))
        drawn.set_xlim(left - spare / 2, right + spare / 2)
        tall = wide * height / (right - left + spare)
        figure.set_size_inches(SIZE[0], SIZE[1] + tall)
        rows[0].get_gridspec().set_height_ratios((*CURVES, tall))
        drawn.set_xlabel("middle of the axles [m]")
        title = f"{title_of(answer.problem)}: {printable(answer.vehicle.words)}"
        figure.suptitle(fill(literal(title), BROAD), x=0.02, ha="left", fontsize=10)
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
    _above(axes, columns=3)


def _thrusts(axes: Axes, answer: Crossing) -> None:
    for heading, dashes in zip(HEADINGS, DASHES, strict=True):
        # Curves end where it falls.
        found = np.array(
            [
                (_middle(place.axles), *(ends or (math.nan, math.nan)))
                for place, ends in zip(answer.places, answer.thrusts, strict=True)
                if place.heading == heading
            ]
        ).reshape(-1, 3)
        if not np.isfinite(found[:, 1:]).all(axis=1).any():
            continue
        x, least, most = found.T * [[1], [1e-3], [1e-3]]
        for name, values, wide in (("min", least, 0.8), ("max", most, 1.8)):
            axes.plot(x, values, color=THRUST, ls=dashes, lw=wide,
                      label=f"{'least' if name == 'min' else 'greatest'}, heading {heading}",
                      gid=f"thrust-{name}-{heading}")  # fmt: skip
    axes.set_ylabel("crown thrust [kN]")
    if axes.get_legend_handles_labels()[0]:
        _above(axes, columns=4)
    else:
        axes.text(0.5, 0.5, "it falls, or thrust has no meaning, at every place", color=QUIET,
                  ha="center", transform=axes.transAxes)  # fmt: skip


def _above(axes: Axes, *, columns: int) -> None:
    """Put the legend above a curve, where it hides nothing."""
    axes.legend(frameon=False, ncols=columns, loc="lower right", bbox_to_anchor=(1, 1),
                borderaxespad=0, fontsize=7)  # fmt: skip


def _structure(axes: Axes, answer: Crossing) -> tuple[Array, Array]:
    """Draw the worst place, and return the corners of what is drawn [m]."""
    problem, road = answer.problem, road_of(answer.problem)
    shown = draw_structure(axes, problem, answer.mechanism)
    height = float(shown[0][:, 1].max()) if road is None else road
    axes.axhline(height, color=QUIET, lw=0.8, ls=(0, (6, 3)), gid="road")
    axes.plot(answer.worst.axles, [height] * len(answer.worst.axles), "v", color=LIVE, ms=7,
              gid="axles", zorder=10)  # fmt: skip
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_ylabel("height [m]")
    points = np.concatenate([*shown, [[answer.worst.axles[0], height]]])
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set_ylim(float(low[1]), float(high[1]))
    return low, high


def range_figure(answer: Bracket) -> Figure:
    """Draw where it stands and falls: artists `stands`, `collapses` and `limit`, by `gid`."""
    ends = [each for each in (answer.low, answer.high) if each is not None]
    exact = answer.limit if answer.limit is not None and math.isfinite(answer.limit) else None
    known = [*ends, *([] if exact is None else [exact])] or [0.0, 1.0]
    width = max(BEYOND * (max(known) - min(known)), 0.1 * abs(max(known, key=abs)), 1e-12)
    first, last = min(known) - width, max(known) + width
    with mpl.rc_context(FONT):
        figure = new_figure((7.6, 1.7), pad=0.1)
        axes = figure.add_subplot()
        below, above = Verdict.COLLAPSES, Verdict.STANDS
        if answer.stands == "low":
            below, above = above, below
        if answer.low is not None:
            _values(axes, below, first, answer.low)
        if answer.high is not None:
            _values(axes, above, answer.high, last)
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


def _values(axes: Axes, verdict: Verdict, first: float, last: float) -> None:
    axes.plot([first, last], [0, 0], color=VERDICTS[verdict], lw=9, label=verdict.value,
              gid=verdict.value, solid_capstyle="butt")  # fmt: skip
