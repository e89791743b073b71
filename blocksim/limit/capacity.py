"""The largest factor on live loads at which forces of equilibrium exist, of one load or many.

The inverse of the factor is a gauge of the live loads: it is convex, grows in proportion to
them, and the gauge of two loads together is at most the sum of theirs. So what is known at two
loads bounds it at all those between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.later import sparse, sparse_linalg
from blocksim.limit.bearing import Bearing
from blocksim.limit.cones import ROUND_OFF
from blocksim.limit.crushing import Crushing, mobilised
from blocksim.limit.linear import LinearProgramme, Optimum
from blocksim.limit.programme import most_common, scaled
from blocksim.limit.symmetry import mirror_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Collapse:
    """The largest factor on the live loads at which forces of equilibrium exist.

    `load_factor`: None where there is no equilibrium at any factor; inf where no live load is
        too much.
    `mechanism`, (blocks, 3 or 6): Rates as the blocks begin to move: x, y and rotation, the
        largest of them 1; in space as of `SpatialEquilibrium`.
    `forces`, (joints, 2, 2): At collapse, as of `Equilibrium`; None in space.
    `gap`: By how much, of the factor, forces and mechanism disagree in space.
    """

    load_factor: float | None
    mechanism: Array | None = None
    forces: Array | None = None
    gap: float = 0.0


class Capacity:
    """What a structure bears besides what acts on it always, of many live loads in turn.

    Where the problem has a strength its blocks crush.

    `problem`: In its plane. Its own live loads and load factor do not matter to answers.
    """

    def __init__(self, problem: Problem) -> None:
        self._bearing = Bearing(problem)
        self.cones, strength = self._bearing.cones, problem.strength
        self._dead = problem.with_load(0.0).applied_forces()
        self._solver, self._shares = LinearProgramme(), LinearProgramme()
        self._shared = False
        crushes = strength is not None
        self._crushing = Crushing(problem, self._bearing, strength) if crushes else None

    def of(self, live: Array) -> Collapse:
        """Find the largest factor on live loads.

        `live`, (blocks, 3): Forces and moments about the centres [mean weight, and that times
            the size].
        """
        cones = self.cones
        column = sparse.csc_array(cones.loads(live)[:, None])
        right = -cones.loads(self._dead)
        if self._crushing is not None:
            return self._collapse(self._crushing.most(column, right)[0])
        endless = (-math.inf, math.inf)
        return self._collapse(self._bearing.most(column, right, endless, self._solver)[0])

    def gauge(self, live: Array) -> float:
        """Return the inverse of the largest factor on live loads of a structure that stands.

        It is the least share of what acts always that has to be there beside the live loads.
        These are on the right side of a programme of which nothing else changes.

        `live`, (blocks, 3): As of `of`, not all 0.
        """
        if self._bearing.columns.shape[1] or self._crushing is not None:
            factor = self.of(live).load_factor
            return math.inf if factor is None else 1 / factor
        cones = self.cones
        dead, loads = cones.loads(self._dead), cones.loads(live)
        # As large as what acts always: HiGHS's tolerances are of numbers near 1.
        size = float(np.abs(dead).sum() / np.abs(loads).sum())
        right = -size * loads
        rows = right, right
        found = self._shares.again(rows) if self._shared else None
        if found is None:
            low, high = (
                np.append(each, end)
                for each, end in zip(cones.bounds, (0, math.inf), strict=True)
            )
            cost = np.append(np.zeros(cones.count), 1.0)
            matrix = sparse.hstack(
                [cones.balance, sparse.csc_array(dead[:, None])], format="csc"
            )
            found = self._shares.solve(cost, matrix, rows, (low, high))
            self._shared = found.exists
        return float(found.values[-1]) / size if found.exists else math.inf

    def _collapse(self, found: Optimum) -> Collapse:
        cones = self.cones
        if not found.exists:
            factor = math.inf if found.unbounded else None
            return Collapse(load_factor=factor)
        return Collapse(
            load_factor=float(found.values[-1]) + 0.0,
            forces=cones.forces(found.values[:-1]),
            mechanism=scaled(cones.rates(found.prices[: cones.balance.shape[0]])),
        )

    def at_most(self, lives: Array) -> Array:
        """Bound the inverse of the load factors of small loads from above, (loads,).

        Forces that balance each are added to a state of equilibrium under what acts always, in
        which every contact presses. They need not be the best ones: near 0 that is no matter.

        `lives`, (loads, blocks, 3): As of `of`.
        """
        at_rest, spread, balanced = self._at_rest
        if at_rest is None:
            return np.full(len(lives), math.inf)
        right = -(lives * self.cones.ease).reshape(len(lives), -1).T
        added = spread @ balanced(right)
        left = np.abs(self.cones.balance @ added - right).max(axis=0)
        presses = self.cones.bounded > 0
        least = (-added[presses] / at_rest[presses, None]).max(axis=0, initial=0.0)
        if self._crushing is not None:
            crushed = [self._crushing.at_most(at_rest, each) for each in added.T]
            least = np.maximum(least, crushed)
        return np.where(left > ROUND_OFF * np.abs(right).max(axis=0), math.inf, least)

    @cached_property
    def _at_rest(self) -> tuple[Array | None, Any, Any]:
        """Parts of equilibrium that all press, and what adds to them in proportion to them."""
        cones = self.cones
        found = most_common(cones, self._dead)
        if not found.exists or found.values[-1] < ROUND_OFF:
            return None, None, None
        parts = found.values[:-1] + found.values[-1] * cones.bounded
        if self._crushing is not None:
            parts = self._crushing.spared(parts, -cones.loads(self._dead))
        if parts is None:
            return None, None, None
        room = np.where(cones.bounded > 0, parts, 1.0) ** 2
        spread = sparse.diags_array(room) @ cones.balance.T
        solve: Any = sparse_linalg.splu(sparse.csc_array(cones.balance @ spread)).solve
        return parts, spread, solve


def collapse(problem: Problem) -> Collapse:
    """Do in the plane what `limit.collapse` does; blocks with a strength crush.

    Raises
    ------
    InputError
        If nothing is known that a strength could be compared with.
    """
    live = problem.live_forces
    problem = mobilised(problem, live)
    found, mirror = Capacity(problem).of(live), mirror_of(problem.with_load(0.0), live)
    if mirror is None:
        return found
    forces, mechanism = found.forces, found.mechanism
    return replace(
        found,
        forces=None if forces is None else mirror.forces(forces),
        mechanism=None if mechanism is None else mirror.rates(mechanism),
    )
