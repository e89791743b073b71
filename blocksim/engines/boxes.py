"""Where blocks lie in a three-dimensional engine, and the boxes on their faces."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.engines.faces import LEDGE, Side, sides_of

PLATE = 0.15
"""Thickness of the box on a face, in units of the block's extent normal to it."""
THINNEST = 2e-4
"""Least thickness of the box on a face [size]."""
ROD = 1e-4
"""Thickness of the rod in a corner [size]."""
FLAT = 1e-9
"""Distance within which sides lie on each other."""
FLUSH = 0.1
"""Sine of the angle between two sides that do not end each other."""
TRIM = 3e-4
"""How far one side of a joint ends short of the other where neither may reach beyond it, in
units of the joint's length."""


class Frame:
    """Where the plane of the assembly lies in the engine's space.

    Parameters
    ----------
    turn : float, optional
        About the vertical [rad].
    origin : tuple of float, optional
        Place of the assembly's origin [size].
    """

    def __init__(
        self, turn: float = 0.0, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> None:
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
    """A box in the frame of its body: half extents, centre, orientation."""

    half: list[float]
    centre: list[float]
    quaternion: list[float]


def plate(
    side: Side, depth: float, origin: Array, overlap: float, thickness: float | None = None
) -> Box:
    """Return the box on one side of a joint; a thin rod for a corner.

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
    if side.is_corner:
        length = thick = ROD
        along = np.array([-side.inward[1], side.inward[0]])
    centre = side.ends.mean(axis=0) + side.inward * (thick - overlap) / 2 - origin
    angle = math.atan2(along[1], along[0])
    return Box(
        half=[length / 2, thick / 2, depth / 2],
        centre=[*centre.tolist(), 0.0],
        quaternion=[0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)],
    )


def uneven_depths(assembly: Assembly) -> Array:
    """Depths of blocks, of two that touch one a little more, shape (blocks,), scaled."""
    joints = assembly.joint_arrays
    rank = np.zeros(len(assembly.blocks))
    near: dict[int, set[int]] = defaultdict(set)
    for one, other in zip(joints.before.tolist(), joints.after.tolist(), strict=True):
        near[one].add(other)
        near[other].add(one)
    for index in range(len(rank)):
        taken = {rank[other] for other in near[index] if 0 <= other < index}
        rank[index] = next(k for k in itertools.count() if k not in taken)
    return assembly.depths + 2 * LEDGE * rank / max(1.0, rank.max())


def support_of(joint: int) -> int:
    """Return a name for what bears a joint with the support."""
    return -1 - joint


def snug(assembly: Assembly) -> dict[int, list[tuple[Side, float, float]]]:
    """Return what touches on each body, so that nothing else of it touches its neighbours.

    For an engine in which all parts of two blocks that share a joint may touch. A side keeps
    within its block: it reaches beyond the joint where it meets nothing there, and otherwise
    falls a little short of the other; where another joint of the block comes near at an acute
    angle its box is thin, and ends where the block is as wide. A face is one side, however
    many joints there are on it.

    Returns
    -------
    dict of int to list of (Side, float, float)
        Of each block, and of what bears each joint with the support (`support_of`): sides,
        how thick their boxes are, and how deep. Of two sides that are alone with each other
        the longer is deeper, too: Bullet's forces are a hundredth off where boxes cross.
    """
    pairs = sides_of(assembly)
    of_body: dict[int, list[Side]] = defaultdict(list)
    near: dict[int, set[int]] = defaultdict(set)
    names = [
        [support_of(index) if side.body == SUPPORT else side.body for side in sides]
        for index, sides in enumerate(pairs)
    ]
    for its, sides in zip(names, pairs, strict=True):
        for name, other, side in zip(its, its[::-1], sides, strict=True):
            of_body[name].append(side)
            near[name].add(other)

    def meets(name: int, stretch: Array, joint: int) -> bool:
        """Tell whether a ledge comes near anything of the body's neighbours."""
        off = float(np.hypot(*(stretch[1] - stretch[0]))) / 20
        others = (side for other in near[name] for side in of_body[other])
        return any(_apart(stretch, side) < off for side in others if side.joint != joint)

    kept: dict[int, list[Side]] = defaultdict(list)
    cut: list[list[Side]] = []
    for index, sides in enumerate(pairs):
        ends = _without_ledges(assembly, index, sides, names[index], meets)
        cut.append([replace(side, ends=its) for side, its in zip(sides, ends, strict=True)])
        for name, side in zip(names[index], cut[-1], strict=True):
            kept[name].append(side)
    faces = {name: _as_faces(sides) for name, sides in kept.items()}
    uneven = uneven_depths(assembly)

    def depth(name: int, side: Side) -> float:
        """Return how deep the box on a face is."""
        joint = side.joint
        if name < 0:
            return 2 * float(uneven[assembly.joints[joint].bears])
        its = zip(names[joint], cut[joint], strict=True)
        alone = all(any(face is each for face in faces[which]) for which, each in its)
        shorter, longer = sorted(_length(each) for each in cut[joint])
        if not alone or shorter == longer:
            return float(uneven[name])
        return float(assembly.depths[name]) + 2 * LEDGE * (_length(side) == longer)

    return {
        name: [(*_within(side, kept[name]), depth(name, side)) for side in its]
        for name, its in faces.items()
    }


def _without_ledges(
    assembly: Assembly,
    index: int,
    sides: tuple[Side, Side],
    names: list[int],
    meets: Callable[[int, Array, int], bool],
) -> list[Array]:
    """Return the ends of both sides of a joint, without ledges that meet anything."""
    joints = assembly.joint_arrays
    along, length = joints.tangent[index], float(joints.length[index])
    ends = [side.ends.copy() for side in sides]
    for end, outward in enumerate((-along, along)):
        true = joints.ends[index, end]
        reach = [float((its[end] - true) @ outward) for its in ends]
        longer = int(reach[1] > reach[0])
        # Where a face goes on beyond the joint there is no ledge.
        if reach[1 - longer] > 0 or length == 0 or reach[longer] > 2 * LEDGE:
            continue
        if meets(names[longer], np.array([true, ends[longer][end]]), index):
            ends[longer][end] = true
            ends[1 - longer][end] = true - TRIM * length * outward
    return ends


def _as_faces(sides: list[Side]) -> list[Side]:
    """Join sides of a body that lie on each other, as joints on one face do."""
    kept: list[Side] = []
    for side in sides:
        for index, other in enumerate(kept):
            along = np.array([-other.inward[1], other.inward[0]])
            arms = side.ends - other.ends[0]
            flat = np.abs(arms @ other.inward).max() < FLAT
            if side.is_corner or other.is_corner or not flat or side.inward @ other.inward < 0:
                continue
            where, own = np.sort(side.ends @ along), np.sort(other.ends @ along)
            if min(where[1], own[1]) <= max(where[0], own[0]):
                continue
            # Ends that differ by no more than ledges are those of one face.
            one_face = np.abs(where - own) < LEDGE
            low = (max if one_face[0] else min)(where[0], own[0])
            high = (min if one_face[1] else max)(where[1], own[1])
            origin = other.ends[0] - along * (other.ends[0] @ along)
            sense = 1 if (other.ends[1] - other.ends[0]) @ along > 0 else -1
            kept[index] = replace(other, ends=(origin + np.outer([low, high], along))[::sense])
            break
        else:
            kept.append(side)
    return kept


def _length(side: Side) -> float:
    return float(np.hypot(*(side.ends[1] - side.ends[0])))


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


def _within(side: Side, sides: list[Side]) -> tuple[Side, float]:
    """Cut the box on a side so that it stays within the other sides of its body."""
    others = [each for each in sides if abs(each.inward @ side.inward) < 1 - FLAT]
    if side.is_corner:
        return replace(side, ends=side.ends + _aside(side, others)), ROD
    ends = [point for each in others for point in each.ends]
    narrowest = min((_off(end, side.ends) for end in ends), default=math.inf)
    thickness = min(PLATE * side.room, max(narrowest / 2, THINNEST))
    if any(_cuts(side, others, thickness)):
        thickness = min(thickness, THINNEST)
    cuts = _cuts(side, others, thickness)
    along = side.ends[1] - side.ends[0]
    along = along / np.hypot(*along)
    ends = side.ends + np.array([[cuts[0]], [-cuts[1]]]) * along
    return replace(side, ends=ends), thickness


def _aside(side: Side, others: list[Side]) -> Array:
    """Return by how much the rod in a corner must be off it, to stay within other sides."""
    inward = side.inward
    along = np.array([-inward[1], inward[0]])
    low, high = -math.inf, math.inf
    for other in others:
        rise = float(along @ other.inward)
        if other.is_corner or abs(rise) < FLUSH or _off(side.ends[0], other.ends) > 2 * ROD:
            continue
        # The farthest corner of the rod.
        far = ROD / 2 * abs(rise) + ROD * max(0.0, -float(inward @ other.inward))
        bound = (far - float((side.ends[0] - other.ends[0]) @ other.inward)) / rise
        low, high = (max(low, bound), high) if rise > 0 else (low, min(high, bound))
    return along * max(low, min(0.0, high))


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
