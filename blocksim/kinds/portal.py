"""Arches on two piers or buttresses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.given import Body
from blocksim.blocks.made import Fill, Made
from blocksim.blocks.maker import FARTHEST, Maker, count, metres, parameter
from blocksim.common.errors import InputError
from blocksim.kinds.archkind import ArchKind
from blocksim.kinds.blockwork import floor, pier
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
    foot_width: float | None = parameter(
        None,
        "width of the piers at the foot, where they are buttresses; as above if left out",
        unit="m",
        high=FARTHEST,
        optional=True,
        stands="high",
    )

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: springings lie wholly on the piers."""
        low, high = super().limits(name)
        if name == "pier_width":
            low = max(_reach(face) for face in self.arch.stones.faces[[0, -1]])
        return low, high

    def made(self, density: float) -> Made:
        """Make floor, piers, skewbacks and voussoirs; joints are found."""
        faces = self.arch.stones.faces[[0, -1]]
        require_bearing(self.arch, faces)
        ground = float(faces[:, 0, 1].min()) - self.pier_height
        foot = self.pier_width if self.foot_width is None else self.foot_width
        bodies: list[Body] = []
        tops: list[int] = []
        widest = max(foot, self.pier_width)
        for name, face, side in (("left", faces[0], -1.0), ("right", faces[1], 1.0)):
            inner, spring = face[0].tolist()
            edge = inner + side * self.pier_width
            below, above = sorted((inner, inner + side * foot)), sorted((inner, edge))
            bodies += pier(
                f"{name} pier", below, above, ground, spring, self.pier_courses, self.arch.depth
            )
            bodies += skewback(name, face, edge, self.arch)
            tops.append(len(bodies))
        left, right = faces[0, 0, 0] - widest, faces[1, 0, 0] + widest
        reach = (right - left) / 4
        first = len(bodies) + 1
        return Made(
            bodies=(
                floor(left - reach, right + reach, ground, reach),
                *bodies,
                *self.arch.bodies(density),
            ),
            fills=(*self.arch.fills(density, first), *self._on_piers(density, tops, faces)),
        )

    def _on_piers(self, density: float, tops: list[int], faces: Array) -> list[Fill]:
        """Return the weight of the fill over the piers, outside the springings."""
        arch, found = self.arch, list[Fill]()
        if arch.fill is None:
            return found
        for body, face, side in zip(tops, faces, (-1.0, 1.0), strict=True):
            (inner, _), (outer, height) = face.tolist()
            edge = inner + side * self.pier_width
            area = abs(edge - outer) * (arch.top + arch.fill - height)
            if area > 0:
                weight = density * arch.fill_density * arch.depth * area
                middle = (edge + outer) / 2
                found.append(Fill(body=body, weight=weight, point=(middle, height)))
        return found


def _reach(face: Array) -> float:
    """Width of a springing, seen from above [m]."""
    return float(abs(face[1, 0] - face[0, 0]))


def require_bearing(arch: ArchKind, faces: Array) -> None:
    """Raise `InputError` unless springings are level or look up and inwards."""
    for face in faces:
        if face[1, 1] < face[0, 1] - LEVEL * arch.thickness:
            raise InputError(
                "arch", arch.name, "one whose springings do not lean in over the opening"
            )


def skewback(name: str, face: Array, edge: float, arch: ArchKind) -> list[Body]:
    """Make the block between the level head of a pier and an inclined springing."""
    (inner, low), (outer, high) = face.tolist()
    if high - low <= LEVEL * arch.thickness:
        return []
    corners = [[inner, low], [edge, low], [edge, high], [outer, high]]
    if abs(edge - outer) <= LEVEL * arch.thickness:
        corners = corners[:3]
    turned = np.array(corners)[:: 1 if edge > inner else -1]
    return [Body(polygons=(turned,), name=f"{name} skewback", depth=arch.depth)]
