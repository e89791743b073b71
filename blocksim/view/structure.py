# matplotlib's own annotations leave keyword arguments open.
# pyright: reportUnknownMemberType=false
"""A still of any structure: blocks, supports, loads, contact forces, mechanism, joints."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import FancyArrowPatch, PathPatch
from matplotlib.path import Path

from blocksim.arch.circular import arch_of
from blocksim.blocks.assembly import SUPPORT, Array, Joint
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Load, Problem
from blocksim.view.drawing import (
    HINGES,
    carried,
    clipped,
    friction_words,
    loading_words,
    outer_sides,
    round_length,
    words_of,
)
from blocksim.view.style import (
    DEAD,
    FONT,
    GROUND,
    INK,
    LIVE,
    MECHANISM,
    PAPER,
    QUIET,
    STONE,
    THRUST,
)

MOVED, LONGEST, AROUND = 0.08, 0.16, 0.06
"""Shares of the larger side of what is drawn: the largest displacement, the largest force,
and how much of a support is shown beyond the blocks."""
MARGIN = 0.03
FAINT = 1e-6
"""Share of the largest force or rate below which there is none."""
WIDE, TALL = 7.6, (1.6, 8.0)
"""Size of the axes [inches]: their width, and range of their height."""
SIDE_OF_TEXT = 2.2
"""Widest that a narrow structure is drawn over its height."""
HATCH = "////"
LINE = 72
"""Letters in a line of a title."""
FEW = 8
"""Loads from which on their arrows are kept short."""


def problem_figure(
    problem: Problem,
    *,
    verdict: str = "",
    forces: Array | None = None,
    mechanism: Array | None = None,
    states: Sequence[JointState] | None = None,
) -> Figure:
    """Draw a structure as it was built, and what is known of it.

    Every artist has a `gid` that says what it is: `block-3`, `support-0`, `joint-5`,
    `hinge-5`, `force-5`, `dead-0`, `live-0`, `moved-3`, `gravity`, `scale`.

    Parameters
    ----------
    problem : Problem
    verdict : str
        What is said of it below the title.
    forces : (joints, 2, 2) float, optional
        Contact forces, as `Equilibrium.forces` has them.
    mechanism : (blocks, 3) float, optional
        Rates x, y (in units of the size) and rotation, as `Equilibrium.mechanism` and
        `Collapse.mechanism` have them; drawn enlarged to a readable size.
    states : sequence of JointState, optional
        Of each joint.

    Returns
    -------
    Figure
    """
    assembly = problem.assembly
    corners = np.concatenate([block.vertices for block in assembly.blocks])
    low, high = corners.min(axis=0), corners.max(axis=0)
    extent = float((high - low).max())
    with mpl.rc_context({**FONT, "hatch.linewidth": 0.7}):
        figure = Figure(layout=ConstrainedLayoutEngine(h_pad=0.2, w_pad=0.12))
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        axes.set_aspect("equal")
        axes.axis("off")
        box = low - AROUND * extent, high + AROUND * extent
        # What is drawn so far has to find place in the picture.
        shown = [corners, *_draw_supports(axes, problem, box, extent)]
        width = _edge(problem, extent)
        _draw_blocks(axes, problem, width)
        if mechanism is not None:
            shown += _draw_mechanism(axes, problem, mechanism, extent)
        if states is not None:
            _draw_states(axes, problem, states)
        if forces is not None:
            shown += _draw_forces(axes, problem, forces, extent)
        shown += _draw_loads(axes, problem, extent)
        shown += _draw_gravity(axes, problem, np.concatenate(shown))
        _frame(figure, axes, np.concatenate(shown))
        _title(axes, problem, verdict)
        handles, names = axes.get_legend_handles_labels()
        entries = dict(zip(names, handles, strict=True))
        figure.legend(
            entries.values(), entries.keys(), loc="outside lower center", ncols=3, frameon=False
        )
    return figure


def _edge(problem: Problem, extent: float) -> float:
    """Width of the edges of blocks, thin where blocks are small [points]."""
    small = float(np.median(problem.assembly.reach)) / extent
    return float(np.clip(12 * small, 0.3, 1.1))


def _shape(polygons: Sequence[Array]) -> Path:
    """One path around and between convex polygons."""
    return Path.make_compound_path(
        *(Path(each, closed=False) for each in map(_closed, polygons))
    )


def _closed(polygon: Array) -> Array:
    return np.concatenate([polygon, polygon[:1]])


def _draw_supports(
    axes: Axes, problem: Problem, box: tuple[Array, Array], extent: float
) -> list[Array]:
    """Hatch the supports near the blocks; one that is not known is a strip behind its joint."""
    assembly = problem.assembly
    bodies = [
        [part for each in support.polygons if len(part := clipped(each, *box))]
        for support in assembly.supports
    ]
    bodies += [
        [_strip(joint, extent)] for joint in assembly.springings if joint.support is None
    ]
    shown: list[Array] = []
    for index, parts in enumerate(bodies):
        if not parts:
            continue
        axes.add_patch(
            PathPatch(_shape(parts), fc=PAPER, ec=GROUND, hatch=HATCH, lw=0, zorder=0.5,
                      gid=f"support-{index}", label="support")
        )  # fmt: skip
        # Where the picture ends, the support goes on.
        sides = [side for side in outer_sides(parts) if not _on_box(side, box)]
        axes.add_collection(LineCollection(sides, colors=INK, linewidths=0.9, zorder=0.6))
        shown += parts
    return shown


def _on_box(side: Array, box: tuple[Array, Array]) -> bool:
    span = float((box[1] - box[0]).max())
    return any(
        bool((np.abs(side[:, axis] - edge[axis]) < 1e-9 * span).all())
        for axis in (0, 1)
        for edge in box
    )


def _strip(joint: Joint, extent: float) -> Array:
    """Place a strip behind a joint, a little wider than it, counter-clockwise."""
    deep = AROUND * extent
    out = joint.normal * (-deep if joint.before == SUPPORT else deep)
    along = joint.tangent * max(0.15 * joint.length, 0.3 * deep)
    near = np.array([joint.inner - along, joint.outer + along])
    return np.array([near[0], near[1], near[1] + out, near[0] + out])


def _draw_blocks(axes: Axes, problem: Problem, width: float) -> None:
    for index, block in enumerate(problem.assembly.blocks):
        # Parts of one block have no edge between them: a hair of stone closes the seam.
        axes.add_patch(
            PathPatch(_shape(block.polygons), fc=STONE, ec=STONE, lw=0.4, zorder=1,
                      gid=f"block-{index}")
        )  # fmt: skip
        sides = outer_sides(block.polygons)
        axes.add_collection(
            LineCollection(sides, colors=INK, linewidths=width, zorder=2, capstyle="round")
        )


def _draw_mechanism(
    axes: Axes, problem: Problem, mechanism: Array, extent: float
) -> list[Array]:
    """Draw the blocks that move where they move to."""
    assembly = problem.assembly
    rates = np.asarray(mechanism) * [assembly.size, assembly.size, 1.0]
    ways = [
        carried(block.vertices, block.centre, rate)
        for block, rate in zip(assembly.blocks, rates, strict=True)
    ]
    reach = [float(np.hypot(*way.T).max()) for way in ways]
    largest = max(reach)
    shown: list[Array] = []
    for index, block in enumerate(assembly.blocks):
        if reach[index] <= FAINT * largest:
            continue
        scale = MOVED * extent / largest
        moved = [
            part + scale * carried(part, block.centre, rates[index]) for part in block.polygons
        ]
        axes.add_patch(
            PathPatch(_shape(moved), fc=MECHANISM, alpha=0.13, ec="none", zorder=3,
                      gid=f"moved-{index}")
        )  # fmt: skip
        axes.add_collection(
            LineCollection(outer_sides(moved), colors=MECHANISM, linewidths=1.1, zorder=4,
                           label="mechanism, enlarged")
        )  # fmt: skip
        shown += moved
    return shown


def _draw_states(axes: Axes, problem: Problem, states: Sequence[JointState]) -> None:
    """Colour joints that take part; dots mark the ends that stay closed, bars what slides."""
    is_arch = arch_of(problem) is not None
    for index, (joint, state) in enumerate(zip(problem.assembly.joints, states, strict=True)):
        if state is JointState.CLOSED:
            continue
        words, tone = words_of(state, is_arch=is_arch)
        ends = np.array([joint.inner, joint.outer])
        # A corner on a face has no length to colour.
        axes.plot(*ends.T, color=tone, lw=3.2, zorder=6, solid_capstyle="butt", label=words,
                  ls="-", marker="D" if joint.is_corner else "", ms=5,
                  gid=f"joint-{index}")  # fmt: skip
        if state in HINGES and not joint.is_corner:
            axes.plot(*ends[HINGES[state]], "o", ms=6, mfc="white", mec=tone, mew=1.6,
                      zorder=7, gid=f"hinge-{index}")  # fmt: skip


def _draw_forces(axes: Axes, problem: Problem, forces: Array, extent: float) -> list[Array]:
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
            _arrow(axes, line, THRUST, f"force-{index}", name, zorder=8)
        else:
            line = np.array([place - way / 2, place + way / 2])
            axes.plot(*line.T, color=THRUST, lw=1.7, zorder=8, gid=f"force-{index}",
                      solid_capstyle="round", label=name)  # fmt: skip
        axes.plot(*place, "o", ms=2.6, color=THRUST, zorder=8, gid=f"centre-{index}")
        shown.append(line)
    return shown


def _draw_loads(axes: Axes, problem: Problem, extent: float) -> list[Array]:
    """Draw loads besides gravity as arrows that end where they act.

    Live ones as they are at the load factor, and where that is 0, at 1.
    """
    factor = problem.load or 1.0
    drawn = [
        (kind, place, times * force)
        for kind, loads, times in (("dead", problem.dead, 1.0), ("live", problem.live, factor))
        for load in loads
        for place, force in _forces(problem, load)
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
    at = f"at load factor {factor:.4g}, " if problem.load else "at factor 1, "
    shown: list[Array] = []
    for index, (kind, place, force) in enumerate(drawn):
        if sizes[index] <= FAINT * largest:
            continue
        most = max(size for size, (name, *_) in zip(sizes, drawn, strict=True) if name == kind)
        tone, words = (DEAD, "dead load, ") if kind == "dead" else (LIVE, f"live load {at}")
        line = np.array([place - scale * force, place])
        name = f"{words}largest {force_words(most)}"
        _arrow(axes, line, tone, f"{kind}-{index}", name, zorder=9)
        shown.append(line)
    return shown


def _forces(problem: Problem, load: Load) -> list[tuple[Array, Array]]:
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


def _arrow(
    axes: Axes, line: Array, tone: str, gid: str, label: str | None, *, zorder: float
) -> None:
    start, end = line.tolist()
    axes.add_patch(
        FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=8, lw=1.4, color=tone,
                        shrinkA=0, shrinkB=0, zorder=zorder, gid=gid)
    )  # fmt: skip
    # A legend has no arrows: a line of the same colour stands for it.
    axes.plot([], [], color=tone, lw=1.7, label=label)


def _frame(figure: Figure, axes: Axes, shown: Array) -> None:
    """Frame what is drawn, with a scale bar below it."""
    low, high = shown.min(axis=0), shown.max(axis=0)
    span = high - low
    margin = MARGIN * float(span.max())
    left, right = float(low[0]) - margin, float(high[0]) + margin
    bottom, top = float(low[1]) - margin, float(high[1]) + margin
    # A tower is as wide as its title.
    spare = (top - bottom) / SIDE_OF_TEXT - (right - left)
    left, right = left - max(0.0, spare / 2), right + max(0.0, spare / 2)
    tall = float(np.clip(WIDE * (top - bottom) / (right - left), *TALL))
    figure.set_size_inches(WIDE, tall + 1.3)
    inch = max((top - bottom) / tall, (right - left) / WIDE)
    length = round_length(0.25 * float(span.max()))
    level = bottom - 0.12 * inch
    bar = np.array([[low[0], level], [low[0] + length, level]])
    axes.plot(*bar.T, color=INK, lw=1.5, marker="|", ms=7, gid="scale", clip_on=False)
    axes.annotate(f"{length:g} m", bar.mean(axis=0), xytext=(0, -12), ha="center",
                  textcoords="offset points", annotation_clip=False)  # fmt: skip
    axes.set_xlim(left, right)
    axes.set_ylim(level - 0.25 * inch, top)


def _draw_gravity(axes: Axes, problem: Problem, shown: Array) -> list[Array]:
    """Show where gravity pulls beside the structure, unless it is straight down."""
    pull = problem.gravity[:2]
    size = float(np.hypot(*pull))
    if size == 0 or (pull[0] == 0 and pull[1] < 0):
        return []
    low, high = shown.min(axis=0), shown.max(axis=0)
    way = MOVED * float((high - low).max()) * pull / size
    start = np.array([low[0] - abs(way[0]) - 0.5 * np.hypot(*way), high[1] - max(0.0, way[1])])
    line = np.array([start, start + way])
    _arrow(axes, line, QUIET, "gravity", "gravity", zorder=9)
    return [line]


def _title(axes: Axes, problem: Problem, verdict: str) -> None:
    blocks = len(problem.assembly.blocks)
    count = f"{blocks} block" if blocks == 1 else f"{blocks} blocks"
    title = textwrap.fill(problem.title or count, LINE)
    axes.set_title(title, fontsize=10.5, pad=20)
    facts = [
        verdict,
        count if problem.title else "",
        friction_words(problem.mu),
        *loading_words(problem),
    ]
    below = ", ".join(word for word in facts if word)
    axes.annotate(below, (0, 1), xytext=(0, 8), xycoords="axes fraction",
                  textcoords="offset points", color=QUIET, va="baseline")  # fmt: skip
