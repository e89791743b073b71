"""Regions of the mode map, the lines between them and their names (Figs 9-11)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from blocksim.arch.circular import Weight
from blocksim.arch.modes import Mode
from blocksim.arch.theory import Landmark
from blocksim.arch.theory.critical import CROWN_ETA
from blocksim.view.mapshapes import (
    COEFFICIENT,
    LARGEST_MU,
    LARGEST_PHI,
    FrictionAxis,
    MapShapes,
    map_shapes,
)
from blocksim.view.style import INK, MODES


class Section(NamedTuple):
    """A part of the map, where modes are named, and where a line to the thin region leads."""

    mu: tuple[float, float]
    eta: tuple[float, float]
    names: dict[Mode, tuple[float, float]]
    thin: tuple[float, float, float] | None = None

    def shows(self, mu: float, eta: float) -> bool:
        """Tell whether a point is in it."""
        return self.mu[0] <= mu <= self.mu[1] and self.eta[0] <= eta <= self.eta[1]


def _named(*places: tuple[float, float]) -> dict[Mode, tuple[float, float]]:
    return dict(zip(NAMED, places, strict=True))


NAMED = (Mode.RRR, Mode.SS, Mode.SRR, Mode.RRS, Mode.RS)
"""Modes that are named on the map, but for the thin region and unbounded friction."""
WHOLE = Section(
    (0.0, LARGEST_MU),
    (0.0, 2.0),
    _named((2.3, 0.35), (0.75, 1.35), (0.72, 0.355), (2.45, 0.885), (3.4, 1.6)),
    (3.4, 3.4, 1.16),
)
CENTRAL = Section(
    (1.2, 2.4),
    (0.6, 1.2),
    _named((2.0, 0.66), (1.45, 1.0), (1.235, 0.618), (2.1, 0.87), (2.15, 1.1)),
    (2.2, 2.24, 1.02),
)
"""The part in which most regions meet (Fig. 11)."""
WHOLE_SECTOR = WHOLE._replace(names={**WHOLE.names, Mode.RRS: (2.45, 0.835)})
CENTRAL_SECTOR = Section(
    (1.05, 2.25),
    (0.52, 1.12),
    _named((1.85, 0.58), (1.25, 0.9), (1.098, 0.532), (1.9, 0.8), (1.95, 1.03)),
    (2.0, 2.05, 0.95),
)
"""The whole map and its middle where voussoirs weigh at their own centroids."""
NEAR = Section(
    (1.70, 1.90),
    (0.92, 1.02),
    {
        Mode.SS: (1.735, 0.99),
        Mode.RRS: (1.865, 0.935),
        Mode.RS: (1.865, 1.0),
        Mode.RSR: (1.868, 0.9625),
    },
)
"""The part that is enlarged where arches crowd: S, J and the thin region rsr."""
LINES = {"divide": "-", "first sliding": "-", "equal angles": ":", "crown hinge": "--"}
"""Names and dashes of the map's lines."""
STRIP = (4.12, 4.30)
"""Ends of the strip for unbounded friction, beyond the axis that is to scale."""
LETTERS = {"T": (-13, 4), "S": (-19, -12), "J": (-17, 6), "B": (13, -9)}
"""Place of each landmark's letter, from the landmark [points]."""


def section_of(weight: Weight, *, central: bool) -> Section:
    """Return the part of the map to draw: all of it, or where most regions meet."""
    if weight == "centreline":
        return CENTRAL if central else WHOLE
    return CENTRAL_SECTOR if central else WHOLE_SECTOR


def draw_regions(
    axes: Axes,
    section: Section = WHOLE,
    weight: Weight = "centreline",
    friction: FrictionAxis = COEFFICIENT,
) -> None:
    """Fill the regions of the six modes at finite friction, and name them (Figs 9-11)."""
    shapes = map_shapes(weight, friction)
    for part in shapes.regions:
        axes.fill_between(
            friction.place(part.mu), part.bottom, part.top, color=MODES[part.mode].tint, lw=0,
            gid=f"region-{part.mode}",
        )  # fmt: skip
    for (name, style), curve in zip(LINES.items(), shapes.lines.values(), strict=True):
        axes.plot(friction.place(curve.mu), curve.eta, style, color=INK, lw=1.1, gid=name)
    _name_regions(axes, section, shapes, friction)
    marks = [each for each in shapes.landmarks.values() if section.shows(each.mu, each.eta)]
    draw_landmarks(axes, marks, LETTERS, friction)
    low, high = friction.place(section.mu).tolist()
    axes.set(xlim=(low, friction.end if section.mu == WHOLE.mu else high), ylim=section.eta)
    axes.set_xlabel(friction.label)
    axes.set_ylabel(r"thickness-to-radius ratio $\eta = t/r$")


def draw_landmarks(
    axes: Axes,
    marks: Iterable[Landmark],
    letters: Mapping[str, tuple[float, float]],
    friction: FrictionAxis,
) -> None:
    """Mark points of the map, each with its letter so many points from it."""
    for mark in marks:
        place = float(friction.place(mark.mu)), mark.eta
        axes.plot(*place, "o", ms=5, mfc="white", mec=INK, zorder=4, clip_on=False)
        axes.annotate(mark.name, place, xytext=letters[mark.name], fontweight="bold",
                      textcoords="offset points", annotation_clip=False)  # fmt: skip


def draw_asymptote(axes: Axes, weight: Weight = "centreline") -> None:
    """Draw the thickness that the lines above T tend to as friction grows: eta = 1."""
    level = CROWN_ETA[weight]
    axes.axhline(level, color=INK, lw=0.8, ls=(0, (6, 4)), gid="asymptote", zorder=1.8)
    axes.annotate(rf"$\eta={level:.4g}$", (0, level), xytext=(3, 2), fontsize=8,
                  textcoords="offset points", xycoords=("axes fraction", "data"))  # fmt: skip


def draw_unbounded(
    axes: Axes, weight: Weight = "centreline", friction: FrictionAxis = COEFFICIENT
) -> None:
    """Draw the far end of the map, unbounded friction: a strip beyond a gap, or at 90 deg."""
    level = CROWN_ETA[weight]
    if friction.angle:
        axes.plot((90, 90), (level, 2.0), color=MODES[Mode.R].ink, lw=4, clip_on=False,
                  solid_capstyle="butt", gid="region-r", zorder=3)  # fmt: skip
        axes.annotate(Mode.R.value, (90, 1.5), xytext=(8, 0), textcoords="offset points",
                      color=MODES[Mode.R].ink, fontweight="bold", fontsize=13,
                      annotation_clip=False)  # fmt: skip
        # Beyond the last line that is computed the regions are as they are there.
        for mode, low, high in ((Mode.RRR, 0.0, level), (Mode.RS, level, 2.0)):
            axes.fill_between((LARGEST_PHI, 90), low, high, color=MODES[mode].tint, lw=0)
        axes.set_xticks(range(0, 91, 10))
        return
    for mode, (low, high) in ((Mode.RRR, (0.0, level)), (Mode.R, (level, 2.0))):
        axes.fill_between(STRIP, low, high, color=MODES[mode].tint, lw=0,
                          gid=f"strip-{mode}")  # fmt: skip
    axes.plot(STRIP, (level, level), color=INK, lw=1.1)
    middle = sum(STRIP) / 2
    axes.text(middle, 1.5, Mode.R.value, color=MODES[Mode.R].ink, fontweight="bold",
              fontsize=13, ha="center", va="center")  # fmt: skip
    axes.set_xlim(0.0, STRIP[1])
    ticks = np.arange(0.0, LARGEST_MU + 0.1, 0.5).tolist()
    axes.set_xticks([*ticks, middle], [*(f"{tick:g}" for tick in ticks), "∞"])
    gap = ((LARGEST_MU + 0.005, -0.03), STRIP[0] - LARGEST_MU - 0.01, 0.06)
    axes.add_patch(Rectangle(*gap, fc="white", ec="none", clip_on=False, zorder=3))


def _name_regions(
    axes: Axes, section: Section, shapes: MapShapes, friction: FrictionAxis
) -> None:
    """Write each mode into its region. A line leads to the name of the thin one."""
    for mode, (mu, eta) in section.names.items():
        size = 10 if mode in {Mode.SRR, Mode.RSR} else 13
        style: dict[str, Any] = {
            "color": MODES[mode].ink,
            "fontweight": "bold",
            "fontsize": size,
        }
        place = float(friction.place(mu))
        axes.text(place, eta, mode.value, ha="center", va="center", **style)
    if section.thin is None:
        return
    mu, beside, above = section.thin
    axes.annotate(
        Mode.RSR.value,
        (float(friction.place(mu)), _within_thin(mu, shapes)),
        xytext=(float(friction.place(beside)), above),
        ha="center",
        color=MODES[Mode.RSR].ink,
        fontweight="bold",
        fontsize=11,
        arrowprops={"arrowstyle": "-", "color": MODES[Mode.RSR].ink, "lw": 1.2},
    )


def _within_thin(mu: float, shapes: MapShapes) -> float:
    """Thickness in the middle of the thin region rsr at a friction beyond J."""
    ends = [
        np.interp(mu, curve.mu, curve.eta)
        for curve in (shapes.lines["equal"], shapes.lines["crown"])
    ]
    return float(sum(ends) / 2)
