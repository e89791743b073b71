"""Blocks of `direct` in space: a world of the protocol in `engines/base.py`."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.engines.base import Quality, Settings
from blocksim.engines.solid.stepping import Stepping

EVEN = 1e-9
"""Share of a step that is none."""


class SolidBlocks(Stepping):
    """Blocks in space, their poses and velocities.

    Poses are x, y, z in units of the size, then rotation vectors since they were built.

    Parameters
    ----------
    problem : SpatialProblem
    settings : Settings
    """

    def __init__(self, problem: SpatialProblem, settings: Settings) -> None:
        super().__init__(problem)
        self._step = settings.step
        self._first = self._lowest = self.bodies.energy(self._place, self._velocities)[0]
        self._gain = 0.0

    def hold(self, sweeps: int) -> Array:  # noqa: ARG002 - the protocol's
        """Solve the contacts as they were built, from rest; the blocks stay.

        Returns
        -------
        (blocks, 6) float
        """
        found = self._rest()
        self._residual = max(self._residual, found.residual)
        rates = (found.x / self.bodies.root).reshape(-1, 6)
        rates[:, 3:] = np.einsum("bij,bj->bi", self._place.turns[:-1], rates[:, 3:])
        return rates

    def advance(self, steps: int) -> None:
        """Let the blocks move."""
        for _ in range(steps):
            self._move(self._step)
            still, moving = self.bodies.energy(self._place, self._velocities)
            self._gain = max(self._gain, still + moving - self._first)
            self._lowest = min(self._lowest, still)

    def poses(self) -> Array:
        """Return centres and rotation vectors, (blocks, 6)."""
        return self.bodies.poses(self._place)

    def quality(self) -> Quality:
        """Tell how well contact and friction have been kept so far."""
        fallen = self._first - self._lowest
        return Quality(
            residual=self._residual if math.isfinite(self._residual) else math.inf,
            penetration=self._penetration,
            gain=self._gain / fallen if fallen > 0 else 0.0,
        )
