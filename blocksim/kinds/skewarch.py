"""Straight and skew barrels: a skew arch, a vault of many rings."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.maker import count, metres, parameter
from blocksim.blocks.space.assembly import Solid
from blocksim.blocks.space.maker import SolidMaker
from blocksim.kinds.solids import abutment, voussoir


class Barrel(SolidMaker):
    """Voussoirs between radial planes and two abutments; kinds say their sizes."""

    radius: float
    thickness: float
    half_angle_deg: float
    voussoirs: int

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the intrados has a radius."""
        low, high = super().limits(name)
        return (low, min(high, 1.9 * self.radius)) if name == "thickness" else (low, high)

    def barrel(
        self, courses: Sequence[Sequence[float]], name: str = "{0}.{1}", skew: float = 0.0
    ) -> tuple[Solid, ...]:
        """Make it, from where each course is cut along the barrel, from the left."""
        half = math.radians(self.half_angle_deg)
        radii = self.radius - self.thickness / 2, self.radius + self.thickness / 2
        angles = np.linspace(-half, half, self.voussoirs + 1).tolist()
        blocks = [
            Solid(parts=(voussoir(radii, ends, along, skew, half),), name=name.format(at, ring))
            for at, (ends, cuts) in enumerate(
                zip(itertools.pairwise(angles), courses, strict=True), 1
            )
            for ring, along in enumerate(itertools.pairwise(cuts), 1)
        ]
        whole = courses[0][0], courses[0][-1]
        left, right = (
            abutment(side, radii, angle, whole, skew, half)
            for side, angle in (("left", -half), ("right", half))
        )
        return left, *blocks, right


@dataclass(frozen=True, kw_only=True)
class SkewArch(Barrel):
    """An arch whose abutments are square to the road, and whose barrel runs aslant.

    x is along the span, y along the barrel. Joints are radial planes, sheared along y.
    """

    name: ClassVar[str] = "skew-arch"
    about: ClassVar[str] = "an arch that crosses aslant"

    radius: float = metres(4.5, "mean radius")
    thickness: float = metres(0.9, "thickness", stands="high")
    width: float = metres(3.0, "width along the barrel")
    half_angle_deg: float = parameter(
        90.0, "half-angle of embrace", unit="deg", low=5.0, high=90.0, above=False
    )
    skew_deg: float = parameter(
        30.0, "angle of skew", unit="deg", low=0.0, high=75.0, above=False, stands="low"
    )
    voussoirs: int = count(15, "number of voussoirs", low=3, high=500)

    def solids(self) -> tuple[Solid, ...]:
        """Make two abutments and the voussoirs, from the left."""
        ends = [-self.width / 2, self.width / 2]
        return self.barrel([ends] * self.voussoirs, "{0}", math.radians(self.skew_deg))


@dataclass(frozen=True, kw_only=True)
class BarrelVault(Barrel):
    """A barrel vault of rings of voussoirs, or in bond; x along the span, y along the vault."""

    name: ClassVar[str] = "barrel-vault"
    about: ClassVar[str] = "a barrel vault of many rings, in bond or not"

    radius: float = metres(2.0, "mean radius")
    thickness: float = metres(0.3, "thickness", stands="high")
    length: float = metres(4.0, "length of the vault")
    half_angle_deg: float = parameter(
        90.0, "half-angle of embrace", unit="deg", low=5.0, high=90.0, above=False
    )
    voussoirs: int = count(15, "number of voussoirs of a ring", low=3, high=500)
    rings: int = count(4, "number of rings", high=200)
    bond: str = parameter(
        "half", "how joints between rings run: straight, or half a ring apart",
        choices=("none", "half"),
    )  # fmt: skip

    def solids(self) -> tuple[Solid, ...]:
        """Make two abutments and the voussoirs, course by course from the left."""
        low, high, step = -self.length / 2, self.length / 2, self.length / self.rings
        cuts = np.linspace(low, high, self.rings + 1).tolist()
        shifted = [low, *(cut - step / 2 for cut in cuts[1:]), high]
        odd = shifted if self.bond == "half" else cuts
        return self.barrel([odd if at % 2 else cuts for at in range(self.voussoirs)])
