"""How fill spreads what stands on the road, on its way down to what lies below.

A load on the road is a fan of rays. Along each of them goes a share of the load that does not
change on the way. Where what lies below is level, the pressure is that of the two usual
assumptions: even over a width that grows with depth, or that of Boussinesq (1885) below a line
load, of which Flamant (1892) gave the rays: 2/pi cos^2 of the angle to the vertical. That is
cut off at an angle, as usual for arches, and the rest carries all of the load.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from blocksim.blocks.assembly import Array
from blocksim.common.checks import COORDINATE, require
from blocksim.common.errors import InputError
from blocksim.common.series import gauss

CUT_OFF = 30.0
"""Angle to the vertical beyond which Boussinesq's pressure is left out [deg]."""
STEEPEST = 10.0
"""Largest width to one side over the depth."""
BOUSSINESQ = "boussinesq"
NODES = 8
"""Points of quadrature by Gauss along what a ray may hit: exact to round-off."""


@dataclass(frozen=True, kw_only=True)
class Dispersal:
    """How a load is spread below the road.

    `road`: Height of the road [m].
    `slope`: Width to one side over the depth, of the outermost ray.
    `even`: Whether pressure at a depth is even; else it is Boussinesq's.
    """

    road: float
    slope: float
    even: bool = True

    def __post_init__(self) -> None:
        """Check the ranges."""
        COORDINATE.require("road", self.road)
        ok = 0 < self.slope <= STEEPEST
        require(ok, "dispersal", self.slope, f"above 0 and at most {STEEPEST:g}")

    @classmethod
    def of(cls, words: str, road: float) -> Dispersal:
        """Read `1:2`, the width to one side over the depth, or `boussinesq`.

        Examples
        --------
        >>> Dispersal.of("1:2", road=3.0).slope
        0.5
        """
        if words == BOUSSINESQ:
            return cls(road=road, slope=math.tan(math.radians(CUT_OFF)), even=False)
        across, _, down = words.partition(":")
        try:
            slope = float(across) / float(down)
        except (ValueError, ZeroDivisionError):
            slope = math.nan
        if not 0 < slope <= STEEPEST:
            allowed = f"across:down, as 1:2, or {BOUSSINESQ}"
            raise InputError("dispersal", words, allowed)
        return cls(road=road, slope=slope)

    def rays(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Return rays between slopes, (parts, 1) each, and the share of the load along each."""
        slopes, shares = quadrature(low, high)
        if self.even:
            return slopes, shares / (2 * self.slope)
        most = self.slope
        # The integral of 1 / (1 + t^2)^2 from one outermost ray to the other.
        whole = most / (1 + most * most) + math.atan(most)
        return slopes, shares / (1 + slopes**2) ** 2 / whole

    @property
    def words(self) -> str:
        """How it is said."""
        if self.even:
            return f"fill spreads loads by {self.slope:.4g} of the depth to each side, evenly"
        angle = math.degrees(math.atan(self.slope))
        return f"fill spreads loads by Boussinesq, up to {angle:.4g} deg from the vertical"


def quadrature(low: Any, high: Any) -> tuple[Array, Array]:
    """Return points between two ends, and their weights, by Gauss."""
    nodes, weights = gauss(NODES)
    return low + (high - low) * nodes, (high - low) * weights
