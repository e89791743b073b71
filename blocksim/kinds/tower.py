"""Towers of boxes, each offset and turned on the one below."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.maker import count, metres, parameter
from blocksim.blocks.space.assembly import Solid
from blocksim.blocks.space.maker import SolidMaker
from blocksim.kinds.solids import ground


@dataclass(frozen=True, kw_only=True)
class Tower(SolidMaker):
    """Equal boxes on each other, each offset along its own length and turned about z."""

    name: ClassVar[str] = "tower"
    about: ClassVar[str] = "boxes on each other, each offset and turned"

    blocks: int = count(6, "number of boxes", high=500)
    length: float = metres(1.0, "length of a box")
    width: float = metres(0.6, "width of a box")
    height: float = metres(0.3, "height of a box")
    offset: float = metres(
        0.1, "how far each box lies beyond the one below", low=0.0, stands="low"
    )
    turn_deg: float = parameter(
        20.0, "angle by which each box is turned on the one below", unit="deg",
        low=-180.0, high=180.0, above=False,
    )  # fmt: skip

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: each box lies on the one below."""
        low, high = super().limits(name)
        return (low, min(high, 0.99 * self.length)) if name == "offset" else (low, high)

    def solids(self) -> tuple[Solid, ...]:
        """Make the ground and the boxes, from the lowest."""
        far = self.blocks * self.offset + self.length + self.width
        solids = [ground(far, self.height)]
        at, turn = np.zeros(2), 0.0
        for index in range(self.blocks):
            along = np.array([math.cos(turn), math.sin(turn)])
            across = np.array([-along[1], along[0]])
            corners = [
                [*(at + a * self.length / 2 * along + b * self.width / 2 * across), z]
                for a in (-1, 1)
                for b in (-1, 1)
                for z in (index * self.height, (index + 1) * self.height)
            ]
            solids.append(Solid(parts=(corners,), name=str(index + 1)))
            at = at + self.offset * along
            turn += math.radians(self.turn_deg)
        return tuple(solids)
