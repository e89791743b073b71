"""Points of contact in space: what a force at each does to the blocks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.space.polyhedron import frame
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.limit.space.cones import Answer, most

Places = NDArray[np.int64]
NEAR = (1e-8, 1e-7, 1e-6, 1e-5, 1e-6, 1e-7)
"""Of the largest rate: openings below which points are held together, step by step."""
SOFT = 1e-14
"""Of the largest stiffness: what keeps equations solvable that say the same."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """The corners of all joints, each with a force: along the normal, and two ways across.

    A face presses anywhere within its polygon. One contact a corner is exact: a force within
    the cone at a point of a convex polygon is a sum of parallel ones at its corners.
    Lengths are in units of the size, forces of the mean block's weight.

    Parameters
    ----------
    problem : SpatialProblem
    """

    problem: SpatialProblem

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
        return float(self.problem.assembly.weights.mean())

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
        weights = assembly.weights / self.unit
        sides = [(each.before, each.after) for each in assembly.joints]
        least = [min(weights[side] for side in pair if side != SUPPORT) for pair in sides]
        return np.array(least)[self.joint] / np.bincount(self.joint)[self.joint]

    @cached_property
    def matrix(self) -> Any:
        """Forces and moments on blocks, (6 blocks, 3 points), of unit forces at the points."""
        assembly = self.problem.assembly
        if not assembly.joints:
            return sparse.csc_matrix((6 * len(assembly.blocks), 0))
        points = np.concatenate([each.points for each in assembly.joints])
        axes = self.axes[self.joint]
        rows: list[Any] = []
        columns: list[Any] = []
        values: list[Array] = []
        at = 3 * np.arange(len(points))[:, None, None] + np.arange(3)[:, None]
        for side, sign in (("before", -1.0), ("after", 1.0)):
            block = np.array([getattr(each, side) for each in assembly.joints])[self.joint]
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

    def pull(self, load: float) -> Array:
        """Return gravity, dead and live loads, (6 blocks,)."""
        problem = self.problem
        return self._scaled(problem.fixed_pull + load * problem.live_pull)

    @property
    def live(self) -> Array:
        """Return live loads at a factor of 1, (6 blocks,)."""
        return self._scaled(self.problem.live_pull)

    def _scaled(self, pull: Array) -> Array:
        size = self.problem.assembly.size
        return (pull / self.unit / np.array([1.0, 1.0, 1.0, size, size, size])).ravel()

    @cached_property
    def rows(self) -> Array:
        """Scale of each equation, (6 blocks,): a block's weight, and that times its size."""
        assembly = self.problem.assembly
        boxes = [[hull.box for hull in block.hulls] for block in assembly.blocks]
        own = [np.ptp(np.concatenate(each), axis=0).max() / 2 for each in boxes]
        arms = np.array(own) / assembly.size
        scale = np.stack([np.ones(len(arms))] * 3 + [arms] * 3, axis=1)
        return (scale * (assembly.weights / self.unit)[:, None]).ravel()

    def most(self, pull: Array, live: Array | None = None) -> Answer:
        """Find the largest factor on `live`, or the most that all points can press by.

        Forces and equations are in units of the blocks beside them, so that blocks of any
        weight and size count alike.
        """
        each = np.repeat(self.own, 3)
        matrix = sparse.diags(1 / self.rows) @ self.matrix @ sparse.diags(each)
        scaled = None if live is None else live / self.rows
        found = most(matrix, pull / self.rows, self.friction, scaled)
        forces = found.forces * each if len(found.forces) else found.forces
        return Answer(forces, found.value, found.rates / self.rows)

    def slack(self, forces: Array) -> Array:
        """Return by how much each point presses more than friction needs, (points,).

        Parameters
        ----------
        forces : (3 points,) float
        """
        each = forces.reshape(-1, 3)
        across = np.hypot(each[:, 1], each[:, 2])
        with np.errstate(invalid="ignore", divide="ignore"):
            needed = np.where(across > 0, across / self.friction, 0.0)
        return each[:, 0] - needed

    def opening(self, rates: Array) -> Array:
        """Return by how much each point opens beyond mu times its slip, (points,).

        Without a bound on friction no point may slip: what does counts below 0.

        Parameters
        ----------
        rates : (6 blocks,) float
        """
        each: Array = (self.matrix.T @ rates).reshape(-1, 3)
        slip = np.hypot(each[:, 1], each[:, 2])
        rough = np.isinf(self.friction)
        mu = np.where(rough, 0.0, self.friction)
        return np.where(rough, np.minimum(each[:, 0], -slip), each[:, 0] - mu * slip)

    def mended(self, rates: Array) -> Array:
        """Return rates at which points that nearly stay together do so to rounding.

        Of points that slide the dilation is held to mu times the slip, of others all three
        rates to 0: Newton's method on what the solver left over.

        Parameters
        ----------
        rates : (6 blocks,) float
        """
        scale = np.sqrt(self.rows)
        matrix = sparse.csr_matrix(self.matrix.T @ sparse.diags(1 / scale))
        best, least = rates, float(-self.opening(rates).min())
        for nearness in NEAR:
            each = (self.matrix.T @ best).reshape(-1, 3)
            slip = np.hypot(each[:, 1], each[:, 2])
            size = float(np.abs(each).max())
            rough = np.isinf(self.friction)
            opening = np.where(rough, each[:, 0], self.opening(best))
            near = np.abs(opening) <= nearness * size
            if not (near | rough).any():
                continue
            slides = near & (slip > nearness * size) & ~rough
            still = np.flatnonzero(near & ~slides)
            # Without a bound on friction nothing slips, not even what opens.
            held = np.flatnonzero(rough & ~near)
            at = np.flatnonzero(slides)
            way = each[at, 1:] / slip[at, None] if len(at) else np.zeros((0, 2))
            rows = sparse.vstack(
                [
                    matrix[3 * at]
                    - sparse.diags(self.friction[at] * way[:, 0]) @ matrix[3 * at + 1]
                    - sparse.diags(self.friction[at] * way[:, 1]) @ matrix[3 * at + 2],
                    *(matrix[3 * still + axis] for axis in range(3)),
                    *(matrix[3 * held + axis] for axis in (1, 2)),
                ]
            ).tocsc()
            left = np.concatenate([self.opening(best)[at], *each[still].T, *each[held, 1:].T])
            normal = rows.T @ rows
            normal = normal + sparse.identity(normal.shape[0]) * (
                SOFT * normal.diagonal().max()
            )
            step = solved(normal, -(rows.T @ left)) / scale
            error = float(-self.opening(best + step).min())
            if error < least:
                best, least = best + step, error
        return best


def solved(matrix: Any, right: Array) -> Array:
    """Solve linear equations."""
    factors = cast("Any", splu(matrix.tocsc()))
    return cast("Array", factors.solve(right))
