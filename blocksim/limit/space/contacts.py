"""Forces at the points of joints in space, and what they rule out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.points import JointPoints
from blocksim.limit.space.cones import Answer, most
from blocksim.limit.space.symmetry import Symmetry, images_of, unmoved

LIFTS = (10, 100, 1000)
"""By how much points are to open, over what the solver left over."""
SOFT = 1e-14
"""Of the largest stiffness: what keeps equations solvable that say the same."""


@dataclass(frozen=True, eq=False)
class Contacts(JointPoints):
    """Points of joints whose forces a cone programme finds.

    `pulls`: Forces and moments on the blocks, each (6 blocks,): planes in which they are
        symmetric, and the structure is, are made use of.
    """

    pulls: tuple[Array, ...] = ()

    @cached_property
    def symmetry(self) -> Symmetry:
        """What forces at all points follow from, and rates of all blocks."""
        return Symmetry(self, images_of(self, *self.pulls) if self.pulls else [unmoved(self)])

    def most(self, pull: Array, live: Array | None = None, lift: float = 0.0) -> Answer:
        """Find the largest factor on `live`, or the most that all points can press by.

        Forces and equations are in units of the blocks beside them, so that blocks of any
        weight and size count alike.
        """
        whole = self.symmetry
        some = (6 * whole.blocks[:, None] + np.arange(6)).ravel()
        scale, own = self.rows[some], np.repeat(self.own[whole.points], 3)
        free = whole.free.T @ sparse.diags(1 / scale)
        matrix = free @ sparse.csr_matrix(self.matrix)[some] @ whole.forces @ sparse.diags(own)
        found = most(
            matrix,
            free @ pull[some],
            self.friction[whole.points],
            None if live is None else free @ live[some],
            lift * whole.counts,
        )
        forces = found.forces
        if len(forces):
            forces = whole.forces @ (forces * own)
            # Where it is smooth, the solver leaves a last digit.
            forces.reshape(-1, 3)[self.friction == 0, 1:] = 0.0
        return Answer(forces, found.value, whole.rates @ (free.T @ found.rates))

    def slack(self, forces: Array) -> Array:
        """Return by how much each point presses more than friction needs, (points,).

        `forces`, (3 points,).
        """
        each = forces.reshape(-1, 3)
        across = np.hypot(each[:, 1], each[:, 2])
        with np.errstate(invalid="ignore", divide="ignore"):
            needed = np.where(across > 0, across / self.friction, 0.0)
        return each[:, 0] - needed

    def opening(self, rates: Array) -> Array:
        """Return by how much each point opens beyond mu times its slip, (points,).

        Without a bound on friction no point may slip: what does counts below 0.

        `rates`, (6 blocks,).
        """
        each: Array = (self.matrix.T @ rates).reshape(-1, 3)
        slip = np.hypot(each[:, 1], each[:, 2])
        rough = np.isinf(self.friction)
        mu = np.where(rough, 0.0, self.friction)
        return np.where(rough, np.minimum(each[:, 0], -slip), each[:, 0] - mu * slip)

    def opened(self, pull: Array, rates: Array) -> Iterator[Array]:
        """Give rates that open each point by more than the solver leaves over, more and more.

        So no point closes by an error. There are none where blocks are wedged.

        `pull`, (6 blocks,).
        `rates`, (6 blocks,): What the solver found without.
        """
        left_over = float((-self.opening(rates) * self.own).max())
        for times in LIFTS:
            found = self.most(pull, lift=times * left_over).rates
            yield found if np.isfinite(self.friction).all() else self._held(found)

    def _held(self, rates: Array) -> Array:
        """Keep points without a bound on friction from slipping."""
        scale = np.sqrt(self.rows)
        across = np.repeat(np.isinf(self.friction), 3)
        across[::3] = False
        rows = sparse.csr_matrix(self.matrix.T @ sparse.diags(1 / scale))[across]
        normal = rows.T @ rows
        soft = SOFT * normal.diagonal().max()
        normal = normal + sparse.identity(normal.shape[0]) * soft
        for _ in range(2):
            rates = rates - solved(normal, rows.T @ (rows @ (scale * rates))) / scale
        return rates


def solved(matrix: Any, right: Array) -> Array:
    """Solve linear equations."""
    factors = cast("Any", splu(matrix.tocsc()))
    return cast("Array", factors.solve(right))
