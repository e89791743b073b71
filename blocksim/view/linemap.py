"""The map as lines: what divides the regions, and equal half-angles (Figs 6-8)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import isotonic_regression

from blocksim.arch.circular import Weight
from blocksim.arch.theory import Curve, equations, landmarks, least_thicknesses
from blocksim.arch.theory.critical import rotational_thrust
from blocksim.arch.theory.map import special_angles
from blocksim.view.drawing import new_figure
from blocksim.view.mapregions import draw_asymptote, draw_landmarks
from blocksim.view.mapshapes import (
    COEFFICIENT,
    FrictionAxis,
    iso_angles,
    iso_continued,
    iso_line,
    map_shapes,
)
from blocksim.view.style import FONT, INK, ISO

DASHED = (0, (5, 2))
SPACE, BESIDE = 0.024, 0.0175
"""Height of a label, and its distance from the frame, as shares of the picture."""
LABELS = {"S": (-17, -14), "J": (-12, 4), "T": (-12, 4), "B": (6, -12)}


@mpl.rc_context(FONT)
def line_map_figure(
    span: tuple[float, float] = (0.0, 2.0),
    weight: Weight = "centreline",
    friction: FrictionAxis = COEFFICIENT,
) -> Figure:
    """Draw dividing lines and lines of equal half-angle, in a span of thickness (Figs 6-8)."""
    figure = new_figure((8.6, 7.2))
    axes = figure.add_subplot()
    axes.set(xlim=(0, friction.end), ylim=span, xlabel=friction.label,
             ylabel=r"thickness-to-radius ratio $\eta = t/r$")  # fmt: skip
    _iso_lines(axes, span, weight, friction)
    _dividing_lines(axes, weight, friction)
    draw_asymptote(axes, weight)
    marks = [each for each in landmarks(weight).values() if span[0] <= each.eta <= span[1]]
    draw_landmarks(axes, marks, LABELS, friction)
    figure.legend(loc="outside upper center", ncols=4, frameon=False, fontsize=8.5)
    return figure


def _iso_lines(
    axes: Axes, span: tuple[float, float], weight: Weight, friction: FrictionAxis
) -> None:
    """Draw lines of equal half-angle, each named where it leaves the picture."""
    beside: dict[str, float] = {}
    names = {
        "feasible": r"equal $\alpha$",
        "infeasible": r"equal $\alpha$, not feasible",
    }
    for half_angle in iso_angles(weight):
        name = angle_name(half_angle)
        continued = iso_continued(half_angle, weight, friction)
        line = iso_line(half_angle, weight, friction)
        if not (line.mu.size or continued.mu.size):
            continue  # wider than any that stands
        for kind, curve, dashes, width in (
            ("feasible", line, "-", 1.0),
            ("infeasible", continued, DASHED, 0.7),
        ):
            if curve.mu.size and curve.eta.min() <= span[1]:
                # Along the frame a line would be cut in half.
                along = bool((curve.eta == span[1]).all())
                axes.plot(friction.place(curve.mu), curve.eta, color=ISO, gid=f"{kind} {name}",
                          label=names.pop(kind, None), zorder=1.5,
                          clip_on=not along, ls=dashes,
                          lw=width)  # fmt: skip
        end = float((line if line.mu.size else continued).eta[-1])
        if span[0] < end <= span[1]:
            beside[name] = end
        elif end <= span[0]:
            # It leaves the picture upright.
            foot = float(friction.place(continued.mu[0])), span[1]
            axes.annotate(name, foot, xytext=(0, 3), textcoords="offset points", ha="center",
                          va="bottom", rotation=90, color=ISO, fontsize=8,
                          annotation_clip=False)  # fmt: skip
    for (name, end), place in zip(
        beside.items(), apart(list(beside.values()), SPACE * (span[1] - span[0])), strict=True
    ):
        last = float(friction.place(friction.largest))
        axes.annotate(name, (last, end), xytext=(friction.end * (1 + BESIDE), place),
                      va="center", color=ISO, fontsize=8, annotation_clip=False,
                      arrowprops={"arrowstyle": "-", "color": ISO, "lw": 0.5, "shrinkA": 0,
                                  "shrinkB": 0, "relpos": (0, 0.5)})  # fmt: skip


def angle_name(half_angle: float) -> str:
    """Write a half-angle: round ones as they are, special ones with three decimals."""
    degrees = math.degrees(half_angle)
    return f"{degrees:.0f}°" if abs(degrees - round(degrees)) < 1e-9 else f"{degrees:.3f}°"


def apart(heights: Sequence[float], space: float) -> list[float]:
    """Move heights, which grow, as little as needed to be apart by a space."""
    steps = space * np.arange(len(heights))
    # Less these steps they may be equal, but not fall.
    return (isotonic_regression(np.array(heights) - steps).x + steps).tolist()


def _dividing_lines(axes: Axes, weight: Weight, friction: FrictionAxis) -> None:
    shapes = map_shapes(weight, friction)

    def draw(curve: Curve, name: str, width: float, style: object) -> None:
        axes.plot(
            friction.place(curve.mu), curve.eta, color=INK, lw=width, ls=style, label=name
        )

    draw(shapes.lines["divide"], r"$\mu=\mu_{ss}=\mu_{is}$", 2.0, "-")
    # Denser towards the wide arches, where friction runs off to infinity.
    widest = special_angles(weight).zero_thrust
    alpha = widest * (1 - np.linspace(0.985, 1e-4, 240) ** 2)
    thrust = np.array([rotational_thrust(float(a), weight) for a in alpha])
    eta = least_thicknesses(alpha, math.inf, weight).eta
    below = alpha <= shapes.landmarks["T"].half_angle
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
        mu = np.asarray(values)
        draw(Curve(mu=mu[real], eta=eta[real]), name, 1.5, style)
        draw(Curve(mu=mu[~real], eta=eta[~real]), "_", 0.7, DASHED)
    draw(shapes.lines["equal"], r"$\beta_r=\beta_s$", 1.2, ":")
    draw(shapes.lines["crown"], r"$\beta_r=0$", 1.2, "-.")
