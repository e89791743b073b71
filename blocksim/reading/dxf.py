"""Drawings as DXF; the one place that reads with ezdxf."""

from __future__ import annotations

import logging
import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from blocksim.blocks.outlines import step_of
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, require_file
from blocksim.common.later import require_library
from blocksim.reading.asked import UNITS, Reading, Unit
from blocksim.reading.curves import Corners, arc
from blocksim.reading.drawing import LARGEST_DRAWING, Drawing, Shape, drawing_of

INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 14: "dm"}
"""Codes of the header's $INSUNITS; 0 is no unit."""
POLYLINES = ("LWPOLYLINE", "POLYLINE")
SMOOTH = 2 | 4
"""Flags of a POLYLINE through which, or beside which, a curve is drawn."""
WORDS = {"TEXT", "MTEXT", "ATTDEF", "ATTRIB", "DIMENSION", "LEADER", "MLEADER", "MULTILEADER",
         "TOLERANCE", "POINT"}  # fmt: skip
"""Entities that say something and bear nothing."""
DEEPEST, MOST_INSERTED = 16, 200_000
"""Block references inside each other, and entities that they stand for in all."""
QUIET = logging.NullHandler()
FLAT = 1e-9
"""How far from the plane a polyline may be, in units of its largest coordinate."""


def read_dxf(path: AnyPath, reading: Reading) -> Drawing:
    """Read outlines, lines and arcs of the model space, and of the blocks inserted there.

    `reading`: Its unit is what $INSUNITS says by default.
    Returns: Blocks are named by their handles.
    """
    require_file(path, "drawing", "an existing .dxf file", LARGEST_DRAWING)
    require_library("ezdxf", "DXF", "dxf")
    # It takes a second to import, which nothing else need wait for.
    import ezdxf

    # What it logs of flaws it mends would be printed where nobody set up logging.
    logging.getLogger("ezdxf").addHandler(QUIET)
    try:
        document: Any = cast(Any, ezdxf).readfile(os.fspath(path))
        shapes = [_shape(*each) for each in _entities(document.modelspace())]
        code = int(document.header.get("$INSUNITS", 0))
    except InputError:
        raise
    except Exception as error:  # a damaged file makes ezdxf raise almost anything
        said = " ".join(str(error).split()) or type(error).__name__
        raise InputError("file", said, "a valid DXF file") from None
    unit = None if reading.unit is not None else _unit(code)
    return drawing_of(shapes, Path(path), unit, reading)


def _unit(code: int) -> Unit | None:
    if code == 0:
        return None
    name = INSUNITS.get(code)
    if name is None:
        known = ", ".join(f"{key} ({each})" for key, each in INSUNITS.items())
        raise InputError("$INSUNITS", code, f"0 (none), {known}; or --unit beside it")
    return Unit(metres=UNITS[name], said=f"unit {name}, by the drawing's $INSUNITS")


def _entities(space: Iterable[Any]) -> Iterator[tuple[Any, str, str]]:
    """Entities with their layers and names, those of block references where they are seen."""
    inserted = 0
    within = [iter([(each, str(each.dxf.layer), str(each.dxf.handle)) for each in space])]
    while within:
        entity, layer, name = next(within[-1], (None, "", ""))
        if entity is None:
            within.pop()
        elif entity.dxftype() != "INSERT":
            yield entity, layer, name
        else:
            at = f"INSERT {name.partition('.')[0]} on layer {layer}"
            deep = len(within) <= DEEPEST
            require(deep, at, f"more than {DEEPEST} deep", "block references without a loop")
            block = entity.block()
            require(
                block is not None, at, entity.dxf.name, "the name of a block in the drawing"
            )
            # Counted before they are made: rows and columns may stand for a billion.
            inserted += max(1, entity.mcount) * max(1, len(block))
            few = inserted <= MOST_INSERTED
            require(few, at, "more entities", f"at most {MOST_INSERTED} by references")
            parts: list[tuple[Any, str, str]] = []
            for one in entity.multi_insert() if entity.mcount > 1 else (entity,):
                for part in one.virtual_entities():
                    own = str(part.dxf.layer)
                    # What is drawn on layer 0 of a block lies on that of its reference.
                    parts.append((part, layer if own == "0" else own, f"{name}.{len(parts)}"))
            within.append(iter(parts))


def _shape(entity: Any, layer: str, name: str) -> Shape:
    kind = entity.dxftype()
    shape = Shape(what=kind, layer=layer, name=name, words=kind in WORDS)
    if shape.words:
        return shape
    if kind == "LINE":
        return _line(shape, [entity.dxf.start, entity.dxf.end], [0.0, 0.0], closed=False)
    if kind == "ARC":
        turn = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360)
        # Turned over, it is seen to turn the other way.
        over = math.copysign(1.0, entity.dxf.extrusion.z)
        points = list(entity.vertices([entity.dxf.start_angle, entity.dxf.end_angle]))
        return _line(shape, points, [over * math.tan(turn / 4), 0.0], closed=False)
    # A POLYLINE may be a mesh.
    if kind == "LWPOLYLINE" or (
        kind == "POLYLINE" and (entity.is_2d_polyline or entity.is_3d_polyline)
    ):
        if kind == "POLYLINE" and entity.dxf.flags & SMOOTH:
            return replace(shape, wrong="is a smooth curve")
        return _line(shape, *_points(entity), closed=bool(entity.is_closed))
    return replace(shape, wrong="is no line, arc or polyline", corners=_place(entity))


def _line(shape: Shape, points: list[Any], bulges: list[float], *, closed: bool) -> Shape:
    """Return a line of straight parts and arcs."""
    heights = [p.z for p in points]
    largest = max((abs(each) for p in points for each in (p.x, p.y, p.z)), default=0.0)
    if points and max(heights) - min(heights) > FLAT * largest:
        return replace(shape, wrong="is not in the xy plane", corners=_flat(points))
    ends = _flat(points)
    # Closed by its flag, or by its first point given again.
    closed = closed or (len(ends) > 3 and ends[0] == ends[-1])
    what = shape.what if closed or shape.what not in POLYLINES else f"open {shape.what}"
    around = ends + ends[:1] * (closed and ends[:1] != ends[-1:])
    if not all(math.isfinite(each) for point in around for each in point):
        return replace(shape, corners=around, closed=closed)
    corners, stray, wrong = around[:1], 0.0, None
    for (x, y), (to_x, to_y), bulge in zip(around, around[1:], bulges, strict=False):
        found = arc(complex(x, y), complex(to_x, to_y), bulge)
        corners += [*found.corners, (to_x, to_y)]
        stray, wrong = max(stray, found.stray), wrong or found.wrong
    if len(corners) < 2:
        return replace(shape, wrong="is a point", corners=corners)
    return replace(
        shape,
        what=what,
        corners=corners,
        closed=closed,
        wrong=wrong,
        step=step_of(np.array(ends).ravel()),
        stray=stray,
    )


def _flat(points: Iterable[Any]) -> Corners:
    return [(float(p.x), float(p.y)) for p in points]


def _place(entity: Any) -> Corners:
    """Return where something is that is no line, as far as that is easily known."""
    for name in ("center", "insert", "location", "start"):
        if entity.dxf.hasattr(name):
            return _flat([entity.ocs().to_wcs(entity.dxf.get(name))])
    return []


def _points(entity: Any) -> tuple[list[Any], list[float]]:
    """Corners of a polyline in world coordinates, and the bulge of the part after each."""
    if entity.dxftype() == "LWPOLYLINE":
        points = list(entity.vertices_in_wcs())
        bulges = [float(each[4]) for each in entity]
    else:
        points = list(entity.points_in_wcs())
        bulges = [float(each.dxf.get("bulge", 0.0)) for each in entity.vertices]
    over = math.copysign(1.0, entity.dxf.extrusion.z)
    return points, [over * each for each in bulges]
