"""What an engineer measures on the drawing, and in what: metres, kilonewtons over the depth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.circular import CircularArch

OFF, ARC_OFF = 8.0, 6.0
"""Distances of dimension lines from what is drawn, on paper [mm]."""
EVEN = 1e-6
"""Share of a length by which others may differ from it and still count as the same."""
QUARTER = 0.25
"""Share of the arch, from its left end, at which the thickness is measured."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Length:
    """A length between two points, measured along a direction.

    `what`: span, rise, thickness, width or height.
    `ends`, pair of (2,): The points [m].
    `at`, (2,): A point of the dimension line [m].
    `along`, (2,): Its direction, from start to end.
    `note`: What it is a dimension of.
    """

    what: str
    ends: tuple[Array, Array]
    at: Array
    along: Array
    note: str = ""

    @property
    def value(self) -> float:
        """The length [m]."""
        return float((self.ends[1] - self.ends[0]) @ self.along)

    @property
    def words(self) -> str:
        """Words on the drawing."""
        said = f"{self.what} {length_words(self.value)}"
        return f"{said} ({self.note})" if self.note else said

    @property
    def line(self) -> Array:
        """The ends of the dimension line, (2, 2) [m]."""
        feet = [self.at + ((end - self.at) @ self.along) * self.along for end in self.ends]
        return np.array(feet)


@dataclass(frozen=True, kw_only=True, eq=False)
class Angle:
    """The half-angle [rad], right of the crown: an arc, and leads from `reach` on [m]."""

    centre: Array
    radius: float
    reach: float
    value: float
    what: str = "half-angle"

    @property
    def words(self) -> str:
        """Words on the drawing."""
        return f"\N{GREEK SMALL LETTER ALPHA} = {math.degrees(self.value):.4g}°"

    def point(self, share: float, radius: float | None = None) -> Array:
        """Return the point at a share of the angle from the crown [m]."""
        turn = share * self.value
        far = self.radius if radius is None else radius
        return self.centre + far * np.array([math.sin(turn), math.cos(turn)])


def dimensions_of(problem: Problem, shown: Array, scale: float) -> list[Length | Angle]:
    """Choose what is measured on the drawing of a problem.

    `shown`, (k, 2): Points of what is drawn [m]; dimension lines of the whole are beyond.
    `scale`: Of the drawing: a millimetre on paper is so many millimetres.
    """
    if problem.is_arch:
        return _of_arch(problem, shown, scale)
    low, high = shown.min(axis=0), shown.max(axis=0)
    away = OFF * scale / 1e3
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    least, most = corners.min(axis=0), corners.max(axis=0)
    top = np.array([least[0], high[1] + away])
    left = np.array([low[0] - away, least[1]])
    return [
        Length(
            what="width",
            ends=(corners[corners[:, 0].argmin()], corners[corners[:, 0].argmax()]),
            at=top,
            along=np.array([1.0, 0.0]),
        ),
        Length(
            what="height",
            ends=(
                corners[corners[:, 1].argmin()],
                np.array([corners[corners[:, 1].argmax(), 0], most[1]]),
            ),
            at=left,
            along=np.array([0.0, 1.0]),
        ),
    ]


def _of_arch(problem: Problem, shown: Array, scale: float) -> list[Length | Angle]:
    joints = problem.assembly.joints
    inner = np.array([joint.inner for joint in joints])
    left, right = inner[0], inner[-1]
    level, middle = min(float(left[1]), float(right[1])), float(inner[:, 0].mean())
    crown = inner[inner[:, 1].argmax()]
    found: list[Length | Angle] = []
    if right[0] - left[0] > EVEN * problem.assembly.size:
        found.append(
            Length(
                what="span",
                ends=(left, right),
                at=np.array([middle, level]),
                along=np.array([1.0, 0.0]),
                note="intrados",
            )
        )
    top = _top(problem, crown)
    if top[1] - level > EVEN * problem.assembly.size:
        found.append(
            Length(
                what="rise",
                ends=(np.array([top[0], level]), top),
                at=top,
                along=np.array([0.0, 1.0]),
                note="intrados",
            )
        )
    found += _thickness(problem)
    return found + _half_angle(problem, shown, scale)


def _top(problem: Problem, crown: Array) -> Array:
    """Highest point of the intrados, which the chord of a keystone is below [m]."""
    kind = problem.maker
    if isinstance(kind, CircularArch) and min(kind.left_deg, kind.right_deg) >= 0:
        return np.array([0.0, kind.radius - kind.thickness / 2])
    return crown


def thickness_of(problem: Problem) -> float | None:
    """Thickness of an arch that is as thick everywhere [m]."""
    kind = problem.maker
    return kind.thickness if isinstance(kind, CurvedArch) else None


def _thickness(problem: Problem) -> list[Length | Angle]:
    thickness, joints = thickness_of(problem), problem.assembly.joints
    if thickness is None:
        return []
    # At a joint square to the centreline: of vertical ones those at the springings are.
    count = len(joints) - 1
    for place in (round(QUARTER * count), 0):
        joint = joints[place]
        if abs(joint.length - thickness) < EVEN * thickness:
            return [
                Length(
                    what="thickness",
                    ends=(joint.inner, joint.outer),
                    at=joint.inner,
                    along=joint.tangent,
                )
            ]
    return []


def half_angle_of(problem: Problem) -> float | None:
    """Half-angle of embrace of a symmetric circular arch [rad]."""
    kind = problem.maker
    if isinstance(kind, CircularArch) and kind.left_deg == kind.right_deg:
        return kind.half_angle or math.radians(kind.right_deg)
    return None


def _half_angle(problem: Problem, shown: Array, scale: float) -> list[Length | Angle]:
    angle = half_angle_of(problem)
    if angle is None:
        return []
    outer = float(np.hypot(*problem.assembly.joints[-1].outer))
    # Beyond what moves, too.
    at = np.arctan2(shown[:, 0], shown[:, 1])
    far = np.hypot(*shown[(at >= 0) & (at <= angle)].T).max(initial=outer)
    radius = float(far) + ARC_OFF * scale / 1e3
    return [Angle(centre=np.zeros(2), radius=radius, reach=outer, value=angle)]


KILO = 1e3


@dataclass(frozen=True, kw_only=True)
class ForceUnit:
    """A unit of force in N, over the depth where all blocks have the same, and a note."""

    newtons: float
    name: str
    note: str = ""

    def number(self, newtons: float) -> str:
        """Return a force of so many newtons without its unit."""
        return number(newtons / self.newtons)

    def words(self, newtons: float) -> str:
        """Return a force of so many newtons with its unit."""
        return f"{self.number(newtons)} {self.name}"


def force_unit(problem: Problem[Any]) -> ForceUnit:
    """Choose in what the forces of a problem are told."""
    depth = common_depth(problem)
    over, per = (1.0, "") if depth is None else (depth, "/m")
    if unit_weight(problem) is None:
        note = "weights are for 1 N/m\N{SUPERSCRIPT THREE}: no unit weight was given"
        return ForceUnit(newtons=over, name=f"N{per}", note=note)
    heavy = problem.unit_force * len(problem.assembly.blocks) / over >= KILO
    return ForceUnit(newtons=over * (KILO if heavy else 1.0), name=f"{'k' * heavy}N{per}")


def common_depth(problem: Problem[Any]) -> float | None:
    """Return the depth that all blocks of the plane have [m], or None."""
    if problem.in_space:
        return None
    depths = problem.assembly.depths * problem.assembly.size
    return float(depths[0]) if np.ptp(depths) <= 1e-9 * depths.max() else None


def unit_weight(problem: Problem[Any]) -> float | None:
    """Return the median unit weight of the blocks [N/m^3], or None where none was given."""
    if not problem.weighed:
        return None
    if problem.maker is not None:
        return problem.maker.unit_weight
    return float(np.median(problem.assembly.weights / problem.assembly.volumes))


def number(value: float) -> str:
    """Return a number in four digits, without an exponent."""
    size = abs(value)
    if size >= KILO:
        return f"{value:.0f}"
    if size < 1e-9:
        return "0"
    return f"{value:#.4g}".rstrip(".") if size >= 1e-3 else f"{value:.3g}"


def length_words(metres: float) -> str:
    """Return a length, to the millimetre where it is one of buildings."""
    return f"{metres:.3f} m" if metres >= 0.1 else f"{metres:.4g} m"
