"""Polygons and words to pixels: the one surface that films are drawn on.

matplotlib's Agg renderer, already here for figures, was the quickest of those measured for
100 blocks at 1280 x 720 (9 ms; skia-python and cairocffi 6 ms but a library more, Pillow
supersampled 46 ms) and draws the same picture as SVG.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, BinaryIO, Literal, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text
from matplotlib.textpath import text_to_path
from matplotlib.transforms import Affine2D, Bbox, IdentityTransform, TransformedBbox
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.view.drawing import save_figure
from blocksim.view.style import FONT, GROUND, INK, PAPER, STONE

Colour = tuple[float, float, float, float]
"""Red, green, blue and opacity, 0 to 1."""
NOTHING: Colour = (0.0, 0.0, 0.0, 0.0)
TIP = 12.0
"""Length of the head of an arrow, in its size."""
DOTS = 72
"""Dots an inch: a typographic point is a pixel."""


def colour(name: str, opacity: float = 1.0) -> Colour:
    """Return a colour given as #rrggbb."""
    return to_rgba(name, opacity)


def mixed(one: Colour, other: Colour, share: float) -> Colour:
    """Go from one colour to another by a share, 0 to 1."""
    red, green, blue, opacity = (a + (b - a) * share for a, b in zip(one, other, strict=True))
    return red, green, blue, opacity


def stone_tones(blocks: int) -> list[Colour]:
    """Stone colours that differ a little, in a fixed order, so that blocks tell apart."""
    stone, light, dark = colour(STONE), colour(PAPER), colour(GROUND)
    shades = [(0.61803398875 * index) % 1.0 - 0.5 for index in range(blocks)]
    return [mixed(stone, light if s > 0 else dark, 0.7 * abs(s)) for s in shades]


def edge_width(scale: float, grain: float) -> float:
    """Width of edges [pixels] by the pixels in a radius, thin where blocks are small [r]."""
    return max(0.25, min(1.6, 0.012 * scale, 0.05 * grain * scale))


class Shape(NamedTuple):
    """A polygon, or a line if it has an edge and no fill.

    `points`, (k, 2): In pixels from the lower left corner.
    `width`: Of the edge, in pixels.
    `closed`: Whether the last point is joined to the first.
    `dash`: Lengths of the edge drawn and left out, in widths; nothing where it is drawn
        through.
    """

    points: Array
    fill: Colour = NOTHING
    edge: Colour = NOTHING
    width: float = 0.0
    closed: bool = True
    dash: tuple[float, ...] = ()


class Label(NamedTuple):
    """Words at a place in pixels."""

    x: float
    y: float
    words: str
    size: float = 15.0
    colour: str = INK
    bold: bool = False
    across: Literal["left", "center", "right"] = "left"


def arrow(tail: Array, tip: Array, tone: Colour, size: float) -> list[Shape]:
    """Draw an arrow from one place to another [pixels], nothing where it is too short."""
    way = tip - tail
    long = float(np.hypot(*way))
    if long < 2 * size:
        return []
    way = way / long
    head = min(TIP * size, long)
    across = np.array([-way[1], way[0]]) * 0.42 * head
    back = tip - head * way
    return [
        Shape(np.array([tail, back]), edge=tone, width=2.6 * size, closed=False),
        Shape(np.array([tip, back + across, back - across]), fill=tone),
    ]


def width_of(words: str, size: float, *, bold: bool = False) -> float:
    """Width of words in pixels."""
    weight = "bold" if bold else "normal"
    font = FontProperties(family="DejaVu Sans", weight=weight, size=size)
    return text_to_path.get_text_width_height_descent(words, font, ismath=False)[0]


class Panel(NamedTuple):
    """A part of the canvas in pixels, from its lower left corner; nothing is drawn beyond."""

    x: float
    y: float
    width: float
    height: float


Part = tuple[Panel, Sequence[Shape]]
"""A panel, and the shapes that are drawn into it."""


class Canvas:
    """A surface, so many pixels wide and high, that is drawn anew for each frame."""

    def __init__(self, width: int, height: int) -> None:
        size = width / DOTS, height / DOTS
        self._figure = Figure(figsize=size, dpi=DOTS, facecolor=PAPER)
        self._agg = FigureCanvasAgg(self._figure)
        self._background: Any = None
        self._still: list[Artist] = []
        self._moving: list[Artist] = []

    def keep(self, parts: Sequence[Part], labels: Sequence[Label] = ()) -> None:
        """Draw what stays the same in every frame, once."""
        self._still = _artists(parts, labels)
        with mpl.rc_context(FONT):
            self._agg.draw()
            for artist in self._still:
                artist.set_figure(self._figure)
                artist.draw(self._agg.get_renderer())
            self._background = self._agg.copy_from_bbox(self._figure.bbox)

    def draw(self, parts: Sequence[Part], labels: Sequence[Label] = ()) -> None:
        """Replace what moves, in front of what was kept."""
        self._moving = _artists(parts, labels)

    def pixels(self) -> NDArray[np.uint8]:
        """Return the picture, shape (height, width, 4): red, green, blue, opacity."""
        self._agg.restore_region(self._background)
        for artist in self._moving:
            artist.set_figure(self._figure)
            artist.draw(self._agg.get_renderer())
        return np.array(self._agg.buffer_rgba())

    def figure(self) -> Figure:
        """Return the picture as a figure, which ends its use for frames."""
        # So that it may be saved with more dots an inch.
        larger = Affine2D().scale(1 / DOTS) + self._figure.dpi_scale_trans
        for order, artist in enumerate([*self._still, *self._moving]):
            artist.set_zorder(order)
            artist.set_transform(larger)
            box = artist.get_clip_box()
            if box is not None:
                artist.set_clip_box(TransformedBbox(Bbox(box.get_points()), larger))
            self._figure.add_artist(artist)
        return self._figure

    def save(self, file: BinaryIO, kind: str) -> None:
        """Write the picture as png, svg or pdf."""
        height = round(self._figure.get_figheight() * DOTS)
        save_figure(self.figure(), file, kind, height=height)


def _artists(parts: Sequence[Part], labels: Sequence[Label]) -> list[Artist]:
    drawn: list[Artist] = [_polygons(panel, shapes) for panel, shapes in parts if shapes]
    return drawn + [_words(label) for label in labels]


def _polygons(panel: Panel, shapes: Sequence[Shape]) -> PolyCollection:
    drawn = PolyCollection(
        [_outline(shape) for shape in shapes],
        closed=False,
        facecolors=[shape.fill for shape in shapes],
        edgecolors=[shape.edge for shape in shapes],
        linewidths=[shape.width for shape in shapes],
        linestyles=[(0, shape.dash) if shape.dash else "-" for shape in shapes],
        joinstyle="round",
        capstyle="round",
        # Upright edges would jump from pixel to pixel as blocks move.
        snap=False,
        transform=IdentityTransform(),
    )
    corners = Bbox.from_bounds(*panel)
    drawn.set_clip_box(TransformedBbox(corners, IdentityTransform()))
    return drawn


def _outline(shape: Shape) -> Array:
    return np.concatenate([shape.points, shape.points[:1]]) if shape.closed else shape.points


def _words(label: Label) -> Text:
    return Text(
        label.x,
        label.y,
        label.words,
        color=label.colour,
        fontsize=label.size,
        fontweight="bold" if label.bold else "normal",
        fontfamily="DejaVu Sans",
        parse_math=False,
        ha=label.across,
        va="baseline",
        transform=IdentityTransform(),
    )
