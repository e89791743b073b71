"""Arcades: several spans on free piers, between fixed abutments."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from blocksim.blocks.given import Body
from blocksim.blocks.made import Fill, Made
from blocksim.blocks.maker import Maker, count, metres, parameter
from blocksim.common.errors import InputError
from blocksim.kinds.archkind import ArchKind
from blocksim.kinds.blockwork import floor, pier
from blocksim.kinds.portal import LEVEL, SEMICIRCLE, require_bearing


@dataclass(frozen=True, kw_only=True)
class Arcade(Maker):
    """Equal arches side by side; the origin is the middle of its springing line."""

    name: ClassVar[str] = "arcade"
    about: ClassVar[str] = "several equal arches on free piers, between fixed abutments"

    arch: ArchKind = parameter(  # noqa: RUF009 - a frozen arch
        SEMICIRCLE, "the arch: a table with its kind and parameters", nested="table"
    )
    spans: int = count(2, "number of arches", high=100)
    pier_width: float = metres(0.6, "width of the piers", stands="high")
    pier_height: float = metres(3.0, "height of the piers", stands="low")
    pier_courses: int = count(1, "blocks of each pier")

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: springings lie wholly on the piers."""
        low, high = super().limits(name)
        if name == "pier_width":
            left, right = self.arch.stones.faces[[0, -1]]
            low = left[0, 0] - left[1, 0] + right[1, 0] - right[0, 0]
        return low, high

    def made(self, density: float) -> Made:
        """Make floor, abutments, piers and voussoirs; joints are found."""
        faces = self.arch.stones.faces[[0, -1]]
        require_bearing(self.arch, faces)
        (left, right), thick = faces.tolist(), self.arch.thickness
        level = abs(left[0][1] - right[0][1]) <= LEVEL * thick
        level = level and abs(left[1][1] - right[1][1]) <= LEVEL * thick
        if not level:
            raise InputError("arch", self.arch.name, "one whose springings are as high")
        wide, spring = right[0][0] - left[0][0], left[0][1]
        pitch = wide + self.pier_width
        ground, middle = spring - self.pier_height, (left[0][0] + right[0][0]) / 2
        centres = pitch * (np.arange(self.spans) - (self.spans - 1) / 2)
        bodies: list[Body] = []
        fills: list[Fill] = []
        outside = centres[0] - wide / 2, centres[-1] + wide / 2
        fixed = [
            _abutment("left", outside[0], -self.pier_width, ground, left, thick),
            _abutment("right", outside[1], self.pier_width, ground, right, thick),
        ]
        reach = 2 * self.pier_width
        fixed.append(floor(outside[0] - reach, outside[1] + reach, ground, reach / 2))
        for index, centre in enumerate(centres[:-1] + pitch / 2):
            ends = centre - self.pier_width / 2, centre + self.pier_width / 2
            name = f"pier {index + 1}"
            bodies += pier(name, ends, ends, ground, spring, self.pier_courses, self.arch.depth)
            bodies += self._saddle(name, ends, left, right, spring)
            fills += self._over(density, ends, left, right, len(fixed) + len(bodies) - 1)
        bodies = [*fixed, *bodies]
        stones = self.arch.bodies(density)
        for index, centre in enumerate(centres):
            shift = np.array([centre - middle, 0.0])
            first = len(bodies)
            bodies += [_moved(stone, shift, f"{index + 1}.{stone.name}") for stone in stones]
            fills += [
                Fill(
                    body=each.body,
                    weight=each.weight,
                    point=(each.point[0] + shift[0], each.point[1]),
                )
                for each in self.arch.fills(density, first)
            ]
        return Made(bodies=tuple(bodies), fills=tuple(fills))

    def _over(
        self,
        density: float,
        ends: tuple[float, float],
        left: list[list[float]],
        right: list[list[float]],
        body: int,
    ) -> list[Fill]:
        """Return the weight of the fill over a pier, between two springings."""
        arch = self.arch
        if arch.fill is None:
            return []
        edges = ends[0] + right[1][0] - right[0][0], ends[1] - left[0][0] + left[1][0]
        area = (edges[1] - edges[0]) * (arch.top + arch.fill - left[1][1])
        weight = density * arch.fill_density * arch.depth * area
        point = (edges[0] + edges[1]) / 2, left[1][1]
        return [Fill(body=body, weight=weight, point=point)] if area > 0 else []

    def _saddle(
        self,
        name: str,
        ends: tuple[float, float],
        left: list[list[float]],
        right: list[list[float]],
        spring: float,
    ) -> list[Body]:
        """Make the block between the head of a pier and two inclined springings."""
        high = left[1][1]
        if high - spring <= LEVEL * self.arch.thickness:
            return []
        corners = [
            [ends[0], spring],
            [ends[1], spring],
            [ends[1] - (left[0][0] - left[1][0]), high],
            [ends[0] + (right[1][0] - right[0][0]), high],
        ]
        return [
            Body(polygons=(np.array(corners),), name=f"{name} saddle", depth=self.arch.depth)
        ]


def _abutment(
    name: str, edge: float, wide: float, ground: float, face: list[list[float]], thick: float
) -> Body:
    """Make a fixed abutment below a springing, and behind it where it is inclined."""
    (inner, low), (outer, high) = face
    slope, side = outer - inner, 1 if wide > 0 else -1
    far = edge + (wide if abs(wide) > abs(slope) else 2 * slope)
    corners = [[edge, ground], [far, ground], [far, low], [edge, low]]
    if high - low > LEVEL * thick:
        corners[2:3] = [[far, high], [edge + slope, high]]
    return Body(polygons=(np.array(corners)[::side],), name=name, fixed=True)


def _moved(body: Body, shift: object, name: str) -> Body:
    corners = np.asarray(body.polygons[0]) + shift
    centre = None if body.centre is None else np.asarray(body.centre) + shift
    return replace(body, polygons=(corners,), centre=centre, name=name)
