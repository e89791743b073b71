"""A sheet as DXF: bodies, joints, lines of thrust and true dimensions, each on its layer.

What is on the layers `blocks` and `supports` is read as a structure again.
"""

from __future__ import annotations

import io
import math
import re
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.closing import marked_gaps
from blocksim.blocks.joints import JointState
from blocksim.blocks.road import road_of
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
from blocksim.view.structure import fill_outlines, road_level

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
    blocks, supports = _bodies(sheet)
    shown = np.concatenate([*blocks, *(part for parts in sheet.supports for part in parts)])
    scale = scale_for(np.ptp(shown, axis=0), ROOM * [A4[0].width, A4[0].height])
    # Dashes are of paper.
    document.header["$LTSCALE"] = DASH * scale / 1e3
    drawing = _Drawing(document.modelspace(), scale / 1e3)
    for layer, rings in (("blocks", blocks), ("supports", supports)):
        for each in rings:
            drawing.polyline(each, layer)
    for joint in sheet.problem.assembly.joints:
        if not joint.is_corner:
            drawing.line(joint.inner, joint.outer, "joints")
    for line in sheet.lines:
        for path in line.paths:
            drawing.polyline(path, f"thrust-{line.name}", close=False)
    _numbers(drawing, sheet)
    _forces(drawing, sheet)
    _road(drawing, sheet, shown)
    _states(drawing, sheet)
    _gaps(drawing, sheet)
    _dimensions(drawing, sheet, shown)
    foot = _words(drawing, sheet, shown)
    _title(drawing, sheet, float(shown[:, 0].max()), foot)


class _Drawing(NamedTuple):
    """The space in which all is drawn, in metres, and a millimetre on paper [m]."""

    space: Any
    mm: float

    def line(self, start: Any, end: Any, layer: str) -> None:
        """Draw a line."""
        self.space.add_line(tuple(start), tuple(end), dxfattribs={"layer": layer})

    def polyline(self, points: Array, layer: str, *, close: bool = True) -> None:
        """Draw a polygon, or an open line."""
        self.space.add_lwpolyline(points.tolist(), close=close, dxfattribs={"layer": layer})

    def text(self, words: str, at: Any, layer: str, height: float, align: str = "LEFT") -> None:
        """Write words of a height [m], by the name of an alignment."""
        from ezdxf.enums import TextEntityAlignment

        text = self.space.add_text(_literal(words), height=height, dxfattribs={"layer": layer})
        text.set_placement(tuple(at), align=TextEntityAlignment[align])


def _bodies(sheet: Sheet) -> tuple[list[Array], list[Array]]:
    """Return outlines of blocks, and of supports."""
    assembly = sheet.problem.assembly
    blocks, supports = (
        [_outline(body.polygons, f"{kind} {body.name or at}") for at, body in enumerate(bodies)]
        for kind, bodies in (("block", assembly.blocks), ("support", assembly.supports))
    )
    unknown = sheet.supports[len(supports) :]
    return blocks, supports + [rim for parts in unknown for rim in rims(parts)]


def _outline(polygons: tuple[Array, ...], name: str) -> Array:
    found = rims(polygons)
    allowed = "without holes, and one body: polylines of DXF have one outline"
    require(len(found) == 1, name, f"{len(polygons)} polygons", allowed)
    return found[0]


def _states(drawing: _Drawing, sheet: Sheet) -> None:
    """Draw joints that take part, and circles where they turn."""
    layer, states = "mechanism", sheet.joint_states or ()
    for joint, state in zip(sheet.problem.assembly.joints, states, strict=False):
        if state is JointState.CLOSED:
            continue
        ends = (joint.inner, joint.outer)
        if not joint.is_corner:
            drawing.line(*ends, layer)
        if state.hinge is not None:
            attributes = {"layer": layer}
            drawing.space.add_circle(ends[state.hinge], HINGE * drawing.mm, attributes)


def _gaps(drawing: _Drawing, sheet: Sheet) -> None:
    """Draw joints at which a gap or an overlap of the drawing is closed, with its size."""
    for index, gap in marked_gaps(sheet.problem.assembly).items():
        joint = sheet.problem.assembly.joints[index]
        if not joint.is_corner:
            drawing.line(joint.inner, joint.outer, "gaps")
        middle = (joint.inner + joint.outer) / 2
        drawing.text(f"{1000 * gap:+.3g} mm", middle, "gaps", LETTERS * drawing.mm / 2)


def _dimensions(drawing: _Drawing, sheet: Sheet, shown: Array) -> None:
    height = LETTERS * drawing.mm
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
    for each in dimensions_of(sheet.problem, shown, 1e3 * drawing.mm):
        if isinstance(each, Length):
            # The rise has the middle of the span.
            aside = each.ends[0] + 0.25 * (each.ends[1] - each.ends[0]) + [0.0, height]
            places = {"thickness": each.ends[1] + each.along * 20 * drawing.mm, "span": aside}
            place = places.get(each.what)
            turn = math.degrees(math.atan2(each.along[1], each.along[0]))
            made = drawing.space.add_linear_dim(
                base=tuple(each.at),
                p1=tuple(each.ends[0]),
                p2=tuple(each.ends[1]),
                # Words that stand on their heads are turned round.
                angle=turn - 180 if turn > 90 else turn,
                location=None if place is None else tuple(place),
                text=f"{each.what} <> m" + (f" ({each.note})" if each.note else ""),
                override=sizes,
                dxfattribs=layer,
            )
        else:
            made = drawing.space.add_angular_dim_3p(
                base=tuple(each.point(0.5)),
                center=tuple(each.centre),
                p1=tuple(each.point(1.0, each.reach)),
                p2=tuple(each.point(0.0, each.reach)),
                text="\N{GREEK SMALL LETTER ALPHA} = <>",
                override={**sizes, "dimadec": 2},
                dxfattribs=layer,
            )
        made.render()


def _words(drawing: _Drawing, sheet: Sheet, shown: Array) -> float:
    """Write title and facts below, and forces where they act. Return how far down."""
    mm, letters, layer = drawing.mm, LETTERS * drawing.mm, "text"
    left, low = shown.min(axis=0).tolist()
    for each in sheet.reactions:
        across, up = map(sheet.unit.words, in_world(sheet.problem, each.force).tolist())
        # Left of an arrow that comes from the left or from below, right of another.
        side = -22.0 if each.force[0] >= 0 else 8.0
        for line, said in ((5, f"H = {across}"), (9, f"V = {up}")):
            at = each.point[0] + side * mm, low - line * mm
            drawing.text(said, at, layer, letters)
    if sheet.thrust is not None:
        index, words = sheet.thrust
        outer = sheet.problem.assembly.joints[index].outer[0]
        at = outer - mm, float(shown[:, 1].max()) + 2 * mm
        drawing.text(words, at, layer, letters, "RIGHT")
    foot = low - 22 * mm
    drawing.text(sheet.title, (left, foot), layer, 2 * letters)
    said = [*sheet.facts, *(f"layer thrust-{line.name}: {line.words}" for line in sheet.lines)]
    for line in said:
        foot -= 5 * mm
        drawing.text(line, (left, foot), layer, letters)
    return foot


def _numbers(drawing: _Drawing, sheet: Sheet) -> None:
    """Write names of blocks on them, smaller where they have less room."""
    for index, block in enumerate(sheet.problem.assembly.blocks):
        name = block.name or str(index)
        sides = np.ptp(block.vertices, axis=0)
        room = min(float(sides.min()) / 3, float(sides.max()) / len(name))
        height = min(LETTERS * drawing.mm, room)
        drawing.text(name, block.centre, "numbers", height, "MIDDLE_CENTER")


def _forces(drawing: _Drawing, sheet: Sheet) -> None:
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
            way = force / size * drawing.mm
            tail, back = tip - way * max(LEAST, ARROW * size / largest), tip - way * HEAD
            across = np.array([-way[1], way[0]]) * HEAD / 3
            drawing.line(tail, back, layer)
            head = [tuple(tip), tuple(back + across), tuple(back - across)]
            drawing.space.add_solid(head, dxfattribs={"layer": layer})


def _road(drawing: _Drawing, sheet: Sheet, shown: Array) -> None:
    """Draw fill, and the level of the road with where x is 0 on it."""
    problem, layer = sheet.problem, "road"
    if road_of(problem) is None and not problem.road:
        return
    for area, is_backing in fill_outlines(problem):
        drawing.polyline(area, "backing" if is_backing else "fill")
    top, (low, high) = road_level(problem), (shown[:, 0].min(), shown[:, 0].max())
    drawing.line((low, top), (high, top), layer)
    drawing.space.add_point((0.0, top), dxfattribs={"layer": layer})
    height = float(high - low) / 80
    drawing.text("x = 0", (0.0, top + height / 2), layer, height)


def _title(drawing: _Drawing, sheet: Sheet, right: float, foot: float) -> None:
    """Draw a title block below the words, to the right, a line for each thing that it says."""
    mm, layer = drawing.mm, "title"
    said = [*sheet.titles.said, ("drawing", sheet.title), ("scale", scale_words(1e3 * mm)),
            ("made by", f"blocksim {__version__}")]  # fmt: skip
    wide, high = TITLED * mm
    top, left, split = foot - high, right - wide, right - 0.75 * wide
    for row, (name, value) in enumerate(said):
        level = top - row * high
        corners = [(left, level), (right, level), (right, level - high), (left, level - high)]
        drawing.polyline(np.array(corners), layer)
        for at, words in ((left, name), (split, value)):
            place = at + 2 * mm, level - 0.7 * high
            drawing.text(words[:60], place, layer, LETTERS * mm)
    drawing.line((split, top), (split, top - len(said) * high), layer)


def _literal(words: str) -> str:
    """Return text of a stranger in which programs that draw find no codes of theirs."""
    # %% begins signs, ^ and a letter characters that control, a backslash any other.
    return printable(words).replace("%%", "% %").replace("^", "^ ").replace("\\", "/")
