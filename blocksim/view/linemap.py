# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""The map as lines: what divides the regions, and equal half-angles (Figs 6-8)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from blocksim.arch.theory import Curve, equations, landmarks, least_thicknesses, regions
from blocksim.arch.theory.critical import rotational_thrust
from blocksim.view.mapshapes import LARGEST_MU, iso_angles, iso_continued, iso_line
from blocksim.view.style import FONT, INK, ISO

DASHED = (0, (5, 2))
SPACE, BESIDE = 0.024, 0.07
"""Height of a label, as a share of the picture, and its distance from the frame [mu]."""
LABELS = {"S": (-17, -14), "J": (-12, 4), "T": (-12, 4), "B": (6, -12)}


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
    figure = Figure(figsize=(8.6, 7.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    marks = landmarks()
    axes.set(xlim=(0, LARGEST_MU), ylim=span, xlabel=r"friction coefficient $\mu$",
             ylabel=r"thickness-to-radius ratio $\eta = t/r$")  # fmt: skip
    _iso_lines(axes, span)
    _dividing_lines(axes)
    for mark in marks.values():
        if span[0] <= mark.eta <= span[1]:
            axes.plot(mark.mu, mark.eta, "o", ms=5, mfc="white", mec=INK, zorder=4,
                      clip_on=False)  # fmt: skip
            axes.annotate(mark.name, (mark.mu, mark.eta), xytext=LABELS[mark.name],
                          fontweight="bold", textcoords="offset points",
                          annotation_clip=False)  # fmt: skip
    figure.legend(loc="outside upper center", ncols=4, frameon=False, fontsize=8.5)
    return figure


def _iso_lines(axes: Axes, span: tuple[float, float]) -> None:
    """Draw lines of equal half-angle, each named where it leaves the picture."""
    beside: dict[str, float] = {}
    names = {
        "feasible": r"equal $\alpha$",
        "infeasible": r"equal $\alpha$, not feasible",
    }
    for half_angle in iso_angles():
        name = angle_name(half_angle)
        continued = iso_continued(half_angle)
        line = iso_line(half_angle)
        for kind, curve, dashes, width in (
            ("feasible", line, "-", 1.0),
            ("infeasible", continued, DASHED, 0.7),
        ):
            if curve.mu.size and curve.eta.min() <= span[1]:
                # Along the frame a line would be cut in half.
                along = bool((curve.eta == span[1]).all())
                axes.plot(curve.mu, curve.eta, color=ISO, gid=f"{kind} {name}",
                          label=names.pop(kind, None), zorder=1.5,
                          clip_on=not along, ls=dashes,
                          lw=width)  # fmt: skip
        end = float((line if line.mu.size else continued).eta[-1])
        if span[0] < end <= span[1]:
            beside[name] = end
        elif end <= span[0]:
            _name_upright(axes, name, float(continued.mu[0]), span[1])
    for (name, end), place in zip(
        beside.items(), apart(list(beside.values()), SPACE * (span[1] - span[0])), strict=True
    ):
        axes.annotate(name, (LARGEST_MU, end), xytext=(LARGEST_MU + BESIDE, place),
                      va="center", color=ISO, fontsize=8, annotation_clip=False,
                      arrowprops={"arrowstyle": "-", "color": ISO, "lw": 0.5, "shrinkA": 0,
                                  "shrinkB": 0, "relpos": (0, 0.5)})  # fmt: skip


def _name_upright(axes: Axes, name: str, mu: float, top: float) -> None:
    """Name a line above the picture, which it leaves upright."""
    axes.annotate(name, (mu, top), xytext=(0, 3), textcoords="offset points", ha="center",
                  va="bottom", rotation=90, color=ISO, fontsize=8,
                  annotation_clip=False)  # fmt: skip


def angle_name(half_angle: float) -> str:
    """Write a half-angle: round ones as they are, special ones with three decimals."""
    degrees = math.degrees(half_angle)
    return f"{degrees:.0f}°" if abs(degrees - round(degrees)) < 1e-9 else f"{degrees:.3f}°"


def apart(heights: Sequence[float], space: float) -> list[float]:
    """Move heights, which grow, as little as needed to be apart by a space."""
    groups: list[list[float]] = []
    for height in heights:
        groups.append([height])
        # Neighbours that are too close become one group about their middle.
        while len(groups) > 1 and _ends(groups[-2], space)[1] > _ends(groups[-1], space)[0]:
            groups[-2:] = [groups[-2] + groups[-1]]
    return [
        _ends(group, space)[0] + space * (place + 0.5)
        for group in groups
        for place in range(len(group))
    ]


def _ends(group: Sequence[float], space: float) -> tuple[float, float]:
    """Lower and upper end of labels stacked about the middle of what they name."""
    middle = sum(group) / len(group)
    return middle - space * len(group) / 2, middle + space * len(group) / 2


@cache
def _between_regions() -> tuple[Curve, Curve, Curve]:
    """Divide, equal angles and crown hinge, computed once."""
    marks = landmarks()
    starts = (marks[name].mu + 1e-6 for name in "SJ")
    right_of_s, right_of_j = (np.linspace(start, LARGEST_MU, 120) for start in starts)
    return (
        regions.divide(np.linspace(0.02, marks["B"].mu, 200)),
        regions.equal_angles(right_of_s),
        regions.crown_hinge(right_of_j),
    )


def _dividing_lines(axes: Axes) -> None:
    marks = landmarks()
    wide, equal, crown = _between_regions()
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
    axes.plot(equal.mu, equal.eta, color=INK, lw=1.2, ls=":", label=r"$\beta_r=\beta_s$")
    axes.plot(crown.mu, crown.eta, color=INK, lw=1.2, ls="-.", label=r"$\beta_r=0$")
