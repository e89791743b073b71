"""What stills are drawn of: supports, blocks, gaps that were closed, mechanism, joints."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from blocksim.blocks.assembly import SUPPORT, Array, Joint
from blocksim.blocks.closing import marked_gaps
from blocksim.blocks.joints import JointState
from blocksim.blocks.outlines import following
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import profile_of, road_of
from blocksim.view.arrows import draw_loads
from blocksim.view.drawing import carried, clipped, rims, words_of
from blocksim.view.style import (
    FILL,
    GAP,
    GROUND,
    INK,
    MECHANISM,
    PAPER,
    QUIET,
    STONE,
    line_style,
)

MOVED, AROUND = 0.08, 0.06
"""Shares of the larger side of what is drawn: the largest displacement, and how much of a
support is shown beyond the blocks."""
FAINT = 1e-6
"""Share of the largest rate below which there is none."""
CLOSE = 1e-6
"""Share of a top's length by which the next may be apart and follow it."""
HATCH = "////"
SIZED = 20
"""How many gaps have their size beside them, the largest ones."""


def edge_width(problem: Problem, extent: float) -> float:
    """Return the width of the edges of blocks, thin where blocks are small [points]."""
    small = float(np.median(problem.assembly.reach)) / extent
    return float(np.clip(12 * small, 0.3, 1.1))


def _shape(polygons: Sequence[Array]) -> Path:
    """One path around and between convex polygons."""
    return Path.make_compound_path(
        *(Path(each, closed=False) for each in map(_closed, polygons))
    )


def _closed(polygon: Array) -> Array:
    return np.concatenate([polygon, polygon[:1]])


def supports_shown(problem: Problem) -> list[list[Array]]:
    """Return convex parts of supports near the blocks. An unknown support is a strip."""
    assembly = problem.assembly
    box, extent = _around(problem)
    bodies = [
        [part for each in support.polygons if len(part := clipped(each, *box))]
        for support in assembly.supports
    ]
    unknown = [joint for joint in assembly.springings if joint.support is None]
    middles = np.array([(joint.inner + joint.outer) / 2 for joint in unknown]).reshape(-1, 2)
    # Those of a horseshoe do not reach into each other.
    apart = float(np.hypot(*np.ptp(middles, axis=0))) if len(unknown) > 1 else math.inf
    bodies += [[_strip(joint, min(AROUND * extent, apart / 3))] for joint in unknown]
    return [parts for parts in bodies if parts]


def _around(problem: Problem) -> tuple[tuple[Array, Array], float]:
    """Box around the blocks in which supports are shown, and the larger side of the blocks."""
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    low, high = corners.min(axis=0), corners.max(axis=0)
    extent = float((high - low).max())
    return (low - AROUND * extent, high + AROUND * extent), extent


def draw_supports(axes: Axes, problem: Problem) -> list[Array]:
    """Hatch the supports near the blocks."""
    box, _ = _around(problem)
    shown: list[Array] = []
    for index, parts in enumerate(supports_shown(problem)):
        axes.add_patch(
            PathPatch(_shape(parts), fc=PAPER, ec=GROUND, hatch=HATCH, lw=0, zorder=0.5,
                      gid=f"support-{index}", label="support")
        )  # fmt: skip
        # Where the picture ends, the support goes on.
        around = (np.stack([rim, following(rim)], axis=1) for rim in rims(parts))
        sides = [side for each in around for side in each if not _on_box(side, box)]
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


def _strip(joint: Joint, deep: float) -> Array:
    """Place a strip behind a joint, a little wider than it, counter-clockwise."""
    out = joint.normal * (-deep if joint.before == SUPPORT else deep)
    along = joint.tangent * max(0.15 * joint.length, 0.3 * deep)
    near = np.array([joint.inner - along, joint.outer + along])
    return np.array([near[0], near[1], near[1] + out, near[0] + out])


def road_level(problem: Problem) -> float:
    """Return the level at which places on the road are told [m]: its own, or of what is top."""
    road = road_of(problem)
    return float(profile_of(problem.assembly).ends[..., 1].max()) if road is None else road


def fill_outlines(problem: Problem) -> list[tuple[Array, bool]]:
    """Return outlines of fill and backing (true) below the road [m], cut off at supports."""
    road = road_of(problem)
    if road is None:
        return []
    (low, high), _ = _around(problem)
    profile = profile_of(problem.assembly)
    tops = [clipped_line(each, low[0], high[0]) for each in profile.ends]
    levels = [(road, False)]
    if problem.soil is not None and problem.soil.backing is not None:
        mine = profile.ends[profile.body < len(problem.assembly.blocks), :, 1]
        levels.append((float(mine.min()) + problem.soil.backing[0], True))
    found: list[tuple[Array, bool]] = []
    for level, is_backing in levels:
        for run in _runs([each for each in tops if len(each)]):
            over = np.array([[run[0, 0], level], [run[-1, 0], level]])
            under = np.minimum(run, [math.inf, level])
            found.append((np.concatenate([under, over[::-1]]), is_backing))
    return found


def clipped_line(ends: Array, low: float, high: float) -> Array:
    """Cut a line from left to right, (2, 2), off at two places along x. Beyond it is empty."""
    (x0, y0), (x1, y1) = ends.tolist()
    start, stop = max(x0, low), min(x1, high)
    if start >= stop:
        return ends[:0]
    return np.array([[x, y0 + (y1 - y0) * (x - x0) / (x1 - x0)] for x in (start, stop)])


def _runs(pieces: Sequence[Array]) -> list[Array]:
    """Join pieces from left to right that follow each other."""
    runs: list[list[Array]] = []
    for piece in pieces:
        if runs and piece[0, 0] - runs[-1][-1][1, 0] <= CLOSE * (piece[1, 0] - piece[0, 0]):
            runs[-1].append(piece)
        else:
            runs.append([piece])
    return [np.concatenate(run) for run in runs]


def draw_fill(axes: Axes, problem: Problem) -> list[Array]:
    """Draw fill as an area up to the road, and backing more densely."""
    shown: list[Array] = []
    for index, (outline, is_backing) in enumerate(fill_outlines(problem)):
        name, hatch = ("backing", "xx..") if is_backing else ("fill", "..")
        axes.add_patch(
            PathPatch(_shape([outline]), fc=FILL, ec=QUIET, hatch=hatch, lw=0, zorder=0.3,
                      gid=f"{name}-{index}", label=name)
        )  # fmt: skip
        if not is_backing:
            axes.plot(*outline[-2:].T, color=QUIET, lw=0.8, zorder=0.4, gid=f"road-{index}")
        shown.append(outline)
    return shown


def draw_blocks(axes: Axes, problem: Problem, width: float) -> None:
    """Draw blocks as stone, with edges so wide [points], and gaps closed between them."""
    for index, block in enumerate(problem.assembly.blocks):
        # Parts of one block have no edge between them: a hair of stone closes the seam.
        axes.add_patch(
            PathPatch(_shape(block.polygons), fc=STONE, ec=STONE, lw=0.4, zorder=1,
                      gid=f"block-{index}")
        )  # fmt: skip
        lines = list(map(_closed, rims(block.polygons)))
        axes.add_collection(
            LineCollection(lines, colors=INK, linewidths=width, zorder=2, capstyle="round",
                           joinstyle="round")
        )  # fmt: skip
    _draw_gaps(axes, problem)


def draw_structure(
    axes: Axes,
    problem: Problem,
    mechanism: Array | None = None,
    states: Sequence[JointState] | None = None,
) -> list[Array]:
    """Draw fill, supports, blocks, how they move, and joints. Return points of all of it."""
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    extent = float(np.ptp(corners, axis=0).max())
    shown = [corners, *draw_fill(axes, problem), *draw_supports(axes, problem)]
    draw_blocks(axes, problem, 0.8 * edge_width(problem, extent))
    if mechanism is not None:
        shown += draw_mechanism(axes, problem, mechanism, extent)
    if states is not None:
        draw_states(axes, problem, states)
    return shown + draw_loads(axes, problem, extent)


def _draw_gaps(axes: Axes, problem: Problem) -> None:
    """Mark joints at which a gap or an overlap of the drawing is closed.

    The legend has the size of most of them; others have theirs beside them.
    """
    joints, gaps = problem.assembly.joints, marked_gaps(problem.assembly)
    sizes = {index: f"{1000 * gap:+.3g} mm" for index, gap in gaps.items()}
    usual = Counter(sizes.values()).most_common(1)
    others = [index for index, size in sizes.items() if size != usual[0][0]]
    for index, size in sizes.items():
        joint = joints[index]
        ends = np.array([joint.inner, joint.outer])
        axes.plot(*ends.T, color=GAP, ls=line_style(GAP), lw=1.8, zorder=2.5,
                  solid_capstyle="butt", marker="D" if joint.is_corner else "", ms=4,
                  label=f"closed gap (+) or overlap (-), {usual[0][0]} where not said",
                  gid=f"gap-{index}")  # fmt: skip
        if index in others[:SIZED]:
            x, y = joint.tangent if joint.tangent[0] >= 0 else -joint.tangent
            axes.annotate(size, ends.mean(axis=0), xytext=(-3 * y, 3 * x),
                          textcoords="offset points", ha="center", va="bottom", color=GAP,
                          rotation=math.degrees(math.atan2(y, x)), rotation_mode="anchor",
                          fontsize=6.5, zorder=8, gid=f"gap-size-{index}")  # fmt: skip


def draw_mechanism(
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
        moved, lines = (
            [each + scale * carried(each, block.centre, rates[index]) for each in of]
            for of in (block.polygons, map(_closed, rims(block.polygons)))
        )
        axes.add_patch(
            PathPatch(_shape(moved), fc=MECHANISM, alpha=0.13, ec="none", zorder=3,
                      gid=f"moved-{index}")
        )  # fmt: skip
        axes.add_collection(
            LineCollection(lines, colors=MECHANISM, linewidths=1.1, zorder=4,
                           linestyles=[line_style(MECHANISM)],
                           label="mechanism, enlarged")
        )  # fmt: skip
        shown += moved
    return shown


def draw_states(axes: Axes, problem: Problem, states: Sequence[JointState]) -> None:
    """Colour joints that take part. Dots mark ends that stay closed, bars what slides."""
    for index, (joint, state) in enumerate(zip(problem.assembly.joints, states, strict=True)):
        if state is JointState.CLOSED:
            continue
        words, tone = words_of(state, is_arch=problem.is_arch)
        ends = np.array([joint.inner, joint.outer])
        # A corner on a face has no length to colour.
        axes.plot(*ends.T, color=tone, lw=3.2, zorder=6, label=words, ls=line_style(tone),
                  solid_capstyle="butt", dash_capstyle="butt", ms=5,
                  marker="D" if joint.is_corner else "", gid=f"joint-{index}")  # fmt: skip
        if state.hinge is not None and not joint.is_corner:
            axes.plot(*ends[state.hinge], "o", ms=6, mfc="white", mec=tone, mew=1.6,
                      zorder=7, gid=f"hinge-{index}")  # fmt: skip
