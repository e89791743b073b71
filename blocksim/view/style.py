"""One colour for each mode, everywhere; told apart by colour-blind readers too."""

from __future__ import annotations

from typing import Any, NamedTuple

from blocksim.modes import Mode
from blocksim.verdict import Verdict


class Style(NamedTuple):
    """How a mode is drawn.

    Parameters
    ----------
    colour : str
        Of points and labels: Okabe and Ito's palette.
    tint : str
        Of regions: the same, lightened.
    marker : str
        Shape of points, so that colour never stands alone.
    """

    colour: str
    tint: str
    marker: str


MODES = {
    Mode.RRR: Style("#0072B2", "#cfe3f0", "o"),
    Mode.SS: Style("#7a7a7a", "#e6e6e6", "X"),
    Mode.SRR: Style("#D55E00", "#f8dcc9", "s"),
    Mode.RRS: Style("#009E73", "#cdebe2", "^"),
    Mode.RSR: Style("#B8860B", "#f3e3b8", "v"),
    Mode.RS: Style("#AA4499", "#efd8ec", "D"),
    Mode.R: Style("#332288", "#d8d3ea", "P"),
}
UNNAMED = Style("#000000", "#ffffff", "*")
MISS = "#c00000"

THRUST, FRICTION, MECHANISM, STONE = "#D55E00", "#0072B2", "#009E73", "#222222"
"""Lines of an arch: of thrust, of friction, its collapse, its outline."""

VERDICTS = {
    Verdict.STANDS: "#117733",
    Verdict.COLLAPSES: "#882255",
    Verdict.UNDECIDED: "#6b6b6b",
}
"""Green and wine of Tol's muted palette; a word always goes with them."""

FONT: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 11.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "blocksim",
}
"""matplotlib settings of every figure; the salt makes SVG files reproducible."""
