"""Rigid blocks, who touches whom, and what is fixed: nothing here knows of arches."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.rows import Rows, column
from blocksim.common.checks import COORDINATE, INERTIA, LENGTH, MASS
from blocksim.common.errors import InputError

Array = NDArray[np.float64]

SUPPORT = -1
"""Block index that stands for the fixed ground."""
FEWEST_CORNERS = 3
FLAT = 1e-6
"""How far a polygon may fold inwards and still count as convex, over twice its area."""
PLANAR, SPATIAL = 3, 6
"""Columns of poses and motions: x, y and rotation in the plane; then z, out of it, and the
rotation vector's components along x and y, from engines in three dimensions."""


def frozen(values: object, shape: tuple[int, ...]) -> Array:
    """Return a read-only float array of the given shape (-1 first: any length)."""
    array = np.array(values, dtype=np.float64)
    if array.shape != shape and (
        array.ndim != len(shape) or shape[0] != -1 or array.shape[1:] != shape[1:]
    ):
        message = f"expected an array of shape {shape}, got {array.shape}"
        raise ValueError(message)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Block:
    """A rigid block in the plane: a convex polygon, or several that move as one.

    Parameters
    ----------
    vertices : (k, 2) float
        Corners, counter-clockwise, x and y [m]; of several polygons their convex hull.
    centre : (2,) float
        Centre of mass [m]; it follows from the weight model and need not be the
        centroid of the polygon.
    mass : float
        [kg]
    inertia : float
        Moment of inertia about the centre of mass [kg m^2].
    depth : float
        Out of the plane [m].
    name : str
        What it is called where it comes from a file.
    parts : tuple of (k, 2) float
        The convex polygons of a block that is not convex; empty for one polygon.
    """

    vertices: Array
    centre: Array
    mass: float
    inertia: float
    depth: float
    name: str = ""
    parts: tuple[Array, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers, make the arrays read-only and corners counter-clockwise."""
        for field, known in (("mass", MASS), ("inertia", INERTIA), ("depth", LENGTH)):
            if not known.has(value := getattr(self, field)):
                raise InputError(self._called(field), value, known.words)
        vertices = frozen(self.vertices, (-1, 2))
        corners, most = vertices.tolist(), COORDINATE.high
        if not all(-most <= x <= most and -most <= y <= most for x, y in corners):
            raise InputError(self._called("vertices"), corners, COORDINATE.words)
        area, folds = _outline(corners)
        if area == 0 or folds:
            allowed = "three corners or more around a convex area"
            raise InputError(self._called("vertices"), corners, allowed)
        if area < 0:
            vertices = frozen(vertices[::-1], (-1, 2))
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "centre", frozen(self.centre, (2,)))
        if self.parts:
            parts = tuple(frozen(part, (-1, 2)) for part in self.parts)
            object.__setattr__(self, "parts", parts)

    def _called(self, field: str) -> str:
        return f"block {self.name}: {field}" if self.name else field

    @property
    def polygons(self) -> tuple[Array, ...]:
        """The convex polygons it consists of."""
        return self.parts or (self.vertices,)


def _outline(corners: list[list[float]]) -> tuple[float, bool]:
    """Return twice the area of a polygon, and whether it folds inwards or has no numbers."""
    if len(corners) < FEWEST_CORNERS:
        return 0.0, True
    (x0, y0), (x1, y1), (x2, y2) = corners[0], corners[-2], corners[-1]
    turns: list[float] = []
    area = 0.0
    for x3, y3 in corners:
        area += (x2 - x0) * (y3 - y0) - (x3 - x0) * (y2 - y0)
        turns.append((x2 - x1) * (y3 - y2) - (y2 - y1) * (x3 - x2))
        x1, y1, x2, y2 = x2, y2, x3, y3
    if not math.isfinite(area):
        return 0.0, True
    slack = FLAT * abs(area)
    return area, min(turns) < -slack and max(turns) > slack


def _mean(corners: list[list[float]]) -> tuple[float, float]:
    x, y = zip(*corners, strict=True)
    return sum(x) / len(x), sum(y) / len(y)


@dataclass(frozen=True, eq=False)
class Support:
    """A body that stays where it is.

    Parameters
    ----------
    polygons : tuple of (k, 2) float
        Convex, corners counter-clockwise [m].
    name : str
        What it is called where it comes from a file.
    """

    polygons: tuple[Array, ...]
    name: str = ""

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        object.__setattr__(
            self, "polygons", tuple(frozen(part, (-1, 2)) for part in self.polygons)
        )


@dataclass(frozen=True, eq=False)
class Joint:
    """A straight dry joint between two blocks, or between a block and the support.

    Parameters
    ----------
    before, after : int
        Indices of the blocks on its two sides, `SUPPORT` for the ground.
    inner, outer : (2,) float
        Its two ends [m]: intrados and extrados for an arch. Seen along the
        direction from `before` to `after`, `inner` lies to the right.
    friction : float or None
        Its own friction coefficient, where it is not that of all others: 0 on a plane of
        symmetry, which is smooth.
    across : (2,) float or None
        Unit normal from `before` to `after`, of a corner that rests on a face: its two
        ends are the same point, and it has no length.
    faces : (2, 2, 2) float or None
        Inner and outer end [m] of the faces of `before` and of `after` that meet in it,
        where a face reaches beyond the joint.
    support : int or None
        Which of the assembly's supports it lies on, where they are known.
    gap : float
        How far apart the faces are drawn that it closes, below 0 where they overlap [m]; 0
        where they lie on each other.
    """

    before: int
    after: int
    inner: Array
    outer: Array
    friction: float | None = None
    across: Array | None = None
    faces: Array | None = None
    support: int | None = None
    gap: float = 0.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        object.__setattr__(self, "inner", frozen(self.inner, (2,)))
        object.__setattr__(self, "outer", frozen(self.outer, (2,)))
        if self.across is not None:
            object.__setattr__(self, "across", frozen(self.across, (2,)))
        if self.faces is not None:
            object.__setattr__(self, "faces", frozen(self.faces, (2, 2, 2)))

    @property
    def is_corner(self) -> bool:
        """Whether it is a corner on a face: a contact without length."""
        return self.across is not None

    @property
    def length(self) -> float:
        """Length of the joint [m]."""
        return float(np.hypot(*(self.outer - self.inner)))

    @property
    def tangent(self) -> Array:
        """Unit vector from the inner to the outer end, shape (2,)."""
        if self.across is not None:
            return np.array([-self.across[1], self.across[0]])
        return (self.outer - self.inner) / self.length

    @property
    def normal(self) -> Array:
        """Unit normal, from `before` to `after`, shape (2,)."""
        along = self.tangent
        return np.array([along[1], -along[0]])

    @property
    def turned(self) -> Joint:
        """The same joint with its ends exchanged, and so its normal the other way."""
        return replace(
            self,
            inner=self.outer,
            outer=self.inner,
            across=None if self.across is None else -self.across,
            faces=None if self.faces is None else self.faces[:, ::-1],
        )

    @property
    def bears(self) -> int:
        """The block that stands on it, where it is one with the support."""
        return self.before if self.after == SUPPORT else self.after


class JointArrays(NamedTuple):
    """All joints of an assembly at once, lengths in units of its size.

    Parameters
    ----------
    before, after : (joints,) int
        Indices of the blocks, `SUPPORT` for the ground.
    ends : (joints, 2, 2) float
        Inner and outer end.
    normal, tangent : (joints, 2) float
    length : (joints,) float
    friction : (joints,) float
        Of each joint's own; nan where it is that of all others.
    faces : (joints, 2, 2, 2) float
        Faces of `before` and `after`, their inner and outer ends.
        A corner's are that which carries it, and twice the corner.
    is_corner : (joints,) bool
    carrier : (joints,) int
        Whose face carries a corner: 0 that of `before`, 1 that of `after`.
    """

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    ends: Array
    normal: Array
    tangent: Array
    length: Array
    friction: Array
    faces: Array
    is_corner: NDArray[np.bool_]
    carrier: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Assembly:
    """Blocks and the joints between them.

    Parameters
    ----------
    blocks : sequence of Block
    joints : sequence of Joint
        Normals of `Rows` lead from `before` to `after`; others are turned where they do not.
    size : float
        A characteristic length [m]; engines work in units of it.
    supports : tuple of Support
        The bodies it stands on, where they are known.
    """

    blocks: Sequence[Block]
    joints: Sequence[Joint]
    size: float
    supports: tuple[Support, ...] = ()

    def __post_init__(self) -> None:
        """Turn joints round whose ends are exchanged: normals lead from `before` to `after`."""
        LENGTH.require("size", self.size)
        if isinstance(self.joints, Rows):
            return
        middles = [_mean(block.vertices.tolist()) for block in self.blocks]
        joints = list(self.joints)
        for index, joint in enumerate(self.joints):
            (x1, y1), (x2, y2) = joint.inner.tolist(), joint.outer.tolist()
            across = (y2 - y1, x1 - x2) if joint.across is None else joint.across.tolist()
            ahead: set[bool] = set()
            for side, sign in ((joint.before, -1.0), (joint.after, 1.0)):
                if side != SUPPORT and not self.blocks[side].parts:
                    x, y = middles[side]
                    away = across[0] * (x - (x1 + x2) / 2) + across[1] * (y - (y1 + y2) / 2)
                    ahead.add(sign * away > 0)
            # Blocks that are hulls of others may lie on both sides: then it is left as given.
            if ahead == {False}:
                joints[index] = joint.turned
        object.__setattr__(self, "joints", tuple(joints))

    @classmethod
    def of_polygons(
        cls,
        polygons: Sequence[ArrayLike],
        *,
        fixed: Collection[int],
        weights: Sequence[float] | None = None,
        centres: Sequence[ArrayLike] | None = None,
        density: float = 1.0,
    ) -> Assembly:
        """Find the joints of polygons; see `polygons.assembly_of_polygons`."""
        # Imported here: that module builds on this one.
        from blocksim.blocks.polygons import assembly_of_polygons

        return assembly_of_polygons(
            polygons, fixed=fixed, weights=weights, centres=centres, density=density
        )

    @property
    def friction(self) -> Array:
        """Friction coefficient of each joint, (joints,); nan where it has none of its own."""
        return self.joint_arrays.friction

    @cached_property
    def centres(self) -> Array:
        """Centres of mass, shape (blocks, 2) [m]."""
        return frozen(column(self.blocks, "centre"), (-1, 2))

    @cached_property
    def masses(self) -> Array:
        """Mass, mass and inertia of each block, in units of the mean mass and the size.

        Shape (blocks, 3), to go with motions x, y and rotation.
        """
        mass = np.array(column(self.blocks, "mass"))
        inertia = np.array(column(self.blocks, "inertia")) / self.size**2
        found = np.column_stack([mass, mass, inertia])
        return frozen(found / mass.mean(), (-1, 3))

    @cached_property
    def spatial_masses(self) -> Array:
        """The same for motions in three dimensions, shape (blocks, 6).

        The moment of inertia in the plane is shared equally by the two axes in it, to
        which the depth adds its part.
        """
        mass, inertia = self.masses[:, 0], self.masses[:, 2]
        across = inertia / 2 + mass * self.depths**2 / 12
        beyond = np.stack([mass, across, across], axis=1)
        return frozen(np.hstack([self.masses, beyond]), (-1, SPATIAL))

    @cached_property
    def depths(self) -> Array:
        """Depth of each block, shape (blocks,), in units of the size."""
        return frozen(np.array(column(self.blocks, "depth")) / self.size, (-1,))

    @cached_property
    def reach(self) -> Array:
        """Largest distance of a corner from the centre of mass, shape (blocks,) [m]."""
        outlines = column(self.blocks, "vertices")
        count = np.array([len(corners) for corners in outlines])
        x, y = (np.concatenate(outlines) - np.repeat(self.centres, count, axis=0)).T
        return frozen(np.maximum.reduceat(np.hypot(x, y), count.cumsum() - count), (-1,))

    @cached_property
    def built(self) -> Array:
        """Poses as built, in units of the size; then that of the ground, index `SUPPORT`.

        Shape (blocks + 1, 3).
        """
        poses = np.zeros((len(self.blocks) + 1, PLANAR))
        poses[:-1, :2] = self.centres / self.size
        return frozen(poses, (-1, PLANAR))

    @cached_property
    def sides(self) -> NDArray[np.int64]:
        """Blocks before and after each joint, shape (2, joints)."""
        sides = [column(self.joints, "before"), column(self.joints, "after")]
        return np.array(sides, dtype=np.int64)

    @cached_property
    def joint_arrays(self) -> JointArrays:
        """The joints gathered into arrays, for what looks at them frame by frame."""
        joints = self.joints
        ends = np.array([column(joints, "inner"), column(joints, "outer")], np.float64)
        ends = ends.reshape(2, -1, 2).transpose(1, 0, 2)
        own = [np.nan if each is None else each for each in column(joints, "friction")]
        is_corner = np.array([each is not None for each in column(joints, "across")], np.bool_)
        given = np.array([each is not None for each in column(joints, "faces")], np.bool_)
        faces = np.repeat(ends[:, None], 2, axis=1)
        way = ends[:, 1] - ends[:, 0]
        length = np.hypot(way[:, 0], way[:, 1])
        tangent = way / np.where(is_corner, 1.0, length)[:, None]
        for index in np.flatnonzero(is_corner | given).tolist():
            faces[index], tangent[index] = self._faces(joints[index]), joints[index].tangent
        at_corner = (faces[:, 0, 0] == faces[:, 0, 1]).all(axis=1)
        return JointArrays(
            before=self.sides[0],
            after=self.sides[1],
            ends=frozen(ends / self.size, (-1, 2, 2)),
            normal=frozen(tangent[:, ::-1] * [1.0, -1.0], (-1, 2)),
            tangent=frozen(tangent, (-1, 2)),
            length=frozen(length / self.size, (-1,)),
            friction=frozen(own, (-1,)),
            faces=frozen(faces / self.size, (-1, 2, 2, 2)),
            is_corner=is_corner,
            carrier=(is_corner & at_corner).astype(np.int64),
        )

    @cached_property
    def joint_arms(self) -> Array:
        """From the centres of the blocks before and after joints to their ends.

        Shape (2 sides, joints, 2 ends, 2), in units of the size; from the origin for the
        ground.
        """
        arms = self.joint_arrays.ends - self.built[self.sides, None, :2]
        return frozen(arms, arms.shape)

    def _faces(self, joint: Joint) -> Array:
        """Return the faces of `before` and `after` that meet in a joint [m]."""
        given = joint.faces
        if joint.across is None:
            return np.array([(joint.inner, joint.outer)] * 2) if given is None else given
        if given is not None and (given[:, 0] != given[:, 1]).any():
            return given
        # Imported here: that module builds on this one.
        from blocksim.blocks.corners import carrying_faces

        bodies = [self.polygons_at(joint, side) for side in (0, 1)]
        return carrying_faces(joint.inner, joint.across, bodies, self.size)

    def polygons_at(self, joint: Joint, side: int) -> tuple[Array, ...]:
        """Polygons [m] of the body before (0) or after (1) a joint; none if not known."""
        body = (joint.before, joint.after)[side]
        if body != SUPPORT:
            return self.blocks[body].polygons
        if joint.support is not None and self.supports:
            return self.supports[joint.support].polygons
        return tuple(polygon for support in self.supports for polygon in support.polygons)

    @property
    def joint_angles(self) -> Array:
        """Directions of the joints from the vertical, shape (joints,) [rad]."""
        x, y = self.joint_arrays.tangent.T
        return np.arctan2(x, y)

    @cached_property
    def springings(self) -> tuple[Joint, ...]:
        """The joints with the support."""
        ground = (self.joint_arrays.before == SUPPORT) | (self.joint_arrays.after == SUPPORT)
        return tuple(self.joints[index] for index in np.flatnonzero(ground).tolist())

    @property
    def shortest(self) -> float:
        """Length of the shortest joint, in units of the size; corners have none."""
        joints = self.joint_arrays
        lengths = joints.length[~joints.is_corner]
        return float(lengths.min()) if len(lengths) else 1.0


def displacement(moved: Array, assembly: Assembly) -> Array:
    """Bound of the displacement of any corner, from those of the centres.

    Parameters
    ----------
    moved : (..., blocks, 3 or 6) float
        Displacements of the centres, in units of the size, and rotations.
    assembly : Assembly

    Returns
    -------
    (...) float
        Largest over the blocks of the translation or the corner's way by rotation.
    """
    reach = (assembly.reach / assembly.size) ** 2
    square = moved**2
    shift, turn = square[..., 0] + square[..., 1], square[..., 2] * reach
    if moved.shape[-1] == SPATIAL:
        # About an axis in the plane a corner's lever has half the depth, too.
        shift = shift + square[..., 3]
        turn = turn + (square[..., 4] + square[..., 5]) * (reach + (assembly.depths / 2) ** 2)
    return np.sqrt(np.maximum(shift, turn)).max(axis=-1)
