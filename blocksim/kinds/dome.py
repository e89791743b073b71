"""Domes of lunes and courses."""

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
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.kinds.solids import ground, wedge


@dataclass(frozen=True, kw_only=True)
class Dome(SolidMaker):
    """A dome with an eye: a hemisphere, or flatter, higher or pointed; the axis is z.

    Its meridian is an ellipse of the radius and the rise about the springing, or an arc whose
    centre lies beyond the axis. Beds are normal to the meridian, or nearly so for an ellipse,
    where they are along the radius of its parameter.
    """

    name: ClassVar[str] = "dome"
    about: ClassVar[str] = "a dome of lunes and courses, with an eye"

    radius: float = metres(1.0, "mean radius at the springing")
    thickness: float = metres(0.1, "thickness", stands="high")
    rise: float = parameter(
        1.0, "rise of the meridian's crown over the springing, in radii",
        low=0.1, high=10.0, above=False,
    )  # fmt: skip
    pointed: float = parameter(
        0.0, "how far the meridian's centre lies beyond the axis, in radii",
        low=0.0, high=10.0, above=False,
    )  # fmt: skip
    eye_deg: float = parameter(
        8.0, "angle of the eye about the meridian's centre, from its crown", unit="deg",
        low=0.1, high=89.0, above=False,
    )  # fmt: skip
    lunes: int = count(12, "number of lunes", low=3, high=200)
    courses: int = count(7, "number of courses", high=200)
    bond: str = parameter(
        "none", "how meridian joints run: through all courses, or half a lune apart",
        choices=("none", "half"),
    )  # fmt: skip

    def __post_init__(self) -> None:
        """Check that the meridian is of one form, the eye open, and no bed crosses another."""
        super().__post_init__()
        if self.pointed and self.rise != 1.0:
            raise InputError("rise", self.rise, "1 of a pointed dome: its arc says it")
        inner = np.array([each[0] for each in self._beds()])
        if self.pointed and inner[0, 0] <= 0:
            beyond = self.pointed * self.radius
            least = math.degrees(
                math.asin(beyond / (beyond + self.radius - self.thickness / 2))
            )
            allowed = f"over {least:.4g} deg: else the eye is closed at its intrados"
            raise InputError("eye_deg", self.eye_deg, allowed)
        sharp = inner[0, 0] <= 0 or not (np.diff(inner, axis=0) * [1, -1] > 0).all()
        allowed = f"less: at a rise of {self.rise:g} beds cross within the wall"
        require(not sharp, "thickness", self.thickness, allowed)

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the intrados has a radius."""
        low, high = super().limits(name)
        return (low, min(high, 1.9 * self.radius)) if name == "thickness" else (low, high)

    def _beds(self) -> list[Array]:
        """Return intrados and extrados at each bed, from the eye down."""
        top = math.radians(self.eye_deg)
        return [self._corners(each) for each in np.linspace(top, math.pi / 2, self.courses + 1)]

    def _corners(self, angle: float) -> Array:
        """Return intrados and extrados at an angle from the crown, (2, 2): out, up [m]."""
        half, beyond = self.thickness / 2, self.pointed * self.radius
        around = self.radius + beyond
        way = np.array([math.sin(angle), self.rise * math.cos(angle)])
        # Across the meridian: of an arc along its radius.
        across = np.array([self.rise * math.sin(angle), math.cos(angle)])
        across /= np.linalg.norm(across)
        at = around * way - np.array([beyond, 0.0])
        return np.stack([at - half * across, at + half * across])

    def solids(self) -> tuple[Solid, ...]:
        """Make the ground and the voussoirs, course by course from the eye."""
        beds, step = self._beds(), 2 * math.pi / self.lunes
        half = self.radius + self.thickness
        solids = [ground(2 * half, half / 2)]
        for course in range(self.courses):
            upper, lower = beds[course], beds[course + 1]
            inner, outer = np.stack([lower[0], upper[0]]), np.stack([lower[1], upper[1]])
            shift = step / 2 if self.bond == "half" and course % 2 else 0.0
            for lune in range(self.lunes):
                start = lune * step + shift
                # In bond both halves have faces of their own: chords of half a lune.
                cuts = (0.0, 0.5, 1.0) if self.bond == "half" else (0.0, 1.0)
                parts = tuple(
                    wedge(inner, outer, start + a * step, start + b * step)
                    for a, b in itertools.pairwise(cuts)
                )
                solids.append(Solid(parts=parts, name=f"{course + 1}.{lune + 1}"))
        return tuple(solids)
