"""One colour, one meaning: hues, line styles and marks of all that pictures and pages show.

Any two that appear together differ by at least 12 in CIEDE2000, for everybody and as simulated
for protanopia, deuteranopia and tritanopia, and where only grey is left in colour or in form
(`tests/test_colours.py`). Maps, drawings, films, pages and the explorer take them from here.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from blocksim.arch.modes import Mode
from blocksim.ask.methods import METHODS
from blocksim.blocks.joints import JointState
from blocksim.simulation.verdict import Verdict


class Style(NamedTuple):
    """The look of a mode or a method.

    `colour`: Of points.
    `tint`: Of regions: the same, lightened.
    `marker`: Shape of points, so that colour never stands alone.
    """

    colour: str
    tint: str
    marker: str

    @property
    def ink(self) -> str:
        """Colour of words on the tint or on paper."""
        return mix(self.colour, "#000000", 0.35)


def mix(one: str, other: str, share: float) -> str:
    """Go from one colour #rrggbb to another by a share, 0 to 1."""
    pairs = ((int(one[i : i + 2], 16), int(other[i : i + 2], 16)) for i in (1, 3, 5))
    return "#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in pairs)


STONE, GROUND, PAPER = "#d9cdb8", "#b9b3a6", "#fbfaf7"
FILL = "#efe9dc"
"""Colour of fill and backing, below their hatching."""
INK, QUIET = "#222222", "#5d5a53"
"""Colours of lines and words, and of those that matter less."""
MISS = "#dd0000"
"""Colour of what is wrong: answers, blocks that overlap, shapes that are refused."""


def _mode(colour: str, marker: str) -> Style:
    return Style(colour, mix("#ffffff", colour, 0.2), marker)


MODES = {
    Mode.RRR: _mode("#295681", "o"),
    Mode.SS: _mode("#42443e", "X"),
    Mode.SRR: _mode("#a88159", "s"),
    Mode.RRS: _mode("#2a8477", "^"),
    Mode.RSR: _mode("#7d6c0f", "v"),
    Mode.RS: _mode("#e55395", "D"),
    Mode.R: _mode("#a670e2", "P"),
}
UNNAMED = Style("#000000", "#ffffff", "*")


def style_of_method(name: str) -> Style:
    """Return the look of a method among others, which its own file says."""
    if name not in METHODS:
        return UNNAMED
    method = METHODS[name]
    return Style(method.colour, method.tint, method.marker)


VERDICTS = {
    Verdict.STANDS: "#032d55",
    Verdict.COLLAPSES: "#8a0200",
    Verdict.UNDECIDED: "#6b6b6b",
}
JOINTS = {
    JointState.HINGE_INTRADOS: "#568fc7",
    JointState.HINGE_EXTRADOS: "#ca7719",
    JointState.SLIDES: "#6018aa",
    JointState.HINGE_AND_SLIDES: "#a25789",
    JointState.OPEN: "#525252",
}
"""Colours of joints that take part. A hinge also has a dot at the end that stays closed."""
THRUST, FRICTION, MECHANISM = "#b4410a", "#6060cf", "#307f53"
DEAD, LIVE = INK, "#661527"
"""Colours of loads that stay, and of those multiplied by the load factor."""
GAP = "#4a1f4f"
"""Colour of joints at which a drawing's gap or overlap is closed."""
ISO = "#0072B2"
"""Colour of lines of equal half-angle on maps that have no modes."""

USE = (
    (0.5, "up to 50 % used", "#adb7eb"),
    (0.8, "50 to 80 % used", "#6c7eda"),
    (math.inf, "more than 80 % used", "#2f45bc"),
)
"""Looks of joints by the share of width or friction in use: largest share, words, colour."""


def use_of(share: float) -> tuple[str, str]:
    """Return words and colour of a joint of which so much is used."""
    return next((words, tone) for most, words, tone in USE if share <= most)


DASHES: dict[str, tuple[float, ...]] = {
    FRICTION: (5.0, 1.6),
    MECHANISM: (6.0, 1.5, 1.0, 1.5),
    JOINTS[JointState.SLIDES]: (1.6, 0.5),
    JOINTS[JointState.HINGE_AND_SLIDES]: (1.6, 0.4, 0.4, 0.4),
    JOINTS[JointState.OPEN]: (0.5, 0.5),
    GAP: (1.0, 1.0),
}
"""Form of lines by their colour: lengths drawn and left out, in widths of the line."""


def line_style(colour: str) -> Any:
    """Return the style of a line of a colour, as matplotlib takes it."""
    return (0, DASHES[colour]) if colour in DASHES else "-"


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
