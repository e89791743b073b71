"""Rigid blocks in space, who touches whom, and what is fixed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import SPATIAL, Array, Bodies, frozen
from blocksim.blocks.space.polyhedron import Polyhedron

Flags = NDArray[np.bool_]
Places = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid:
    """A rigid block in space: a convex polyhedron, or several that move as one.

    Parameters
    ----------
    parts : tuple of (k, 3) array_like
        Corners of each convex part [m], in any order.
    name : str
    fixed : bool
        Whether it is a support.
    weight : float or None
        [N]; by default density times volume.
    centre : (3,) array_like or None
        Where its weight acts [m]; by default the centroid.

    Examples
    --------
    >>> import itertools
    >>> block = Solid(parts=(list(itertools.product((0, 1), (0, 1), (0, 2))),))
    >>> block.name, block.fixed
    ('', False)
    """

    parts: tuple[ArrayLike, ...]
    name: str = ""
    fixed: bool = False
    weight: float | None = None
    centre: ArrayLike | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidBlock:
    """A block of an assembly in space.

    `hulls`: The convex parts it consists of.
    `weight`: [N]
    `centre`, (3,): Centre of mass [m].
    """

    hulls: tuple[Polyhedron, ...]
    name: str
    weight: float
    centre: Array

    @cached_property
    def gyration(self) -> Array:
        """Moments of inertia about its centroid over its mass [m2], (3, 3).

        As of one material, whatever its centre of mass is.
        """
        volumes = np.array([hull.volume for hull in self.hulls])
        centroid = volumes @ np.array([hull.centroid for hull in self.hulls]) / volumes.sum()
        spread = sum(hull.second_moment(centroid) for hull in self.hulls) / volumes.sum()
        return np.trace(spread) * np.eye(3) - spread


@dataclass(frozen=True, eq=False, kw_only=True)
class FaceJoint:
    """A dry joint in space: a polygon, a segment or a point where two blocks touch.

    Parameters
    ----------
    before, after : int
        Indices of the blocks on its two sides, `SUPPORT` for the ground.
    points : (k, 3) float
        Corners of the polygon in order, ends of the segment, or the point [m].
    normal : (3,) float
        Unit normal, from `before` into `after`.
    friction : float or None
        Its own friction coefficient, where it is not that of all others.
    support : int or None
        Which of the supports it lies on.
    gap : float
        How far apart the faces are drawn that it closes, below 0 where they overlap [m].
    """

    before: int
    after: int
    points: Array
    normal: Array
    friction: float | None = None
    support: int | None = None
    gap: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialAssembly(Bodies):
    """Blocks, supports and the joints between them.

    Parameters
    ----------
    blocks : tuple of SolidBlock
    supports : tuple of SolidBlock
        Fixed; their weight is of no account.
    joints : tuple of FaceJoint
    """

    dimensions: ClassVar[int] = 3
    columns: ClassVar[int] = SPATIAL
    down: ClassVar[tuple[float, ...]] = (0.0, 0.0, -1.0)

    blocks: tuple[SolidBlock, ...]
    supports: tuple[SolidBlock, ...]
    joints: tuple[FaceJoint, ...]

    @cached_property
    def size(self) -> float:
        """Half the longest side of the box around all blocks that move [m]."""
        boxes = np.array([hull.box for block in self.blocks for hull in block.hulls])
        return float((boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)).max()) / 2

    @cached_property
    def points(self) -> Array:
        """Points of all joints, one joint after the other [m], (points, 3)."""
        return frozen(
            np.concatenate([np.zeros((0, 3)), *(each.points for each in self.joints)]), (-1, 3)
        )

    @property
    def joint_angles(self) -> Array:
        """Directions of the joints from a crown, (joints,): nan, as there is none."""
        return np.full(len(self.joints), np.nan)

    @cached_property
    def weights(self) -> Array:
        """Weights of the blocks [N], (blocks,)."""
        return frozen([block.weight for block in self.blocks], (-1,))

    @cached_property
    def volumes(self) -> Array:
        """Volumes of the blocks [m3], (blocks,)."""
        return frozen([sum(h.volume for h in block.hulls) for block in self.blocks], (-1,))

    @cached_property
    def unit_force(self) -> float:
        """Weight of the mean block [N]."""
        return float(self.weights.mean())

    @cached_property
    def units(self) -> Array:
        """Units of forces [N] and moments [N m] of columns of motions, (6,)."""
        return self.unit_force * np.array([1.0, 1.0, 1.0, *[self.size] * 3])

    def weights_under(self, gravity: Array) -> Array:
        """Return gravity on each block as columns of motions, (blocks, 6) [mean weights]."""
        return np.pad(self.weights[:, None] * gravity / self.unit_force, ((0, 0), (0, 3)))

    def of_load(self, load: Load, poses: Array | None = None) -> Array:  # noqa: ARG002
        """Return forces and moments of a load, (blocks, 6), on blocks as they were built.

        In mean weights, and that times the size.
        """
        found = np.zeros((len(self.blocks), SPATIAL))
        for index, force, arm in self.forces_of(load):
            found[index] += np.concatenate([force, np.cross(arm, force)]) / self.units
        return found

    def forces_of(self, load: Load) -> Iterator[tuple[int, Array, Array]]:
        """Give each block of a load, the force [N], and its arm from the centre of mass [m]."""
        for index in load.blocks:
            own = self.blocks[index]
            arm = np.zeros(3) if load.point is None else load.point - own.centre
            yield index, load.force * (own.weight if load.per_weight else 1.0), arm

    @property
    def corners(self) -> tuple[Array, ...]:
        """Corners of the parts of each block, (k, 3) [m]."""
        return tuple(np.concatenate([h.corners for h in block.hulls]) for block in self.blocks)
