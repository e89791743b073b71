"""Pictures of few colours."""

from __future__ import annotations

import io
from typing import BinaryIO

from matplotlib.figure import Figure
from PIL import Image

from blocksim.view.drawing import save_figure
from blocksim.view.style import LIVE
from blocksim.view.video import DRAWN, to_bytes

COLOURS = 256
"""Of a picture."""


def few_colours(figure: Figure, file: BinaryIO) -> None:
    """Write a figure with a palette: a third of the size, and nobody sees it."""
    whole = io.BytesIO()
    save_figure(figure, whole, "png")
    fewer_colours(whole, file)


def fewer_colours(whole: BinaryIO, file: BinaryIO) -> None:
    """Write a picture that is drawn with a palette."""
    picture = Image.open(whole).convert("RGB")
    # Colours that say something are few pixels among many of stone and ground: they are given.
    given = [part for name in dict.fromkeys((*DRAWN, LIVE)) for part in to_bytes(name)]
    rest = picture.quantize(COLOURS - len(given) // 3).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([*given, *rest][: 3 * COLOURS])
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
