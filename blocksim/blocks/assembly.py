"""Rigid blocks in the plane and the joints between them, as arrays."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.block import SUPPORT as SUPPORT
from blocksim.blocks.block import Array as Array
from blocksim.blocks.block import Block as Block
from blocksim.blocks.block import Joint as Joint
from blocksim.blocks.block import Support as Support
from blocksim.blocks.block import frozen as frozen
from blocksim.blocks.corners import carrying_faces
from blocksim.blocks.outlines import signed_area
from blocksim.blocks.rows import Rows, column
from blocksim.common.checks import LENGTH

if TYPE_CHECKING:
    from typing_extensions import TypeVar

    from blocksim.blocks.acting import Load
    from blocksim.blocks.space.assembly import SpatialAssembly

    Blocks = TypeVar("Blocks", bound="Assembly | SpatialAssembly", default="Assembly")
else:
    from typing import TypeVar

    Blocks = TypeVar("Blocks")


STANDARD_GRAVITY = 9.81
"""To turn weight into mass [m/s^2]."""
PLANAR, SPATIAL = 3, 6
"""Columns of poses and motions: x, y and rotation in the plane; in space x, y, z and a rotation
vector."""


class JointArrays(NamedTuple):
    """All joints of an assembly at once, lengths in units of its size.

    `before`, `after`, (joints,): Indices of the blocks, `SUPPORT` for the ground.
    `ends`, (joints, 2, 2): Inner and outer end.
    `normal`, `tangent`, (joints, 2).
    `length`, (joints,).
    `friction`, (joints,): Of each joint's own; nan where it is that of all others.
    `faces`, (joints, 2, 2, 2): Faces of `before` and `after`, their inner and outer ends. A
        corner's are that which carries it, and twice the corner.
    `is_corner`, (joints,).
    `carrier`, (joints,): Whose face carries a corner: 0 that of `before`, 1 that of `after`.
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


def _mean(corners: list[list[float]]) -> tuple[float, float]:
    x, y = zip(*corners, strict=True)
    return sum(x) / len(x), sum(y) / len(y)


class Bodies(ABC):
    """What blocks and their joints are in the plane and in space alike."""

    dimensions: ClassVar[int]
    columns: ClassVar[int]
    down: ClassVar[tuple[float, ...]]

    blocks: Any
    joints: Any
    size: Any

    @property
    @abstractmethod
    def corners(self) -> Sequence[Array]:
        """Corners of each block, (k, 2 or 3) [m]."""

    @cached_property
    def reach(self) -> Array:
        """Largest distance of a corner from the centre of mass, shape (blocks,) [m]."""
        corners = self.corners
        count = np.array([len(each) for each in corners])
        arms = np.concatenate(corners) - np.repeat(self.centres, count, axis=0)
        far = np.hypot.reduce(arms, axis=1)
        return frozen(np.maximum.reduceat(far, count.cumsum() - count), (-1,))

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient of each joint, (joints,); nan where it has none of its own."""
        own = column(self.joints, "friction")
        return frozen([math.nan if each is None else each for each in own], (-1,))

    @cached_property
    def centres(self) -> Array:
        """Centres of mass, shape (blocks, 2 or 3) [m]."""
        return frozen(column(self.blocks, "centre"), (-1, self.dimensions))

    @cached_property
    def built(self) -> Array:
        """Poses as built, in units of the size; then that of the ground, index `SUPPORT`.

        Shape (blocks + 1, 3 or 6).
        """
        poses = np.zeros((len(self.blocks) + 1, self.columns))
        poses[:-1, : self.dimensions] = self.centres / self.size
        return frozen(poses, (-1, self.columns))

    @cached_property
    def sides(self) -> NDArray[np.int64]:
        """Blocks before and after each joint, shape (2, joints)."""
        sides = [column(self.joints, "before"), column(self.joints, "after")]
        return np.array(sides, dtype=np.int64)

    def displacement(self, moved: Array) -> Array:
        """Bound of the displacement of any corner, from those of the centres.

        `moved`, (..., blocks, 3 or 6): Displacements of the centres, in units of the size, and
            rotations.
        Returns (...): Largest over the blocks of the translation or a corner's way by rotation.
        """
        square = moved**2
        first, *ways = (square[..., at] for at in range(self.dimensions))
        turn, *turns = (square[..., at] for at in range(self.dimensions, self.columns))
        shift, far = sum(ways, first), sum(turns, turn) * self._square_reach
        return np.sqrt(np.maximum(shift, far)).max(axis=-1)

    @cached_property
    def lesser_reach(self) -> Array:
        """Reach of the smaller block at each joint, (joints,) [size]."""
        reach = np.append(self.reach, np.inf)[self.sides]
        return frozen(reach.min(axis=0) / self.size, (-1,))

    @cached_property
    def _square_reach(self) -> Array:
        """Of each block, (blocks,), in units of the size."""
        return (self.reach / self.size) ** 2


@dataclass(frozen=True, eq=False)
class Assembly(Bodies):
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

    dimensions: ClassVar[int] = 2
    columns: ClassVar[int] = PLANAR
    down: ClassVar[tuple[float, ...]] = (0.0, -1.0, 0.0)

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
    def weights(self) -> Array:
        """Weights of the blocks [N], (blocks,)."""
        return frozen(np.array(column(self.blocks, "mass")) * STANDARD_GRAVITY, (-1,))

    @cached_property
    def volumes(self) -> Array:
        """Volumes of the blocks [m3], (blocks,)."""
        areas = [sum(abs(signed_area(each)) for each in one.polygons) for one in self.blocks]
        return frozen(np.array(areas) * column(self.blocks, "depth"), (-1,))

    @cached_property
    def unit_force(self) -> float:
        """Weight of the mean block [N]."""
        return float(np.mean(column(self.blocks, "mass"))) * STANDARD_GRAVITY

    def weights_under(self, gravity: Array) -> Array:
        """Return gravity on each block as columns of motions, (blocks, 3) [mean weights]."""
        return self.masses * [gravity[0], gravity[1], 0.0]

    def of_load(self, load: Load, poses: Array | None = None) -> Array:
        """Return forces and moments of a load, (blocks, 3).

        In mean weights, and that times the size.

        Parameters
        ----------
        load : Load
        poses : (blocks, 3) float, optional
            Where the blocks are, by default where they were built: points turn with them.
        """
        found = np.zeros((len(self.blocks), PLANAR))
        chosen = list(load.blocks)
        if load.per_weight:
            found[chosen, :2] = self.masses[chosen, :1] * load.force
            return found
        force = load.force / self.unit_force
        for index in chosen:
            found[index, :2] += force
            if load.point is not None:
                arm = (load.point - self.centres[index]) / self.size
                turn = 0.0 if poses is None else float(poses[index, 2])
                cos, sin = math.cos(turn), math.sin(turn)
                x, y = cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]
                found[index, 2] += x * force[1] - y * force[0]
        return found

    @cached_property
    def depths(self) -> Array:
        """Depth of each block, shape (blocks,), in units of the size."""
        return frozen(np.array(column(self.blocks, "depth")) / self.size, (-1,))

    @property
    def corners(self) -> Sequence[Array]:
        """Corners of each block, or of the hull of its polygons, (k, 2) [m]."""
        return cast("Sequence[Array]", column(self.blocks, "vertices"))

    @cached_property
    def joint_arrays(self) -> JointArrays:
        """The joints gathered into arrays, for what looks at them frame by frame."""
        joints = self.joints
        ends = np.array([column(joints, "inner"), column(joints, "outer")], np.float64)
        ends = ends.reshape(2, -1, 2).transpose(1, 0, 2)
        is_corner = np.array([each is not None for each in column(joints, "across")], np.bool_)
        own_faces = column(joints, "faces")
        given = np.array([each is not None for each in own_faces], np.bool_)
        faces = np.repeat(ends[:, None], 2, axis=1)
        way = ends[:, 1] - ends[:, 0]
        length = np.hypot(way[:, 0], way[:, 1])
        tangent = way / np.where(is_corner, 1.0, length)[:, None]
        for index in np.flatnonzero(given & ~is_corner).tolist():
            faces[index] = own_faces[index]
        for index in np.flatnonzero(is_corner).tolist():
            faces[index], tangent[index] = self._faces(joints[index]), joints[index].tangent
        at_corner = (faces[:, 0, 0] == faces[:, 0, 1]).all(axis=1)
        return JointArrays(
            before=self.sides[0],
            after=self.sides[1],
            ends=frozen(ends / self.size, (-1, 2, 2)),
            normal=frozen(tangent[:, ::-1] * [1.0, -1.0], (-1, 2)),
            tangent=frozen(tangent, (-1, 2)),
            length=frozen(length / self.size, (-1,)),
            friction=self.friction,
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
        """Return the faces of `before` and `after` that meet at a corner on a face [m]."""
        given = joint.faces
        if given is not None and (given[:, 0] != given[:, 1]).any():
            return given
        bodies = [self.polygons_at(joint, side) for side in (0, 1)]
        return carrying_faces(joint.inner, joint.normal, bodies, self.size)

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
