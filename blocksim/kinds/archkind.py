"""What all arches have in common: voussoirs along a centreline, joints, weights, springings."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.given import Body, GivenJoint
from blocksim.blocks.made import Fill, Made
from blocksim.blocks.maker import FARTHEST, Maker, count, metres, parameter
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.common.checks import VOUSSOIRS
from blocksim.common.errors import InputError
from blocksim.kinds.curves import Curve, Voussoirs, chords, strips, where

JOINTS = ("normal", "radial", "vertical")
FOOT = 0.5
"""Depth of the support drawn behind a springing, in thicknesses."""
NEARLY = 1 - 1e-9
"""Share of the thickness at which the intrados would fold that is allowed."""


@dataclass(frozen=True, kw_only=True)
class ArchKind(Maker):
    """An arch of voussoirs between two springings, which are fixed."""

    is_arch: ClassVar[bool] = True

    thickness: float = metres(0.2, "thickness, square to the centreline", stands="high")
    voussoirs: int = count(27, "number of voussoirs", low=2, high=VOUSSOIRS.high)
    depth: float = metres(1.0, "depth out of the plane")
    fill: float | None = parameter(
        None,
        "height of fill over the highest point of the extrados; none if left out",
        unit="m",
        high=FARTHEST,
        above=False,
        optional=True,
    )
    fill_density: float = parameter(
        1.0, "density of the fill over that of the blocks", high=1e3
    )

    @cached_property
    @abstractmethod
    def stones(self) -> Voussoirs:
        """Measure the voussoirs."""

    @property
    @abstractmethod
    def top(self) -> float:
        """Height of the highest point of the extrados [m]."""

    def bodies(self, density: float) -> list[Body]:
        """Return the voussoirs as bodies, named 1 to n from left to right."""
        stones, heavy = self.stones, density * self.depth
        return [
            Body(
                polygons=(corners,),
                name=str(index + 1),
                weight=heavy * area,
                centre=centre,
                inertia=heavy * polar / STANDARD_GRAVITY,
                depth=self.depth,
            )
            for index, (corners, area, centre, polar) in enumerate(
                zip(
                    stones.corners,
                    stones.area.tolist(),
                    stones.centre,
                    stones.polar.tolist(),
                    strict=True,
                )
            )
        ]

    def fills(self, density: float, first: int) -> list[Fill]:
        """Return the weight of the fill on each voussoir, the first of them body `first`."""
        if self.fill is None:
            return []
        stones = self.stones
        width, y_width, x_width, xy_width = stones.cover.T
        if (np.diff(stones.faces[:, 1, 0]) <= 0).any():
            allowed = "left out where the extrados turns back below itself"
            raise InputError("fill", self.fill, allowed)
        top = self.top + self.fill
        area = top * width - y_width
        middle = (top * x_width - xy_width) / area
        heavy = density * self.fill_density * self.depth
        height = stones.corners[:, 2:, 1].mean(axis=1)
        return [
            Fill(body=first + index, weight=heavy * each, point=(x, y))
            for index, (each, x, y) in enumerate(
                zip(area.tolist(), middle.tolist(), height.tolist(), strict=True)
            )
        ]

    def made(self, density: float) -> Made:
        """Make voussoirs, joints and fixed springings, `left` and `right`."""
        faces = self.stones.faces
        bodies = [
            _foot("left", faces[0], -1),
            *self.bodies(density),
            _foot("right", faces[-1], 1),
        ]
        joints = tuple(
            GivenJoint(a=index, b=index + 1, ends=face) for index, face in enumerate(faces)
        )
        fills = tuple(self.fills(density, 1))
        return Made(bodies=tuple(bodies), joints=joints, fills=fills)


def _foot(name: str, face: Array, side: int) -> Body:
    """Draw a support behind a springing: on the left (-1) or on the right (1)."""
    along = face[1] - face[0]
    out = FOOT * side * np.array([along[1], -along[0]])
    corners = np.array([*face, face[1] + out, face[0] + out])[::-side]
    return Body(polygons=(corners,), name=name, fixed=True)


@dataclass(frozen=True, kw_only=True)
class CurvedArch(ArchKind):
    """An arch along a curved centreline, as thick everywhere."""

    joints: Literal["normal", "radial", "vertical"] = parameter(
        "normal", "direction of the joints", choices=JOINTS
    )
    weight: Literal["curved", "chord", "centreline", "sector"] = parameter(
        "curved",
        "weight and centre of each voussoir: with curved faces, or with straight ones",
        choices=("curved", "chord"),
    )

    @abstractmethod
    def curve(self) -> Curve:
        """Return the centreline."""

    @property
    @abstractmethod
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the intrados of an arch too thick would fold."""
        low, high = super().limits(name)
        return (
            (low, min(high, 2 * self.tightest * NEARLY)) if name == "thickness" else (low, high)
        )

    @property
    def top(self) -> float:
        """Height of the highest point of the extrados [m]."""
        curve = self.curve()
        crown = where(lambda s: -curve.first(s)[1], np.zeros(1), curve.start, curve.end)
        return float(curve.point(crown, self.thickness / 2)[0, 1])

    def cuts(self, curve: Curve) -> tuple[Array, Array]:
        """Return parameters at which joints meet intrados and extrados.

        Springings are square to the centreline. Normal joints cut it into equal lengths,
        vertical ones the intrados into equal widths, radial ones into equal angles about
        the origin.
        """
        if self.joints == "normal" or (self.radial_is_normal and self.joints == "radial"):
            cuts = curve.equal_lengths(self.voussoirs)
            return cuts, cuts
        half = self.thickness / 2
        measure = _across if self.joints == "vertical" else _around
        ends = np.array([curve.start, curve.end])
        first, last = measure(curve.point(ends, -half)).tolist()
        share = np.arange(1, self.voussoirs) / self.voussoirs
        levels = first + (last - first) * share
        inner, outer = (
            np.concatenate(
                [
                    ends[:1],
                    where(
                        lambda s, at=offset: measure(curve.point(s, at)),
                        levels,
                        curve.start,
                        curve.end,
                    ),
                    ends[1:],
                ]
            )
            for offset in (-half, half)
        )
        least = 1e-9 * (curve.end - curve.start)
        if min(np.diff(inner).min(), np.diff(outer).min()) <= least:
            allowed = "normal, or fewer voussoirs: they would cut the springings"
            raise InputError("joints", self.joints, allowed)
        return inner, outer

    @property
    def radial_is_normal(self) -> bool:
        """Whether radial joints are the normal ones, as of circles."""
        return False

    @cached_property
    def stones(self) -> Voussoirs:
        """Measure the voussoirs."""
        curve = self.curve()
        found = strips(curve, self.thickness, *self.cuts(curve))
        return chords(found.corners) if self.weight == "chord" else found


def _across(points: Array) -> Array:
    return points[..., 0]


def _around(points: Array) -> Array:
    """Angle from the vertical through the origin."""
    return np.arctan2(points[..., 0], points[..., 1])
