# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""Regions of the mode map, the lines between them and their names (Figs 9-11)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from blocksim.arch.modes import Mode
from blocksim.view.mapshapes import LARGEST_MU, map_shapes
from blocksim.view.style import INK, MODES


class Section(NamedTuple):
    """A part of the map to draw.

    Parameters
    ----------
    mu, eta : (float, float)
        Friction and thickness shown.
    names : dict of Mode to (float, float)
        Where each mode is named.
    thin : two of (float, float), optional
        Where a line to the thin region rsr ends, and where it is named.
    """

    mu: tuple[float, float]
    eta: tuple[float, float]
    names: dict[Mode, tuple[float, float]]
    thin: tuple[tuple[float, float], tuple[float, float]] | None = None

    def shows(self, mu: float, eta: float) -> bool:
        """Tell whether a point is in it."""
        return self.mu[0] <= mu <= self.mu[1] and self.eta[0] <= eta <= self.eta[1]


WHOLE = Section(
    (0.0, LARGEST_MU),
    (0.0, 2.0),
    {
        Mode.RRR: (2.3, 0.35),
        Mode.SS: (0.75, 1.35),
        Mode.SRR: (0.72, 0.355),
        Mode.RRS: (2.45, 0.885),
        Mode.RS: (3.4, 1.6),
    },
    ((3.4, 0.987), (3.4, 1.16)),
)
CENTRAL = Section(
    (1.2, 2.4),
    (0.6, 1.2),
    {
        Mode.RRR: (2.0, 0.66),
        Mode.SS: (1.45, 1.0),
        Mode.SRR: (1.235, 0.618),
        Mode.RRS: (2.1, 0.87),
        Mode.RS: (2.15, 1.1),
    },
    ((2.2, 0.972), (2.24, 1.02)),
)
"""Where most regions meet (Fig. 11)."""
NEAR = Section(
    (1.70, 1.90),
    (0.92, 1.02),
    {
        Mode.SS: (1.735, 0.99),
        Mode.RRS: (1.865, 0.935),
        Mode.RS: (1.865, 1.0),
        Mode.RSR: (1.868, 0.9625),
    },
)
"""What is enlarged where arches crowd: the points S and J, and the thin region rsr."""
STRIP = (4.12, 4.30)
"""Where unbounded friction is drawn, beyond the largest that is drawn to scale."""
LETTERS = {"T": (-13, 4), "S": (-19, -12), "J": (-17, 6), "B": (13, -9)}
"""Where the letter of each landmark begins, in points from it."""


def draw_regions(axes: Axes, section: Section = WHOLE) -> None:
    """Fill the regions of the six modes at finite friction, and name them (Figs 9-11)."""
    shapes = map_shapes()
    for part in shapes.regions:
        tint = MODES[part.mode].tint
        axes.fill_between(part.mu, part.bottom, part.top, color=tint, lw=0)
    lines = (
        (shapes.divide, "-"),
        (shapes.first, "-"),
        (shapes.equal, ":"),
        (shapes.crown, "--"),
    )
    for curve, style in lines:
        axes.plot(curve.mu, curve.eta, style, color=INK, lw=1.1)
    _name_regions(axes, section)
    for mark in shapes.landmarks.values():
        if not section.shows(mark.mu, mark.eta):
            continue
        axes.plot(mark.mu, mark.eta, "o", ms=5, mfc="white", mec=INK, zorder=4, clip_on=False)
        axes.annotate(
            mark.name,
            (mark.mu, mark.eta),
            xytext=LETTERS[mark.name],
            textcoords="offset points",
            fontweight="bold",
            annotation_clip=False,
        )
    axes.set(xlim=section.mu, ylim=section.eta)
    axes.set_xlabel(r"friction coefficient $\mu$")
    axes.set_ylabel(r"thickness-to-radius ratio $\eta = t/r$")


def draw_unbounded(axes: Axes) -> None:
    """Draw the far end of the map, unbounded friction, as a strip beyond a gap."""
    for mode, (low, high) in ((Mode.RRR, (0.0, 1.0)), (Mode.R, (1.0, 2.0))):
        axes.fill_between(STRIP, low, high, color=MODES[mode].tint, lw=0)
    axes.plot(STRIP, (1.0, 1.0), color=INK, lw=1.1)
    middle = sum(STRIP) / 2
    axes.text(middle, 1.5, Mode.R.value, color=MODES[Mode.R].colour, fontweight="bold",
              fontsize=13, ha="center", va="center")  # fmt: skip
    axes.set_xlim(0.0, STRIP[1])
    ticks = np.arange(0.0, LARGEST_MU + 0.1, 0.5).tolist()
    axes.set_xticks([*ticks, middle], [*(f"{tick:g}" for tick in ticks), "∞"])
    gap = ((LARGEST_MU + 0.005, -0.03), STRIP[0] - LARGEST_MU - 0.01, 0.06)
    axes.add_patch(Rectangle(*gap, fc="white", ec="none", clip_on=False, zorder=3))


def _name_regions(axes: Axes, section: Section) -> None:
    """Write each mode into its region; the thin one gets a line to its name."""
    for mode, (x, y) in section.names.items():
        size = 10 if mode in {Mode.SRR, Mode.RSR} else 13
        style: dict[str, Any] = {
            "color": MODES[mode].colour,
            "fontweight": "bold",
            "fontsize": size,
        }
        axes.text(x, y, mode.value, ha="center", va="center", **style)
    if section.thin is None:
        return
    target, words = section.thin
    axes.annotate(
        Mode.RSR.value,
        target,
        xytext=words,
        ha="center",
        color=MODES[Mode.RSR].colour,
        fontweight="bold",
        fontsize=11,
        arrowprops={"arrowstyle": "-", "color": MODES[Mode.RSR].colour, "lw": 1.2},
    )
