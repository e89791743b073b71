"""Elliptic arches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from blocksim.blocks.maker import metres
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.curves import Curve, ellipse


@dataclass(frozen=True, kw_only=True)
class EllipticArch(CurvedArch):
    """Half an ellipse; the origin is its centre."""

    name: ClassVar[str] = "elliptic-arch"
    about: ClassVar[str] = "half an ellipse"

    span: float = metres(2.0, "span of the centreline", stands="low")
    rise: float = metres(0.6, "rise of the centreline")

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""
        half = self.span / 2
        return min(half**2 / self.rise, self.rise**2 / half)

    def curve(self) -> Curve:
        """Return the centreline, by the ellipse's angle."""
        return ellipse(self.span / 2, self.rise, -math.pi / 2, math.pi / 2)
