# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""Forces on the still of a structure: of contact, loads, and where gravity pulls."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Load, Problem
from blocksim.view.style import DEAD, LIVE, QUIET, THRUST

LONGEST, PULL = 0.16, 0.08
"""Shares of the larger side of what is drawn: the largest force, the arrow of gravity."""
FAINT = 1e-6
"""Share of the largest force below which there is none."""
FEW = 8
"""Loads from which on their arrows are kept short."""


def draw_forces(axes: Axes, problem: Problem, forces: Array, extent: float) -> list[Array]:
    """Draw the resultant of each joint through the point where it acts.

    Between blocks it is a bar, because it acts both ways; from a support an arrow.
    """
    joints = problem.assembly.joint_arrays
    pressure, shear = np.asarray(forces).sum(axis=1).T
    resultants = pressure[:, None] * joints.normal + shear[:, None] * joints.tangent
    size = np.hypot(*resultants.T)
    largest = float(size.max(initial=0.0))
    if largest == 0:
        return []
    scale = LONGEST * extent / largest
    name = f"contact force, largest {force_words(largest * problem.unit_force)}"
    shown: list[Array] = []
    for index, joint in enumerate(problem.assembly.joints):
        if size[index] <= FAINT * largest:
            continue
        ends = np.array([joint.inner, joint.outer])
        share = forces[index][:, 0] / pressure[index] if pressure[index] > 0 else [0.5, 0.5]
        place = np.asarray(share) @ ends
        way = scale * resultants[index]
        if SUPPORT in (joint.before, joint.after):
            way = -way if joint.after == SUPPORT else way
            line = np.array([place - way, place])
            arrow(axes, line, THRUST, f"force-{index}", name, zorder=8)
        else:
            line = np.array([place - way / 2, place + way / 2])
            axes.plot(*line.T, color=THRUST, lw=1.7, zorder=8, gid=f"force-{index}",
                      solid_capstyle="round", label=name)  # fmt: skip
        axes.plot(*place, "o", ms=2.6, color=THRUST, zorder=8, gid=f"centre-{index}")
        shown.append(line)
    return shown


def draw_loads(axes: Axes, problem: Problem, extent: float) -> list[Array]:
    """Draw loads besides gravity as arrows that end where they act.

    Live ones as they are at the load factor, and where that is 0, at 1.
    """
    factor = problem.load or 1.0
    drawn = [
        (kind, place, times * force)
        for kind, loads, times in (("dead", problem.dead, 1.0), ("live", problem.live, factor))
        for load in loads
        for place, force in forces_of(problem, load)
    ]
    sizes = [float(np.hypot(*force)) for _, _, force in drawn]
    largest = max(sizes, default=0.0)
    if largest == 0:
        return []
    # Arrows at the centres of many small blocks are no longer than those.
    room = LONGEST * extent
    if len(drawn) > FEW:
        room = min(room, float(np.median(problem.assembly.reach)))
    scale = room / largest
    at = f"at load factor {factor:.4g}, " if problem.load else "at factor 1 (not on it), "
    shown: list[Array] = []
    for index, (kind, place, force) in enumerate(drawn):
        if sizes[index] <= FAINT * largest:
            continue
        most = max(size for size, (name, *_) in zip(sizes, drawn, strict=True) if name == kind)
        tone, words = (DEAD, "dead load, ") if kind == "dead" else (LIVE, f"live load {at}")
        line = np.array([place - scale * force, place])
        name = f"{words}largest {force_words(most)}"
        arrow(axes, line, tone, f"{kind}-{index}", name, zorder=9)
        shown.append(line)
    return shown


def forces_of(problem: Problem, load: Load) -> list[tuple[Array, Array]]:
    """Points [m] and forces [N] of a load, one for each of its blocks."""
    assembly = problem.assembly
    weights = assembly.masses[:, 0] * problem.unit_force
    return [
        (
            assembly.centres[block] if load.point is None else load.point,
            load.force * weights[block] if load.per_weight else load.force,
        )
        for block in load.blocks
    ]


def force_words(newtons: float) -> str:
    """Force with a unit that keeps it short."""
    for least, unit in ((1e6, "MN"), (1e3, "kN")):
        if newtons >= least:
            return f"{newtons / least:.3g} {unit}"
    return f"{newtons:.3g} N"


def arrow(
    axes: Axes,
    line: Array,
    tone: str,
    gid: str,
    label: str | None = None,
    *,
    zorder: float,
) -> None:
    """Draw an arrow from the first of two points to the second."""
    start, end = line.tolist()
    axes.add_patch(
        FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=8, lw=1.4, color=tone,
                        shrinkA=0, shrinkB=0, zorder=zorder, gid=gid)
    )  # fmt: skip
    # A legend has no arrows: a line of the same colour stands for it.
    if label is not None:
        axes.plot([], [], color=tone, lw=1.7, label=label)


def draw_gravity(axes: Axes, problem: Problem, shown: Array) -> list[Array]:
    """Show where gravity pulls beside the structure, unless it is straight down."""
    pull = problem.gravity[:2]
    size = float(np.hypot(*pull))
    if size == 0 or (pull[0] == 0 and pull[1] < 0):
        return []
    low, high = shown.min(axis=0), shown.max(axis=0)
    way = PULL * float((high - low).max()) * pull / size
    start = np.array([low[0] - abs(way[0]) - 0.5 * np.hypot(*way), high[1] - max(0.0, way[1])])
    line = np.array([start, start + way])
    arrow(axes, line, QUIET, "gravity", "gravity", zorder=9)
    return [line]
