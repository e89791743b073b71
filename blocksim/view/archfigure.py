# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""An arch with its lines of thrust and friction and its mechanism (Figs 13-25)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from blocksim.arch.circular import Arch, Weight
from blocksim.arch.limit.collapse import collapse_of_mode
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode
from blocksim.arch.theory.critical import Critical, inner_sliding
from blocksim.arch.theory.equations import normal_force
from blocksim.arch.theory.lines import critical_moment, friction_line, thrust_line
from blocksim.blocks.assembly import Array
from blocksim.view.style import FONT, FRICTION, INK, MECHANISM, THRUST

MOVED = 0.16
"""Largest displacement drawn, in mean radii."""
FINE = 400
FORCELESS = 1e-9
FARTHEST = 1.6
"""Largest eccentricity at which a line is drawn; 1 is the edge of the arch."""
FAINT = 1e-7
"""Share of the largest rate below which a joint counts as closed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ArchPicture:
    """What is drawn of one arch; r = 1.

    Parameters
    ----------
    title : str
    half_angle, eta, mu : float
    weight : {"centreline", "sector"}
    thrust, crown_moment : float
        h and m of the equilibrium shown.
    joints : (j,) float
        Joints of the stonework, none for the continuous arch [rad].
    angles : (k,) float
        Joints of the mechanism, left to right [rad].
    rates : (k, 4) float
    motions : (k - 1, 3) float
        As in `Mechanism`; none move where the arch stands.
    """

    title: str
    half_angle: float
    eta: float
    mu: float
    weight: Weight
    thrust: float
    crown_moment: float
    joints: Array
    angles: Array
    rates: Array
    motions: Array


def picture_of_arch(arch: Arch, mu: float) -> ArchPicture:
    """Picture of an arch of voussoirs as it is, standing or not.

    Where it falls, the lines are those of the equilibrium that asks for the least extra
    strength, and leave the arch.
    """
    found = mechanism(arch, mu)
    state = (
        "stands" if not found.rates.any() else f"mode {found.mode}" if found.mode else "falls"
    )
    return ArchPicture(
        title=f"{state}: {_figures(arch.half_angle, arch.eta, mu)}, n = {arch.voussoirs}",
        half_angle=arch.half_angle,
        eta=arch.eta,
        mu=mu,
        weight=arch.weight,
        thrust=found.thrust,
        crown_moment=found.crown_moment,
        joints=arch.joint_angles,
        angles=found.angles,
        rates=found.rates,
        motions=found.motions,
    )


def picture_of_theory(
    critical: Critical, mode: Mode, half_angle: float, mu: float, weight: Weight = "centreline"
) -> ArchPicture:
    """Picture of the continuous arch at its least thickness, moving in one of its modes.

    Raises
    ------
    ValueError
        If no thickness stands, or the mode is not possible there.
    """
    moment = critical_moment(half_angle, critical, weight)
    eta, thrust = critical.eta, critical.thrust
    if eta is None or thrust is None:
        message = "no thickness stands"
        raise ValueError(message)
    found = collapse_of_mode(
        mode, half_angle, eta, mu,
        beta_r=critical.beta_r, beta_s=inner_sliding(mu)[1], weight=weight,
    )  # fmt: skip
    name = mode.description.split(" (")[0]
    return ArchPicture(
        title=f"{name} [{mode.value}]: {_figures(half_angle, eta, mu)}",
        half_angle=half_angle,
        eta=eta,
        mu=mu,
        weight=weight,
        thrust=thrust,
        crown_moment=moment,
        joints=np.array([-half_angle, half_angle]),
        angles=found.angles,
        rates=found.rates,
        motions=found.motions,
    )


def arch_figure(pictures: Sequence[ArchPicture]) -> Figure:
    """Draw arches one above the other.

    Parameters
    ----------
    pictures : sequence of ArchPicture
        One or more.

    Returns
    -------
    Figure
    """
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(7.6, 0.5 + 5.4 * len(pictures)), layout="constrained")
        FigureCanvasAgg(figure)
        for place, picture in enumerate(pictures):
            draw_arch(figure.add_subplot(len(pictures), 1, place + 1), picture)
        figure.legend(handles=_handles(), loc="outside lower center", ncols=3, frameon=False)
    return figure


def draw_arch(axes: Axes, picture: ArchPicture) -> None:
    """Draw one arch into axes."""
    inner, outer = 1 - picture.eta / 2, 1 + picture.eta / 2
    axes.set_title(picture.title, fontsize=9.5, pad=8)
    axes.set_aspect("equal")
    axes.axis("off")
    _draw_mechanism(axes, picture, inner, outer)
    whole = _ring(-picture.half_angle, picture.half_angle, inner, outer)
    axes.add_patch(Polygon(whole, fill=False, ec=INK, lw=1.5, zorder=3))
    for angle in picture.joints[1:-1]:
        axes.plot(*_radius(float(angle), inner, outer), color=INK, lw=0.5, zorder=2)
    pressure, shear = lines_of(picture)
    for line, colour, style, width in (
        (pressure, THRUST, "-", 2.0),
        (shear, FRICTION, (0, (5, 1.6)), 1.5),
    ):
        axes.plot(*line.T, color=colour, ls=style, lw=width, zorder=5)
    _mark_joints(axes, picture, inner, outer)
    axes.margins(0.03)


def lines_of(picture: ArchPicture) -> tuple[Array, Array]:
    """Lines of thrust and of friction from the left springing to the right, each (k, 2).

    NaN where they leave the arch by more than 0.3 of its thickness, and where no force
    passes: an overturning arch has no thrust, and at its crown no lines.
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
    drawn: list[Array] = []
    for line in (pressure, shear):
        radius = 1 - np.asarray(line) * picture.eta / 2
        radius[forceless | (np.abs(line) > FARTHEST)] = np.nan
        drawn.append(radius[:, None] * rays)
    return drawn[0], drawn[1]


def _draw_mechanism(axes: Axes, picture: ArchPicture, inner: float, outer: float) -> None:
    """Draw the pieces where they move to, faces of joints included."""
    active = picture.rates.max(axis=1) > FAINT * max(float(picture.rates.max()), FAINT)
    if not active.any():
        return
    # Voussoirs that move together are one piece; springings bound the outermost ones.
    active[0] = active[-1] = True
    ends = np.flatnonzero(active)
    reach = max(
        float(
            np.hypot(*_velocity(picture.motions[i], _corners(picture, i, inner, outer)).T).max()
        )
        for i in range(len(picture.motions))
    )
    for first, last in pairwise(ends.tolist()):
        start, stop = float(picture.angles[first]), float(picture.angles[last])
        ring = _ring(start, stop, inner, outer)
        moved = ring + MOVED / reach * _velocity(picture.motions[first], ring)
        axes.add_patch(
            Polygon(moved, fc=MECHANISM, alpha=0.13, ec="none", zorder=1),
        )
        axes.add_patch(
            Polygon(moved, fill=False, ec=MECHANISM, lw=1.3, ls=(0, (6, 1.5, 1, 1.5)), zorder=4)
        )


def _mark_joints(axes: Axes, picture: ArchPicture, inner: float, outer: float) -> None:
    """Mark hinges by dots at their edge, sliding joints by bars across."""
    largest = max(float(picture.rates.max()), FAINT)
    for angle, rates in zip(picture.angles.tolist(), picture.rates, strict=True):
        out, into, *slides = (rates > FAINT * largest).tolist()
        for turns, radius in ((out, outer), (into, inner)):
            # A joint that opens at both ends parts: no hinge is left.
            if turns and not (out and into):
                axes.plot(radius * math.sin(angle), radius * math.cos(angle), "o", ms=7,
                          mfc="white", mec=INK, mew=1.5, zorder=7)  # fmt: skip
        if any(slides):
            axes.plot(*_radius(angle, inner, outer), color=INK, lw=3.2, zorder=6,
                      solid_capstyle="butt")  # fmt: skip
            axes.plot(*_radius(angle, inner, outer), color="white", lw=1.2, ls=(0, (2, 1)),
                      zorder=6)  # fmt: skip


def _handles() -> list[Line2D]:
    return [
        Line2D([], [], color=INK, lw=1.5, label="arch"),
        Line2D([], [], color=THRUST, lw=2.0, label="line of thrust"),
        Line2D([], [], color=FRICTION, lw=1.5, ls=(0, (5, 1.6)), label="line of friction"),
        Line2D([], [], color=MECHANISM, lw=1.3, ls=(0, (6, 1.5, 1, 1.5)), label="mechanism"),
        Line2D([], [], ls="", marker="o", ms=7, mfc="white", mec=INK, mew=1.5, label="hinge"),
        Line2D([], [], color=INK, lw=3.2, label="sliding joint"),
    ]


def _figures(half_angle: float, eta: float, mu: float) -> str:
    friction = r"\infty" if math.isinf(mu) else f"{mu:.4g}"
    degrees = f"{math.degrees(half_angle):.4g}"
    return rf"$\alpha$ = {degrees}°, $\mu$ = ${friction}$, $\eta$ = {eta:.4g}"


def _ring(start: float, stop: float, inner: float, outer: float) -> Array:
    """Outline of a piece, (k, 2)."""
    angle = np.linspace(start, stop, max(3, int(FINE * (stop - start))))
    rays = np.column_stack([np.sin(angle), np.cos(angle)])
    return np.concatenate([inner * rays, outer * rays[::-1]])


def _corners(picture: ArchPicture, piece: int, inner: float, outer: float) -> Array:
    start, stop = picture.angles[piece : piece + 2].tolist()
    return _ring(start, stop, inner, outer)


def _radius(angle: float, inner: float, outer: float) -> tuple[list[float], list[float]]:
    sine, cosine = math.sin(angle), math.cos(angle)
    return [inner * sine, outer * sine], [inner * cosine, outer * cosine]


def _velocity(motion: Array, points: Array) -> Array:
    return motion[:2] + motion[2] * np.column_stack([-points[:, 1], points[:, 0]])
