"""A sheet on paper: drawn to scale, its axes as large as the page, in metres."""

from __future__ import annotations

import math
import textwrap
from dataclasses import replace
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Patch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import width
from blocksim.common.version import __version__
from blocksim.common.words import printable
from blocksim.limit import in_world
from blocksim.view.arrows import arrow, draw_forces, draw_gravity, draw_pressures, draw_use
from blocksim.view.dimensions import Angle, Length, dimensions_of, half_angle_of
from blocksim.view.drawing import literal, new_figure, round_length
from blocksim.view.sheet import Sheet, scale_words
from blocksim.view.sheetlayout import COLUMNS, LINE, MARGIN, TITLE, Layout, layout_of, wrapped
from blocksim.view.structure import draw_blocks, draw_structure, draw_supports, road_level
from blocksim.view.style import FONT, INK, QUIET, STONE, THRUST
from blocksim.view.thrustlines import force_sizes

INCH = 25.4
"""Millimetres in an inch."""
SCREEN = (190.0, 150.0)
"""Width and most height of a drawing in a notebook [mm]."""
REACTION = 14.0
"""Length of the arrow of the largest reaction [mm]."""
LONG = 34.0
"""Dimension lines from which on words stand along them [mm]."""
SMALL, SMALLER, NUMBERED = 8.0, 7.5, 5.0
"""Sizes of letters [points]."""
NUMBER, DIGIT, ROOMY = 2.4, 1.1, 6.0
"""Width of a block that has room for its number, of a letter of that, and of one that has
more than enough [mm]."""
EVERY = 5
"""Where blocks have little room, one in so many has its number."""
BAND = 9.0
"""Width of the band of the largest force along a line of thrust [points]."""
LINES = {"min": (0, (6, 2)), "max": (0, (1, 1.2)), "safest": "-"}
"""Dashes of each line of thrust."""


def sheet_figure(
    sheet: Sheet, *, column: tuple[float, float] | None = None, bare: bool = False
) -> Figure:
    """Draw a sheet. Its pdf and svg are to scale where they are printed at 100 %.

    Every artist has a `gid` that says what it is: `block-3`, `support-0`, `joint-5`,
    `hinge-5`, `thrust-min-0`, `reaction-1`, `dimension-span`, `moved-3`, `scale`.

    `column`, (width, height): Of a column that it is put into [mm], the height at most. By
        default it is a page of A4, across or upright.
    `bare`: Without title, facts and version: a page says them.
    """
    problem = sheet.problem
    with mpl.rc_context({**FONT, "font.size": SMALL, "hatch.linewidth": 0.5}):
        figure = new_figure()
        axes = figure.add_axes((0, 0, 1, 1))
        axes.axis("off")
        points = _draw_drawing(axes, sheet)
        low, high = points.min(axis=0), points.max(axis=0)
        entries = _entries(axes)
        layout = layout_of(sheet, low, high, len(entries), column, bare=bare)
        figure.set_size_inches(layout.paper.width / INCH, layout.paper.height / INCH)
        axes.set_xlim(float(layout.low[0]), float(layout.high[0]))
        axes.set_ylim(float(layout.low[1]), float(layout.high[1]))
        _draw_reactions(axes, sheet, layout, float(low[1]))
        measured = [] if sheet.pressed else dimensions_of(problem, points, layout.scale)
        for each in measured:
            if isinstance(each, Length):
                _draw_length(axes, each, layout)
            else:
                _draw_angle(axes, each, layout)
        _draw_numbers(axes, sheet, layout)
        _draw_thrust(axes, sheet, layout, float(high[1]))
        _draw_words(figure, axes, sheet, layout, bare=bare)
        if entries:
            at = layout.edge / layout.paper.width, layout.edge / layout.paper.height
            figure.legend(entries.values(), entries.keys(), loc="lower left", frameon=False,
                          bbox_to_anchor=Bbox.from_bounds(*at, 0, 0), ncols=COLUMNS,
                          borderpad=0, borderaxespad=0, fontsize=SMALLER,
                          handlelength=3.2, labelspacing=0.45)  # fmt: skip
    return figure


def _draw_drawing(axes: Axes, sheet: Sheet) -> Array:
    """Draw all that is in metres, and return points that have to find room."""
    problem = sheet.problem
    used = None if sheet.carried is None else sheet.carried.resultants
    if sheet.pressed and used is not None:
        shown = draw_supports(axes, problem)
        draw_blocks(axes, problem, 0.4)
        shown += [block.vertices for block in problem.assembly.blocks]
        shown += draw_pressures(axes, problem, used)
    else:
        shown = draw_structure(axes, problem, sheet.mechanism, sheet.joint_states)
        extent = float(np.ptp(shown[0], axis=0).max())
        if sheet.forces is not None:
            shown += draw_forces(axes, problem, sheet.forces, extent)
        shown += draw_gravity(axes, problem, np.concatenate(shown))
        _draw_band(axes, sheet)
    if used is not None and sheet.mechanism is None:
        draw_use(axes, problem, used)
    for line in sheet.lines:
        _draw_line(axes, line.name, line.words, line.paths)
        shown += line.paths
    if sheet.reactions and sheet.forces is None:
        words = "reaction at greatest margin"
        axes.plot([], [], color=INK, lw=1.2, marker=6, ms=5, label=words)
    return np.concatenate(shown)


def _entries(axes: Axes) -> dict[str, Patch | Line2D]:
    """Legend of what is there, each once."""
    handles, names = axes.get_legend_handles_labels()
    return dict(zip(names, handles, strict=True))  # type: ignore[arg-type]


def _draw_band(axes: Axes, sheet: Sheet) -> None:
    """Draw a band along the safest line of thrust, as wide as the force is large."""
    carried = sheet.carried
    if carried is None or carried.forces is None or not carried.stands:
        return
    paths = [path for line in sheet.lines if line.name == "safest" for path in line.paths]
    if not paths:
        return
    sizes = [force_sizes(sheet.problem, carried.forces, path) for path in paths]
    largest = max(float(each.max()) for each in sizes)
    words = f"force along it: this wide at {sheet.unit.words(largest)}"
    for index, (path, each) in enumerate(zip(paths, sizes, strict=True)):
        pieces = list(np.stack([path[:-1], path[1:]], axis=1))
        axes.add_collection(
            LineCollection(pieces, colors=THRUST, alpha=0.22, capstyle="butt", zorder=7.5,
                           linewidths=BAND * each / largest, gid=f"force-band-{index}")
        )  # fmt: skip
    axes.plot([], [], color=THRUST, alpha=0.22, lw=BAND, label=words, solid_capstyle="butt")


def _draw_line(axes: Axes, name: str, words: str, paths: tuple[Array, ...]) -> None:
    for index, path in enumerate(paths):
        axes.plot(*path.T, color=THRUST, ls=LINES[name], lw=1.5 if name == "safest" else 1.2,
                  zorder=8, label=words, gid=f"thrust-{name}-{index}",
                  solid_capstyle="round")  # fmt: skip


def _draw_length(axes: Axes, each: Length, layout: Layout) -> None:
    """Draw a dimension line with oblique strokes, lines that lead to it, and its words."""
    mm = layout.mm
    if each.what == "height":
        each = replace(each, at=layout.left_of_words(axes, each.line))
    line, along = each.line, each.along
    across = np.array([-along[1], along[0]])
    gid = f"dimension-{each.what}"
    for foot, point in zip(line, each.ends, strict=True):
        way = foot - point
        far = float(np.hypot(*way))
        if far > 2 * mm:
            lead = np.array([point + way / far * 1.2 * mm, foot + way / far * 1.5 * mm])
            axes.plot(*lead.T, color=QUIET, lw=0.5, zorder=9, gid=f"{gid}-lead")
        stroke = (along + across) * 1.1 * mm
        axes.plot(*np.array([foot - stroke, foot + stroke]).T, color=INK, lw=0.9, zorder=9,
                  gid=f"{gid}-end")  # fmt: skip
    axes.plot(*line.T, color=INK, lw=0.6, zorder=9, gid=gid)
    middle, long = line.mean(axis=0), each.value / mm
    if each.what == "thickness":
        # Beyond the outer end, on the side to which it leads.
        tail = line[1] + along * 6 * mm
        axes.plot(*np.array([line[1], tail]).T, color=INK, lw=0.6, zorder=9,
                  gid="dimension-thickness-lead")  # fmt: skip
        side = -1.0 if along[0] < 0 else 1.0
        at, away = tail + along * mm, (side, 0.0)
        style = {"va": "center", "ha": "right" if side < 0 else "left"}
    elif abs(along[0]) > 0.5:
        side = 1.0 if each.what == "width" else -1.0
        at, away = middle + np.array([0.0, side]) * mm, (0.0, side)
        style = {"ha": "center", "va": "bottom" if side > 0 else "top"}
    elif long > LONG or each.what == "height":
        # Along the line, lest they go into what is drawn beside it.
        at, away = middle - np.array([mm, 0.0]), (0.0, 1.0)
        style = {"ha": "right", "va": "center", "rotation": 90}
    else:
        # Low, where an arch is wide.
        low = line[line[:, 1].argmin()]
        at, away = low + (middle - low) / 2 + np.array([1.5 * mm, 0.0]), (1.0, 0.0)
        style = {"ha": "left", "va": "center"}
    layout.write(axes, at, each.words, away, gid=f"{gid}-words", **style)


def _draw_angle(axes: Axes, each: Angle, layout: Layout) -> None:
    """Draw the arc of an angle beyond the extrados, and its words."""
    mm, turn = layout.mm, math.degrees(each.value)
    gid = f"dimension-{each.what}"
    axes.add_patch(
        Arc((float(each.centre[0]), float(each.centre[1])), 2 * each.radius, 2 * each.radius,
            theta1=90 - turn, theta2=90, color=INK, lw=0.6, zorder=9, gid=gid)
    )  # fmt: skip
    for share in (0.0, 1.0):
        lead = np.array([
            each.point(share, each.reach + 1.2 * mm), each.point(share, each.radius + 1.5 * mm)
        ])  # fmt: skip
        axes.plot(*lead.T, color=QUIET, lw=0.5, zorder=9, gid=f"{gid}-lead")
        point, turned = each.point(share), share * each.value
        # Across the line from the centre, turned by half a right angle as those of lengths.
        stroke = np.array([math.cos(turned - 0.785), -math.sin(turned - 0.785)]) * 1.5 * mm
        axes.plot(*np.array([point - stroke, point + stroke]).T, color=INK, lw=0.9, zorder=9,
                  gid=f"{gid}-end")  # fmt: skip
    where = each.point(0.55, each.radius + 1.5 * mm)
    below = 0.55 * each.value > math.pi / 2
    layout.write(axes, where, each.words, (1.0, 0.0), ha="left",
                 va="top" if below else "bottom", gid=f"{gid}-words")  # fmt: skip


def _draw_numbers(axes: Axes, sheet: Sheet, layout: Layout) -> None:
    """Write names on blocks that have room for them, and mark x = 0 on the road."""
    problem, mm = sheet.problem, layout.mm
    for index, block in enumerate(problem.assembly.blocks):
        name = printable(block.name or str(index))
        # However it is turned: voussoirs of an arch have as much room each.
        room = max(width(part) for part in block.polygons)
        # Where there is little room, every fifth: they are counted on.
        seldom = room < ROOMY * mm and index % EVERY != EVERY - 1
        if seldom or room < max(NUMBER, len(name) * DIGIT) * mm:
            continue
        x, y = block.centre.tolist()
        axes.text(x, y, literal(name), ha="center", va="center", fontsize=NUMBERED,
                  color=INK, zorder=9.5, gid=f"number-{index}", clip_on=True,
                  path_effects=[withStroke(linewidth=1.6, foreground=STONE)])  # fmt: skip
    if problem.road and not sheet.pressed:
        top = road_level(problem)
        axes.plot(0.0, top, marker=7, ms=5, color=INK, zorder=9, gid="origin")
        layout.write(axes, np.array([0.0, top + 2 * mm]), "x = 0", (0.0, 1.0), ha="center",
                     va="bottom", fontsize=SMALLER, gid="origin-words")  # fmt: skip


def _draw_thrust(axes: Axes, sheet: Sheet, layout: Layout, top: float) -> None:
    """Tell the thrust above the joint at which it is told."""
    if sheet.thrust is None:
        return
    index, words = sheet.thrust
    joint, mm = sheet.problem.assembly.joints[index], layout.mm
    head = joint.outer if joint.outer[1] > joint.inner[1] else joint.inner
    foot = np.array([head[0], top + 3.5 * mm])
    lead = np.array([head + np.array([0.0, 0.8 * mm]), foot])
    axes.plot(*lead.T, color=QUIET, lw=0.5, zorder=9, gid="thrust-lead")
    # The half-angle is told to the right of the crown.
    side = "center" if half_angle_of(sheet.problem) is None else "right"
    aside = -1.5 if side == "right" else 0.5
    layout.write(axes, foot + np.array([aside, 0.6]) * mm, words, (0.0, 1.0), ha=side,
                 va="bottom", gid="thrust-words")  # fmt: skip


def _draw_reactions(axes: Axes, sheet: Sheet, layout: Layout, low: float) -> None:
    """Draw what supports bear as arrows with words. Where forces are drawn, words suffice."""
    sizes = [float(np.hypot(*each.force)) for each in sheet.reactions]
    largest, unit, mm = max(sizes, default=0.0), sheet.unit, layout.mm
    for index, (each, size) in enumerate(zip(sheet.reactions, sizes, strict=True)):
        if size <= 1e-9 * largest or largest == 0:
            continue
        # A small one is still an arrow.
        way = each.force / size * REACTION * max(0.35, size / largest) * mm
        tail = each.point - way
        if sheet.forces is None:
            arrow(axes, np.array([tail, each.point]), INK, f"reaction-{index}", zorder=9)
        else:
            tail = np.array([each.point[0], low])
        borne = in_world(sheet.problem, each.force)
        across, up = (unit.words(float(part)) for part in np.abs(borne))
        side = "\N{RIGHTWARDS ARROW}" if borne[0] >= 0 else "\N{LEFTWARDS ARROW}"
        rise = "\N{UPWARDS ARROW}" if borne[1] >= 0 else "\N{DOWNWARDS ARROW}"
        words = f"{rise} {up}"
        if abs(borne[0]) > 1e-6 * largest:
            words += f"\n{side} {across}"
        style: dict[str, Any] = {"linespacing": 1.15, "gid": f"reaction-{index}-words"}
        if abs(way[0]) > 2 * abs(way[1]):
            # One that is nearly level comes from beside.
            ahead = math.copysign(1.0, way[0])
            layout.write(axes, tail - np.array([0.8 * ahead * mm, 0.0]), words, (-ahead, 0.0),
                         va="center", ha="right" if ahead > 0 else "left", **style)  # fmt: skip
        else:
            rises = math.copysign(1.0, way[1])
            layout.write(axes, tail - np.array([0.0, 0.8 * rises * mm]), words, (0.0, -rises),
                         va="top" if rises > 0 else "bottom", ha="center", **style)  # fmt: skip


def _draw_words(
    figure: Figure, axes: Axes, sheet: Sheet, layout: Layout, *, bare: bool
) -> None:
    """Write title and facts above, and scale and version below."""
    paper, mm = layout.paper, layout.mm

    def write(x: float, y: float, words: str, **style: object) -> None:
        figure.text(x / paper.width, y / paper.height, literal(words), **style)  # type: ignore[arg-type]

    if not bare:
        level = paper.height - layout.edge
        title = textwrap.shorten(sheet.title, int((paper.width - 2 * MARGIN) / 2.4))
        write(layout.edge, level - 4, title, fontsize=12, weight="bold", color=INK)
        level -= TITLE
        for fact in sheet.facts:
            for line in wrapped(fact, paper):
                level -= LINE
                write(layout.edge, level + 2, line, color=QUIET, fontsize=SMALL)
    length = round_length(45 * mm)
    right = float(layout.high[0]) - layout.edge * mm
    level = float(layout.low[1]) + layout.bar * mm
    axes.plot([right - length, right], [level, level], color=INK, lw=1.2, marker="|", ms=6,
              gid="scale")  # fmt: skip
    axes.text(right - length / 2, level + 1.2 * mm, f"{length:g} m", ha="center", va="bottom",
              color=INK, gid="scale-words")  # fmt: skip
    on = f" on {paper.name}" if paper.name else ""
    said = f"{scale_words(layout.scale)}{on}, true where printed at 100 %"
    if not bare:
        said += f" \N{MIDDLE DOT} blocksim {__version__}"
    axes.text(right, level - 1.6 * mm, said, ha="right", va="top", color=QUIET,
              fontsize=SMALLER, gid="scale-note")  # fmt: skip
