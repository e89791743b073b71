"""What was read of a drawing, by its names, and what was refused, where it is."""

from __future__ import annotations

import textwrap

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from blocksim.common.errors import InputError
from blocksim.common.words import printable
from blocksim.reading.drawing import Drawing, plain
from blocksim.view.drawing import literal
from blocksim.view.style import FONT, INK, MISS, QUIET, STONE

MOST = 12
"""Refusals that are listed below the picture."""
NAMED = 400
"""Blocks from which on none has its name."""


def read_figure(drawing: Drawing, refusal: InputError | None = None) -> Figure:
    """Draw what was read in units of the drawing, and in red what was refused.

    Artists have a `gid`: `block-NAME`, `support-NAME`, `refused-1`, `marked-NAME`.

    `refusal`: What was said of it; blocks that it names are marked.
    """
    with mpl.rc_context({**FONT, "font.size": 8.0}):
        figure = Figure(figsize=(11.7, 8.3))
        FigureCanvasAgg(figure)
        axes = figure.add_axes((0.07, 0.24, 0.9, 0.68))
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_title(literal(plain(drawing.path.name)), loc="left", color=INK)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        words = set[str]() if refusal is None else {*refusal.field.split()}
        many = len(drawing.blocks) > NAMED
        for shape, fixed in drawing.blocks:
            name = plain(shape.name)
            look = {"fc": "#e4e4e4", "hatch": "////"} if fixed else {"fc": STONE}
            gid = f"{'support' if fixed else 'block'}-{name}"
            axes.fill(*np.array(shape.corners).T, ec=QUIET, lw=0.6, gid=gid, **look)  # type: ignore[arg-type]
            if name in words:
                axes.fill(*np.array(shape.corners).T, fc="none", ec=MISS, lw=2.2, zorder=5,
                          gid=f"marked-{name}")  # fmt: skip
            if not many or name in words:
                middle = np.mean(shape.corners, axis=0).tolist()
                axes.text(middle[0], middle[1], literal(name), ha="center", va="center",
                          color=INK, fontsize=6, clip_on=True)  # fmt: skip
        said = [] if refusal is None else [str(refusal)]
        for number, each in enumerate(drawing.refused, start=1):
            corners = each.shape.corners
            if len(corners) > 1:
                axes.plot(*np.array(corners).T, color=MISS, lw=1.6, zorder=6)
            place = each.at or (tuple(np.mean(corners, axis=0).tolist()) if corners else None)
            if place is not None:
                axes.plot(*place, "o", ms=9, mfc="none", mec=MISS, mew=1.6, zorder=7,
                          gid=f"refused-{number}")  # fmt: skip
                axes.annotate(str(number), place, xytext=(6, 6), textcoords="offset points",
                              color=MISS, zorder=7)  # fmt: skip
            said.append(f"{number}  {each.said}: {each.why}")
        if not said:
            said = ["nothing was refused"]
        more = len(said) - MOST
        lines = said[:MOST] + ([f"and {more} more"] if more > 0 else [])
        folded = [
            part for line in lines for part in textwrap.wrap(literal(printable(line)), 140)
        ]
        figure.text(0.03, 0.19, "\n".join(folded), va="top", fontsize=7,
                    color=MISS if refusal is not None else QUIET)  # fmt: skip
    return figure
