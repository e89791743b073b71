"""Span, rise and thickness of a circular arch: what engineers measure, to and from `Arch`.

A circle through the two ends of a line of span s and its top, f above them, has the radius
(s^2/4 + f^2)/(2f) and spans tan(alpha/2) = 2f/s to each side. Both hold for segments, where
f < s/2, and for horseshoes alike: there the span is that between the springings, not the
widest. The half-angle is the same at intrados, centreline and extrados.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from blocksim.arch.circular import Arch
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.common.checks import HALF_ANGLE, LENGTH, PER_VOLUME, Range, is_number, require

At = Literal["intrados", "centreline", "extrados"]
LINES: tuple[str, ...] = get_args(At)
OFFSET: dict[str, float] = {"intrados": -0.5, "centreline": 0.0, "extrados": 0.5}
"""How far each line is outside the centreline, over the thickness."""
ALMOST = 1 + 1e-12
"""Round-off allowed of arches that are as thick as can be."""
MEASURE = Range(low=1e-30, high=1e12, unit="m")
"""Of an arch in its range, however flat or thin."""
LONGEST = 1000.0
"""Longest span that is believed to be in metres."""
HEAVIEST, NEWTONS = 200.0, 8000.0
"""Largest unit weight that is believed to be in kN/m^3, gold having 189; from the second on
one is taken for N/m^3, below it for a density in kg/m^3."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """One of the three arcs of an arch.

    `span`, `rise`: Between its ends, and of its top above them [m].
    `at`, {"intrados", "centreline", "extrados"}: Which one it is.
    """

    span: float
    rise: float
    at: At = "intrados"

    def __post_init__(self) -> None:
        """Check the ranges."""
        for field in ("span", "rise"):
            MEASURE.require(field, getattr(self, field))
        require(self.at in LINES, "at", self.at, f"one of {', '.join(LINES)}")

    @property
    def half_angle(self) -> float:
        """Half-angle of embrace alpha [rad]."""
        return 2 * math.atan2(2 * self.rise, self.span)

    @property
    def radius(self) -> float:
        """Radius of this line [m]."""
        return (self.span * (self.span / self.rise) / 4 + self.rise) / 2

    def mean_radius(self, eta: float) -> float:
        """Radius of the centreline of an arch of a thickness-to-radius ratio [m].

        Infinite where the intrados was measured and eta = 2 makes a point of it.
        """
        share = 1 + OFFSET[self.at] * eta
        return self.radius / share if share else math.inf

    def around(self, thickness: float) -> float:
        """Radius of the centreline of an arch of a thickness [m]."""
        MEASURE.require("thickness", thickness)
        inside = OFFSET[self.at] + 0.5
        allowed = f"at most {self.radius / (inside or 1.0):.6g} m, which is eta = 2"
        fits = inside * thickness <= self.radius * ALMOST
        require(fits, "thickness", thickness, allowed)
        return self.radius - OFFSET[self.at] * thickness

    def require_measured(self, thickness: float | None) -> None:
        """Raise `InputError` for dimensions that nobody has measured, as of a wrong unit.

        `thickness`: Where it is known [m].
        """
        span, rise = self.span, self.rise
        for field, value in (("span", span), ("rise", rise), ("thickness", thickness)):
            if value is not None:
                LENGTH.require(field, value)
        millimetres = f"at most {LONGEST:g} m (in mm it would be {span / 1000:g} m)"
        require(span <= LONGEST, "span", span, millimetres)
        closed = (
            f"at most the span, {span:g} m (a horseshoe beyond that: by its half-angle and eta)"
        )
        require(rise <= span, "rise", rise, closed)
        flattest = span / 2 * math.tan(HALF_ANGLE.low / 2)
        flat = f"at least {flattest:.6g} m for this span: what is flatter is no arch"
        require(rise >= flattest, "rise", rise, flat)
        if thickness is not None:
            radius = self.around(thickness)
            thick = f"at most the mean radius, {radius:.6g} m, which is eta = 1 (is it in m?)"
            require(thickness <= radius, "thickness", thickness, thick)


def line_of(arch: Arch, at: At = "intrados") -> Line:
    """Return one of the lines of an arch."""
    radius = arch.radius + OFFSET[at] * arch.thickness
    require(radius > 0, "eta", arch.eta, "below 2: the intrados is a point")
    return Line(
        span=2 * radius * math.sin(arch.half_angle),
        rise=2 * radius * math.sin(arch.half_angle / 2) ** 2,
        at=at,
    )


def friction_of(angle: float) -> float:
    """Return the friction coefficient of an angle in degrees; inf at a right angle."""
    return math.inf if angle == 90 else math.tan(math.radians(angle))


def friction_angle(mu: float) -> float:
    """Return the angle of a friction coefficient in degrees."""
    return math.degrees(math.atan(mu))


def require_unit_weight(field: str, value: float) -> None:
    """Raise `InputError` unless a value is a unit weight in kN/m^3."""
    lightest = PER_VOLUME.low / 1000
    allowed = f"{lightest:g} to {HEAVIEST:g} kN/m3"
    if is_number(value, HEAVIEST, math.inf):
        unit, share = ("N/m3", 1e-3) if value >= NEWTONS else ("kg/m3", STANDARD_GRAVITY / 1000)
        allowed += f" ({value:g} {unit} would be {value * share:.4g})"
    require(is_number(value, 0, HEAVIEST) and value >= lightest, field, value, allowed)
