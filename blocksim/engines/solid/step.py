"""What a step of blocks in space asks, and how far an answer is from Coulomb's law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands

ALIKE = np.ones((1, 3))
"""Weights of the rows of a point."""


@dataclass(frozen=True, eq=False)
class Step:
    """What a step asks.

    `bands`: Which blocks each point is between.
    `rows`, (points, 3, 12): Velocities at the points, along the normal and two ways across, of
        scaled ones of both blocks; 0 for what is fixed.
    `drift`, (points, 3): Velocities without acceleration, over the step.
    `free`, (6 blocks,): Accelerations without contact, scaled.
    `friction`, (points,).
    """

    bands: Bands
    rows: Array
    drift: Array
    free: Array
    friction: Array

    def velocities(self, x: Array) -> Array:
        """Return velocities at the points at the end, over the step, (points, 3)."""
        return self.bands.along(self.rows, x) + self.drift

    def pushed_by(self, forces: Array) -> Array:
        """Return the accelerations that forces give, (6 blocks,)."""
        return self.free + self.bands.pull(self.rows, forces)

    def residual(self, x: Array, forces: Array) -> float:
        """Return how far accelerations and forces are from a solution."""
        left = x - self.pushed_by(forces)
        u = self.velocities(x)
        # Of a contact either the pressure or the velocity is 0.
        off = np.abs(forces - projected(forces - u, self.friction)).max(initial=0.0)
        scale = max(1.0, float(np.abs(x).max(initial=0.0)))
        return max(float(np.abs(left).max(initial=0.0)), float(off)) / scale

    def with_springs(self, springs: Array, right: Array) -> Array | None:
        """Solve (1 + H^T S H) x = right; None where that says nothing of some unknowns.

        `springs`, (points, 3, 3): S, of each point; H are the rows.
        `right`, (6 blocks,).
        """
        band = self.bands.band(self.rows, ALIKE, np.matmul(springs, self.rows))
        found = self.bands.solve_band(band, right)
        return found if np.isfinite(found).all() else None

    @property
    def matrix(self) -> Any:
        """The rows as a sparse matrix, (3 points, 6 blocks)."""
        columns = np.broadcast_to(self.bands.place[:, None], self.rows.shape)
        at = np.arange(3 * len(self.rows)).reshape(-1, 3, 1)
        rows, inside = np.broadcast_to(at, self.rows.shape), columns < self.bands.size
        entries: Any = (self.rows[inside], (rows[inside], columns[inside]))
        return sparse.csr_matrix(entries, shape=(3 * len(self.rows), self.bands.size))


@dataclass(frozen=True, eq=False)
class Answer:
    """Accelerations and forces.

    `x`, (6 blocks,).
    `forces`, (points, 3).
    `residual`: Worst of imbalance, penetration and friction off its law, over the largest
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


def slip_of(velocities: Array) -> Array:
    """Return how fast points slip, (points,), of their velocities."""
    return np.hypot(velocities[:, 1], velocities[:, 2])
