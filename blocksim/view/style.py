"""One colour for each mode, verdict, joint and line, told apart by colour-blind readers too."""

from __future__ import annotations

from typing import Any, NamedTuple

from blocksim.arch.modes import Mode
from blocksim.ask.methods import METHODS
from blocksim.blocks.joints import JointState
from blocksim.simulation.verdict import Verdict


class Style(NamedTuple):
    """How a mode or a method is drawn.

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


def style_of_method(name: str) -> Style:
    """Return the style of a method, where they are compared; each method's file says it."""
    if name not in METHODS:
        return UNNAMED
    method = METHODS[name]
    return Style(method.colour, method.tint, method.marker)


MISS = "#c00000"

VERDICTS = {
    Verdict.STANDS: "#0060A0",
    Verdict.COLLAPSES: "#B84300",
    Verdict.UNDECIDED: "#6b6b6b",
}
JOINTS = {
    JointState.HINGE_INTRADOS: "#0072B2",
    JointState.HINGE_EXTRADOS: "#E69F00",
    JointState.SLIDES: "#009E73",
    JointState.HINGE_AND_SLIDES: "#CC79A7",
    JointState.OPEN: "#555555",
}
"""Of joints that take part; a closed one is drawn as stone."""
THRUST, FRICTION, MECHANISM, ISO = "#D55E00", "#0072B2", "#009E73", "#0072B2"
INK, QUIET = "#222222", "#5d5a53"
"""Of lines and words, and of those that matter less."""
DEAD, LIVE = "#222222", "#CC0055"
"""Of loads besides gravity: those that stay, and those multiplied by the load factor."""
GAP = "#AA4499"
"""Of joints at which a drawing's gap or overlap is closed."""
STONE, GROUND, PAPER = "#d9cdb8", "#b9b3a6", "#fbfaf7"

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
