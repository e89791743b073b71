"""Drawings as SVG: polygons, rectangles and closed paths of straight segments.

The file is read from front to back, without a tree: nesting costs nothing, an entity is
refused where it is declared, and nothing is fetched.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np

from blocksim.blocks.outlines import step_of
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, read_file
from blocksim.reading.drawing import (
    LARGEST_DRAWING,
    LAYERS,
    NO_UNIT,
    UNITS,
    Corners,
    Shape,
    Unit,
    given_unit,
    structure_from,
)

DEEPEST = 256
"""Elements inside each other."""
LENGTHS = {"mm": UNITS["mm"], "cm": UNITS["cm"], "in": UNITS["in"]}
"""Lengths on paper, in metres; px, pt and per cent say nothing of what was drawn."""
CONTAINERS = {"svg", "g", "a", "switch"}
HIDDEN = {"defs", "symbol", "clipPath", "mask", "marker", "pattern", "metadata", "title",
          "desc", "style", "script", "foreignObject", "linearGradient", "radialGradient",
          "filter"}  # fmt: skip
"""Elements of which nothing is drawn where they stand; what is in them is passed over."""
WORDS = {"text", "tspan", "textPath", "tref", "view", "animate", "set"}
"""Elements that say something and bear nothing."""
WRONG = {"use": "is a clone: unlink it (Inkscape: Edit, Clone, Unlink Clone)"}
SVG = "http://www.w3.org/2000/svg"
LABEL = "http://www.inkscape.org/namespaces/inkscape label"

Matrix = tuple[float, float, float, float, float, float]
"""a, b, c, d, e, f of SVG: x' = a x + c y + e, y' = b x + d y + f."""
UPWARDS: Matrix = (1.0, 0.0, 0.0, -1.0, 0.0, 0.0)
"""y of SVG points down."""
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_SPACE = re.compile(r"[\s,]*")
_CALL = re.compile(r"[\s,]*([a-zA-Z]+)\s*\(([^()]*)\)")
_LENGTH = re.compile(rf"\s*({_NUMBER.pattern})\s*([a-z%]*)\s*")


def read_svg(path: AnyPath, unit: float | None = None) -> dict[str, Any]:
    """Read the closed outlines of a drawing.

    Layers are groups, or outlines themselves, with `blocks` or `supports` as id, class or
    Inkscape's label; the nearest one counts.

    Parameters
    ----------
    path : str or path
    unit : float, optional
        Metres that a unit of the viewBox is; by default what width and viewBox say in mm,
        cm or in.

    Returns
    -------
    dict
        As of a structure file, without friction. Blocks are named by their ids.

    Raises
    ------
    InputError
        In one line, if the file is too large, no SVG, declares entities, or has no
        outlines to read.
    """
    text = read_file(path, "drawing", "an existing .svg file", LARGEST_DRAWING)
    reader = _Reader()
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.EntityDeclHandler = _refuse_entity
    parser.AttlistDeclHandler = _refuse_attributes
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("file", str(error), "a valid SVG file") from None
    if reader.unit is None:
        raise InputError("file", "no svg element", "a valid SVG file")
    return structure_from(
        reader.shapes, Path(path), reader.unit if unit is None else given_unit(unit)
    )


def _refuse_entity(name: str, *_: object) -> None:
    raise InputError("entity", name, "left out: a drawing needs none")


def _refuse_attributes(element: str, name: str, *_: object) -> None:
    # Each element would be given all of them: a small file would cost minutes.
    raise InputError(f"ATTLIST {element}", name, "left out: a drawing needs none")


class _Reader:
    """Follows the elements of a drawing with their transforms and layers."""

    def __init__(self) -> None:
        self.shapes: list[Shape] = []
        self.unit: Unit | None = None
        self._inside: list[tuple[Matrix, str]] = []
        self._hidden = 0
        self._names: set[str] = set()

    def start(self, tag: str, given: dict[str, str]) -> None:
        """Begin an element."""
        if len(self._inside) + self._hidden >= DEEPEST:
            raise InputError("elements", "nested more deeply", f"at most {DEEPEST} deep")
        space, _, kind = tag.rpartition(" ")
        if self.unit is None:
            if tag not in {"svg", f"{SVG} svg"}:
                raise InputError("file", f"a {kind} element", "a valid SVG file")
            self.unit = _unit_of(given)
            self._inside.append((UPWARDS, ""))
            return
        outer, above = self._inside[-1]
        layer = _layer_of(given, above)
        # A drawing in a drawing has a view of its own.
        inner = kind in HIDDEN or kind == "svg" or space not in {"", SVG}
        if self._hidden or inner:
            if kind == "svg" and not self._hidden:
                wrong = "has a view of its own"
                self.shapes.append(Shape(what="nested svg", layer=layer, wrong=wrong))
            self._hidden += 1
            return
        styled = "transform" in given.get("style", "")
        require(not styled, f"{kind} style", "a transform", "left out: use the attribute")
        matrix = _times(outer, _matrix(given.get("transform", "")))
        self._inside.append((matrix, layer))
        if kind not in CONTAINERS:
            self.shapes.append(self._shape(kind, given, matrix, layer))

    def end(self, _: str) -> None:
        """End an element."""
        if self._hidden:
            self._hidden -= 1
        else:
            self._inside.pop()

    def _shape(self, kind: str, given: dict[str, str], matrix: Matrix, layer: str) -> Shape:
        if layer.lower() not in LAYERS or kind in WORDS:
            # Frames and the like may be anything: "100%" wide, and curved.
            return Shape(what=kind, layer=layer, words=kind in WORDS)
        name = given.get("id", "")
        if not name or name in self._names:
            name = f"{kind} {len(self.shapes) + 1}"
        self._names.add(name)
        corners, wrong, what = _outline(kind, given)
        step = None
        if corners is not None:
            a, b, c, d, e, f = matrix
            step = step_of(np.array(corners).ravel()) * math.hypot(a, b, c, d) / math.sqrt(2)
            corners = [(a * x + c * y + e, b * x + d * y + f) for x, y in corners]
        return Shape(what=what, layer=layer, name=name, corners=corners, wrong=wrong, step=step)


def _layer_of(given: dict[str, str], above: str) -> str:
    """Return the layer an element names, or else that of the one around it."""
    label, name = given.get(LABEL, ""), given.get("id", "")
    for each in (label, name, *given.get("class", "").split()):
        if each.strip().lower() in LAYERS:
            return each.strip()
    return above if above.lower() in LAYERS else label or above


def _outline(kind: str, given: dict[str, str]) -> tuple[Corners | None, str | None, str]:
    """Return the corners of an element, what is wrong with it, and what it is."""
    if kind == "polygon":
        return _pairs(given.get("points", ""), "points"), None, kind
    if kind == "polyline":
        corners = _pairs(given.get("points", ""), "points")
        closed = len(corners) > 3 and corners[0] == corners[-1]
        return (corners, None, kind) if closed else (None, "is not closed", "open polyline")
    if kind == "rect":
        x, y, wide, high = (
            _number(given.get(key, "0"), key) for key in ("x", "y", "width", "height")
        )
        rounded = any(given.get(key, "0") not in {"0", "auto"} for key in ("rx", "ry"))
        wrong = "has rounded corners" if rounded else None
        right, low = x + wide, y + high
        return [(x, y), (right, y), (right, low), (x, low)], wrong, kind
    if kind == "path":
        return _path(given.get("d", ""))
    return None, WRONG.get(kind, "is no outline of straight sides"), kind


def _path(text: str) -> tuple[Corners | None, str | None, str]:
    """Return the corners of a path, if it is one closed line of straight segments."""
    corners: Corners = []
    x = y = 0.0
    at, command, closed, parts = 0, "", False, 0
    text = text.strip()
    while at < len(text):
        letter = text[at]
        if letter.isalpha() and letter not in "eE":
            command, at = letter, at + 1
        elif not command or command in "zZ":
            raise InputError("path", text[at : at + 20], "commands and numbers")
        lower = command.lower()
        if lower in "csqta":
            return None, "has curves", "path with curves"
        if lower == "z":
            closed = True
            at = _past_space(text, at)
            continue
        if lower not in "mlhv":
            raise InputError("path", command, "one of M, L, H, V, Z")
        if lower != "m" and not parts:
            raise InputError("path", text[:20], "begun with M")
        near = command.islower()
        number, at = _next(text, at)
        if lower == "h":
            x = number + x * near
        elif lower == "v":
            y = number + y * near
        else:
            other, at = _next(text, at)
            x, y = number + x * near, other + y * near
        if lower == "m" or closed:
            parts, closed = parts + 1, False
        if lower == "m":
            command = "l" if near else "L"
        corners.append((x, y))
        at = _past_space(text, at)
    closed = closed or (parts == 1 and len(corners) > 3 and corners[0] == corners[-1])
    if not closed:
        return None, "is not closed", "open path"
    if parts > 1:
        return None, f"is {parts} lines", "path of several lines"
    return corners, None, "path"


def _past_space(text: str, at: int) -> int:
    found = _SPACE.match(text, at)
    return found.end() if found else at


def _next(text: str, at: int) -> tuple[float, int]:
    """Return the number at a place, and the place after it."""
    at = _past_space(text, at)
    found = _NUMBER.match(text, at)
    if found is None:
        raise InputError("path", text[at : at + 20], "a number")
    return float(found[0]), found.end()


def _pairs(text: str, field: str) -> Corners:
    numbers = _numbers(text, field)
    if len(numbers) % 2:
        raise InputError(field, f"{len(numbers)} numbers", "pairs")
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def _numbers(text: str, field: str) -> list[float]:
    numbers: list[float] = []
    at, text = 0, text.strip()
    while at < len(text):
        found = _NUMBER.match(text, at)
        if found is None:
            raise InputError(field, text, "numbers, without units")
        numbers.append(float(found[0]))
        at = _past_space(text, found.end())
    return numbers


def _number(text: str, field: str) -> float:
    numbers = _numbers(text, field)
    if len(numbers) != 1:
        raise InputError(field, text, "one number, in units of the viewBox")
    return numbers[0]


def _matrix(text: str) -> Matrix:
    """Return the matrix of a `transform` attribute."""
    matrix: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    at, text = 0, text.strip()
    while at < len(text):
        found = _CALL.match(text, at)
        if found is None:
            raise InputError("transform", text[at : at + 40], "as of SVG 1.1")
        matrix = _times(matrix, _one(found[1], _numbers(found[2], "transform")))
        at = found.end()
    return matrix


def _one(name: str, given: list[float]) -> Matrix:
    """Return the matrix of one transform."""
    match name, given:
        case "matrix", [a, b, c, d, e, f]:
            return a, b, c, d, e, f
        case "translate", [x]:
            return 1.0, 0.0, 0.0, 1.0, x, 0.0
        case "translate", [x, y]:
            return 1.0, 0.0, 0.0, 1.0, x, y
        case "scale", [x]:
            return x, 0.0, 0.0, x, 0.0, 0.0
        case "scale", [x, y]:
            return x, 0.0, 0.0, y, 0.0, 0.0
        case "rotate", [angle, *about] if len(about) in {0, 2}:
            x, y = about or (0.0, 0.0)
            c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            return c, s, -s, c, x - c * x + s * y, y - s * x - c * y
        case "skewX", [angle]:
            return 1.0, 0.0, math.tan(math.radians(angle)), 1.0, 0.0, 0.0
        case "skewY", [angle]:
            return 1.0, math.tan(math.radians(angle)), 0.0, 1.0, 0.0, 0.0
        case _:
            raise InputError("transform", f"{name} of {len(given)} numbers", "as of SVG 1.1")


def _times(one: Matrix, other: Matrix) -> Matrix:
    """Return what maps by `other` first, then by `one`."""
    a, b, c, d, e, f = one
    p, q, r, s, t, u = other
    return (
        a * p + c * q,
        b * p + d * q,
        a * r + c * s,
        b * r + d * s,
        a * t + c * u + e,
        b * t + d * u + f,
    )


def _unit_of(given: dict[str, str]) -> Unit:
    """Return what width, height and viewBox of a drawing say of its unit."""
    width, height = given.get("width", ""), given.get("height", "")
    box = _numbers(given.get("viewBox", ""), "viewBox")
    found = [_LENGTH.fullmatch(each) for each in (width, height)]
    if len(box) != 4 or box[2] <= 0 or box[3] <= 0:
        return NO_UNIT
    sizes = [
        float(each[1]) * LENGTHS[each[2]] / extent
        for each, extent in zip(found, box[2:], strict=True)
        if each and each[2] in LENGTHS
    ]
    if not sizes:
        return NO_UNIT
    # Where the shapes of page and box differ, the box is fitted into the page.
    metres = min(sizes)
    return Unit(metres=metres, said=f"a unit of the viewBox is {metres:g} m, by the width")
