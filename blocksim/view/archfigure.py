"""An arch at its least thickness: its only lines of thrust and friction, how it moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Polygon

from blocksim.arch.circular import Weight
from blocksim.arch.limit.collapse import Collapse, collapse_of_mode
from blocksim.arch.modes import Mode
from blocksim.arch.theory.critical import Critical, inner_sliding
from blocksim.arch.theory.equations import normal_force
from blocksim.arch.theory.lines import critical_moment, friction_line, thrust_line
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.view.drawing import carried, friction_words
from blocksim.view.style import (
    FONT,
    FRICTION,
    GROUND,
    INK,
    JOINTS,
    MECHANISM,
    QUIET,
    THRUST,
    line_style,
)

MOVED = 0.16
"""Largest displacement drawn, in mean radii."""
FINE, ROUND = 400, 100
"""Points of a line on half an arch; of an arc, in a radian."""
ALPHA = "\N{GREEK SMALL LETTER ALPHA}"
SUPPORT, WIDER = 0.06, 0.25
"""Angle over which a support is drawn [rad]; how much it is wider than the springing."""
FORCELESS = 1e-9
ORIGIN = np.zeros(2)
FARTHEST = 0.3
"""Distance from the arch beyond which a line that leaves it is not drawn [r]."""
SLIDES = "sliding joint: it opens, too (dilatancy)"
"""The mechanisms drawn are associated: a joint that slides opens by mu times the slip."""
FAINT = 1e-7
"""Share of the largest rate below which a joint counts as closed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ArchPicture:
    """One arch as it is drawn. The radius is 1.

    `title`, `subtitle`: Outcome and figures; which arch it is.
    `weight`, {"centreline", "sector"}.
    `thrust`, `crown_moment`: h and m of the equilibrium shown.
    `joints`, (j,): Joints of the stonework, none for the continuous arch [rad].
    `collapse`: How it falls.
    """

    title: str
    subtitle: str
    half_angle: float
    eta: float
    mu: float
    weight: Weight
    thrust: float
    crown_moment: float
    joints: Array
    collapse: Collapse

    @property
    def sides(self) -> tuple[float, float]:
        """Radii of the intrados and of the extrados."""
        return 1 - self.eta / 2, 1 + self.eta / 2

    @property
    def ring(self) -> Array:
        """Outline of the whole, (k, 2)."""
        return _ring(-self.half_angle, self.half_angle, *self.sides)


def picture_of_theory(
    critical: Critical, mode: Mode, half_angle: float, mu: float, weight: Weight = "centreline"
) -> ArchPicture:
    """Picture of the continuous arch at its least thickness, moving in one of its modes."""
    moment = critical_moment(half_angle, critical, weight)
    eta, thrust = critical.eta, critical.thrust
    if eta is None or thrust is None:
        raise ValueError("no thickness stands")
    found = collapse_of_mode(
        mode, half_angle, eta, mu,
        beta_r=critical.beta_r, beta_s=inner_sliding(mu)[1], weight=weight,
    )  # fmt: skip
    name = mode.description.split(" (")[0]
    acting = "" if weight == "centreline" else f", weight {weight}"
    return ArchPicture(
        title=f"{name} [{mode.value}]: {figures_of(half_angle, eta, mu)}",
        subtitle=f"the continuous arch at its least thickness{acting}",
        half_angle=half_angle,
        eta=eta,
        mu=mu,
        weight=weight,
        thrust=thrust,
        crown_moment=moment,
        joints=np.array([-half_angle, half_angle]),
        collapse=found,
    )


def arch_figure(pictures: Sequence[ArchPicture], *, columns: int = 1) -> Figure:
    """Draw arches one above the other, or row by row in so many columns."""
    with mpl.rc_context(FONT):
        firsts = pictures[::columns]
        heights = [1.0 + min(5.0, 6.6 * _slenderness(picture)) for picture in firsts]
        layout = ConstrainedLayoutEngine(h_pad=0.17, w_pad=0.08)
        figure = Figure(figsize=(7.6 * columns, 0.5 + sum(heights)), layout=layout)
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(len(firsts), columns, height_ratios=heights)
        entries: dict[str, Artist] = {}
        for place, picture in enumerate(pictures):
            axes = figure.add_subplot(grid[divmod(place, columns)])
            draw_arch(axes, picture)
            # Of what is drawn only, each once.
            handles, names = axes.get_legend_handles_labels()
            entries |= dict(zip(names, handles, strict=True))
        figure.legend(
            entries.values(),
            entries.keys(),
            loc="outside lower center",
            ncols=3 * columns,
            frameon=False,
        )
    return figure


def draw_arch(axes: Axes, picture: ArchPicture) -> None:
    """Draw one arch into axes."""
    axes.set_title(picture.title, fontsize=10.5, pad=20)
    axes.annotate(picture.subtitle, (0, 1), xytext=(0, 8), xycoords="axes fraction",
                  textcoords="offset points", color=QUIET, va="baseline")  # fmt: skip
    axes.set_aspect("equal")
    axes.axis("off")
    _draw_supports(axes, picture)
    _draw_mechanism(axes, picture)
    _put(axes, picture.ring, fill=False, ec=INK, lw=1.5, zorder=3)
    for angle in picture.joints[1:-1]:
        axes.plot(*_radius(float(angle), *picture.sides), color=INK, lw=0.5, zorder=2)
    pressure, shear = lines_of(picture)
    for line, name, tone, width in (
        (pressure, "line of thrust, the only one left", THRUST, 2.0),
        (shear, "line of friction", FRICTION, 1.5),
    ):
        if line is None:
            axes.plot([], [], ls="", label=f"{name}: too far out to be drawn")
        else:
            axes.plot(*line.T, zorder=5, label=name, color=tone, ls=line_style(tone),
                      lw=width)  # fmt: skip
    _mark_joints(axes, picture)
    axes.margins(0.03)
    _draw_scale(axes)


def _slenderness(picture: ArchPicture) -> float:
    """Height of an arch over its width."""
    across, up = np.ptp(picture.ring, axis=0).tolist()
    return (up + 0.2) / (across + 0.3)


def _draw_supports(axes: Axes, picture: ArchPicture) -> None:
    """Draw what the springings stand on, a little wider than they are."""
    half = picture.eta / 2 * (1 + WIDER)
    wider = max(0.0, 1 - half), 1 + half
    deep = min(SUPPORT, 0.8 * (math.pi - picture.half_angle))
    for side in (-1, 1):
        low, high = sorted((side * picture.half_angle, side * (picture.half_angle + deep)))
        ring = _ring(low, high, *wider)
        _put(axes, ring, fc=GROUND, ec="none", zorder=0.5, label="support")


def _draw_scale(axes: Axes) -> None:
    """Draw a bar of half a radius in the lower left corner."""
    left, low = axes.get_xlim()[0], axes.get_ylim()[0]
    level = low - 0.04 * (axes.get_ylim()[1] - low)
    axes.plot([left, left + 0.5], [level, level], color=INK, lw=1.5, marker="|", ms=7)
    axes.annotate("0.5 r", (left + 0.25, level), xytext=(0, -12), ha="center",
                  textcoords="offset points", annotation_clip=False)  # fmt: skip


def lines_of(picture: ArchPicture) -> tuple[Array | None, Array | None]:
    """Lines of thrust and of friction from the left springing to the right, each (k, 2).

    Whole or None: a line that leaves the arch by more than `FARTHEST` is not drawn. NaN
    where no force passes: an overturning arch has no thrust, and at its crown no lines.
    """
    size = np.linspace(-picture.half_angle, picture.half_angle, 2 * FINE + 1)
    across = np.abs(size)
    forceless = normal_force(across, picture.thrust) < FORCELESS
    with np.errstate(divide="ignore", invalid="ignore"):
        pressure = thrust_line(
            across, picture.thrust, picture.crown_moment, picture.eta, picture.weight
        )
        shear = friction_line(across, picture.thrust, picture.mu)
    rays = np.column_stack([np.sin(size), np.cos(size)])
    drawn: list[Array | None] = []
    for line in (pressure, shear):
        off = np.where(forceless, np.nan, np.asarray(line)) * picture.eta / 2
        leaves = float(np.nanmax(np.abs(off))) - picture.eta / 2
        drawn.append(None if leaves > FARTHEST else (1 - off)[:, None] * rays)
    return drawn[0], drawn[1]


def _draw_mechanism(axes: Axes, picture: ArchPicture) -> None:
    """Draw the pieces where they move to, faces of joints included."""
    angles, rates = picture.collapse.angles, picture.collapse.rates
    active = rates.max(axis=1) > FAINT * max(float(rates.max()), FAINT)
    if not active.any():
        return
    # Voussoirs that move together are one piece; springings bound the outermost ones.
    active[0] = active[-1] = True
    ends = np.flatnonzero(active)
    motions = picture.collapse.motions
    rings = [_ring(*pair, *picture.sides) for pair in pairwise(angles.tolist())]
    reach = max(
        float(np.hypot(*carried(ring, ORIGIN, motion).T).max())
        for motion, ring in zip(motions, rings, strict=True)
    )
    for first, last in pairwise(ends.tolist()):
        ring = _ring(float(angles[first]), float(angles[last]), *picture.sides)
        moved = ring + MOVED / reach * carried(ring, ORIGIN, motions[first])
        _put(axes, moved, fc=MECHANISM, alpha=0.13, ec="none", zorder=1)
        _put(axes, moved, fill=False, ec=MECHANISM, lw=1.3, ls=line_style(MECHANISM), zorder=4,
             label="mechanism")  # fmt: skip


def _put(axes: Axes, points: Array, **looks: Any) -> None:
    """Draw a polygon. `add_patch` would look at every side as a curve, which takes longer."""
    axes.add_artist(Polygon(points, **looks))
    axes.update_datalim(points)


def _mark_joints(axes: Axes, picture: ArchPicture) -> None:
    """Mark hinges by dots at their edge, sliding joints by bars across."""
    (inner, outer), fall = picture.sides, picture.collapse
    largest = max(float(fall.rates.max()), FAINT)
    for angle, rates in zip(fall.angles.tolist(), fall.rates, strict=True):
        out, into, *slides = (rates > FAINT * largest).tolist()
        for turns, radius, state in (
            (out, outer, JointState.HINGE_EXTRADOS),
            (into, inner, JointState.HINGE_INTRADOS),
        ):
            # A joint that opens at both ends parts: no hinge is left.
            if turns and not (out and into):
                axes.plot(radius * math.sin(angle), radius * math.cos(angle), "o", ms=7,
                          mfc="white", mec=JOINTS[state], mew=2.0, zorder=7,
                          label=state.words)  # fmt: skip
        if any(slides):
            tone = JOINTS[JointState.SLIDES]
            axes.plot(*_radius(angle, inner, outer), color=tone, lw=4.0, zorder=6,
                      ls=line_style(tone), dash_capstyle="butt", label=SLIDES)  # fmt: skip


def figures_of(half_angle: float, eta: float, mu: float) -> str:
    """Write half-angle, friction with its angle, and thickness for a title."""
    angle = math.degrees(math.atan(mu))
    friction = f"{friction_words(mu)} (φ = {angle:.1f}°)"
    return f"{ALPHA} = {math.degrees(half_angle):.6g}°, {friction}, η = {eta:.4g}"


def _ring(start: float, stop: float, inner: float, outer: float) -> Array:
    """Outline of a piece, (k, 2)."""
    angle = np.linspace(start, stop, max(3, int(ROUND * (stop - start))))
    rays = np.column_stack([np.sin(angle), np.cos(angle)])
    return np.concatenate([inner * rays, outer * rays[::-1]])


def _radius(angle: float, inner: float, outer: float) -> tuple[list[float], list[float]]:
    sine, cosine = math.sin(angle), math.cos(angle)
    return [inner * sine, outer * sine], [inner * cosine, outer * cosine]
