"""What attributes of SVG say: numbers, transforms, and the lines and curves of a path."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.reading.curves import LINE, Chords, Corners, bezier, ellipse

Matrix = tuple[float, float, float, float, float, float]
"""a, b, c, d, e, f of SVG: x' = a x + c y + e, y' = b x + d y + f."""
AS_IT_IS: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
GIVEN = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7, "z": 0}
"""How many numbers a command of a path takes."""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_FLAG = re.compile(r"[01]")
_SPACE = re.compile(r"[\s,]*")
_CALL = re.compile(r"[\s,]*([a-zA-Z]+)\s*\(([^()]*)\)")


@dataclass
class Line:
    """A line of a path: its corners, those at which parts end, and how far chords are off."""

    corners: Corners = field(default_factory=Corners)
    ends: Corners = field(default_factory=Corners)
    closed: bool = False
    stray: float = 0.0
    wrong: str | None = None

    def to(self, end: complex, chords: Chords = LINE) -> None:
        """Go on to a point."""
        point = end.real, end.imag
        self.corners += [*chords.corners, point]
        self.ends.append(point)
        self.stray = max(self.stray, chords.stray)
        self.wrong = self.wrong or chords.wrong


def lines_of(text: str) -> list[Line]:
    """Return the lines of the `d` of a path, curves as chords."""
    lines: list[Line] = []
    here, last, before = 0j, 0j, ""
    at, command, text = 0, "", text.strip()
    while at < len(text):
        if text[at].isalpha() and text[at] not in "eE":
            command, at = text[at], at + 1
            known = command.lower() in GIVEN and (lines or command in "mM")
            begun = "begun with M, as SVG has it"
            require(bool(known), "path", text[at - 1 : at + 19], begun)
        else:
            going = command not in {"", "z", "Z"}
            require(going, "path", text[at : at + 20], "commands, numbers")
            # More points after the first of M are those of lines.
            command = {"m": "l", "M": "L"}.get(command, command)
        name = command.lower()
        given: list[float] = []
        for k in range(GIVEN[name]):
            number, at = _next(text, at, _FLAG if name == "a" and k in {3, 4} else NUMBER)
            given.append(number)
        at = _past_space(text, at)
        if name == "z":
            lines[-1].closed = True
            here = complex(*lines[-1].corners[0])
            continue
        if name == "m" or lines[-1].closed:
            lines.append(Line())
            if name != "m":
                lines[-1].to(here)
        from_ = here if command.islower() else 0j
        # A smooth curve goes on as the one before it, of its own kind.
        kept = any(name in kinds and before in kinds for kinds in ("cs", "qt") if before)
        here, last = _on(lines[-1], name, given, (here, from_), last if kept else here)
        before = name
    return [each for each in lines if len(each.corners) > 1]


def _on(
    line: Line, name: str, given: list[float], begin: tuple[complex, complex], last: complex
) -> tuple[complex, complex]:
    """Go on along a path: return where it is then, and the last point that steered it."""
    here, from_ = begin
    if name == "h":
        end = complex(from_.real + given[0], here.imag)
    elif name == "v":
        end = complex(here.real, from_.imag + given[0])
    else:
        end = from_ + complex(*given[-2:])
    if name in "mlhv":
        line.to(end)
        return end, end
    if name == "a":
        radii, turned = (given[0], given[1]), math.radians(given[2])
        line.to(end, ellipse(here, end, radii, turned, bool(given[3]), bool(given[4])))
        return end, end
    smooth = 2 * here - last
    points = [from_ + complex(x, y) for x, y in zip(given[:-2:2], given[1:-2:2], strict=True)]
    if name in "qt":
        steer = points[0] if points else smooth
        points = [here + 2 / 3 * (steer - here), end + 2 / 3 * (steer - end)]
    else:
        points = points if name == "c" else [smooth, *points]
        steer = points[1]
    line.to(end, bezier([here, *points, end]))
    return end, steer


def _past_space(text: str, at: int) -> int:
    found = _SPACE.match(text, at)
    return found.end() if found else at


def _next(text: str, at: int, what: re.Pattern[str]) -> tuple[float, int]:
    """Return the number at a place, and the place after it."""
    at = _past_space(text, at)
    found = what.match(text, at)
    if found is None:
        raise InputError("path", text[at : at + 20], "a number")
    return float(found[0]), found.end()


def pairs_of(text: str, field: str) -> Corners:
    """Return points of a text of numbers."""
    numbers = numbers_of(text, field)
    if len(numbers) % 2:
        raise InputError(field, f"{len(numbers)} numbers", "pairs")
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def numbers_of(text: str, field: str) -> list[float]:
    """Return the numbers of a text."""
    numbers: list[float] = []
    at, text = 0, text.strip()
    while at < len(text):
        found = NUMBER.match(text, at)
        if found is None:
            raise InputError(field, text, "numbers, without units")
        numbers.append(float(found[0]))
        at = _past_space(text, found.end())
    return numbers


def number_of(text: str, field: str) -> float:
    """Return the one number of a text."""
    numbers = numbers_of(text, field)
    if len(numbers) != 1:
        raise InputError(field, text, "one number, in units of the viewBox")
    return numbers[0]


def matrix_of(text: str) -> Matrix:
    """Return the matrix of a `transform` attribute."""
    matrix = AS_IT_IS
    at, text = 0, text.strip()
    while at < len(text):
        found = _CALL.match(text, at)
        if found is None:
            raise InputError("transform", text[at : at + 40], "as of SVG 1.1")
        matrix = times(matrix, _one(found[1], numbers_of(found[2], "transform")))
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


def times(one: Matrix, other: Matrix) -> Matrix:
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
