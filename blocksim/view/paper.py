"""Every figure of Cocchetti and Rizzi (2024), by its number."""

from __future__ import annotations

import math
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from blocksim.arch.limit.complementary import Complementary, complementary, joints_through
from blocksim.arch.modes import Mode
from blocksim.arch.theory.critical import inner_sliding
from blocksim.common.checks import require
from blocksim.studies.paper import ARCHES, FIGURES, PaperArch, paper_arches
from blocksim.view.archfigure import ArchPicture, arch_figure, picture_of_theory
from blocksim.view.drawing import new_figure
from blocksim.view.linemap import line_map_figure
from blocksim.view.mapregions import (
    CENTRAL,
    STRIP,
    WHOLE,
    draw_asymptote,
    draw_regions,
    draw_unbounded,
)
from blocksim.view.papercurves import curve_figure
from blocksim.view.papersketches import sketch_figure
from blocksim.view.style import FONT, MODES

SKETCHES = (1, 2, 12)
CURVES = (3, 4, 5)
VOUSSOIRS = 30
"""Number of voussoirs in the complementary problems, about."""
SPANS = {6: (0.0, 2.0), 7: (0.0, 1.0), 8: (0.6, 2.0)}
"""Thickness ratios of the map's three pictures as lines."""


class Note(NamedTuple):
    """Equations of a region, where they stand, and where a line to it ends [mu, eta]."""

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
"""Equations of each region: h_L (1), h_U (2), h_2 (3), h_e (4), mu_ss (8), mu_is (9)."""


def paper_figure(number: int) -> Figure:
    """Draw a figure of the paper.

    `number`: 1 to 25.
    """
    require(number in FIGURES, "figure", number, "from 1 to 25")
    with mpl.rc_context(FONT):
        if number in SKETCHES:
            figure = sketch_figure(number)
        elif number in CURVES:
            figure = curve_figure(number)
        elif number in SPANS:
            figure = line_map_figure(SPANS[number])
        elif number in ARCHES:
            figure = _arches(number)
        else:
            figure = _filled(number)
        return figure


def _filled(number: int) -> Figure:
    """Draw the regions: Fig. 9 with equations, Fig. 10 without, Fig. 11 the middle."""
    figure = new_figure((8.6, 7.0))
    axes = figure.add_subplot()
    draw_regions(axes, CENTRAL if number == 11 else WHOLE)
    if number == 9:
        draw_unbounded(axes)
        draw_asymptote(axes)
        _draw_equations(axes)
        return figure
    # These two have no words within; the colours are told below.
    names = {mode.value for mode in MODES}
    for text in axes.texts:
        text.set_visible(text.get_text() not in names)
    fills = {str(each.get_gid()).removeprefix("region-"): each for each in axes.collections}
    handles = [
        Patch(fc=style.tint, ec=style.colour, label=f"{mode.value}  {mode.description}")
        for mode, style in MODES.items()
        if mode.value in fills
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _draw_equations(axes: Axes) -> None:
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


def _arches(number: int) -> Figure:
    """Draw one of Figs 13-25: on the left by closed form, on the right eqs (15) and (16)."""
    pictures: list[ArchPicture] = []
    for arch in paper_arches()[number]:
        pictures += [
            picture_of_theory(arch.critical, arch.mode, arch.half_angle, arch.mu),
            picture_of_voussoirs(arch),
        ]
    return arch_figure(pictures, columns=2)


def complementary_of(arch: PaperArch) -> Complementary:
    """Solve eqs (15) and (16) on joints where the continuous arch turns and slides."""
    if arch.critical.eta is None:
        message = f"no thickness stands at a half-angle of {arch.half_angle}"
        raise ValueError(message)
    # Where modes coincide theory names the inner sliding joint of one that has it.
    places = [arch.critical.beta_r or 0.0]
    if math.isfinite(arch.mu):
        places.append(inner_sliding(arch.mu)[1])
    angles = joints_through(arch.half_angle, places, VOUSSOIRS)
    return complementary(angles, arch.critical.eta, arch.mu)


def picture_of_voussoirs(arch: PaperArch) -> ArchPicture:
    """Picture of voussoirs at the least thickness, moving as the complementary problem says."""
    found = complementary_of(arch)
    ways = [each for each in found.modes if each.mode is arch.mode]
    if not ways or arch.critical.eta is None:
        message = f"no mechanism {arch.mode} on these voussoirs"
        raise ValueError(message)
    way = ways[0]
    others = [str(each.mode) for each in found.modes if each is not way]
    besides = f"; besides: {', '.join(others)}" if others else ""
    return ArchPicture(
        title=f"[{arch.mode.value}] of {2 * len(found.angles) - 2} voussoirs, "
        f"eqs (15) and (16){besides}",
        subtitle=f"at the same thickness, joints where they turn and slide; strength it lacks "
        f"{found.extra_strength:.0e}, eq. (16) {way.product:.0e}",
        half_angle=arch.half_angle,
        eta=arch.critical.eta,
        mu=arch.mu,
        weight="centreline",
        thrust=found.thrust,
        crown_moment=found.crown_moment,
        joints=np.concatenate([-found.angles[:0:-1], found.angles]),
        collapse=way.collapse,
    )
