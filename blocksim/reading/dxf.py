"""Drawings as DXF; the one place that reads with ezdxf."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, cast

from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, require_file
from blocksim.common.later import require_library
from blocksim.reading.drawing import (
    LARGEST_DRAWING,
    NO_UNIT,
    UNITS,
    Shape,
    Unit,
    given_unit,
    structure_from,
)

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


def read_dxf(path: AnyPath, unit: float | None = None) -> dict[str, Any]:
    """Read the closed polylines of the model space, and of the blocks inserted there.

    Parameters
    ----------
    path : str or path
    unit : float, optional
        Metres that a unit of the drawing is; by default what $INSUNITS says.

    Returns
    -------
    dict
        As of a structure file, without friction. Blocks are named by their handles.

    Raises
    ------
    InputError
        In one line, if the file is too large, no DXF, or has no outlines to read.
    MissingPart
        If ezdxf is not installed.
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
    return structure_from(shapes, Path(path), _unit(code) if unit is None else given_unit(unit))


def _unit(code: int) -> Unit:
    if code == 0:
        return NO_UNIT
    name = INSUNITS.get(code)
    if name is None:
        known = ", ".join(f"{key} ({each})" for key, each in INSUNITS.items())
        raise InputError("$INSUNITS", code, f"0 (none), {known}; or convert it with --unit")
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
    if kind in WORDS:
        return Shape(what=kind, layer=layer, words=True)
    if kind not in POLYLINES or not (kind == "LWPOLYLINE" or _is_line(entity)):
        return Shape(what=kind, layer=layer, name=name, wrong="is no closed polyline")
    points = [(p.x, p.y, p.z) for p in _points(entity)]
    # Closed by its flag, or by its first point given again.
    closed = bool(entity.is_closed) or (len(points) > 3 and points[0] == points[-1])
    if not closed:
        return Shape(what=f"open {kind}", layer=layer, name=name, wrong="is not closed")
    wrong = "has arcs" if entity.has_arc else None
    if kind == "POLYLINE" and entity.dxf.flags & SMOOTH:
        wrong = "is a smooth curve"
    heights = [z for _, _, z in points]
    largest = max((abs(each) for point in points for each in point), default=0.0)
    if points and max(heights) - min(heights) > FLAT * largest:
        wrong = "is not in the xy plane"
    corners = [(x, y) for x, y, _ in points]
    return Shape(what=kind, layer=layer, name=name, corners=corners, wrong=wrong)


def _is_line(entity: Any) -> bool:
    """Whether a POLYLINE is a line, and no mesh."""
    return bool(entity.is_2d_polyline or entity.is_3d_polyline)


def _points(entity: Any) -> list[Any]:
    """Corners of a polyline in world coordinates."""
    if entity.dxftype() == "LWPOLYLINE":
        return list(entity.vertices_in_wcs())
    return list(entity.points_in_wcs())
