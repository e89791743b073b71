"""A sheet as DXF: bodies, joints, lines of thrust and true dimensions, each on its layer.

What is on the layers `blocks` and `supports` is read as a structure again.
"""

from __future__ import annotations

import io
import math
import re
from typing import Any, BinaryIO

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.closing import marked_gaps
from blocksim.blocks.joints import JointState
from blocksim.blocks.road import profile_of, road_of
from blocksim.common.checks import require
from blocksim.common.dates import is_dated, present
from blocksim.common.later import require_library
from blocksim.common.version import __version__
from blocksim.common.words import printable
from blocksim.limit import in_world
from blocksim.view.arrows import FAINT, acting_on
from blocksim.view.dimensions import Length, dimensions_of
from blocksim.view.drawing import rims
from blocksim.view.sheet import A4, Sheet, scale_for, scale_words
from blocksim.view.structure import fill_outlines

LAYERS = {
    "blocks": (7, "CONTINUOUS", 35),
    "supports": (8, "CONTINUOUS", 50),
    "joints": (9, "CONTINUOUS", 13),
    "numbers": (8, "CONTINUOUS", 13),
    "thrust-min": (5, "DASHED", 25),
    "thrust-max": (6, "DASHDOT", 25),
    "thrust-safest": (30, "CONTINUOUS", 35),
    "mechanism": (3, "CONTINUOUS", 35),
    "gaps": (1, "CONTINUOUS", 25),
    "loads-dead": (8, "CONTINUOUS", 18),
    "loads-live": (1, "CONTINUOUS", 25),
    "reactions": (7, "CONTINUOUS", 25),
    "road": (8, "DASHED2", 18),
    "fill": (9, "CONTINUOUS", 13),
    "backing": (9, "DASHED2", 13),
    "dimensions": (7, "CONTINUOUS", 13),
    "text": (7, "CONTINUOUS", 18),
    "title": (7, "CONTINUOUS", 25),
}
"""Their colours by AutoCAD's index, line types, and widths of lines [mm / 100]."""
ARROW, LEAST, HEAD = 14.0, 4.0, 1.5
"""Lengths of the largest and the smallest arrow of a force, and of its head [mm]."""
TITLED = np.array([110.0, 8.0])
"""Width of a title block and height of its lines [mm]."""
DATES = re.compile(r"(\$TDU?(?:CREATE|UPDATE)\n *40\n)[^\n]*")
"""Dates of the header. ezdxf writes the year 2000 there, for files that are made again."""
METRES = 6
"""Number by which $INSUNITS means metres."""
LETTERS, HINGE = 2.5, 1.2
"""Height of letters and radius of the mark of a hinge, on paper [mm]."""
ROOM = np.array([0.75, 0.55])
"""Shares of a page of A4 that what is drawn takes."""
DASH = 0.4
"""Factor on the dashes of line types, whose own are in inches [mm]."""


def write_dxf(sheet: Sheet, file: BinaryIO) -> None:
    """Write a sheet as DXF in metres."""
    require_library("ezdxf", "DXF", "dxf")
    # It takes a second to import, which nothing else need wait for.
    import ezdxf

    library: Any = ezdxf
    before = library.options.write_fixed_meta_data_for_testing
    library.options.write_fixed_meta_data_for_testing = is_dated()
    try:
        document = library.new("R2010", setup=True)
        _draw(document, sheet)
        written = io.StringIO()
        document.write(written)
    finally:
        library.options.write_fixed_meta_data_for_testing = before
    text = written.getvalue()
    if is_dated():
        text = DATES.sub(rf"\g<1>{library.tools.juliandate(present())}", text)
    file.write(text.encode(document.output_encoding, "dxfreplace"))


def _draw(document: Any, sheet: Sheet) -> None:
    document.units = METRES
    document.header["$MEASUREMENT"] = 1
    for name, (colour, dashes, width) in LAYERS.items():
        document.layers.add(name, color=colour, linetype=dashes, lineweight=width)
    space: Any = document.modelspace()
    shown = _bodies(space, sheet)
    for line in sheet.lines:
        for path in line.paths:
            _polyline(space, path, f"thrust-{line.name}", close=False)
    span = np.ptp(shown, axis=0)
    paper = np.array([A4[0].width, A4[0].height])
    scale = scale_for(span, ROOM * paper)
    # Dashes are of paper.
    document.header["$LTSCALE"] = DASH * scale / 1e3
    _numbers(space, sheet, scale)
    _forces(space, sheet, scale)
    _road(space, sheet, shown)
    _states(space, sheet, scale)
    _gaps(space, sheet, scale)
    _dimensions(space, sheet, shown, scale)
    foot = _words(space, sheet, shown, scale)
    _title(space, sheet, float(shown[:, 0].max()), foot, scale)


def _bodies(space: Any, sheet: Sheet) -> Array:
    """Draw blocks, supports and joints, and return corners of all of them."""
    problem = sheet.problem
    corners = [
        _named(block.polygons, f"block {block.name or index}")
        for index, block in enumerate(problem.assembly.blocks)
    ]
    for each in corners:
        _polyline(space, each, "blocks", close=True)
    bodies = [
        _named(support.polygons, f"support {support.name or index}")
        for index, support in enumerate(problem.assembly.supports)
    ]
    known = len(bodies)
    bodies += [rim for parts in sheet.supports[known:] for rim in rims(parts)]
    for each in bodies:
        _polyline(space, each, "supports", close=True)
    for joint in problem.assembly.joints:
        if not joint.is_corner:
            space.add_line(joint.inner, joint.outer, dxfattribs={"layer": "joints"})
    return np.concatenate([*corners, *(part for parts in sheet.supports for part in parts)])


def _named(polygons: tuple[Array, ...], name: str) -> Array:
    found = rims(polygons)
    allowed = "without holes, and one body: polylines of DXF have one outline"
    require(len(found) == 1, name, f"{len(polygons)} polygons", allowed)
    return found[0]


def _polyline(space: Any, points: Array, layer: str, *, close: bool) -> None:
    space.add_lwpolyline(points.tolist(), close=close, dxfattribs={"layer": layer})


def _states(space: Any, sheet: Sheet, scale: float) -> None:
    """Draw joints that take part, and circles where they turn."""
    layer = {"layer": "mechanism"}
    states = sheet.joint_states or ()
    for joint, state in zip(sheet.problem.assembly.joints, states, strict=False):
        if state is JointState.CLOSED:
            continue
        ends = (joint.inner, joint.outer)
        if not joint.is_corner:
            space.add_line(*ends, dxfattribs=layer)
        if state.hinge is not None:
            space.add_circle(ends[state.hinge], HINGE * scale / 1e3, dxfattribs=layer)


def _gaps(space: Any, sheet: Sheet, scale: float) -> None:
    """Draw joints at which a gap or an overlap of the drawing is closed, with its size."""
    layer, mm = {"layer": "gaps"}, scale / 1e3
    for index, gap in marked_gaps(sheet.problem.assembly).items():
        joint = sheet.problem.assembly.joints[index]
        if not joint.is_corner:
            space.add_line(joint.inner, joint.outer, dxfattribs=layer)
        size = space.add_text(
            f"{1000 * gap:+.3g} mm", height=LETTERS * mm / 2, dxfattribs=layer
        )
        size.set_placement(tuple((joint.inner + joint.outer) / 2))


def _dimensions(space: Any, sheet: Sheet, shown: Array, scale: float) -> None:
    height = LETTERS * scale / 1e3
    sizes = {
        "dimtxt": height,
        "dimasz": height,
        "dimtsz": height / 2,
        "dimexo": height / 2,
        "dimexe": height / 2,
        "dimgap": height / 3,
        "dimdec": 3,
        "dimzin": 0,
        # ezdxf's own style tells metres in centimetres.
        "dimlfac": 1.0,
    }
    layer = {"layer": "dimensions"}
    for each in dimensions_of(sheet.problem, shown, scale):
        if isinstance(each, Length):
            note = f" ({each.note})" if each.note else ""
            beside = each.what == "thickness"
            # The rise has the middle of the span.
            aside = each.ends[0] + 0.25 * (each.ends[1] - each.ends[0]) + [0.0, height]
            turn = math.degrees(math.atan2(each.along[1], each.along[0]))
            made = space.add_linear_dim(
                base=tuple(each.at),
                p1=tuple(each.ends[0]),
                p2=tuple(each.ends[1]),
                # Words that stand on their heads are turned round.
                angle=turn - 180 if turn > 90 else turn,
                location=tuple(each.ends[1] + each.along * 20 * scale / 1e3)
                if beside
                else tuple(aside)
                if each.what == "span"
                else None,
                text=f"{each.what} <> m{note}",
                override=sizes,
                dxfattribs=layer,
            )
        else:
            made = space.add_angular_dim_3p(
                base=tuple(each.point(0.5)),
                center=tuple(each.centre),
                p1=tuple(each.point(1.0, each.reach)),
                p2=tuple(each.point(0.0, each.reach)),
                text="\N{GREEK SMALL LETTER ALPHA} = <>",
                override={**sizes, "dimadec": 2},
                dxfattribs=layer,
            )
        made.render()


def _words(space: Any, sheet: Sheet, shown: Array, scale: float) -> float:
    """Write title and facts below, and forces where they act. Return how far down."""
    from ezdxf.enums import TextEntityAlignment

    mm = scale / 1e3
    unit, layer = sheet.unit, {"layer": "text"}

    def write(words: str, at: Array, height: float = LETTERS, *, before: bool = False) -> None:
        text = space.add_text(_literal(words), height=height * mm, dxfattribs=layer)
        text.set_placement(tuple(at), align=TextEntityAlignment.RIGHT if before else None)

    for each in sheet.reactions:
        borne = in_world(sheet.problem, each.force)
        across, up = (unit.words(float(part)) for part in borne)
        # Left of an arrow that comes from the left or from below, right of another.
        side = -22.0 if each.force[0] >= 0 else 8.0
        below = np.array([each.point[0] + side * mm, float(shown[:, 1].min()) - 5 * mm])
        write(f"H = {across}", below)
        write(f"V = {up}", below - [0, 4 * mm])
    if sheet.thrust is not None:
        index, words = sheet.thrust
        joint = sheet.problem.assembly.joints[index]
        at = np.array([joint.outer[0] - mm, float(shown[:, 1].max()) + 2 * mm])
        write(words, at, before=True)
    at = np.array([float(shown[:, 0].min()), float(shown[:, 1].min()) - 22 * mm])
    write(sheet.title, at, 2 * LETTERS)
    said = [*sheet.facts, *(f"layer thrust-{line.name}: {line.words}" for line in sheet.lines)]
    for line in said:
        at = at - [0, 5 * mm]
        write(line, at)
    return float(at[1])


def _numbers(space: Any, sheet: Sheet, scale: float) -> None:
    """Write names of blocks on them, smaller where they have less room."""
    from ezdxf.enums import TextEntityAlignment

    for index, block in enumerate(sheet.problem.assembly.blocks):
        name = _literal(block.name or str(index))
        sides = np.ptp(block.vertices, axis=0)
        room = min(float(sides.min()) / 3, float(sides.max()) / len(name))
        height = min(LETTERS * scale / 1e3, room)
        text = space.add_text(name, height=height, dxfattribs={"layer": "numbers"})
        text.set_placement(tuple(block.centre), align=TextEntityAlignment.MIDDLE_CENTER)


def _forces(space: Any, sheet: Sheet, scale: float) -> None:
    """Draw loads and reactions as arrows that end where they act, those of a kind to scale."""
    arrows: dict[str, list[tuple[Array, Array]]] = {
        "reactions": [(each.point, each.force) for each in sheet.reactions]
    }
    for kind, point, force in acting_on(sheet.problem):
        arrows.setdefault(f"loads-{kind}", []).append((point, force))
    for layer, found in arrows.items():
        largest = max((float(np.hypot(*force)) for _, force in found), default=0.0)
        for tip, force in found:
            size = float(np.hypot(*force))
            if size <= FAINT * largest:
                continue
            way = force / size
            mm = scale / 1e3
            tail = tip - way * max(LEAST, ARROW * size / largest) * mm
            back, across = tip - way * HEAD * mm, np.array([-way[1], way[0]]) * HEAD / 3 * mm
            space.add_line(tuple(tail), tuple(back), dxfattribs={"layer": layer})
            head = [tuple(tip), tuple(back + across), tuple(back - across)]
            space.add_solid(head, dxfattribs={"layer": layer})


def _road(space: Any, sheet: Sheet, shown: Array) -> None:
    """Draw fill, and the level of the road with where x is 0 on it."""
    problem, level = sheet.problem, road_of(sheet.problem)
    if level is None and not problem.road:
        return
    for area, is_backing in fill_outlines(problem):
        _polyline(space, area, "backing" if is_backing else "fill", close=True)
    top = float(profile_of(problem.assembly).ends[..., 1].max()) if level is None else level
    low, high = float(shown[:, 0].min()), float(shown[:, 0].max())
    layer = {"layer": "road"}
    space.add_line((low, top), (high, top), dxfattribs=layer)
    space.add_point((0.0, top), dxfattribs=layer)
    height = (high - low) / 80
    text = space.add_text("x = 0", height=height, dxfattribs=layer)
    text.set_placement((0.0, top + height / 2))


def _title(space: Any, sheet: Sheet, right: float, foot: float, scale: float) -> None:
    """Draw a title block below the words, to the right, a line for each thing that it says."""
    said = [*sheet.titles.said, ("drawing", sheet.title), ("scale", scale_words(scale)),
            ("made by", f"blocksim {__version__}")]  # fmt: skip
    mm, layer = scale / 1e3, {"layer": "title"}
    wide, high = TITLED * mm
    top, left, split = foot - high, right - wide, right - 0.75 * wide
    for row, (name, value) in enumerate(said):
        level = top - row * high
        corners = [(left, level), (right, level), (right, level - high), (left, level - high)]
        space.add_lwpolyline(corners, close=True, dxfattribs=layer)
        for at, words in ((left, name), (split, value)):
            text = space.add_text(_literal(words)[:60], height=LETTERS * mm, dxfattribs=layer)
            text.set_placement((at + 2 * mm, level - 0.7 * high))
    space.add_line((split, top), (split, top - len(said) * high), dxfattribs=layer)


def _literal(words: str) -> str:
    """Return text of a stranger in which programs that draw find no codes of theirs."""
    # %% begins signs, ^ and a letter characters that control, a backslash any other.
    return printable(words).replace("%%", "% %").replace("^", "^ ").replace("\\", "/")
