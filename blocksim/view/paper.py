"""Every figure of Cocchetti and Rizzi (2024), by its number; curves of Figs 3-5."""

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
from blocksim.arch.theory import landmarks
from blocksim.arch.theory.critical import inner_sliding
from blocksim.arch.theory.curves import rotational_branches, sliding_curve
from blocksim.arch.theory.map import special_angles
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
from blocksim.view.papersketches import sketch_figure
from blocksim.view.style import FONT, INK, MODES, QUIET

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
        raise ValueError(f"no thickness stands at a half-angle of {arch.half_angle}")
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
        raise ValueError(f"no mechanism {arch.mode} on these voussoirs")
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


DASHED, DOTTED = (0, (5, 2)), (0, (1, 1))
UPPER, LOWER = "eq. (7), upper signs", "eq. (7), lower signs"
SLIDING, BEYOND = "purely sliding", "purely sliding, beyond η = 2"
ROTATIONAL = "purely rotational"
TURNS, SLIDES = "#0072B2", "#C00000"
"""Colours of the second branch of eq. (7), and of sliding: red, as in the paper."""
MOST_FRICTION = 5.0
"""Friction up to which curves are drawn; it has no end."""


def curve_figure(number: int) -> Figure:
    """Draw Fig. 3, 4 or 5: a panel for each quantity, one above the other."""
    rows, draw = {3: (3, _rotational), 4: (2, _inner_sliding), 5: (3, _sliding)}[number]
    figure = new_figure((7.0, 2.6 * rows))
    panels = [figure.add_subplot(rows, 1, row + 1) for row in range(rows)]
    draw(panels)
    for axes in panels:
        axes.grid(color="#dddddd", lw=0.6)
        axes.set_ylim(0, None)
    return figure


def _rotational(panels: list[Axes]) -> None:
    """Fig. 3: beta_r, eta and h of the rotational mode, both branches of eq. (7)."""
    special = special_angles()
    for branch, name, colour in zip(
        rotational_branches(), (UPPER, LOWER), (INK, TURNS), strict=True
    ):
        curves = (
            (branch.beta_r, r"$\beta_r$"),
            (branch.eta, r"$\eta$"),
            (branch.thrust, "$h$"),
        )
        for axes, (values, symbol) in zip(panels, curves, strict=True):
            axes.plot(branch.half_angle, values, color=colour, lw=1.8, label=name)
            axes.set(ylabel=f"{symbol} [rad]" if "beta" in symbol else symbol)
            axes.plot(branch.half_angle[-1], values[-1], "o", mfc="white", mec=INK, ms=5)
    for axes in panels:
        _half_angles(axes)
        for angle in (special.widest_hinge, special.zero_thrust):
            axes.axvline(angle, color=QUIET, lw=0.8, ls=":")
    widest, last = math.degrees(special.widest_hinge), math.degrees(special.zero_thrust)
    panels[0].annotate(
        rf"$\alpha_{{s\beta}}$ = {widest:.1f}°, $\beta_{{s\beta}}$ = "
        rf"{math.degrees(special.hinge):.1f}°",
        (special.widest_hinge, special.hinge), xytext=(-110, -95), textcoords="offset points",
        arrowprops={"arrowstyle": "-", "color": QUIET, "lw": 0.6},
    )  # fmt: skip
    panels[1].annotate(rf"$\alpha_l$ = {last:.1f}°, $\eta=1$, $h=0$, $\beta_r=0$",
                       (special.zero_thrust, 1.0), xytext=(-150, -4),
                       textcoords="offset points")  # fmt: skip
    panels[0].legend(frameon=False, loc="upper left")
    panels[-1].set_xlabel(r"half-angle $\alpha$ [rad]")


def _half_angles(axes: Axes) -> None:
    """Let an axis of half-angles go from 0 to pi."""
    axes.set_xlim(0, math.pi)
    axes.set_xticks(
        [0, math.pi / 4, math.pi / 2, 3 * math.pi / 4, math.pi],
        ["0", r"$\pi/4$", r"$\pi/2$", r"$3\pi/4$", r"$\pi$"],
    )


def _inner_sliding(panels: list[Axes]) -> None:
    """Fig. 4: h and beta_s at inner sliding, from no friction on."""
    found = sliding_curve()
    shown = found.mu <= MOST_FRICTION
    curves = ((found.thrust, "$h$"), (found.beta_s, r"$\beta_s$"))
    for axes, (values, symbol) in zip(panels, curves, strict=True):
        axes.plot(found.mu[shown], values[shown], color=SLIDES, lw=1.8, label=symbol)
        axes.set(ylabel=f"{symbol} [rad]" if "beta" in symbol else symbol, xlim=(0, 4))
    most = int(np.argmax(found.beta_s))
    panels[1].annotate(r"$\beta_s=1/2$ at $h=1/2$", (found.mu[most], found.beta_s[most]),
                       xytext=(24, 2), textcoords="offset points")  # fmt: skip
    panels[-1].set_xlabel(r"friction coefficient $\mu$")


def _sliding(panels: list[Axes]) -> None:
    """Fig. 5: beta_s, mu and h of the sliding mode, from 0 to pi; dashed beyond eta = 2."""
    marks = landmarks()
    found, end = sliding_curve(), marks["B"].half_angle
    curves = ((found.beta_s, r"$\beta_s$"), (found.mu, r"$\mu$"), (found.thrust, "$h$"))
    for axes, (values, symbol) in zip(panels, curves, strict=True):
        for where, style, name in (
            (found.half_angle <= end, "-", SLIDING),
            (found.half_angle >= end, DASHED, BEYOND),
        ):
            axes.plot(found.half_angle[where], values[where], color=SLIDES, lw=1.8, ls=style,
                      label=name)  # fmt: skip
        axes.set(ylabel=f"{symbol} [rad]" if "beta" in symbol else symbol)
        axes.axvline(end, color=QUIET, lw=0.8, ls=":")
        _half_angles(axes)
    for place, branch in enumerate(rotational_branches()):
        panels[2].plot(branch.half_angle, branch.thrust, color=INK, lw=1.4, ls=DOTTED,
                       label="_" if place else ROTATIONAL)  # fmt: skip
    panels[1].axhline(marks["B"].mu, color=QUIET, lw=0.8, ls=":")
    panels[1].annotate(rf"$\alpha_B$ = {math.degrees(end):.1f}°, $\mu_B$ = {marks['B'].mu:.4g}",
                       (end, marks["B"].mu), xytext=(-140, 4),
                       textcoords="offset points")  # fmt: skip
    point = marks["T"]
    assert point.beta_s is not None  # noqa: S101 - T is of a sliding mode
    # The letter is above the curve: right of a point where it falls, left where it rises.
    for axes, value, aside in zip(
        panels, (point.beta_s, point.mu, point.thrust), (5, -13, 5), strict=True
    ):
        axes.plot(point.half_angle, value, "o", mfc="white", mec=INK, ms=5, zorder=4)
        axes.annotate("T", (point.half_angle, value), xytext=(aside, 5), fontweight="bold",
                      textcoords="offset points")  # fmt: skip
    panels[1].set_ylim(0, MOST_FRICTION)
    panels[2].legend(frameon=False)
    panels[-1].set_xlabel(r"half-angle $\alpha$ [rad]")
