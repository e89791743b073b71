"""Two equal barrels that cross at right angles."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.maker import count, metres, parameter
from blocksim.blocks.space.assembly import Solid
from blocksim.blocks.space.maker import SolidMaker
from blocksim.kinds.solids import Ends


@dataclass(frozen=True, kw_only=True)
class GroinVault(SolidMaker):
    """Two equal barrels along x and y, cut off at the groins where they meet, on four corners.

    Stones at a groin have an arm in either barrel, long and short in turn, so that there is
    bond. The barrels end square, a way beyond the corners.
    """

    name: ClassVar[str] = "groin-vault"
    about: ClassVar[str] = "two barrels that cross, on four corners"

    radius: float = metres(2.5, "mean radius of both barrels")
    thickness: float = metres(0.4, "thickness", stands="high")
    half_angle_deg: float = parameter(
        90.0, "half-angle of embrace", unit="deg", low=20.0, high=90.0, above=False
    )
    beyond: float = metres(0.5, "how far the barrels go on beyond the corners")
    stone: float = metres(1.0, "length of stones along the barrels")
    courses: int = count(6, "courses from a springing to the crown", high=200)

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the intrados has a radius, arms and ends go past groins."""
        low, high = super().limits(name)
        most = min(1.9 * self.radius, 0.99 * self.stone, 1.98 * self.beyond)
        return (low, min(high, most)) if name == "thickness" else (low, high)

    @property
    def radii(self) -> Ends:
        """Of intrados and extrados [m]."""
        return self.radius - self.thickness / 2, self.radius + self.thickness / 2

    @property
    def end(self) -> float:
        """Where the barrels end, from the middle [m]."""
        return self.radius * math.sin(math.radians(self.half_angle_deg)) + self.beyond

    def _piece(self, angles: Ends, low: float | None, high: float) -> Array:
        """Return corners in the barrel along y, (8, 3): from y = `low`, or the groin."""
        drop = self.radii[0] * math.cos(math.radians(self.half_angle_deg))
        found: list[list[float]] = []
        for at in angles:
            for radius in self.radii:
                x, z = radius * math.sin(at), radius * math.cos(at) - drop
                found += [[x, x if low is None else low, z], [x, high, z]]
        return np.array(found)

    def solids(self) -> tuple[Solid, ...]:
        """Make the four corners and what they carry, course by course from the springing."""
        half = math.radians(self.half_angle_deg)
        angles = np.linspace(half, 0.0, self.courses + 1).tolist()
        bed = self._piece((half, half), None, self.end)
        under = np.concatenate([bed, bed - [0.0, 0.0, self.thickness]])
        solids: list[Solid] = []
        for quarter, (x, y) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)], start=1):
            way = np.array([x, y, 1])
            corner = tuple(way * each for each in (under, under[:, [1, 0, 2]]))
            solids.append(Solid(parts=corner, name=f"corner.{quarter}", fixed=True))
            for course, (lower, upper) in enumerate(itertools.pairwise(angles), start=1):
                arm = self.stone / (2 - course % 2)
                first = self.radius * math.sin(lower) + arm
                left = max(self.end - first, 0.0) if first + self.stone / 2 < self.end else 0.0
                cuts = np.linspace(self.end - left, self.end, math.ceil(left / self.stone) + 1)
                groin = self._piece((lower, upper), None, float(cuts[0]))
                name = f"{quarter}.{course}"
                arms = tuple(way * each for each in (groin, groin[:, [1, 0, 2]]))
                solids.append(Solid(parts=arms, name=name))
                for at, (low, high) in enumerate(itertools.pairwise(cuts.tolist()), start=1):
                    web = self._piece((lower, upper), low, high)
                    for barrel, piece in (("y", web), ("x", web[:, [1, 0, 2]])):
                        named = f"{name}.{barrel}{at}"
                        solids.append(Solid(parts=(way * piece,), name=named))
        return tuple(solids)
