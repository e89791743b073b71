"""Where a sheet's drawing and its words lie on paper."""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox

from blocksim.blocks.assembly import Array
from blocksim.view.sheet import A4, Paper, Sheet, scale_for
from blocksim.view.style import INK

MARGIN, NARROW = 12.0, 2.0
"""Widths of the margin of a page, and of a drawing within a page [mm]."""
WIDE, COLUMNS = 250.0, 2
"""Width of a page that has room for a scale beside the legend [mm], and its columns."""
SIDE, ABOVE, BELOW, BARE = 22.0, 14.0, 24.0, 3.0
"""Room for dimensions beside and above what is drawn, for reactions below it; for nothing."""
LINE, TITLE = 4.2, 8.0
"""Height of a line of words, and of the title."""
LETTER = 1.62
"""Width of a letter of the facts [mm]."""
CLEAR = {"fc": "white", "ec": "none", "pad": 0.5, "alpha": 0.8}
"""Look of the box behind words, lest lines cross them."""
STEP, TRIES = 1.5, 12
"""Step by which words give way to others [mm], and the most steps."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """The place of a drawing on its page, and of the words so far.

    `scale`: A millimetre on paper is so many millimetres.
    `low`, (2,): What lies at the lower left corner of the page [m].
    `edge`, `bar`: Width of the margin, and height of the scale's bar above the page's lower
        edge [mm].
    `words`: Boxes of the words so far, in dots.
    """

    paper: Paper
    scale: float
    low: Array
    edge: float
    bar: float
    words: list[Bbox] = field(default_factory=list[Bbox])

    @property
    def mm(self) -> float:
        """Metres that a millimetre on paper is."""
        return self.scale / 1e3

    @property
    def high(self) -> Array:
        """The point at the upper right corner [m]."""
        return self.low + np.array([self.paper.width, self.paper.height]) * self.mm

    def left_of_words(self, axes: Axes, line: Array) -> Array:
        """Return the place of an upright line [m], moved left of words that are beside it."""
        (x, low), (beside, high) = axes.transData.transform([line[0], line[1] + [self.mm, 0]])
        dots = float(beside - x)
        for box in sorted(self.words, key=lambda box: -box.x0):
            if box.x0 < x + dots and box.x1 > x - dots and box.y0 < high and box.y1 > low:
                x = box.x0 - 2 * dots
        return axes.transData.inverted().transform((x, low))

    def write(
        self, axes: Axes, at: Array, words: str, away: tuple[float, float], **style: Any
    ) -> None:
        """Write words at a place [m], or as far away from it as others leave free."""
        looks: dict[str, Any] = {"color": INK, "zorder": 10, "bbox": dict(CLEAR)}
        text = axes.text(float(at[0]), float(at[1]), words, **{**looks, **style})
        step = STEP * self.mm * np.asarray(away)
        for _ in range(TRIES):
            box = text.get_window_extent()
            if not any(box.overlaps(other) for other in self.words):
                break
            at = at + step
            text.set_position((float(at[0]), float(at[1])))
        self.words.append(text.get_window_extent())


def layout_of(
    sheet: Sheet,
    low: Array,
    high: Array,
    entries: int,
    column: tuple[float, float] | None,
    *,
    bare: bool,
) -> Layout:
    """Choose paper and scale so that all has room, and lay the drawing in the middle of it."""
    above, below = ABOVE, BELOW if sheet.reactions else BARE + SIDE / 2
    aside = SIDE
    if sheet.pressed:
        above = below = aside = BARE
    edge = MARGIN if column is None else NARROW
    tries: list[Layout] = []
    for paper in A4 if column is None else (Paper("", *column),):
        tall = paper.height
        rows = max(LINE * math.ceil(entries / COLUMNS), 2 * LINE)
        # Where the legend may be as wide as the page, the scale stands above it.
        bar = edge + (LINE if paper.width > WIDE else rows + LINE)
        foot = max(edge + rows, bar + LINE) + 2
        lines = sum(len(wrapped(fact, paper)) for fact in sheet.facts)
        head = edge + TITLE + LINE * lines + 2 if not bare else 0.0
        room = np.array([paper.width - 2 * (edge + aside), tall - head - foot - above - below])
        scale = scale_for(high - low, room)
        drawn = 1e3 * (high - low) / scale
        if column is not None:
            tall -= float(room[1] - drawn[1])
            room[1] = drawn[1]
        corner = np.array([edge + aside, foot + below]) + (room - drawn) / 2
        tries.append(
            Layout(
                paper=Paper(paper.name, paper.width, tall),
                scale=scale,
                low=low - corner * scale / 1e3,
                edge=edge,
                bar=bar,
            )
        )
    return min(tries, key=lambda each: each.scale)


def wrapped(words: str, paper: Paper) -> list[str]:
    """Break a fact into lines that are no wider than the page."""
    return textwrap.wrap(words, int((paper.width - 2 * MARGIN) / LETTER))
