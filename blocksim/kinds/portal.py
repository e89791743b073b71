"""Arches on two piers or buttresses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.given import Body
from blocksim.blocks.made import Fill, Made
from blocksim.blocks.maker import Maker, count, metres, parameter
from blocksim.common.errors import InputError
from blocksim.kinds.archkind import ArchKind
from blocksim.kinds.blockwork import fill_over, floor, head, pier
from blocksim.kinds.circular import CircularArch

LEVEL = 1e-9
"""Height of a springing, over the thickness, that counts as none."""


SEMICIRCLE = CircularArch()


@dataclass(frozen=True, kw_only=True)
class Portal(Maker):
    """An arch on piers that are free to tip and to slide."""

    name: ClassVar[str] = "portal"
    about: ClassVar[str] = "an arch on two piers or buttresses"

    arch: ArchKind = parameter(
        SEMICIRCLE, "the arch: a table with its kind and parameters", nested="table"
    )
    pier_width: float = metres(
        0.6, "width of the piers at the springing, from the intrados outwards", stands="high"
    )
    pier_height: float = metres(
        1.0, "height of the piers, up to the lower springing", stands="low"
    )
    pier_courses: int = count(1, "blocks of each pier")
    foot_width: float | None = metres(
        None,
        "width of the piers at the foot, where they are buttresses; as above if left out",
        optional=True,
        stands="high",
    )

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: springings lie wholly on the piers."""
        low, high = super().limits(name)
        if name == "pier_width":
            # Widths of the springings, seen from above.
            low = float(np.abs(np.diff(self.arch.stones.faces[[0, -1], :, 0])).max())
        return low, high

    def made(self, density: float) -> Made:
        """Make floor, piers, skewbacks and voussoirs; joints are found."""
        arch, depth = self.arch, self.arch.depth
        faces = arch.stones.faces[[0, -1]]
        require_bearing(arch, faces)
        ground = float(faces[:, 0, 1].min()) - self.pier_height
        foot = self.pier_width if self.foot_width is None else self.foot_width
        bodies, fills = list[Body](), list[Fill]()
        widest = max(foot, self.pier_width)
        for name, face, side in (("left", faces[0], -1.0), ("right", faces[1], 1.0)):
            (inner, spring), (outer, high) = face.tolist()
            edge = inner + side * self.pier_width
            below, above = sorted((inner, inner + side * foot)), sorted((inner, edge))
            courses = pier(
                f"{name} pier", below, above, ground, spring, self.pier_courses, depth
            )
            place, bodies = len(bodies) + 1, [*bodies, *courses]
            left, right = sorted([(edge, high), (outer, high)])
            near = LEVEL * arch.thickness
            bodies += head(f"{name} skewback", above, spring, left, right, near, depth)
            if arch.fill is not None:
                road, heavy = arch.top + arch.fill, density * arch.fill_density * depth
                fills += fill_over(len(bodies), left, right, road, heavy)
                for at, course in enumerate(courses if foot > self.pier_width else ()):
                    # Their backs look up.
                    ends = np.array(course.polygons[0])[[0, 3] if side < 0 else [2, 1]]
                    (x0, y0), (x1, y1) = ends.tolist()
                    fills += fill_over(place + at, (x0, y0), (x1, y1), road, heavy)
        west, east = faces[0, 0, 0] - widest, faces[1, 0, 0] + widest
        reach = (east - west) / 4
        first = len(bodies) + 1
        return Made(
            bodies=(
                floor(west - reach, east + reach, ground, reach),
                *bodies,
                *arch.bodies(density),
            ),
            fills=(*arch.fills(density, first), *fills),
        )


def require_bearing(arch: ArchKind, faces: Array) -> None:
    """Raise `InputError` unless springings are level or look up and inwards."""
    for face in faces:
        if face[1, 1] < face[0, 1] - LEVEL * arch.thickness:
            raise InputError(
                "arch", arch.name, "one whose springings do not lean in over the opening"
            )
