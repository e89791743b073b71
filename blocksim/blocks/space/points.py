"""Points of joints in space: what a force at each does to the blocks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.polyhedron import frame

Places = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class JointPoints:
    """The corners of all joints, each with a force: along the normal, and two ways across.

    A face presses anywhere within its polygon. One contact a corner is exact: a force within
    the cone at a point of a convex polygon is a sum of parallel ones at its corners.
    Lengths are in units of the size, forces of the mean block's weight.
    """

    problem: Problem[SpatialAssembly]

    @cached_property
    def joint(self) -> Places:
        """Joint of each point, (points,)."""
        joints = self.problem.assembly.joints
        return np.repeat(np.arange(len(joints)), [len(each.points) for each in joints])

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient at each point, (points,)."""
        return self.problem.friction[self.joint]

    @cached_property
    def unit(self) -> float:
        """The mean block's weight [N]."""
        return self.problem.unit_force

    @cached_property
    def axes(self) -> Array:
        """Normal, from `before` into `after`, and two directions across, (joints, 3, 3)."""
        normals = [each.normal for each in self.problem.assembly.joints]
        return np.array([np.vstack([each, frame(each)]) for each in normals]).reshape(-1, 3, 3)

    @cached_property
    def own(self) -> Array:
        """At each point the weight of the lighter block beside it, over its joint's points.

        (points,) float, in mean weights: the pressure by which it is told whether it presses.
        """
        assembly = self.problem.assembly
        weights = np.append(assembly.weights / self.unit, np.inf)
        least = weights[assembly.sides].min(axis=0)
        return least[self.joint] / np.bincount(self.joint)[self.joint]

    @cached_property
    def matrix(self) -> Any:
        """Forces and moments on blocks, (6 blocks, 3 points), of unit forces at the points."""
        assembly = self.problem.assembly
        if not assembly.joints:
            return sparse.csc_matrix((6 * len(assembly.blocks), 0))
        points = assembly.points
        axes = self.axes[self.joint]
        rows: list[Any] = []
        columns: list[Any] = []
        values: list[Array] = []
        at = 3 * np.arange(len(points))[:, None, None] + np.arange(3)[:, None]
        for side, sign in zip(assembly.sides, (-1.0, 1.0), strict=True):
            block = side[self.joint]
            on = block != SUPPORT
            arms = (points[on] - assembly.centres[block[on]]) / assembly.size
            wrench: Array = sign * np.concatenate(
                [axes[on], np.cross(arms[:, None], axes[on])], axis=2
            )
            row = 6 * block[on][:, None, None] + np.arange(6)
            rows.append(np.broadcast_to(row, wrench.shape).ravel())
            columns.append(np.broadcast_to(at[on], wrench.shape).ravel())
            values.append(wrench.ravel())
        shape = (6 * len(assembly.blocks), 3 * len(points))
        entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return sparse.csc_matrix(entries, shape=shape)

    @cached_property
    def rows(self) -> Array:
        """Scale of each equation, (6 blocks,): a block's weight, and that times its size."""
        assembly = self.problem.assembly
        own = [np.ptp(each, axis=0).max() / 2 for each in assembly.corners]
        arms = np.array(own) / assembly.size
        scale = np.stack([np.ones(len(arms))] * 3 + [arms] * 3, axis=1)
        return (scale * (assembly.weights / self.unit)[:, None]).ravel()
