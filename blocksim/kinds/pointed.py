"""Pointed arches: two arcs that meet at a vertical joint."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.maker import count, metres
from blocksim.common.checks import VOUSSOIRS, require
from blocksim.kinds.archkind import NEARLY, CurvedArch
from blocksim.kinds.curves import Curve, Voussoirs, chords, circle, strips, where


@dataclass(frozen=True, kw_only=True)
class PointedArch(CurvedArch):
    """Two arcs on one springing line; the origin is its middle."""

    name: ClassVar[str] = "pointed-arch"
    about: ClassVar[str] = "two arcs that meet in a point, at a vertical joint"

    span: float = metres(2.0, "span of the centreline", stands="low")
    radius: float = metres(1.5, "radius of both arcs of the centreline, half the span or more")
    voussoirs: int = count(28, "number of voussoirs, even", low=2, high=VOUSSOIRS.high)

    def __post_init__(self) -> None:
        """Check that both arcs have as many voussoirs."""
        super().__post_init__()
        require(self.voussoirs % 2 == 0, "voussoirs", self.voussoirs, "an even number")

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""
        return self.radius

    @property
    def radial_is_normal(self) -> bool:
        """Radial joints, to the centres of the arcs, are the normal ones."""
        return True

    @property
    def _shift(self) -> float:
        """How far the centre of the left arc lies to the right of the middle [m]."""
        return self.radius - self.span / 2

    @property
    def _crown(self) -> float:
        """Angle from the vertical at which the left arc ends, of the centreline."""
        return -math.asin(self._shift / self.radius)

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the last voussoir reaches the joint of the crown."""
        low, high = super().limits(name)
        if name == "radius":
            low = self.span / 2 * NEARLY
        if name == "thickness" and self._shift > 0:
            last = -math.pi / 2 + (self._crown + math.pi / 2) * (1 - 2 / self.voussoirs)
            nearest = (
                self._shift if self.joints == "vertical" else self._shift / -math.sin(last)
            )
            high = min(high, 2 * (self.radius - nearest) * NEARLY)
        return low, high

    def curve(self) -> Curve:
        """Return the left arc of the centreline."""
        return circle(self._shift, self.radius, -math.pi / 2, self._crown)

    @property
    def top(self) -> float:
        """Height of the highest point of the extrados [m]."""
        return math.sqrt((self.radius + self.thickness / 2) ** 2 - self._shift**2)

    @cached_property
    def stones(self) -> Voussoirs:
        """Measure the voussoirs of the left arc; the others are their mirror image."""
        curve, half = self.curve(), self.voussoirs // 2
        ends = [
            -math.asin(self._shift / (self.radius + side * self.thickness / 2))
            for side in (-1, 1)
        ]
        if self.joints == "vertical":
            inner, outer = self._vertical(ends, half)
        else:
            inner, outer = (curve.equal_lengths(half) for _ in ends)
            inner[-1], outer[-1] = ends
        left = strips(curve, self.thickness, inner, outer)
        left.corners[-1, 1:3, 0] = 0.0  # exactly in the middle, where both arcs meet
        if self.weight == "chord":
            left = chords(left.corners)
        return left.and_then(left.mirrored())

    def _vertical(self, ends: list[float], half: int) -> list[Array]:
        found: list[Array] = []
        levels = (self.span / 2 - self.thickness / 2) * (np.arange(1, half) / half - 1)
        for end, side in zip(ends, (-1, 1), strict=True):
            radius = self.radius + side * self.thickness / 2
            arc = circle(self._shift, radius, -math.pi / 2, end)
            between = where(lambda s, arc=arc: arc.at(s)[0], levels, arc.start, end)
            found.append(np.concatenate([[arc.start], between, [end]]))
        return found
