"""What studies share: random arches, their places in a figure, pictures of few colours."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from blocksim import Arch, Mode
from blocksim.arch.circular import Weight
from blocksim.arch.limit import least_thickness
from blocksim.arch.theory.map import divide_friction
from blocksim.view.drawing import save_figure
from blocksim.view.style import LIVE, MODES
from blocksim.view.video import DRAWN, to_bytes

COLOURS = 256
"""Of a picture."""


@dataclass(frozen=True)
class Draw:
    """An arch to be asked about: half-angle [rad], friction, voussoirs, weight, exact eta."""

    half_angle: float
    mu: float
    voussoirs: int
    weight: Weight
    eta: float
    mode: Mode

    def arch(self, ratio: float = 1.0) -> Arch:
        """Return the arch at a ratio of its least thickness."""
        return Arch(
            half_angle=self.half_angle,
            eta=self.eta * ratio,
            voussoirs=self.voussoirs,
            weight=self.weight,
        )


def draws(
    seed: int,
    degrees: tuple[float, float],
    counts: tuple[int, int],
    near: float,
    frictions: tuple[float, float] = (0.35, 3),
) -> Iterator[Draw]:
    """Draw arches that some thickness lets stand, without end.

    Half-angles, numbers of voussoirs and frictions are between the two given; `near` is the
    share of arches with little more friction than the divide, where that is within the bounds:
    that is where the mixed modes are.
    """
    least, most = frictions
    random = np.random.default_rng(seed)
    while True:
        half_angle = math.radians(random.uniform(*degrees))
        mu = math.exp(random.uniform(math.log(least), math.log(most)))
        scant = divide_friction(half_angle) * random.uniform(1.0, 1.15)
        if random.random() < near and scant >= least:
            mu = scant
        voussoirs = int(random.integers(*counts, endpoint=True))
        weight: Weight = "sector" if random.random() < 0.5 else "centreline"
        state = least_thickness(half_angle, mu, voussoirs, weight)
        if mu <= most and state.eta is not None and state.mode is not None:
            yield Draw(half_angle, mu, voussoirs, weight, state.eta, state.mode)


def plot_by_mode(axes: Axes, drawn: Sequence[Draw], heights: Sequence[float]) -> None:
    """Mark one height for each arch over its half-angle, by mode and weight."""
    for mode in Mode:
        style = MODES[mode]
        for weight, face in (("centreline", style.colour), ("sector", "white")):
            points = [
                (math.degrees(draw.half_angle), height)
                for draw, height in zip(drawn, heights, strict=True)
                if (draw.mode, draw.weight) == (mode, weight)
            ]
            if points:
                axes.plot(
                    *zip(*points, strict=True),
                    style.marker,
                    mfc=face,
                    mec=style.colour,
                    label=f"{mode.value}, {weight}",
                )
    axes.set_xlabel("half-angle of embrace [deg]")
    axes.legend(frameon=False, fontsize=7.5, ncols=4, loc="upper left")


def few_colours(figure: Figure, file: BinaryIO) -> None:
    """Write a figure with a palette: a third of the size, and nobody sees it."""
    whole = io.BytesIO()
    save_figure(figure, whole, "png")
    picture = Image.open(whole).convert("RGB")
    # Colours that say something are few pixels among many of stone and ground: they are given.
    given = [part for name in dict.fromkeys((*DRAWN, LIVE)) for part in to_bytes(name)]
    rest = picture.quantize(COLOURS - len(given) // 3).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([*given, *rest][: 3 * COLOURS])
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
