# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""Draw the sketch of the glossary: an arch with its words."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon

from blocksim import Arch
from blocksim.arch.carried import carried_by_arch
from blocksim.kinds.circular import CircularArch
from blocksim.view.style import GROUND, INK, QUIET, STONE, THRUST

HALF, ETA, COUNT = math.radians(66), 0.2, 11
HERE = Path(__file__).parent


def point(angle: float, radius: float) -> tuple[float, float]:
    """Return a point by its angle from the crown and its distance from the centre."""
    return radius * math.sin(angle), radius * math.cos(angle)


def label(axes: Axes, words: str, at: tuple[float, float], to: tuple[float, float]) -> None:
    """Write words at a place, with a line to what they name."""
    axes.annotate(words, to, xytext=at, ha="center", va="center", fontsize=10, color=INK,
                  arrowprops={"arrowstyle": "-", "color": QUIET, "lw": 0.8})  # fmt: skip


def measure(axes: Axes, words: str, ends: list[tuple[float, float]], off: float) -> None:
    """Draw a dimension line between two points, with its words beside the middle."""
    axes.annotate("", ends[0], xytext=ends[1],
                  arrowprops={"arrowstyle": "<->", "color": INK, "lw": 0.9,
                              "shrinkA": 0, "shrinkB": 0})  # fmt: skip
    middle = np.mean(ends, axis=0)
    if not words:
        return
    axes.text(middle[0], middle[1] + off, words, ha="center", va="center", fontsize=10,
              color=INK, bbox={"fc": "white", "ec": "none", "pad": 1.2})  # fmt: skip


def figure() -> Figure:
    """Draw an arch of eleven voussoirs and name its parts."""
    arch = Arch(half_angle=HALF, eta=ETA, voussoirs=COUNT, weight="sector")
    inner, outer = 1 - ETA / 2, 1 + ETA / 2
    drawn = Figure(figsize=(8.6, 3.93))
    axes = drawn.add_axes((0, 0, 1, 1))
    axes.set_aspect("equal")
    axes.axis("off")
    for side in (-1, 1):
        angles = side * np.linspace(HALF, HALF + 0.16, 12)
        rays = np.column_stack([np.sin(angles), np.cos(angles)])
        ring = np.concatenate([(inner - 0.04) * rays, (outer + 0.04) * rays[::-1]])
        axes.add_patch(Polygon(ring, fc=GROUND, ec="none"))
    for start, stop in zip(arch.joint_angles[:-1], arch.joint_angles[1:], strict=True):
        angles = np.linspace(start, stop, 12)
        rays = np.column_stack([np.sin(angles), np.cos(angles)])
        ring = np.concatenate([inner * rays, outer * rays[::-1]])
        axes.add_patch(Polygon(ring, fc=STONE, ec=INK, lw=1.1))
    around = np.linspace(-HALF, HALF, 200)
    axes.plot(np.sin(around), np.cos(around), color=QUIET, lw=0.9, ls=(0, (8, 3, 2, 3)))
    line = _thrust(axes, arch)
    _words(axes, inner, outer, line)
    return drawn


def _thrust(axes: Axes, arch: Arch) -> np.ndarray:
    """Draw the safest line of thrust of the sketched arch, and the force at its crown."""
    found = carried_by_arch(arch, CircularArch.of(arch, 0.7).problem()).resultants
    assert found is not None  # noqa: S101
    axes.plot(*found.point.T, color=THRUST, lw=1.8, gid="thrust")
    return found.point


def _words(axes: Axes, inner: float, outer: float, line: np.ndarray) -> None:
    crown, left = (0.0, outer), point(-HALF, inner)
    label(axes, "crown", (0.0, outer + 0.17), crown)
    label(axes, "extrados", (0.62, 1.12), point(0.36, outer))
    label(axes, "intrados", (0.3, 0.62), point(0.3, inner))
    label(axes, "centreline", (-0.36, 0.6), point(-0.3, 1.0))
    label(axes, "voussoir", (-0.72, 1.1), point(-0.48, 1.04))
    label(axes, "joint", (-1.08, 0.86), point(-0.84 * HALF + 0.03, 1.07))
    label(axes, "springing", (-1.32, 0.54), point(-HALF, 1.06))
    label(axes, "support", (-1.36, 0.22), point(-HALF - 0.1, 1.0))
    label(axes, "line of thrust", (1.14, 0.98), tuple(line[3 * len(line) // 4].tolist()))
    measure(axes, "", [left, (-left[0], left[1])], 0.0)
    axes.text(0.42, left[1], "span", ha="center", va="center", fontsize=10, color=INK,
              bbox={"fc": "white", "ec": "none", "pad": 1.2})  # fmt: skip
    measure(axes, "rise", [(0.0, left[1]), (0.0, inner)], -0.05)
    measure(axes, "", [point(HALF - 0.3, inner), point(HALF - 0.3, outer)], 0.0)
    label(axes, "thickness t", (1.26, 0.72), point(HALF - 0.3, outer - 0.02))
    axes.plot(0, 0, "+", color=INK, ms=8)
    for angle in (0.0, HALF):
        axes.plot(*zip((0, 0), point(angle, 0.3 if not angle else inner), strict=True),
                  color=QUIET, lw=0.8)  # fmt: skip
    axes.add_patch(
        Arc((0, 0), 0.44, 0.44, theta1=90 - math.degrees(HALF), theta2=90, color=INK)
    )
    axes.text(*point(HALF / 2, 0.33), "half-angle alpha", fontsize=10, color=INK,
              ha="left", va="center")  # fmt: skip
    measure(axes, "radius r", [(0, 0), point(-HALF / 2, 1.0)], 0.0)
    axes.set_xlim(-1.6, 1.6)
    axes.set_ylim(-0.1, 1.36)


if __name__ == "__main__":
    # Words stay words, which can be searched for.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "sketch"}):
        figure().savefig(HERE / "sketch.svg", metadata={"Date": None})
