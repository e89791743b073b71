"""Curves of the paper's Figs 3-5."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from blocksim.arch.theory import landmarks
from blocksim.arch.theory.curves import rotational_branches, sliding_curve
from blocksim.arch.theory.map import special_angles
from blocksim.view.drawing import new_figure
from blocksim.view.style import INK, QUIET

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
