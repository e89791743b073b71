"""Arcades and viaducts: several spans on free piers, between fixed abutments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from blocksim.blocks.given import Body
from blocksim.blocks.made import Fill, Made
from blocksim.blocks.maker import Maker, Table, count, metres, parameter
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.fields import fields_of
from blocksim.kinds.archkind import ArchKind
from blocksim.kinds.blockwork import box, fill_over, floor, head, pier
from blocksim.kinds.portal import LEVEL, SEMICIRCLE, require_bearing


@dataclass(frozen=True, kw_only=True)
class Span(Table):
    """What is another of one span than of the others."""

    span: float | None = metres(None, "its span", optional=True)
    rise: float | None = metres(None, "its rise", optional=True)
    thickness: float | None = metres(None, "its thickness", optional=True)
    voussoirs: int | None = parameter(
        None, "number of its voussoirs", whole=True, low=2, high=10_000, optional=True
    )
    fill_density: float | None = parameter(
        None, "density of its fill over that of the blocks", high=1e3, optional=True
    )


@dataclass(frozen=True, kw_only=True)
class Pier(Table):
    """What is another of one pier than of the others."""

    width: float | None = metres(None, "its width", optional=True)
    height: float | None = metres(None, "its height", optional=True)


@dataclass(frozen=True, kw_only=True)
class Arcade(Maker):
    """Arches side by side; the origin is the middle of its springing line.

    They are equal but for what `each_span` and `each_pier` say, from the left. Springings are
    as high as those of the arch, and the road is level: fill is as high over the highest.
    """

    name: ClassVar[str] = "arcade"
    about: ClassVar[str] = "several arches on free piers, between fixed abutments"
    row_types: ClassVar[Mapping[str, type[Table]]] = {"each_span": Span, "each_pier": Pier}

    arch: ArchKind = parameter(
        SEMICIRCLE, "the arch: a table with its kind and parameters", nested="table"
    )
    spans: int = count(2, "number of arches", high=100)
    pier_width: float = metres(0.6, "width of the piers", stands="high")
    pier_height: float = metres(3.0, "height of the piers", stands="low")
    pier_courses: int = count(1, "blocks of each pier")
    each_span: tuple[Span, ...] = parameter(
        (), "tables of what is another of each span, from the left", nested="tables"
    )
    each_pier: tuple[Pier, ...] = parameter(
        (), "tables of what is another of each pier, from the left", nested="tables"
    )

    def __post_init__(self) -> None:
        """Check the parameters, and the number of tables."""
        super().__post_init__()
        for name, many, most in (
            ("each_span", len(self.each_span), self.spans),
            ("each_pier", len(self.each_pier), self.spans - 1),
        ):
            require(many <= most, name, f"{many} tables", f"{most} at most")

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: springings lie wholly on the piers."""
        low, high = super().limits(name)
        if name == "pier_width":
            left, right = self.arch.stones.faces[[0, -1]]
            low = left[0, 0] - left[1, 0] + right[1, 0] - right[0, 0]
        return low, high

    @cached_property
    def arches(self) -> tuple[ArchKind, ...]:
        """The arches from the left, with fill up to one level."""
        rows = [*self.each_span, *[Span()] * (self.spans - len(self.each_span))]
        found: list[ArchKind] = []
        for place, row in enumerate(rows):
            given = {name: value for name, value in row.table().items() if value is not None}
            known = fields_of(type(self.arch))
            for name, value in given.items():
                allowed = f"left out: a {self.arch.name} has no {name}"
                require(name in known, f"each_span[{place}].{name}", value, allowed)
            found.append(self.arch.but(**given) if given else self.arch)
        if self.arch.fill is None:
            return tuple(found)
        over = [each.top - _spring(each) for each in found]
        road = max(over) + self.arch.fill
        return tuple(
            each if each is self.arch and high == max(over) else each.but(fill=road - high)
            for each, high in zip(found, over, strict=True)
        )

    @property
    def road(self) -> float | None:
        """Height of the road [m]; None without fill."""
        one = self.arches[0]
        if one.fill is None:
            return None
        return _spring(self.arch) + one.top - _spring(one) + one.fill

    @cached_property
    def piers(self) -> tuple[tuple[float, float], ...]:
        """Width and height of the piers from the left [m]."""
        rows = [*self.each_pier, *[Pier()] * (self.spans - 1 - len(self.each_pier))]
        return tuple(
            (
                self.pier_width if row.width is None else row.width,
                self.pier_height if row.height is None else row.height,
            )
            for row in rows
        )

    def made(self, density: float) -> Made:
        """Make floors, abutments, piers and voussoirs; joints are found."""
        spring = _spring(self.arch)
        faces = [_level_faces(arch, spring) for arch in self.arches]
        wides = [right[0][0] - left[0][0] for left, right in faces]
        widths = [width for width, _ in self.piers]
        pitches = [wide + width for wide, width in zip(wides, widths, strict=False)]
        starts = np.cumsum([0.0, *pitches])
        first, last = faces[0][0], faces[-1][1]
        whole = starts[-1] + wides[-1]
        starts = starts - whole / 2
        outside, ground = (starts[0], starts[-1] + wides[-1]), spring - self.pier_height
        fixed = [
            _abutment(name, edge, side * self.pier_width, ground, face, arch.thickness)
            for name, edge, side, face, arch in (
                ("left", outside[0], -1, first, self.arches[0]),
                ("right", outside[1], 1, last, self.arches[-1]),
            )
        ]
        reach = 2 * self.pier_width
        levels = {height for _, height in self.piers} or {self.pier_height}
        if levels == {self.pier_height}:
            fixed.append(floor(outside[0] - reach, outside[1] + reach, ground, reach / 2))
        bodies: list[Body] = []
        fills: list[Fill] = []
        for place, (width, height) in enumerate(self.piers):
            ends = float(starts[place + 1] - width), float(starts[place + 1])
            low = spring - height
            name = f"pier {place + 1}"
            if levels != {self.pier_height}:
                fixed.append(box(f"floor of {name}", ends, (low - reach / 2, low), fixed=True))
            before, after = faces[place][1], faces[place + 1][0]
            # Two springings lie wholly on a pier.
            least = before[1][0] - before[0][0] + after[0][0] - after[1][0]
            wide = f"{name}, {width:g} m wide"
            require(width >= least, "each_pier", wide, f"{least:.6g} m or wider")
            bodies += pier(name, ends, ends, low, spring, self.pier_courses, self.arch.depth)
            left = ends[0] + (before[1][0] - before[0][0]), before[1][1]
            right = ends[1] - (after[0][0] - after[1][0]), after[1][1]
            near = LEVEL * self.arch.thickness
            bodies += head(f"{name} saddle", ends, spring, left, right, near, self.arch.depth)
            if self.road is not None:
                both = self.arches[place : place + 2]
                heavy = density * (sum(each.fill_density for each in both) / 2)
                heavy *= self.arch.depth
                fills += fill_over(len(bodies) - 1, left, right, self.road, heavy)
        bodies = [*fixed, *bodies]
        fills = [replace(each, body=each.body + len(fixed)) for each in fills]
        for place, arch in enumerate(self.arches):
            at = np.array([starts[place] - arch.stones.faces[0, 0, 0], spring - _spring(arch)])
            begin = len(bodies)
            bodies += [
                _moved(each, at, f"{place + 1}.{each.name}") for each in arch.bodies(density)
            ]
            fills += [
                replace(each, point=(each.point[0] + at[0], each.point[1] + at[1]))
                for each in arch.fills(density, begin)
            ]
        return Made(bodies=tuple(bodies), fills=tuple(fills))


Face = list[list[float]]
"""Inner and outer end of a springing [m]."""


def _spring(arch: ArchKind) -> float:
    """Height of the springings of an arch in its own coordinates [m]."""
    return float(arch.stones.faces[0, 0, 1])


def _level_faces(arch: ArchKind, spring: float) -> tuple[Face, Face]:
    """Return both springings of an arch, moved up to a height; they are as high."""
    ends = arch.stones.faces[[0, -1]].copy()
    require_bearing(arch, ends)
    ends[:, :, 1] += spring - _spring(arch)
    left, right = ends.tolist()
    near = LEVEL * arch.thickness
    if abs(left[0][1] - right[0][1]) > near or abs(left[1][1] - right[1][1]) > near:
        raise InputError("arch", arch.name, "one whose springings are as high")
    return left, right


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
