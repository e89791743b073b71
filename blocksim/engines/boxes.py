"""Where blocks lie in a three-dimensional engine, and the boxes on their faces."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.engines.faces import LEDGE, Side, sides_of

PLATE = 0.15
"""Thickness of the box on a face, in units of the block's extent normal to it."""
THINNEST = 2e-4
"""Least thickness of the box on a face [size]."""
BALL = 2e-4
"""Radius of the balls at the two ends of a corner [size]."""
TRIM = 3e-4
"""How far one side of a joint ends short of the other where neither may reach beyond it, in
units of the joint's length."""


class Frame:
    """Where the plane of the assembly lies in the engine's space.

    Parameters
    ----------
    turn : float
        About the vertical [rad].
    origin : tuple of float
        Place of the assembly's origin [size].
    """

    def __init__(self, turn: float, origin: tuple[float, float, float]) -> None:
        self._turned = Rotation.from_rotvec([0.0, turn, 0.0])
        self._origin = np.array(origin)

    def vector(self, x: float, y: float, z: float) -> list[float]:
        """Turn a vector of the plane, z out of it, into the engine's space."""
        turned: list[float] = self._turned.apply([x, y, z]).tolist()
        return turned

    def place(self, centre: Array) -> list[float]:
        """Where a point of the plane lies, x, y, z."""
        x, y, z = self.vector(centre[0], centre[1], 0.0)
        return [x + self._origin[0], y + self._origin[1], z + self._origin[2]]

    @property
    def quaternion(self) -> list[float]:
        """How a block at rest is turned."""
        turned: list[float] = self._turned.as_quat().tolist()
        return turned

    def motions(self, linear: Array, angular: Array) -> Array:
        """Return velocities in the assembly's columns, shape (blocks, 6).

        Parameters
        ----------
        linear, angular : (blocks, 3) float
            In the engine's space.
        """
        back = self._turned.inv()
        shift, turn = back.apply(linear), back.apply(angular)
        return np.column_stack([shift[:, :2], turn[:, 2], shift[:, 2], turn[:, :2]])

    def point(self, place: Array) -> Array:
        """Where in the plane a place (3,) lies, x and y."""
        x, y, _ = self._turned.inv().apply(place - self._origin)
        return np.array([x, y])

    def wrench(self, place: Array, force: Array) -> Array:
        """Return a force (3,) at a place (3,) as x, y and moment in the plane, (3,)."""
        back = self._turned.inv()
        (x, y, _), (right, up, _) = back.apply([place - self._origin, force])
        return np.array([right, up, x * up - y * right])

    def poses(self, places: Array, quaternions: Array) -> Array:
        """Return places (blocks, 3) and orientations x, y, z, w (blocks, 4) likewise."""
        since = Rotation.from_quat(quaternions) * self._turned.inv()
        return self.motions(places - self._origin, since.as_rotvec())


@dataclass(frozen=True)
class Box:
    """A box in the frame of its body: half extents, centre, orientation.

    A corner is a box without extent but in depth, along which it is two balls.
    """

    half: list[float]
    centre: list[float]
    quaternion: list[float]

    @property
    def is_corner(self) -> bool:
        """Whether it is a corner on a face."""
        return self.half[0] == 0


def plate(
    side: Side, depth: float, origin: Array, overlap: float, thickness: float | None = None
) -> Box:
    """Return the box on one side of a joint.

    Parameters
    ----------
    side : Side
    depth : float
        How deep it is.
    origin : (2,) float
        Of its body.
    overlap : float
        Of two closed sides.
    thickness : float, optional
        By default a share of its body's.

    Returns
    -------
    Box
        Its first axis is the joint's tangent, and its last is the depth.
    """
    along = side.ends[1] - side.ends[0]
    length = float(np.hypot(*along))
    thick = max(PLATE * side.room, THINNEST) if thickness is None else thickness
    thick = 2 * BALL if side.is_corner else thick
    centre = side.ends.mean(axis=0) + side.inward * (thick - overlap) / 2 - origin
    angle = math.atan2(along[1], along[0])
    return Box(
        half=[length / 2, thick / 2, depth / 2],
        centre=[*centre.tolist(), 0.0],
        quaternion=[0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)],
    )


def depths(assembly: Assembly, sides: tuple[Side, Side]) -> tuple[float, float]:
    """Return how deep the two sides of a joint are: one reaches beyond the other."""
    bodies = [side.body for side in sides]
    if SUPPORT in bodies:
        depth = float(assembly.depths[max(bodies)])
        return (depth, 2 * depth) if bodies[1] == SUPPORT else (2 * depth, depth)
    first, second = assembly.depths[bodies].tolist()
    if sides[1].is_corner:
        return first + 2 * LEDGE, second
    return first, second + 2 * LEDGE


def snug(assembly: Assembly) -> list[tuple[tuple[Side, float], tuple[Side, float]]]:
    """Return what touches at each joint so that other sides of the same blocks do not.

    For an engine in which all parts of two blocks that share a joint may touch. A side keeps
    within its block: it reaches beyond the joint where it meets nothing there, and otherwise
    falls a little short of the other; where another joint of the block comes near at an acute
    angle its box is thin, and ends where the block is as wide.

    Returns
    -------
    list of ((Side, float), (Side, float))
        Sides before and after each joint, with the thickness of their boxes.
    """
    pairs = sides_of(assembly)
    of_body: dict[int, list[Side]] = defaultdict(list)
    near: dict[int, set[int]] = defaultdict(set)
    for index, sides in enumerate(pairs):
        # Each joint with the support has a body of its own there.
        names = [-1 - index if side.body == SUPPORT else side.body for side in sides]
        for name, other, side in zip(names, names[::-1], sides, strict=True):
            of_body[name].append(side)
            near[name].add(other)
    joints = assembly.joint_arrays
    found: list[tuple[tuple[Side, float], tuple[Side, float]]] = []
    for index, sides in enumerate(pairs):
        names = [-1 - index if side.body == SUPPORT else side.body for side in sides]
        ends = [side.ends.copy() for side in sides]
        along = joints.tangent[index]
        length = float(joints.length[index]) or LEDGE
        for end, outward in enumerate((-along, along)):
            reach = [
                float((side.ends[end] - joints.ends[index, end]) @ outward) for side in sides
            ]
            longer = int(reach[1] > reach[0])
            beyond = reach[longer]
            true = joints.ends[index, end]
            if reach[1 - longer] > 0 or sides[longer].is_corner:
                continue
            stretch = np.array([true + 0.1 * beyond * outward, true + beyond * outward])
            met = any(
                _apart(stretch, other) < beyond / 20
                for name in near[names[longer]]
                for other in of_body[name]
                if other.joint != index
            )
            if met and not sides[1 - longer].is_corner:
                ends[longer][end] = true
                ends[1 - longer][end] = true - TRIM * length * outward
        kept = [replace(side, ends=its) for side, its in zip(sides, ends, strict=True)]
        before, after = (
            _within(side, [each for each in of_body[name] if each.joint != index])
            for side, name in zip(kept, names, strict=True)
        )
        found.append((before, after))
    return found


def _apart(stretch: Array, side: Side) -> float:
    """Distance of a stretch from a side."""
    return min(
        *(_off(point, side.ends) for point in stretch),
        *(_off(point, stretch) for point in side.ends),
    )


def _off(point: Array, stretch: Array) -> float:
    """Distance of a point from a stretch."""
    way, arm = stretch[1] - stretch[0], point - stretch[0]
    square = float(way @ way)
    share = min(1.0, max(0.0, float(way @ arm) / square)) if square > 0 else 0.0
    return float(np.hypot(*(arm - share * way)))


def _within(side: Side, others: list[Side]) -> tuple[Side, float]:
    """Cut the box on a side so that it stays within the other sides of its body."""
    if side.is_corner:
        return side, 2 * BALL
    ends = [point for each in others for point in each.ends]
    narrowest = min((_off(end, side.ends) for end in ends), default=math.inf)
    thickness = min(PLATE * side.room, max(narrowest / 2, THINNEST))
    if any(_cuts(side, others, thickness)):
        thickness = min(thickness, THINNEST)
    cuts = _cuts(side, others, thickness)
    along = side.ends[1] - side.ends[0]
    length = float(np.hypot(*along))
    along = along / length
    ends = side.ends + np.array([[cuts[0]], [-cuts[1]]]) * along
    return replace(side, ends=ends), thickness


def _cuts(side: Side, others: list[Side], thickness: float) -> tuple[float, float]:
    """How far a box must end short of its side's ends, to stay within other sides."""
    along = side.ends[1] - side.ends[0]
    along = along / np.hypot(*along)
    found = [0.0, 0.0]
    for end, inwards in enumerate((along, -along)):
        corner = side.ends[end] + thickness * side.inward
        for other in others:
            rise = float(inwards @ other.inward)
            if other.is_corner or rise <= 0 or _off(side.ends[end], other.ends) > 2 * thickness:
                continue
            short = -float((corner - other.ends[0]) @ other.inward)
            found[end] = max(found[end], short / rise)
    return found[0], found[1]
