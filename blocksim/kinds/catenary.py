"""Arches along a hanging chain, upside down."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.maker import metres
from blocksim.common.later import optimize
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.curves import Curve

STEEPEST = 100.0
"""Largest rise over span."""


@dataclass(frozen=True, kw_only=True)
class CatenaryArch(CurvedArch):
    """A catenary of even weight; the origin is the middle of its springing line."""

    name: ClassVar[str] = "catenary-arch"
    about: ClassVar[str] = "a hanging chain, upside down"

    span: float = metres(2.0, "span of the centreline", stands="low")
    rise: float = metres(1.0, "rise of the centreline")

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter."""
        low, high = super().limits(name)
        return (self.span / 1e4, STEEPEST * self.span) if name == "rise" else (low, high)

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline, that of its crown [m]."""
        ratio = self.rise / (self.span / 2)

        # Of a half-span of 1: rise = (cosh u - 1) / u = 2 sinh(u/2)^2 / u, u the inverse.
        def excess(u: float) -> float:
            return 2 * math.sinh(u / 2) ** 2 / u - ratio

        inverse = float(optimize.brentq(excess, 1e-6, 20.0, xtol=1e-15, rtol=1e-15))
        return self.span / 2 / inverse

    def curve(self) -> Curve:
        """Return the centreline, by x."""
        half, size = self.span / 2, self.tightest
        return Curve(
            start=-half,
            end=half,
            at=lambda s: (s, self.rise - 2 * size * np.sinh(s / (2 * size)) ** 2),
            first=lambda s: (np.ones_like(s), -np.sinh(s / size)),
            second=lambda s: (np.zeros_like(s), -np.cosh(s / size) / size),
        )
