"""The bands of two answers upon the paper's map, over the friction angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import itemgetter

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.saved_answers import Row
from blocksim import Mode
from blocksim.arch.circular import Weight
from blocksim.view.mapregions import Section, draw_regions
from blocksim.view.mapshapes import ANGLE
from blocksim.view.style import INK

SHOWN, WIDE = 7, 140.0
"""Voussoirs of the arches drawn as bands, and half-angle from which on they are [deg]."""
SEVERAL = 3
"""Frictions of a half-angle from which on its band is drawn."""
ANGLES = 142.5, 157.5
"""Half-angles of the first and the last colour [deg]."""
LEFT = 58.0
"""Friction angle at which the map begins here [deg]."""
PLACES = {Mode.RRR: (60.0, 0.5), Mode.SS: (59.6, 1.5), Mode.RRS: (59.7, 0.8),
          Mode.RS: (86.5, 1.9)}  # fmt: skip
"""Where modes are named: friction angle [deg] and thickness."""
MARKERS = {5: "p", 9: "v", 11: "^", 15: "s", 27: "D", 101: "*"}
"""What marks both ends of the band of other numbers of voussoirs."""
LIMIT, END = "-", "--"


def draw(rows: Sequence[Row]) -> Figure:
    """Draw least thickness and end of the band upon the map, for both weights.

    Parameters
    ----------
    rows : sequence of Row
        With `voussoirs`, `weight`, `alpha_deg`, `mu`, `eta_limit`, and `eta_moves`, the end
        of the band, None where there is none.

    Returns
    -------
    Figure
        Half-angles in colours; seven voussoirs as bands, others as marks at both ends, and
        crosses where there is no band.
    """
    figure = Figure(figsize=(13.0, 7.6), layout="constrained")
    weights: tuple[Weight, ...] = ("centreline", "sector")
    panels = figure.subplots(1, len(weights), sharey=True)
    for axes, weight in zip(panels, weights, strict=True):
        names = {
            mode: (math.tan(math.radians(phi)), eta) for mode, (phi, eta) in PLACES.items()
        }
        low = math.tan(math.radians(LEFT))
        draw_regions(axes, Section((low, 1e3), (0.4, 2.0), names), weight, ANGLE)
        axes.set_xlim(LEFT, 90.0)
        _bands(axes, [row for row in rows if row["weight"] == weight])
        axes.set_title(
            f"weight of the {weight}" if weight == "centreline" else "sectors' weight"
        )
    panels[1].set_ylabel("")
    figure.suptitle(
        "Above the least thickness arches can rest and may move, up to the dashed line"
    )
    figure.legend(handles=_legend(rows), loc="outside lower center", ncols=8, frameon=False)
    return figure


def _bands(axes: Axes, rows: Sequence[Row]) -> None:
    wide = [row for row in rows if float(row["alpha_deg"] or 0) > WIDE]
    for alpha in sorted({float(row["alpha_deg"] or 0) for row in wide}):
        own = sorted((row for row in wide if row["alpha_deg"] == alpha), key=itemgetter("mu"))
        seven = [row for row in own if row["voussoirs"] == SHOWN]
        drawn = seven if len(seven) >= SEVERAL else []
        colour = colour_of(alpha)
        if drawn:
            at, least, end = _lines(drawn)
            axes.fill_between(at, least, end, color=colour, alpha=0.35, lw=0)
            axes.plot(at, least, LIMIT, color=colour, label=f"{alpha:g}° least")
            axes.plot(at, end, END, color=colour, label=f"{alpha:g}° end")
        for row in own:
            if row in drawn:
                continue
            (at,), (least,), (end,) = _lines([row])
            mark = MARKERS.get(int(row["voussoirs"] or 0), "o")
            label = f"{row['voussoirs']} voussoirs, {alpha:g}°"
            if row["eta_moves"] is None or row["eta_moves"] == "":
                axes.plot(at, least, "x", color=INK, ms=6, label=f"{label}, none")
            else:
                axes.plot([at, at], [least, end], "-", marker=mark, color=colour, mec=INK,
                          mew=0.7, ms=6, label=label)  # fmt: skip


def _lines(rows: Sequence[Row]) -> tuple[list[float], list[float], list[float]]:
    """Friction angle, least thickness, and end of the band."""
    at = ANGLE.place([float(row["mu"] or 0) for row in rows]).tolist()
    least = [float(row["eta_limit"] or 0) for row in rows]
    return at, least, [float(row["eta_moves"] or row["eta_limit"] or 0) for row in rows]


def colour_of(alpha: float) -> tuple[float, float, float, float]:
    """Colour of a half-angle [deg]."""
    low, high = ANGLES
    return colormaps["plasma"](0.9 * min(max((alpha - low) / (high - low), 0.0), 1.0))


def _legend(rows: Sequence[Row]) -> list[Line2D]:
    alphas = sorted({float(row["alpha_deg"] or 0) for row in rows})
    several = [
        alpha
        for alpha in alphas
        if alpha > WIDE
        and sum(row["alpha_deg"] == alpha and row["voussoirs"] == SHOWN for row in rows)
        >= SEVERAL
    ]
    handles = [Line2D([], [], color=colour_of(each), label=f"{each:g}°") for each in several]
    band = {int(row["voussoirs"] or 0) for row in rows if row["eta_moves"]}
    handles += [
        Line2D([], [], ls="", marker=mark, color="white", mec=INK, label=f"{n} voussoirs")
        for n, mark in MARKERS.items()
        if n in band
    ]
    handles.append(Line2D([], [], ls="", marker="o", color="white", mec=INK, label="7, single"))
    handles.append(Line2D([], [], ls="", marker="x", color=INK, label="no band"))
    return handles
