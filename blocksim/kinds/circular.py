"""Circular arches between any two springings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.base import metres, parameter
from blocksim.kinds.curves import Curve
from blocksim.kinds.strips import Voussoirs

ROUND = 360.0


@dataclass(frozen=True, kw_only=True)
class CircularArch(CurvedArch):
    """A circular arch; the origin is the centre of the circle."""

    name: ClassVar[str] = "circular-arch"
    about: ClassVar[str] = "part of a ring between any two springings"

    radius: float = metres(1.0, "radius of the centreline", stands="low")
    left_deg: float = parameter(
        90.0, "angle from the crown to the left springing", unit="deg", low=-90.0, high=179.0
    )
    right_deg: float = parameter(
        90.0, "angle from the crown to the right springing", unit="deg", low=-90.0, high=179.0
    )
    weight: str = parameter(
        "curved",
        "weight and centre of each voussoir: with curved faces, with straight ones, or at its "
        "arc of the centreline",
        choices=("curved", "chord", "centreline"),
    )

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""
        return self.radius

    @property
    def radial_is_normal(self) -> bool:
        """Radial joints are the normal ones."""
        return True

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the left springing lies left of the right one."""
        low, high = super().limits(name)
        if name == "right_deg":
            low, high = max(low, -self.left_deg), min(high, ROUND - 1.0 - self.left_deg)
        if name in {"left_deg", "right_deg"} and self.joints == "vertical":
            high = min(high, 90.0)
        return low, high

    def curve(self) -> Curve:
        """Return the centreline, by the angle from the crown."""
        return circle(
            0.0, self.radius, -math.radians(self.left_deg), math.radians(self.right_deg)
        )

    @cached_property
    def stones(self) -> Voussoirs:
        """Measure the voussoirs."""
        found = super().stones
        if self.weight != "centreline":
            return found
        curve = self.curve()
        inner, outer = self.cuts(curve)
        ends = (inner + outer) / 2
        half, middle = np.diff(ends) / 2, (ends[1:] + ends[:-1]) / 2
        arm = self.radius * np.sin(half) / half
        centre = arm[:, None] * np.column_stack([np.sin(middle), np.cos(middle)])
        return Voussoirs(**{**vars(found), "centre": centre})


def circle(shift: float, radius: float, start: float, end: float) -> Curve:
    """Return an arc about a centre at a height of 0, by the angle from the vertical."""
    return Curve(
        start=start,
        end=end,
        at=lambda s: (shift + radius * np.sin(s), radius * np.cos(s)),
        first=lambda s: (radius * np.cos(s), -radius * np.sin(s)),
        second=lambda s: (-radius * np.sin(s), -radius * np.cos(s)),
    )
