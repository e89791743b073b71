"""Forces at the points of joints in space, and what they rule out."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.points import JointPoints
from blocksim.limit.space.cones import Answer, most

NEAR = (1e-8, 1e-7, 1e-6, 1e-5, 1e-6, 1e-7)
"""Of the largest rate: openings below which points are held together, step by step."""
SOFT = 1e-14
"""Of the largest stiffness: what keeps equations solvable that say the same."""


class Contacts(JointPoints):
    """Points of joints whose forces a cone programme finds."""

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
