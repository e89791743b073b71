"""What a step of blocks in space asks, and how far an answer is from Coulomb's law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from blocksim.blocks.assembly import Array


@dataclass(frozen=True, eq=False)
class Step:
    """What a step asks.

    Parameters
    ----------
    matrix : (3 points, 6 blocks) sparse
        Velocities at the points, along the normal and two ways across, of scaled ones.
    drift : (3 points,) float
        Velocities without acceleration, over the step.
    free : (6 blocks,) float
        Accelerations without contact, scaled.
    friction : (points,) float
    """

    matrix: Any
    drift: Array
    free: Array
    friction: Array

    def velocities(self, x: Array) -> Array:
        """Return velocities at the points at the end, over the step, (points, 3)."""
        return (self.matrix @ x + self.drift).reshape(-1, 3)

    def pushed_by(self, forces: Array) -> Array:
        """Return the accelerations that forces give, (6 blocks,)."""
        return self.free + self.matrix.T @ forces.ravel()

    def residual(self, x: Array, forces: Array) -> float:
        """Return how far accelerations and forces are from a solution."""
        left = x - self.free - self.matrix.T @ forces.ravel()
        u = self.velocities(x)
        # Of a contact either the pressure or the velocity is 0.
        off = np.abs(forces - projected(forces - u, self.friction)).max(initial=0.0)
        scale = max(1.0, float(np.abs(x).max(initial=0.0)))
        return max(float(np.abs(left).max(initial=0.0)), float(off)) / scale


@dataclass(frozen=True, eq=False)
class Answer:
    """Accelerations and forces.

    Parameters
    ----------
    x : (6 blocks,) float
    forces : (points, 3) float
    residual : float
        Worst of imbalance, penetration and friction off its law, over the largest
        acceleration where that is above 1.
    """

    x: Array
    forces: Array
    residual: float


def projected(pushed: Array, friction: Array) -> Array:
    """Return the pressure that is left of forces, and friction cut to what it bears."""
    found = pushed.copy()
    found[:, 0] = np.maximum(found[:, 0], 0.0)
    across = np.hypot(found[:, 1], found[:, 2])
    most = friction * found[:, 0]
    slides = across > most
    found[slides, 1:] *= (most[slides] / across[slides])[:, None]
    found[found[:, 0] <= 0, 1:] = 0.0
    return found


def rows_of(points: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the rows of points, three of each."""
    return (3 * points[:, None] + np.arange(3)).ravel()


def on_diagonal(blocks: Array) -> Any:
    """Return a sparse matrix with blocks along its diagonal, (k, n, n)."""
    count = np.arange(len(blocks) + 1)
    return sparse.bsr_matrix((blocks, count[:-1], count)).tocsr()


def solved(system: Any, right: Array) -> Array | None:
    """Solve equations of the blocks; None where they say nothing of some of them."""
    try:
        return cast("Any", splu(system.tocsc(), permc_spec="MMD_AT_PLUS_A")).solve(right)
    except RuntimeError:
        return None
