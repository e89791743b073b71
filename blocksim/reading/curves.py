"""Curves of drawings as chords: their ends stay, and the area beside them is exact."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array

TURN = math.radians(5)
"""By which a curve turns from chord to chord, at most."""
FEWEST = 3
"""Chords of a curve."""
STRAIGHT = 1e-9
"""Share of its length by which a curve may be off its chord and be a straight line."""
SAMPLED = 65
"""Places at which it is looked how far chords are off."""
FAR = 1e100
"""Coordinates beyond which squares of lengths may be none that a float can hold."""

Corners = list[tuple[float, float]]
Points = NDArray[np.complex128]


@dataclass(frozen=True)
class Chords:
    """A curve as chords.

    `corners`, list of (x, y): Between its ends.
    `stray`: How far chords are off the curve, at most.
    `wrong`: Why it cannot be drawn as chords of the same area.
    """

    corners: Corners
    stray: float = 0.0
    wrong: str | None = None


LINE = Chords([])
TOO_FAR = Chords([], wrong="reaches too far")


def _near(*points: complex) -> bool:
    return all(abs(each.real) <= FAR and abs(each.imag) <= FAR for each in points)


def arc(start: complex, end: complex, bulge: float) -> Chords:
    """Return a part of a circle as chords.

    `bulge`: Tangent of a quarter of its angle, above 0 where it turns counter-clockwise (as of
        DXF).
    """
    if not _near(start, end, bulge):
        return TOO_FAR
    chord = end - start
    if abs(bulge) < STRAIGHT or not chord:
        return LINE
    angle = 4 * math.atan(bulge)
    centre = (start + end) / 2 + 1j * chord / 2 * (1 - bulge * bulge) / (2 * bulge)

    def at(shares: Array) -> Points:
        return centre + (start - centre) * np.exp(1j * angle * shares)

    radius = abs(start - centre)
    return _chords(start, end, at, radius**2 / 2 * (angle - math.sin(angle)), abs(angle))


def bezier(points: list[complex]) -> Chords:
    """Return a cubic of four points as chords."""
    start, end = points[0], points[-1]
    if not _near(*points):
        return TOO_FAR
    one, two, chord = (each - start for each in points[1:])
    off = max(abs((each * chord.conjugate()).imag) for each in (one, two))
    if not chord or off <= STRAIGHT * max(map(abs, (one, two, chord))) * abs(chord):
        return LINE

    def at(shares: Array) -> Points:
        back = 1 - shares
        return start + shares * (3 * back * (back * one + shares * two) + shares**2 * chord)

    # Half of the integral of the curve, seen from its start, across its speed.
    swept = one.conjugate() * (two + chord) + 2 * two.conjugate() * chord
    ways = [each for each in (one, two - one, chord - two) if each]
    turn = sum(abs(cmath.phase(b / a)) for a, b in pairwise(ways))
    return _chords(start, end, at, 0.15 * swept.imag, turn)


def ellipse(
    start: complex, end: complex, radii: tuple[float, float], turned: float,
    large: bool, rising: bool,
) -> Chords:  # fmt: skip
    """Return a part of an ellipse as chords, as `A` of SVG gives it.

    `radii`, (float, float).
    `turned`: Angle of the first radius from x [rad].
    `large`, `rising`: Whether it is the longer one of two arcs, and the one on which the angle
        grows.
    """
    if not _near(start, end, *radii):
        return TOO_FAR
    rx, ry = map(abs, radii)
    if not (rx and ry) or start == end:
        return LINE
    unturn = cmath.exp(-1j * turned)

    # Where the ellipse is a circle of radius 1.
    def flat(point: complex) -> complex:
        point *= unturn
        return complex(point.real / rx, point.imag / ry)

    one, other = flat(start), flat(end)
    # Radii that are too small are enlarged until they reach, as SVG says.
    half = min(abs(other - one) / 2 / max(1.0, abs(other - one) / 2), 1.0)
    angle = 2 * math.asin(half)
    angle = 2 * math.pi - angle if large else angle
    found = arc(one, other, math.tan((angle if rising else -angle) / 4))
    corners: Corners = []
    for x, y in found.corners:
        point = complex(x * rx, y * ry) / unturn
        corners.append((point.real, point.imag))
    return Chords(corners, found.stray * max(rx, ry), found.wrong)


def _chords(
    start: complex, end: complex, at: Callable[[Array], Points], area: float, turn: float
) -> Chords:
    """Return corners on a curve, moved across its chord until the area beside it is right."""
    count = max(FEWEST, math.ceil(turn / TURN - 1e-9))
    chord = end - start
    # Along and across the chord, in units of its length: an area is kept times abs(chord)**2.
    inner = (at(np.arange(1, count) / count) - start) / chord
    path: Points = np.concatenate([np.zeros(1, complex), inner, np.ones(1, complex)])
    beside = 0.5 * float((path[:-1].conj() * path[1:]).imag.sum())
    wanted = area / abs(chord) ** 2
    if abs(beside) < STRAIGHT or not 0.5 < wanted / beside < 2:
        return Chords([], 0.0, "has a curve that turns both ways")
    path = path.real + 1j * path.imag * (wanted / beside)
    seen = (at(np.linspace(0, 1, SAMPLED)) - start) / chord
    ways = path[1:] - path[:-1]
    shares = ((seen[:, None] - path[:-1]) / ways).real.clip(0, 1)
    off = np.abs(path[:-1] + shares * ways - seen[:, None]).min(axis=1).max()
    moved = start + path[1:-1] * chord
    return Chords([(p.real, p.imag) for p in moved.tolist()], float(off) * abs(chord))
