"""The largest factor on live loads at which forces of equilibrium exist, of one load or many.

The inverse of the factor is a gauge of the live loads: it is convex, grows in proportion to
them, and the gauge of two loads together is at most the sum of theirs. So what is known at two
loads bounds it at all those between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.later import Library
from blocksim.limit.bearing import Bearing, bears, settled
from blocksim.limit.cones import ROUND_OFF, Cones
from blocksim.limit.crushing import Crushing
from blocksim.limit.linear import LinearProgramme, Optimum
from blocksim.limit.programme import most, most_common, scaled
from blocksim.limit.symmetry import symmetric_forces, symmetric_rates

if TYPE_CHECKING:
    from scipy import sparse
    from scipy.sparse import linalg
else:
    sparse, linalg = Library("scipy.sparse"), Library("scipy.sparse.linalg")


@dataclass(frozen=True, kw_only=True, eq=False)
class Collapse:
    """The largest factor on the live loads at which forces of equilibrium exist.

    Parameters
    ----------
    load_factor : float or None
        None where there is no equilibrium at any factor; inf where no live load is too much.
    forces : (joints, 2, 2) float or None
        At collapse; as of `Equilibrium`.
    mechanism : (blocks, 3) float or None
        Rates x, y and rotation as the blocks begin to move, the largest of them 1.
    """

    load_factor: float | None
    forces: Array | None
    mechanism: Array | None


class Capacity:
    """What a structure bears besides what acts on it always, of many live loads in turn.

    Where the problem has a strength its blocks crush.

    Parameters
    ----------
    problem : Problem
        In its plane. Its own live loads and load factor do not matter to answers.
    """

    def __init__(self, problem: Problem) -> None:
        self.cones = Cones(problem)
        self._dead = problem.with_load(0.0).pull()
        self._solver = LinearProgramme()
        crushes = problem.strength is not None
        self._bearing = Bearing(problem, self.cones) if bears(problem) else None
        self._crushing = Crushing(problem, self.cones) if crushes else None

    def of(self, live: Array) -> Collapse:
        """Find the largest factor on live loads.

        Parameters
        ----------
        live : (blocks, 3) float
            Forces and moments about the centres [mean weight, and that times the size].
        """
        cones = self.cones
        column = sparse.csc_array(cones.loads(live)[:, None])
        right = -cones.loads(self._dead)
        if self._bearing is not None:
            endless = (-math.inf, math.inf)
            return self._collapse(self._bearing.most(column, right, endless, self._solver)[0])
        if self._crushing is not None:
            return self._collapse(self._crushing.most(column, right))
        return self._collapse(most(cones, column, right, (-math.inf, math.inf), self._solver))

    def _collapse(self, found: Optimum) -> Collapse:
        cones = self.cones
        if found.unbounded:
            return Collapse(load_factor=math.inf, forces=None, mechanism=None)
        if not found.exists:
            return Collapse(load_factor=None, forces=None, mechanism=None)
        return Collapse(
            load_factor=float(found.values[-1]),
            forces=cones.forces(found.values[:-1]),
            mechanism=scaled(cones.rates(found.prices[: cones.balance.shape[0]])),
        )

    def at_most(self, live: Array) -> float:
        """Bound the inverse of the load factor of a small load from above.

        Forces that balance it are added to a state of equilibrium under what acts always, in
        which every contact presses. They need not be the best ones: near 0 that is no matter.
        """
        at_rest, spread, balanced = self._at_rest
        if at_rest is None:
            return math.inf
        right = -self.cones.loads(live)
        added = spread @ balanced(right)
        if np.abs(self.cones.balance @ added - right).max() > ROUND_OFF * np.abs(right).max():
            return math.inf
        presses = self.cones.bounded > 0
        least = max(0.0, float((-added[presses] / at_rest[presses]).max()))
        if self._crushing is not None:
            least = max(least, self._crushing.at_most(at_rest, added))
        return least

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
        solve: Any = linalg.splu(sparse.csc_array(cones.balance @ spread)).solve
        return parts, spread, solve


def collapse(problem: Problem) -> Collapse:
    """Find the largest factor on the live loads at which forces of equilibrium exist.

    The problem's own load factor does not matter. Below 0 it falls, or crushes, without them.

    Parameters
    ----------
    problem : Problem
        In its plane, with live loads. Where it has a strength its blocks crush
        (`limit.crushing`).

    Returns
    -------
    Collapse

    Raises
    ------
    InputError
        If nothing is known that a strength could be compared with.
    """
    still = np.zeros((len(problem.assembly.blocks), 3))
    live = sum((problem.of_load(load) for load in problem.live), still)
    problem = settled(problem, live)
    capacity = Capacity(problem)
    found, at_rest = capacity.of(live), problem.with_load(0.0)
    return replace(
        found,
        forces=found.forces
        if found.forces is None
        else symmetric_forces(at_rest, found.forces, live),
        mechanism=found.mechanism
        if found.mechanism is None
        else symmetric_rates(at_rest, found.mechanism, live),
    )
