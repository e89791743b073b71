"""Elliptic arches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.maker import metres
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.curves import Curve


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
        half, rise = self.span / 2, self.rise
        return Curve(
            start=-math.pi / 2,
            end=math.pi / 2,
            at=lambda s: (half * np.sin(s), rise * np.cos(s)),
            first=lambda s: (half * np.cos(s), -rise * np.sin(s)),
            second=lambda s: (-half * np.sin(s), -rise * np.cos(s)),
        )
