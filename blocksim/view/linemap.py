# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""The map as lines: what divides the regions, and equal half-angles (Figs 6-8)."""

from __future__ import annotations

import math

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from blocksim.arch.theory import equations, landmarks, least_thicknesses, regions
from blocksim.arch.theory.critical import rotational_thrust
from blocksim.view.mapshapes import ISO_DEGREES, LARGEST_MU, iso_line
from blocksim.view.style import FONT, INK, ISO, QUIET

DASHED = (0, (5, 2))
LABELS = {"S": (6, -12), "J": (-12, 4), "T": (-12, 4), "B": (6, -12)}


def line_map_figure(span: tuple[float, float] = (0.0, 2.0)) -> Figure:
    """Draw the dividing lines and lines of equal half-angle (Figs 6-8).

    Parameters
    ----------
    span : (float, float)
        Thickness-to-radius ratios shown: (0, 2), (0, 1) and (0.6, 2) in the paper.

    Returns
    -------
    Figure
    """
    with mpl.rc_context(FONT):
        return _line_map(span)


def _line_map(span: tuple[float, float]) -> Figure:
    figure = Figure(figsize=(8.6, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    marks = landmarks()
    for degrees in ISO_DEGREES:
        line = iso_line(math.radians(degrees))
        if not line.mu.size:
            continue
            axes.plot(line.mu, line.eta, color=ISO, lw=0.8)
        if span[0] < line.eta[-1] < span[1]:
            axes.annotate(f"{degrees:g}°", (LARGEST_MU, line.eta[-1]), xytext=(3, 0),
                          va="center", textcoords="offset points", color=ISO,
                          fontsize=8)  # fmt: skip
    _dividing_lines(axes)
    axes.axhline(1.0, color=QUIET, lw=0.8, ls=DASHED)
    for mark in marks.values():
        if span[0] <= mark.eta <= span[1]:
            axes.plot(mark.mu, mark.eta, "o", ms=5, mfc="white", mec=INK, zorder=4)
            axes.annotate(mark.name, (mark.mu, mark.eta), xytext=LABELS[mark.name],
                          fontweight="bold", textcoords="offset points",
                          annotation_clip=False)  # fmt: skip
    axes.set(xlim=(0, LARGEST_MU), ylim=span, xlabel=r"friction coefficient $\mu$",
             ylabel=r"thickness-to-radius ratio $\eta = t/r$")  # fmt: skip
    figure.legend(loc="outside upper center", ncols=5, frameon=False, fontsize=8.5)
    return figure


def _dividing_lines(axes: Axes) -> None:
    marks = landmarks()
    wide = regions.divide(np.linspace(0.02, marks["B"].mu, 200))
    axes.plot(wide.mu, wide.eta, color=INK, lw=2.0, label=r"$\mu=\mu_{ss}=\mu_{is}$")
    alpha = 2.645 * (1 - np.linspace(0.97, 0.0, 240) ** 2)
    thrust = np.array([rotational_thrust(float(a), "centreline") for a in alpha])
    eta = least_thicknesses(alpha, math.inf).eta
    below = alpha <= marks["T"].half_angle
    for values, real, style, name in (
        (
            equations.shoulder_friction(alpha, thrust),
            below,
            "-",
            r"$\mu=\mu_{ss}$, $h=h_1=h_2$",
        ),
        (
            equations.inner_friction(thrust),
            ~below,
            (0, (8, 1.5)),
            r"$\mu=\mu_{is}$, $h=h_U=h_2$",
        ),
    ):
        friction = np.asarray(values)
        axes.plot(friction[real], eta[real], color=INK, lw=1.5, ls=style, label=name)
        axes.plot(friction[~real], eta[~real], color=INK, lw=0.7, ls=DASHED)
    equal = regions.equal_angles(np.linspace(marks["S"].mu + 1e-6, LARGEST_MU, 120))
    crown = regions.crown_hinge(np.linspace(marks["J"].mu + 1e-6, LARGEST_MU, 120))
    axes.plot(equal.mu, equal.eta, color=INK, lw=1.2, ls=":", label=r"$\beta_r=\beta_s$")
    axes.plot(crown.mu, crown.eta, color=INK, lw=1.2, ls="-.", label=r"$\beta_r=0$")
