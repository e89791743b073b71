"""What all pictures have in common: files, outlines, clipping, words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, BinaryIO, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from blocksim.blocks.acting import tilt_and_lean
from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.joints import JointState
from blocksim.blocks.outlines import signed_area
from blocksim.blocks.problem import Problem
from blocksim.common.words import printable
from blocksim.view.style import FONT, JOINTS

ARCH_WORDS = {
    JointState.HINGE_INTRADOS: "hinge intrados",
    JointState.HINGE_EXTRADOS: "hinge extrados",
    JointState.SLIDES: "slides",
    JointState.HINGE_AND_SLIDES: "hinge and slides",
    JointState.OPEN: "open",
}
HINGES = {JointState.HINGE_INTRADOS: 0, JointState.HINGE_EXTRADOS: 1}
"""End of a joint that stays closed: inner or outer."""
NEAR = 1e-6
"""Share of a length within which sides lie on each other."""
MEETS = 1e-9
"""Share of a side within which ends of sides are the same corner."""
DOTS = 150
"""In an inch of a picture whose height is not given."""


def new_figure(size: tuple[float, float] | None = None, *, pad: float | None = None) -> Figure:
    """Begin a figure so large [inches], parts so far apart; not laid out without a size."""
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


def state_of_any(state: JointState) -> JointState:
    """Give hinges at either end one colour: only an arch has an intrados and an extrados."""
    return JointState.HINGE_INTRADOS if state in HINGES else state


def words_of(state: JointState, *, is_arch: bool) -> tuple[str, str]:
    """Words and colour of a joint's state in a legend."""
    if not is_arch and state in HINGES:
        return "hinge", JOINTS[state_of_any(state)]
    return ARCH_WORDS[state], JOINTS[state]


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
        words.append(f"tilted {abs(tilt):.4g}°{side}")
    if lean:
        words.append(f"gravity leans {lean:.3g}° out of the plane")
    if problem.live and problem.load:
        words.append(f"load factor {problem.load:.4g}")
    if problem.shaking is not None:
        words.append(problem.shaking.words)
    return words


def clipped(polygon: Array, low: Array, high: Array) -> Array:
    """Cut a convex polygon off at a box, (k, 2); k = 0 beyond (Sutherland and Hodgman 1974)."""
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


class Part(NamedTuple):
    """A part of a side of one of several polygons, from one share of it to another."""

    polygon: int
    side: int
    start: float
    stop: float


def outer_parts(polygons: Sequence[Array]) -> list[Part]:
    """Parts of the sides of polygons that touch where no other of them is met."""
    sides = [
        (place, side, one, two)
        for place, polygon in enumerate(polygons)
        for side, (one, two) in enumerate(
            zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
        )
    ]
    found: list[Part] = []
    for place, side, one, two in sides:
        length = float(np.hypot(*(two - one)))
        if length == 0:
            continue
        along = (two - one) / length
        across = np.array([-along[1], along[0]])
        hidden: list[tuple[float, float]] = []
        for other, _, start, stop in sides:
            off = max(abs(float((start - one) @ across)), abs(float((stop - one) @ across)))
            # A side that meets this one runs the other way.
            first, last = float((stop - one) @ along), float((start - one) @ along)
            if other != place and off < NEAR * length and first < last:
                hidden.append((first / length, last / length))
        reached = 0.0
        for first, last in [*sorted(hidden), (1.0, 1.0)]:
            if first > reached + NEAR:
                found.append(Part(place, side, reached, min(first, 1.0)))
            reached = max(reached, last)
    return found


def outer_sides(polygons: Sequence[Array]) -> list[Array]:
    """Sides of polygons that touch, without where two of them meet, (2, 2) each."""
    return [
        along_side(polygons[polygon], side, start, stop)
        for polygon, side, start, stop in outer_parts(polygons)
    ]


def outline(polygons: tuple[Array, ...]) -> Array:
    """Return the outline of convex polygons that touch, counter-clockwise."""
    if len(polygons) == 1:
        return polygons[0]
    sides = outer_sides(polygons)
    near = MEETS * max(float(np.hypot(*(side[1] - side[0]))) for side in sides)
    left, corners = sides[1:], [sides[0][0], sides[0][1]]
    while left:
        ahead = next(
            (k for k, side in enumerate(left) if np.hypot(*(side[0] - corners[-1])) < near),
            None,
        )
        if ahead is None:
            break
        corners.append(left.pop(ahead)[1])
    closed = np.array(corners)
    if left or np.hypot(*(closed[-1] - closed[0])) > near or signed_area(closed[:-1]) <= 0:
        message = "the outline is not one closed line"
        raise ValueError(message)
    return closed[:-1]


def along_side(corners: Array, side: int, start: float, stop: float) -> Array:
    """Two points on a side of a polygon, by their shares of it, (2, 2 or 3)."""
    ends = np.array([[1 - start, start], [1 - stop, stop]])
    return ends @ corners[[side, (side + 1) % len(corners)]]


def grain_of(assembly: Assembly) -> float:
    """Least distance between the centres of blocks that meet; of one alone its reach [m]."""
    before, after, *_ = assembly.joint_arrays
    pairs = (before != SUPPORT) & (after != SUPPORT)
    apart = np.hypot(*(assembly.centres[after[pairs]] - assembly.centres[before[pairs]]).T)
    return float(apart.min() if len(apart) else assembly.reach.min())


def carried(points: Array, centre: Array, rates: Array) -> Array:
    """Velocities of points of a block that moves with rates x, y and rotation."""
    arm = points - centre
    return rates[:2] + rates[2] * np.column_stack([-arm[:, 1], arm[:, 0]])
