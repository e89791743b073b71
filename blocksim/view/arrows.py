"""Forces on the still of a structure: of contact, loads, gravity, pressure along joints."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, Polygon

from blocksim.blocks.acting import push_of
from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Load, Problem
from blocksim.blocks.road import fill_loads, profile_of, road_of
from blocksim.limit import Resultants, resultants
from blocksim.view.drawing import grain_of
from blocksim.view.style import DEAD, INK, LIVE, QUIET, THRUST, use_of

LONGEST, PULL = 0.16, 0.08
"""Shares of the larger side of what is drawn: the largest force, the arrow of gravity."""
FAINT = 1e-6
"""Share of the largest force below which there is none."""
FEW = 8
"""Loads from which on their arrows are kept short."""
DEEPEST = 0.8
"""Share of the distance from block to block that the largest pressure is long."""


def draw_forces(axes: Axes, problem: Problem, forces: Array, extent: float) -> list[Array]:
    """Draw resultants of joints where they act: bars between blocks, arrows from supports."""
    found = resultants(problem, np.asarray(forces))
    size = np.hypot(*found.force.T)
    largest = float(size.max(initial=0.0))
    if largest == 0:
        return []
    scale = LONGEST * extent / largest
    name = f"contact force, largest {force_words(largest)}"
    shown: list[Array] = []
    for index, joint in enumerate(problem.assembly.joints):
        if size[index] <= FAINT * largest:
            continue
        place = found.point[index]
        if np.isnan(place[0]):
            place = (joint.inner + joint.outer) / 2
        way = scale * found.force[index]
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


def acting_on(problem: Problem) -> list[tuple[str, Array, Array]]:
    """Return the loads that are drawn as arrows: kind, where it acts [m], and force [N].

    Live ones are as they are at the load factor, and where that is 0, at 1. What stands on
    the road acts on it. Fill is no arrow: it is drawn as an area.
    """
    factor = problem.load or 1.0
    dead = problem.dead[fill_loads(problem) :]
    found = [("dead", *each) for load in dead for each in forces_of(problem, load)]
    if problem.road:
        level, profile = road_of(problem), profile_of(problem.assembly)
        for low, high, weight in problem.road:
            middle = (low + high) / 2
            under = profile.at(middle) or [(0, 1.0, np.array([middle, profile.ends[0, 0, 1]]))]
            top = under[0][2][1] if level is None else level
            force = np.array([0.0, -factor * weight])
            found.append(("live", np.array([middle, top]), force))
        return found
    live = [each for load in problem.live for each in forces_of(problem, load)]
    return [*found, *(("live", point, factor * force) for point, force in live)]


def draw_loads(axes: Axes, problem: Problem, extent: float) -> list[Array]:
    """Draw loads besides gravity as arrows that end where they act (`acting_on`)."""
    drawn = acting_on(problem)
    sizes = [float(np.hypot(*force)) for _, _, force in drawn]
    largest = max(sizes, default=0.0)
    if largest == 0:
        return []
    # Arrows at the centres of many small blocks are no longer than those.
    room = LONGEST * extent
    if len(drawn) > FEW:
        room = min(room, float(np.median(problem.assembly.reach)))
    scale = room / largest
    at = f"at load factor {problem.load:.4g}, " if problem.load else "at factor 1 (not on it), "
    shown: list[Array] = []
    for index, (kind, place, force) in enumerate(drawn):
        if sizes[index] <= FAINT * largest:
            continue
        most = max(size for size, (name, *_) in zip(sizes, drawn, strict=True) if name == kind)
        tone, words = (DEAD, "dead load, ") if kind == "dead" else (LIVE, f"live load {at}")
        if kind == "dead" and (push := push_of(problem)):
            words = f"push, {push}, "
        line = np.array([place - scale * force, place])
        name = f"{words}largest {force_words(most)}"
        arrow(axes, line, tone, f"{kind}-{index}", name, zorder=9)
        shown.append(line)
    on_road = drawn[len(drawn) - len(problem.road) :]
    for index, ((low, high, _), (_, place, _)) in enumerate(
        zip(problem.road, on_road, strict=True)
    ):
        if high > low:
            axes.plot([low, high], [place[1]] * 2, color=LIVE, lw=3, solid_capstyle="butt",
                      zorder=9, gid=f"patch-{index}")  # fmt: skip
    return shown


def forces_of(problem: Problem[Any], load: Load) -> list[tuple[Array, Array]]:
    """Points [m] and forces [N] of a load, one for each of its blocks."""
    assembly = problem.assembly
    down = assembly.weights_under(np.array(assembly.down))
    weights = np.linalg.norm(down, axis=1) * problem.unit_force
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


def draw_use(axes: Axes, problem: Problem, carried: Resultants) -> None:
    """Colour joints by the larger of the shares of width and friction that they use."""
    joints = problem.assembly.joints
    order: list[int] = np.argsort(carried.used, kind="stable").tolist()
    for index in order:
        joint = joints[index]
        if math.isnan(carried.point[index, 0]):
            continue
        if joint.is_corner:
            axes.plot(*joint.inner, "o", ms=5, mfc="white", mec=INK, zorder=9,
                      label="hinge", gid=f"hinge-{index}")  # fmt: skip
            continue
        words, tone = use_of(float(carried.used[index]))
        ends = np.array([joint.inner, joint.outer])
        axes.plot(*ends.T, color=tone, lw=2.4, zorder=5, solid_capstyle="butt",
                  label=f"joint, {words}", gid=f"used-{index}")  # fmt: skip


def pressures_of(problem: Problem, carried: Resultants) -> dict[int, tuple[Array, float]]:
    """Return the pressed part of each joint, (2, 2) [m], and the pressure there [Pa].

    Pressure is even from the nearer end of the joint to as far beyond the resultant, as of
    `Resultants.stress`. At an end it is inf, and the part is a point.
    """
    found: dict[int, tuple[Array, float]] = {}
    for index, joint in enumerate(problem.assembly.joints):
        point, stress = carried.point[index], float(carried.stress[index])
        if joint.is_corner or math.isnan(point[0]) or not stress:
            continue
        ends = np.array([joint.inner, joint.outer])
        near = ends[np.hypot(*(ends - point).T).argmin()]
        found[index] = np.array([near, 2 * point - near]), stress
    return found


def draw_pressures(axes: Axes, problem: Problem, carried: Resultants) -> list[Array]:
    """Draw pressure along joints as areas beside them, to a scale that the legend states."""
    found, joints = pressures_of(problem, carried), problem.assembly.joints
    largest = max((each for _, each in found.values() if math.isfinite(each)), default=0.0)
    if not largest:
        return []
    long = DEEPEST * grain_of(problem.assembly)
    shown: list[Array] = []
    for index, (part, stress) in found.items():
        joint = joints[index]
        across = long * min(stress / largest, 1.0) * joint.normal
        area = np.concatenate([part, part[::-1] + across])
        tone = use_of(float(carried.used[index]))[1]
        axes.add_patch(
            Polygon(area, fc=tone, ec=INK, lw=0.5, zorder=6, gid=f"pressure-{index}")
        )
        shown.append(area)
    words = "pressure along joints"
    if problem.weighed and problem.has_size:
        words += f": {largest / 1e6:.3g} MPa is {long:.3g} m long"
    axes.plot([], [], color=use_of(0.0)[1], lw=6, solid_capstyle="butt", label=words)
    return shown
