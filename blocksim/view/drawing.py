"""What all pictures have in common: files, outlines, clipping, words."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any, BinaryIO

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from blocksim.blocks.acting import push_of, shaking_words, tilt_and_lean, towards
from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Problem
from blocksim.common.words import printable
from blocksim.view.style import FONT, JOINTS

DOTS = 150
"""Dots an inch of a picture whose height is not given."""


def new_figure(size: tuple[float, float] | None = None, *, pad: float | None = None) -> Figure:
    """Begin a figure of a size [inches], or one without layout where no size is given."""
    layout = None if size is None else ConstrainedLayoutEngine(h_pad=pad)
    figure = Figure(figsize=size, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def save_figure(
    figure: Figure, file: BinaryIO, kind: str, *, height: int | None = None
) -> None:
    """Write a png (of so many pixels), svg or pdf without the date: equal ones are equal."""
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    metadata = undated.get(kind, {"Software": "blocksim"})
    # A hair more, lest a pixel is lost to round-off.
    dots = DOTS if height is None else height * (1 + 1e-12) / figure.get_figheight()
    with mpl.rc_context(FONT):
        figure.savefig(file, format=kind, dpi=dots, metadata=metadata)


def figure_bytes(figure: Figure, kind: str = "svg") -> bytes:
    """Return what `save_figure` writes."""
    file = io.BytesIO()
    save_figure(figure, file, kind)
    return file.getvalue()


def state_of_any(state: JointState) -> JointState:
    """Give hinges at either end one colour: only an arch has an intrados and an extrados."""
    return state if state.hinge is None else JointState.HINGE_INTRADOS


def words_of(state: JointState, *, is_arch: bool) -> tuple[str, str]:
    """Return words and colour of a joint's state for a legend."""
    if not is_arch and state.hinge is not None:
        return "hinge", JOINTS[state_of_any(state)]
    return state.words, JOINTS[state]


def round_length(length: float) -> float:
    """Largest 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))


def literal(text: str) -> str:
    """Return text of a stranger for matplotlib, to which dollars begin formulas."""
    return printable(text).replace("$", r"\$")


def friction_words(mu: float) -> str:
    """Friction coefficient for titles."""
    return "μ = ∞" if math.isinf(mu) else f"μ = {mu:.4g}"


def loading_words(problem: Problem[Any]) -> list[str]:
    """Say what besides its weight acts: tilt, lean, the load factor, ground that shakes."""
    tilt, lean = tilt_and_lean(problem)
    words = [] if problem.gravity.any() else ["no gravity"]
    if abs(tilt) > 1e-9:
        side = "" if tilt > 0 else " to the left"
        side = f" towards {towards(problem):.4g}° from x" if problem.in_space else side
        words.append(f"tilted {abs(tilt):.4g}°{side}")
    if lean:
        words.append(f"gravity leans {lean:.3g}° out of the plane")
    if problem.in_space and (push := push_of(problem)):
        words.append(f"a push of {push}")
    if problem.live and problem.load:
        words.append(f"load factor {problem.load:.4g}")
    if problem.shaking is not None:
        words.append(shaking_words(problem))
    return words


def clipped(polygon: Array, low: Array, high: Array) -> Array:
    """Cut a convex polygon off at a box (Sutherland and Hodgman 1974).

    Returns: (k, 2), with k = 0 where it lies beyond the box.
    """
    for axis in (0, 1):
        for sign, limit in ((1.0, float(high[axis])), (-1.0, -float(low[axis]))):
            kept: list[Array] = []
            for one, two in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
                over = sign * one[axis] - limit, sign * two[axis] - limit
                if over[0] <= 0:
                    kept.append(one)
                if min(over) < 0 < max(over):
                    kept.append(one + (two - one) * over[0] / (over[0] - over[1]))
            polygon = np.array(kept).reshape(-1, 2)
    return polygon if len(polygon) >= 3 else polygon[:0]


def rims(polygons: Sequence[Array]) -> list[Array]:
    """Return the rims of polygons that touch, without sides where two of them meet."""
    if len(polygons) == 1:
        return list(polygons)
    # Most blocks are one polygon, which needs no library.
    from blocksim.blocks.regions import rings

    return rings(polygons)


def grain_of(assembly: Assembly) -> float:
    """Return the least distance between centres of blocks that meet, or a lone reach [m]."""
    before, after, *_ = assembly.joint_arrays
    pairs = (before != SUPPORT) & (after != SUPPORT)
    apart = np.hypot(*(assembly.centres[after[pairs]] - assembly.centres[before[pairs]]).T)
    return float(apart.min() if len(apart) else assembly.reach.min())


def carried(points: Array, centre: Array, rates: Array) -> Array:
    """Velocities of points of a block that moves with rates x, y and rotation."""
    arm = points - centre
    return rates[:2] + rates[2] * np.column_stack([-arm[:, 1], arm[:, 0]])
