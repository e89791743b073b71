"""Sketches of the paper's Figs 1, 2 and 12: measures, the rotational mode, a joint."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from blocksim.arch.modes import Mode
from blocksim.arch.theory import least_thickness
from blocksim.blocks.assembly import Array
from blocksim.view.archfigure import draw_arch, picture_of_theory
from blocksim.view.drawing import new_figure
from blocksim.view.style import FRICTION, INK, MECHANISM, QUIET, STONE, THRUST

HALF_ANGLE, ETA = math.radians(75), 0.24
"""Half-angle and thickness ratio of the arch of Fig. 1."""
SECTION = math.radians(38)
"""Angle of the section that is shown [rad]."""
FRICTION_SHOWN = 0.6
"""Friction coefficient of Fig. 12."""
HALF_DEPTH, RATE, LENGTH = 0.5, 0.3, 0.8
"""Sizes in Fig. 12 (b): half the thickness, the motion, the length of a block."""
RATES = (
    (r"$\dot\lambda_1$: turns about the extrados", 0),
    (r"$\dot\lambda_2$: turns about the intrados", 1),
    (r"$\dot\lambda_3$: slides outwards, and opens", 2),
    (r"$\dot\lambda_4$: slides inwards, and opens", 3),
)
"""Rates of a joint, in the order of its strength conditions."""


def sketch_figure(number: int) -> Figure:
    """Draw Fig. 1, 2 or 12."""
    if number == 12:
        return _joint()
    figure = new_figure((7.6, 5.2))
    axes = figure.add_subplot()
    (_measures if number == 1 else _rotational)(axes)
    axes.set_aspect("equal")
    axes.axis("off")
    return figure


def _at(angle: float, radius: float) -> tuple[float, float]:
    return radius * math.sin(angle), radius * math.cos(angle)


def _arc(start: float, stop: float, radius: float) -> tuple[Array, Array]:
    angle = np.linspace(start, stop, 120)
    return radius * np.sin(angle), radius * np.cos(angle)


def _arrow(
    axes: Axes, tail: tuple[float, float], head: tuple[float, float], gid: str,
    colour: str = INK, style: str = "-|>",
) -> None:  # fmt: skip
    shape = {"arrowstyle": style, "color": colour, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", head, xytext=tail, arrowprops=shape, gid=gid)


def _word(axes: Axes, text: str, place: tuple[float, float], colour: str = INK) -> None:
    axes.text(*place, text, ha="center", va="center", fontsize=11, color=colour,
              bbox={"fc": "white", "ec": "none", "pad": 1})  # fmt: skip


def _dotted(axes: Axes, end: tuple[float, float], gid: str | None = None) -> None:
    axes.plot([0, end[0]], [0, end[1]], color=QUIET, lw=0.8, ls=":", gid=gid)


def _measures(axes: Axes) -> None:
    """Fig. 1: radius, thickness, half-angle, a section, and the weight."""
    inner, outer = 1 - ETA / 2, 1 + ETA / 2
    edges = [np.column_stack(_arc(-HALF_ANGLE, HALF_ANGLE, each)) for each in (inner, outer)]
    whole = np.concatenate([edges[0], edges[1][::-1]])
    axes.add_patch(Polygon(whole, fc=STONE, ec=INK, lw=1.5, alpha=0.6, gid="arch"))
    axes.plot(*_arc(-HALF_ANGLE, HALF_ANGLE, 1.0), color=INK, lw=0.9, ls=(0, (8, 2, 1, 2)),
              gid="centreline")  # fmt: skip
    _dotted(axes, (0, outer + 0.1))
    for angle in (-HALF_ANGLE, HALF_ANGLE):
        _dotted(axes, _at(angle, inner))
    axes.plot(*zip(_at(SECTION, inner), _at(SECTION, outer), strict=True), color=INK, lw=1.0)
    _dotted(axes, _at(SECTION, inner))
    for stop, radius, name in ((HALF_ANGLE, 0.3, r"$\alpha$"), (SECTION, 0.55, r"$\beta$"),
                               (-HALF_ANGLE, 0.3, r"$\alpha$")):  # fmt: skip
        axes.plot(*_arc(0, stop, radius), color=INK, lw=1.0, gid=f"angle {name}")
        _word(axes, name, _at(stop / 2, radius))
    _arrow(axes, (0.0, 0.0), _at(-1.05, 1.0), "radius")
    _word(axes, "$r$", _at(-1.05, 0.62))
    _arrow(axes, _at(1.05, inner), _at(1.05, outer), "thickness", style="<|-|>")
    _word(axes, "$t$", _at(1.12, 1.0))
    place = _at(-0.35, 1.0)
    _arrow(axes, place, (place[0], place[1] - 0.3), "weight", THRUST)
    axes.plot(*place, "o", ms=3, color=THRUST)
    _word(axes, r"$\gamma\,t\,d$", (place[0] + 0.12, place[1] - 0.24), THRUST)
    axes.plot(0, 0, "o", ms=3, color=INK)
    words = r"unit weight $\gamma$, depth $d$; $\gamma\,t\,d$ is the weight of a unit of length"
    _word(axes, words, (0, -0.12), QUIET)
    axes.margins(0.05)


def _rotational(axes: Axes) -> None:
    """Fig. 2: five hinges, the reactions at those of the shoulders, and the measures."""
    alpha = math.pi / 2
    critical = least_thickness(alpha, math.inf)
    draw_arch(axes, picture_of_theory(critical, Mode.RRR, alpha, math.inf))
    axes.set_title("")
    # Without scale, and without friction: nothing slides.
    scale = [line for line in axes.lines if line.get_marker() == "|"]
    friction = [line for line in axes.lines if line.get_label() == "line of friction"]
    for artist in (*axes.texts, *scale, *friction):
        artist.set_visible(False)
    eta, beta = critical.eta or 0.0, critical.beta_r or 0.0
    outer = 1 + eta / 2
    for side in (-1, 1):
        foot = side * outer, 0.0
        _arrow(axes, (side * outer, -0.42), foot, "reaction V", THRUST)
        _arrow(axes, (side * (outer + 0.42), 0.0), foot, "reaction H", THRUST)
        _word(axes, "$V$", (side * (outer - 0.08), -0.3), THRUST)
        _word(axes, "$H$", (side * (outer + 0.3), 0.09), THRUST)
    _dotted(axes, (0, outer))
    _dotted(axes, _at(beta, 1 - eta / 2), "ray of the inner hinge")
    axes.plot(*_arc(0, beta, 0.4), color=INK, lw=1.0, gid="angle beta_r")
    _word(axes, r"$\beta=\beta_r$", _at(beta / 2, 0.55))
    _dotted(axes, (1, 0))
    _arrow(axes, (0.0, 0.0), _at(-0.75, 1.0), "radius")
    _word(axes, "$r$", _at(-0.75, 0.55))
    _arrow(axes, _at(-1.2, 1 - eta / 2), _at(-1.2, outer), "thickness", style="<|-|>")
    _word(axes, "$t$", _at(-1.2, 1.18))
    axes.text(0, -0.2, r"$\eta = t/r$,   $h = H/(w\,r)$,   $w=\gamma\,t\,d$,"
              r"   $V = w\,r\,\alpha$", ha="center", fontsize=11)  # fmt: skip
    axes.set_xlim(-1.65, 1.65)
    axes.set_ylim(-0.5, 1.25)


def _joint() -> Figure:
    """Fig. 12: strength of a joint, and its rates."""
    figure = new_figure((8.6, 7.4))
    grid = figure.add_gridspec(2, 1, height_ratios=(1.25, 1.0))
    above, below = (figure.add_subfigure(grid[row]) for row in range(2))
    moment, shear = (above.add_subplot(1, 2, place + 1) for place in range(2))
    turning = r"$\varphi_1=M-\frac{t}{2}N\leq 0$", r"$\varphi_2=-M-\frac{t}{2}N\leq 0$"
    sliding = r"$\varphi_3=T-\mu N\leq 0$", r"$\varphi_4=-T-\mu N\leq 0$"
    _cone(moment, "moment $2M/t$", 1.0, turning, THRUST)
    _cone(shear, "shear $T$", FRICTION_SHOWN, sliding, FRICTION)
    above.suptitle(r"(a) strength conditions $\varphi\leq 0$", fontsize=10.5)
    below.suptitle(
        r"(b) rates $\dot\lambda\geq 0$ of the block on the crown's side, extrados on top",
        fontsize=10.5,
    )
    for words, kind in RATES:
        axes = below.add_subplot(1, 4, kind + 1)
        _moved_joint(axes, kind)
        name, _, does = words.partition(": ")
        axes.set_xlabel(f"{name}\n{does.replace(', ', ',' + chr(10))}", fontsize=9)
    return figure


def _cone(axes: Axes, name: str, slope: float, words: tuple[str, str], colour: str) -> None:
    """Draw what a joint can carry: |M| <= N t/2, or |T| <= mu N, N being compressive."""
    reach = np.array([0.0, 1.0])
    for side, word in zip((1, -1), words, strict=True):
        axes.plot(reach, side * slope * reach, color=colour, lw=1.8, label=word)
        axes.annotate(word, (0.62, side * slope * 0.62), xytext=(0.03, side * 0.86),
                      color=colour, fontsize=10, va="center",
                      arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.6})  # fmt: skip
    axes.fill_between(reach, -slope * reach, slope * reach, color=colour, alpha=0.12, lw=0,
                      gid="strength")  # fmt: skip
    axes.axhline(0, color=QUIET, lw=0.6)
    axes.set(xlim=(0, 1.0), ylim=(-1.05, 1.05), xlabel="normal force $N$, compressive",
             ylabel=name, xticks=[], yticks=[0])  # fmt: skip


def moved_block(kind: int, points: Array) -> Array:
    """Move points of the block on the crown's side of a joint at one of its four rates.

    `kind`: Place in the order of the strength conditions: turns about the extrados, about the
        intrados, slides outwards, inwards.
    `points`, (k, 2): Along the arch from the joint to the crown, and outwards from the
        centreline.
    """
    if kind < 2:
        edge = np.array([0.0, HALF_DEPTH if kind == 0 else -HALF_DEPTH])
        angle = RATE if kind == 0 else -RATE
        turn = np.array([[math.cos(angle), -math.sin(angle)],
                         [math.sin(angle), math.cos(angle)]])  # fmt: skip
        return edge + (points - edge) @ turn.T
    side = 1.0 if kind == 2 else -1.0
    return points + RATE * np.array([FRICTION_SHOWN, side])


def _moved_joint(axes: Axes, kind: int) -> None:
    """Draw two blocks at a joint, the second one moved."""
    still = np.array([[-LENGTH, -HALF_DEPTH], [0, -HALF_DEPTH], [0, HALF_DEPTH],
                      [-LENGTH, HALF_DEPTH]])  # fmt: skip
    moving = moved_block(kind, still * [-1, 1])
    axes.add_patch(Polygon(still, fc=STONE, ec=INK, lw=1.2, gid="block"))
    axes.add_patch(Polygon(still * [-1, 1], fill=False, ec=QUIET, lw=0.8, ls=":"))
    axes.add_patch(Polygon(moving, fc=MECHANISM, alpha=0.25, ec=MECHANISM, lw=1.4,
                           gid=f"rate {kind + 1}"))  # fmt: skip
    if kind < 2:
        edge = HALF_DEPTH if kind == 0 else -HALF_DEPTH
        axes.plot(0, edge, "o", mfc="white", mec=INK, ms=6, zorder=4)
    axes.set(xlim=(-1.0, 1.35), ylim=(-1.15, 1.15), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.spines[:].set_visible(False)
