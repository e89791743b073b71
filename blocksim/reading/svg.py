"""Drawings as SVG: shapes with closed outlines, paths, and clones of them.

The file is read from front to back into a list: nesting costs nothing, an entity is refused
where it is declared, and nothing is fetched.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple
from xml.parsers import expat

import numpy as np

from blocksim.blocks.outlines import step_of
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, read_file
from blocksim.reading.asked import UNITS, Reading, Unit
from blocksim.reading.curves import Corners
from blocksim.reading.drawing import LARGEST_DRAWING, MOST_SHAPES, Drawing, Shape, drawing_of
from blocksim.reading.svgtext import (
    NUMBER,
    Line,
    Matrix,
    lines_of,
    matrix_of,
    number_of,
    numbers_of,
    pairs_of,
    times,
)

DEEPEST, MOST_CLONED = 256, 200_000
"""Elements inside each other, and those that clones stand for in all."""
CLONES = 16
"""Clones of clones."""
LENGTHS = {"mm": UNITS["mm"], "cm": UNITS["cm"], "in": UNITS["in"]}
"""Lengths on paper, in metres; px, pt and per cent say nothing of what was drawn."""
CONTAINERS = {"g", "a", "switch"}
HIDDEN = {"defs", "symbol", "clipPath", "mask", "marker", "pattern", "metadata", "title",
          "desc", "style", "script", "foreignObject", "linearGradient", "radialGradient",
          "filter"}  # fmt: skip
"""Elements of which nothing is drawn where they stand; what is in them is passed over."""
WORDS = {"text", "tspan", "textPath", "tref", "view", "animate", "set"}
"""Elements that say something and bear nothing."""
SVG = "http://www.w3.org/2000/svg"
LABEL = "http://www.inkscape.org/namespaces/inkscape label"
LINK = "http://www.w3.org/1999/xlink href"
UPWARDS: Matrix = (1.0, 0.0, 0.0, -1.0, 0.0, 0.0)
"""y of SVG points down."""
_LENGTH = re.compile(rf"\s*({NUMBER.pattern})\s*([a-z%]*)\s*")


def read_svg(path: AnyPath, reading: Reading) -> Drawing:
    """Read the outlines and lines of a drawing.

    Layers are groups, or outlines themselves, with the name of the layer as id, class or
    Inkscape's label; the nearest one counts.

    `reading`: Its unit is by default what width and viewBox say in mm, cm or in.
    Returns: Blocks are named by their ids.
    """
    text = read_file(path, "drawing", "an existing .svg file", LARGEST_DRAWING)
    elements = _Elements()
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = elements.start
    parser.EndElementHandler = elements.end
    parser.EntityDeclHandler = _refuse_entity
    parser.AttlistDeclHandler = _refuse_attributes
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("file", str(error), "a valid SVG file") from None
    if not elements.found:
        raise InputError("file", "no svg element", "a valid SVG file")
    shapes = _Shapes(elements, reading.roles)
    unit = _unit_of(elements.found[0].given)
    return drawing_of(shapes.drawn(), Path(path), unit, reading)


def _refuse_entity(name: str, *_: object) -> None:
    raise InputError("entity", name, "left out: a drawing needs none")


def _refuse_attributes(element: str, name: str, *_: object) -> None:
    # Each element would be given all of them: a small file would cost minutes.
    raise InputError(f"ATTLIST {element}", name, "left out: a drawing needs none")


class _Element(NamedTuple):
    """An element: how deep it lies, its kind, and its attributes."""

    deep: int
    kind: str
    given: dict[str, str]


class _Elements:
    """The elements of a file in their order, and where those with an id are."""

    def __init__(self) -> None:
        self.found: list[_Element] = []
        self.by_id: dict[str, int] = {}
        self._deep = 0

    def start(self, tag: str, given: dict[str, str]) -> None:
        """Begin an element."""
        space, _, kind = tag.rpartition(" ")
        if not self.found and tag not in {"svg", f"{SVG} svg"}:
            raise InputError("file", f"a {kind} element", "a valid SVG file")
        if self._deep >= DEEPEST:
            raise InputError("elements", "nested more deeply", f"at most {DEEPEST} deep")
        few = len(self.found) < MOST_SHAPES
        require(few, "drawing", "more elements", f"at most {MOST_SHAPES}")
        if "id" in given:
            self.by_id.setdefault(given["id"], len(self.found))
        # What is of other programs draws nothing.
        kind = kind if space in {"", SVG} else "metadata"
        self.found.append(_Element(self._deep, kind, given))
        self._deep += 1

    def end(self, _: str) -> None:
        """End an element."""
        self._deep -= 1

    def within(self, at: int) -> int:
        """Return the place after an element and all that is in it."""
        end = at + 1
        while end < len(self.found) and self.found[end].deep > self.found[at].deep:
            end += 1
        return end


@dataclass
class _Shapes:
    """Follows elements, and clones to what they stand for, with transforms and layers."""

    elements: _Elements
    roles: dict[str, str]
    names: set[str] = field(default_factory=set[str])
    cloned: int = 0

    def drawn(self) -> Iterator[Shape]:
        """Give everything that is drawn."""
        yield from self._from(1, len(self.elements.found), UPWARDS, "")

    def _from(
        self,
        at: int,
        end: int,
        matrix: Matrix,
        layer: str,
        clones: int = 0,
        base: int = 0,
        of: str = "",
    ) -> Iterator[Shape]:
        """Give what is drawn from one element up to another."""
        inside = [(base, matrix, layer)]
        while at < end:
            deep, kind, given = self.elements.found[at]
            while inside[-1][0] >= deep:
                inside.pop()
            _, outer, above = inside[-1]
            own = _layer_of(given, above, self.roles)
            if kind in HIDDEN or kind == "svg":
                if kind == "svg":
                    # A drawing in a drawing has a view of its own.
                    wrong = "has a view of its own"
                    yield Shape(what="nested svg", layer=own, wrong=wrong)
                at = self.elements.within(at)
                continue
            styled = "transform" in given.get("style", "")
            require(not styled, f"{kind} style", "a transform", "left out: use the attribute")
            moved = times(outer, matrix_of(given.get("transform", "")))
            if kind in CONTAINERS:
                inside.append((deep, moved, own))
            elif kind == "use" and own.casefold() in self.roles:
                yield from self._clone(given, moved, own, clones)
            else:
                yield self._shape(kind, given, moved, own, of)
                # Words may have parts.
                at = self.elements.within(at) - 1
            at += 1

    def _clone(
        self, given: dict[str, str], matrix: Matrix, layer: str, clones: int
    ) -> Iterator[Shape]:
        """Give what a clone stands for, on the clone's layer if it has none of its own."""
        link = given.get("href", given.get(LINK, ""))
        at = self.elements.by_id.get(link.removeprefix("#"))
        name = f"use {given.get('id', '')}".strip()
        require(at is not None, name, link, "# and the id of an element of the drawing")
        at = at or 0
        end = self.elements.within(at)
        self.cloned += end - at
        ok = clones < CLONES and self.cloned <= MOST_CLONED
        require(
            ok, name, "more clones", f"at most {CLONES} deep, and of {MOST_CLONED} elements"
        )
        x, y = (number_of(given.get(key, "0"), key) for key in ("x", "y"))
        moved = times(matrix, (1.0, 0.0, 0.0, 1.0, x, y))
        element = self.elements.found[at]
        if element.kind == "symbol":
            sized = bool({"viewBox", "width", "height"} & {*element.given, *given})
            require(not sized, name, link, "a symbol without a view of its own, or a group")
            at, base = at + 1, element.deep
        else:
            base = element.deep - 1
        yield from self._from(at, end, moved, layer, clones + 1, base, given.get("id", link))

    def _shape(
        self, kind: str, given: dict[str, str], matrix: Matrix, layer: str, of: str
    ) -> Shape:
        role = self.roles.get(layer.casefold())
        shape = Shape(what=kind, layer=layer, words=kind in WORDS)
        if role in {None, "ignored"} or shape.words:
            # Frames and the like may be anything: "100%" wide, and curved.
            return shape
        # Clones have names of their own.
        name = of or given.get("id", "")
        if not name or name in self.names:
            name = f"{of or kind} {len(self.names) + 1}"
        self.names.add(name)
        a, b, c, d, e, f = matrix

        def placed(points: Corners) -> Corners:
            return [(a * x + c * y + e, b * x + d * y + f) for x, y in points]

        lines = _lines(kind, given)
        if isinstance(lines, str):
            return replace(shape, name=name, wrong=lines, corners=placed(_place(given)))
        line = lines[0] if lines else Line()
        corners = placed(line.corners)
        closed = line.closed or (len(line.corners) > 3 and line.corners[0] == line.corners[-1])
        wrong = line.wrong
        if len(lines) > 1:
            wrong = f"is {len(lines)} lines"
        elif len(corners) < 2:
            wrong = "has no corners"
        far = math.hypot(a, b, c, d) / math.sqrt(2)
        return replace(
            shape,
            what=kind if closed else f"open {kind}",
            name=name,
            corners=corners + corners[:1] * (line.closed and corners[:1] != corners[-1:]),
            closed=closed,
            wrong=wrong,
            step=step_of(np.array(line.ends).ravel()) * far,
            stray=line.stray * math.hypot(a, b, c, d),
        )


def _place(given: dict[str, str]) -> Corners:
    """Return where something is that is no line, as far as that is easily known."""
    for keys in (("cx", "cy"), ("x", "y")):
        said = [given.get(key, "") for key in keys]
        if all(NUMBER.fullmatch(each) for each in said):
            return [(float(said[0]), float(said[1]))]
    return []


def _layer_of(given: dict[str, str], above: str, roles: dict[str, str]) -> str:
    """Return the layer an element names, or else that of the one around it."""
    label, name = given.get(LABEL, ""), given.get("id", "")
    for each in (label, name, given.get("class", ""), *given.get("class", "").split()):
        if each.strip().casefold() in roles:
            return each.strip()
    return above if above.casefold() in roles else label or above


def _lines(kind: str, given: dict[str, str]) -> list[Line] | str:
    """Return the lines of an element, or what is wrong with it."""
    if kind in {"polygon", "polyline"}:
        points = pairs_of(given.get("points", ""), "points")
        return [Line(points, points, closed=kind == "polygon")]
    if kind == "line":
        x, y, to_x, to_y = (number_of(given.get(k, "0"), k) for k in ("x1", "y1", "x2", "y2"))
        return [Line([(x, y), (to_x, to_y)], [(x, y), (to_x, to_y)])]
    if kind == "rect":
        x, y, wide, high = (
            number_of(given.get(key, "0"), key) for key in ("x", "y", "width", "height")
        )
        if any(given.get(key, "0") not in {"0", "auto"} for key in ("rx", "ry")):
            return "has rounded corners"
        right, low = x + wide, y + high
        points = [(x, y), (right, y), (right, low), (x, low)]
        return [Line(points, points, closed=True)]
    if kind == "path":
        return lines_of(given.get("d", ""))
    return "is no outline or line"


def _unit_of(given: dict[str, str]) -> Unit | None:
    """Return what width, height and viewBox of a drawing say of its unit."""
    width, height = given.get("width", ""), given.get("height", "")
    box = numbers_of(given.get("viewBox", ""), "viewBox")
    found = [_LENGTH.fullmatch(each) for each in (width, height)]
    if len(box) != 4 or box[2] <= 0 or box[3] <= 0:
        return None
    sizes = [
        float(each[1]) * LENGTHS[each[2]] / extent
        for each, extent in zip(found, box[2:], strict=True)
        if each and each[2] in LENGTHS
    ]
    if not sizes:
        return None
    # Where the shapes of page and box differ, the box is fitted into the page.
    metres = min(sizes)
    return Unit(metres=metres, said=f"a unit of the viewBox is {metres:g} m, by the width")
