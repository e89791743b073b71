"""Parabolic arches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.maker import metres
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.curves import Curve


@dataclass(frozen=True, kw_only=True)
class ParabolicArch(CurvedArch):
    """A parabola; the origin is the middle of its springing line."""

    name: ClassVar[str] = "parabolic-arch"
    about: ClassVar[str] = "a parabola, upright"

    span: float = metres(2.0, "span of the centreline", stands="low")
    rise: float = metres(1.0, "rise of the centreline")

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""
        return self.span**2 / (8 * self.rise)

    def curve(self) -> Curve:
        """Return the centreline, by x."""
        half = self.span / 2
        bend = self.rise / half**2
        return Curve(
            start=-half,
            end=half,
            at=lambda s: (s, self.rise - bend * s * s),
            first=lambda s: (np.ones_like(s), -2 * bend * s),
            second=lambda s: (np.zeros_like(s), np.full_like(s, -2 * bend)),
        )
