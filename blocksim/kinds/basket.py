"""Basket-handle arches: three arcs that meet without a corner."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.maker import metres, parameter
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.curves import Curve


@dataclass(frozen=True, kw_only=True)
class BasketHandleArch(CurvedArch):
    """Three centres; the origin is the middle of the springing line."""

    name: ClassVar[str] = "basket-handle-arch"
    about: ClassVar[str] = "three arcs, the outer two sharper"

    span: float = metres(2.0, "span of the centreline", stands="low")
    rise: float = metres(0.6, "rise of the centreline, at most half the span")
    side_deg: float = parameter(
        60.0, "angle of each outer arc", unit="deg", low=10.0, high=80.0
    )

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the outer arcs have a radius above 0."""
        low, high = super().limits(name)
        if name == "rise":
            side, half = math.radians(self.side_deg), self.span / 2
            gain = math.sin(side) + math.cos(side) - 1
            return half * (1 - gain / math.cos(side)), half
        return low, high

    @property
    def radii(self) -> tuple[float, float]:
        """Radii of the outer arcs and of the middle one, of the centreline [m]."""
        side, half = math.radians(self.side_deg), self.span / 2
        apart = (half - self.rise) / (math.sin(side) + math.cos(side) - 1)
        small = half - apart * math.cos(side)
        return small, small + apart

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""
        return self.radii[0]

    def curve(self) -> Curve:
        """Return the centreline, by the direction of its normal from the vertical."""
        side, half = math.radians(self.side_deg), self.span / 2
        small, large = self.radii
        jump = math.pi / 2 - side

        def arc(s: Array) -> Array:
            return np.where(np.abs(s) > jump, small, large)

        def at(s: Array) -> tuple[Array, Array]:
            outer = np.abs(s) > jump
            shift = np.where(outer, np.sign(s) * (half - small), 0.0)
            drop = np.where(outer, 0.0, self.rise - large)
            return shift + arc(s) * np.sin(s), drop + arc(s) * np.cos(s)

        return Curve(
            start=-math.pi / 2,
            end=math.pi / 2,
            at=at,
            first=lambda s: (arc(s) * np.cos(s), -arc(s) * np.sin(s)),
            second=lambda s: (-arc(s) * np.sin(s), -arc(s) * np.cos(s)),
            breaks=(-jump, jump),
        )
