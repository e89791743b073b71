"""Corbelled domes: rings of stones with level beds, each reaching over the one below."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.maker import count, metres
from blocksim.blocks.space.assembly import Solid
from blocksim.blocks.space.maker import SolidMaker
from blocksim.kinds.solids import ground, wedge

LESS = 0.99
"""Share of a ring's width, and of the way to the axis, that is corbelled at most."""


@dataclass(frozen=True, kw_only=True)
class CorbelDome(SolidMaker):
    """Rings of stones with level beds, open at the top; the axis is z."""

    name: ClassVar[str] = "corbel-dome"
    about: ClassVar[str] = "rings with level beds, each reaching over the one below"

    radius: float = metres(2.0, "inner radius of the lowest ring")
    width: float = metres(0.8, "width of a ring", stands="high")
    height: float = metres(0.3, "height of a ring")
    corbel: float = metres(0.15, "how far each ring reaches over the one below", stands="low")
    rings: int = count(8, "number of rings", high=200)
    stones: int = count(16, "stones of a ring", low=3, high=200)

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the highest ring is open, and each lies on the one below."""
        low, high = super().limits(name)
        if name == "width":
            return max(low, self.corbel / LESS), high
        most = LESS * min(self.width, self.radius / max(1, self.rings - 1))
        return (low, min(high, most)) if name == "corbel" else (low, high)

    def solids(self) -> tuple[Solid, ...]:
        """Make the ground and the stones, ring by ring, joints half a stone apart."""
        far = self.radius + self.width
        solids = [ground(2 * far, self.height)]
        step = 2 * math.pi / self.stones
        for ring in range(self.rings):
            inner = self.radius - ring * self.corbel
            levels = np.array([ring, ring + 1]) * self.height
            near = np.stack([np.full(2, inner), levels], axis=1)
            outer = np.stack([np.full(2, inner + self.width), levels], axis=1)
            for stone in range(self.stones):
                start = (stone + (ring % 2) / 2) * step
                corners = wedge(near, outer, start, start + step)
                solids.append(Solid(parts=(corners,), name=f"{ring + 1}.{stone + 1}"))
        return tuple(solids)
