# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""The equations that rule in each region of the map, written into it (Fig. 9)."""

from __future__ import annotations

from typing import NamedTuple

from matplotlib.axes import Axes

from blocksim.arch.modes import Mode
from blocksim.view.mapregions import STRIP
from blocksim.view.style import MODES


class Note(NamedTuple):
    """Equations of a region.

    Parameters
    ----------
    text : str
    at : (float, float)
        Where they are written: mu and eta.
    target : (float, float), optional
        Where a line to the region ends, if they are written beside it.
    """

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


def draw_equations(axes: Axes) -> None:
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
