"""Sums over the joints of a chain of blocks, and the banded systems they form."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import LinAlgError, solve_banded, solveh_banded

from blocksim.assembly import Array


class Bands:
    """Which unknowns each joint couples.

    A system that cannot be solved gives nan, which no residual of a step survives.

    Rows have shape (joints, k, 6): each is a velocity of a joint, from the six of its two
    blocks.

    Parameters
    ----------
    before, after : (joints,) int
        Blocks on both sides of each joint, -1 for the ground.
    blocks : int
    """

    def __init__(
        self, before: NDArray[np.int64], after: NDArray[np.int64], blocks: int
    ) -> None:
        self.size = 3 * blocks
        pair = np.repeat(np.stack([before, after], axis=1), 3, axis=1)
        # Entries of the ground go to one place past the end and are dropped.
        self._place = np.where(pair < 0, self.size, 3 * pair + np.tile(np.arange(3), 2))
        row, column = np.broadcast_arrays(self._place[:, :, None], self._place[:, None, :])
        inside = (row < self.size) & (column < self.size)
        apart = row - column
        self._width = int(np.abs(apart[inside]).max())
        lower = inside & (apart >= 0)
        self._lower = np.flatnonzero(lower)
        self._lower_at = (apart * self.size + column)[lower]
        self._whole = np.flatnonzero(inside)
        self._whole_at = ((self._width + apart) * self.size + column)[inside]

    def of_joints(self, values: Array) -> Array:
        """Return for each joint the six values of its blocks, 0 for the ground's."""
        return np.append(values, 0.0)[self._place]

    def along(self, rows: Array, values: Array) -> Array:
        """Velocities along rows, shape (joints, k)."""
        return np.matmul(rows, self.of_joints(values)[:, :, None])[:, :, 0]

    def pull(self, rows: Array, forces: Array) -> Array:
        """Sum forces along rows, shape (joints, k), on the blocks."""
        parts = np.matmul(forces[:, None, :], rows).ravel()
        sums = np.bincount(self._place.ravel(), parts, self.size + 1)
        return sums[:-1].astype(np.float64, copy=False)

    def solve_symmetric(self, rows: Array, weight: ArrayLike, right: Array) -> Array:
        """Solve (1 + rows^T weight rows) x = right."""
        weighted = rows.transpose(0, 2, 1) * np.asarray(weight)[:, None, :]
        products = np.matmul(weighted, rows).ravel()
        count = self._width + 1
        band = np.bincount(self._lower_at, products[self._lower], count * self.size)
        band = band.reshape(count, self.size)
        band[0] += 1.0
        try:
            return solveh_banded(band, right, lower=True, check_finite=False)
        except LinAlgError:
            return np.full_like(right, np.nan)

    def solve(self, rows: Array, weight: ArrayLike, seen: Array, right: Array) -> Array:
        """Solve (1 + rows^T weight seen) x = right."""
        weighted = rows.transpose(0, 2, 1) * np.asarray(weight)[:, None, :]
        products = np.matmul(weighted, seen).ravel()
        count = 2 * self._width + 1
        band = np.bincount(self._whole_at, products[self._whole], count * self.size)
        band = band.reshape(count, self.size)
        band[self._width] += 1.0
        try:
            return solve_banded((self._width, self._width), band, right, check_finite=False)
        except LinAlgError:
            return np.full_like(right, np.nan)


def line_search(
    slope: float, curvature: float, trial: Array, turn: Array, stiffness: float
) -> float:
    """Step along a direction to the minimum of a convex, piecewise quadratic function.

    Parameters
    ----------
    slope : float
        Derivative at the start.
    curvature : float
        Second derivative without the constraints.
    trial, turn : (joints, k) float
        Forces of the constraints at the start, active where positive, and their change
        over a step of length 1.
    stiffness : float
        An active constraint adds turn^2 / stiffness to the second derivative.
    """
    if not np.any((trial > 0) != (trial + turn > 0)):
        return 1.0
    moving = turn != 0
    force, change = trial[moving], turn[moving]
    weight = change * change / stiffness
    active = (force > 0) | ((force == 0) & (change > 0))
    where = -force / change
    ahead = np.flatnonzero(where > 0)
    order = ahead[np.argsort(where[ahead])]
    bends = np.append(0.0, where[order])
    curvatures = np.cumsum(
        np.append(curvature + weight[active].sum(), np.sign(change[order]) * weight[order])
    )
    slopes = slope + np.append(0.0, np.cumsum(curvatures[:-1] * np.diff(bends)))
    last = max(int(np.searchsorted(slopes, 0.0)) - 1, 0)
    return float(bends[last] - slopes[last] / curvatures[last])
