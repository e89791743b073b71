"""Rigid blocks, who touches whom, and what is fixed: nothing here knows of arches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SUPPORT = -1
"""Block index that stands for the fixed ground."""


def _frozen(values: object, shape: tuple[int, ...]) -> Array:
    """Return a read-only float array of the given shape (-1: any length)."""
    array = np.array(values, dtype=np.float64)
    fits = array.ndim == len(shape) and all(
        want in (-1, have) for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits:
        message = f"expected an array of shape {shape}, got {array.shape}"
        raise ValueError(message)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Block:
    """A rigid convex block in the plane.

    Parameters
    ----------
    vertices : (k, 2) float
        Corners, counter-clockwise, x and y [m].
    centre : (2,) float
        Centre of mass [m]; it follows from the weight model and need not be the
        centroid of the polygon.
    mass : float
        [kg]
    inertia : float
        Moment of inertia about the centre of mass [kg m^2].
    depth : float
        Out of the plane [m].
    """

    vertices: Array
    centre: Array
    mass: float
    inertia: float
    depth: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        object.__setattr__(self, "vertices", _frozen(self.vertices, (-1, 2)))
        object.__setattr__(self, "centre", _frozen(self.centre, (2,)))


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
    """

    before: int
    after: int
    inner: Array
    outer: Array

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        object.__setattr__(self, "inner", _frozen(self.inner, (2,)))
        object.__setattr__(self, "outer", _frozen(self.outer, (2,)))

    @property
    def length(self) -> float:
        """Length of the joint [m]."""
        return float(np.hypot(*(self.outer - self.inner)))

    @property
    def tangent(self) -> Array:
        """Unit vector from the inner to the outer end, shape (2,)."""
        return (self.outer - self.inner) / self.length

    @property
    def normal(self) -> Array:
        """Unit normal, from `before` to `after`, shape (2,)."""
        along = self.tangent
        return np.array([along[1], -along[0]])


@dataclass(frozen=True, eq=False)
class Assembly:
    """Blocks and the joints between them.

    Parameters
    ----------
    blocks : tuple of Block
    joints : tuple of Joint
    size : float
        A characteristic length [m]; engines work in units of it.
    """

    blocks: tuple[Block, ...]
    joints: tuple[Joint, ...]
    size: float

    @cached_property
    def centres(self) -> Array:
        """Centres of mass, shape (blocks, 2) [m]."""
        return _frozen([block.centre for block in self.blocks], (-1, 2))

    @cached_property
    def masses(self) -> Array:
        """Mass, mass and inertia of each block, in units of the mean mass and the size.

        Shape (blocks, 3), to go with motions x, y and rotation.
        """
        mass = np.array([block.mass for block in self.blocks])
        inertia = np.array([block.inertia for block in self.blocks]) / self.size**2
        return _frozen(np.stack([mass, mass, inertia], axis=1) / mass.mean(), (-1, 3))

    @cached_property
    def joint_ends(self) -> Array:
        """Inner and outer ends of the joints, shape (joints, 2, 2) [m]."""
        return _frozen([(joint.inner, joint.outer) for joint in self.joints], (-1, 2, 2))

    @cached_property
    def joint_lengths(self) -> Array:
        """Lengths of the joints, shape (joints,) [m]."""
        along = self.joint_ends[:, 1] - self.joint_ends[:, 0]
        return _frozen(np.hypot(along[:, 0], along[:, 1]), (-1,))

    @cached_property
    def joint_sides(self) -> NDArray[np.int64]:
        """Blocks before and after each joint, shape (joints, 2)."""
        return np.array([(joint.before, joint.after) for joint in self.joints])

    @cached_property
    def reach(self) -> Array:
        """Largest distance of a corner from the centre of mass, shape (blocks,) [m]."""
        return _frozen(
            [np.hypot(*(block.vertices - block.centre).T).max() for block in self.blocks],
            (-1,),
        )
