"""Blocks that crush: the thrust needs a width, at the strength of the material.

A joint that carries a normal force n presses evenly on as much of its width as that force needs
at the compressive strength, as near to its end as can be (a rectangular block of stress). So
with P the force that crushes all of it, either end carries at least n^2 / (2 P). That is a cone
of the second order, also where the strength is sought, in proportion to which P is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.conic import Cone, solved_cones
from blocksim.common.errors import Unsolved
from blocksim.common.later import sparse
from blocksim.limit.bearing import Bearing, bears, settled
from blocksim.limit.cones import Cones, joint_areas
from blocksim.limit.linear import NONE, UNBOUNDED, Optimum
from blocksim.limit.programme import scaled

FINEST = 1e-11
"""Gap and residuals at which the solver may end; it ends where it gets no farther."""
FAITHFUL, ROUGH = 1e-7, 1e-5
"""Gap and residuals up to which its answer is taken; the gap of a strength, which is told with
it."""
NOTHING = 1e-6
"""Force that is none, over what the joint carries."""
ALIKE = 10.0
"""Ratio of the strength that is needed to that of which a share is sought, from which on it is
sought again as a share of the first."""
TRIES, FARTHER = 6, 100.0
"""How often another strength is tried, and how much more where nothing is told."""
SPARED = (0.9, 0.5, 0.2, 0.05)
"""Shares of forces that are tried beside those that need least strength."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Needed:
    """The least compressive strength at which forces of equilibrium exist.

    `low`, `high`: Between which it is [Pa], as far as the solver's gap and what its forces lack
        tell.
    `forces`, (joints, 2, 2): Those that were found, as of `Equilibrium`: they press least on
        the joint that is pressed most.
    `mechanism`, (blocks, 3): Rates x, y and rotation with which blocks of less strength begin
        to move.
    """

    low: float
    high: float
    forces: Array
    mechanism: Array


class Crushing:
    """The programmes of joints that crush.

    `problem`: In its plane, with weights and sizes.
    `bearing`: Of the problem.
    `strength`: Compressive strength [Pa], of any size.
    Raises `InputError`: If there are no weights or sizes to compare the strength with, or a
        corner bears a block: a point bears nothing then.
    """

    def __init__(self, problem: Problem, bearing: Bearing, strength: float) -> None:
        require_sizes(problem)
        self._bearing, self._soil = bearing, bearing.columns
        self._cones = cones = bearing.cones
        crushing = strength * joint_areas(problem) / problem.unit_force
        # Both ends of each joint.
        self._full = np.repeat(crushing, 2)
        self._unit = np.repeat(cones.unit, 2)
        self._ends = ends = cones.pressing
        self._both = (ends[0::2] + ends[1::2])[np.repeat(np.arange(crushing.size), 2)]
        self._kept = dict[tuple[bool, int, bool], tuple[Any, Any, Array]]()

    def most(self, column: Any, right: Array) -> tuple[Optimum, Array]:
        """Make the factor on a column as large as balance, friction and strength allow.

        Returns `found`: The factor is the last of its values; the first prices are those of
            the balance.
        Returns `shares`, (loads,): Of what soil bears.
        Raises `Unsolved`: If the solver gives up.
        """
        cost = np.append(np.zeros(self._cones.count), -1.0)
        # The solver's tolerances are of numbers near 1: a wheel that has hardly come is small.
        live = float(np.abs(column).sum())
        size = float(np.abs(right).sum()) / live if live else 1.0
        found, shares = self._solve(cost, column * size, right, self._soil)
        values = np.append(found.values[:-1], found.values[-1:] * size)
        return replace(found, values=values), shares

    def extreme(self, cost: Array, right: Array) -> Optimum:
        """Find forces of equilibrium within the strength, at the least cost."""
        return self._solve(cost, None, right, self._soil)[0]

    def least(self, right: Array) -> tuple[Optimum, Array]:
        """Find the least share of the strength that balance and friction need.

        Returns `found`: The share is the last of its values.
        Returns `shares`, (loads,): Of what soil bears.
        """
        cost = np.append(np.zeros(self._cones.count), 1.0)
        return self._solve(cost, None, right, self._soil, sought=True)

    def spared(self, parts: Array, right: Array) -> Array | None:
        """Return forces between some and those that need least strength, which need not all.

        Soil bears nothing more in them.
        """
        cost = np.append(np.zeros(self._cones.count), 1.0)
        found, _ = self._solve(cost, None, right, self._soil[:, :0], sought=True)
        if not found.exists:
            return None
        least = found.values[:-1]
        for share in SPARED:
            mixed = share * parts + (1 - share) * least
            if self.needed(mixed) < SPARED[0]:
                return mixed
        return None

    def at_most(self, parts: Array, added: Array) -> float:
        """Return the inverse of the largest factor at which added forces crush nothing."""
        end, force = self._ends @ parts, self._both @ parts
        more, pressed = self._ends @ added, self._both @ added
        spare = end - force**2 / (2 * self._full)
        slope, bend = more - force * pressed / self._full, pressed**2 / (2 * self._full)
        return float(((np.sqrt(slope**2 + 4 * spare * bend) - slope) / (2 * spare)).max())

    def needed(self, parts: Array) -> float:
        """Return the largest share of its strength that forces need at an end of a joint."""
        force, end = self._both @ parts, self._ends @ parts
        loaded = force > NOTHING * self._unit
        force, end, full = force[loaded], end[loaded], self._full[loaded]
        return float((force**2 / (2 * full * np.maximum(end, NOTHING**2 * force))).max())

    def _solve(
        self, cost: Array, column: Any, right: Array, soil: Any, *, sought: bool = False
    ) -> tuple[Optimum, Array]:
        """Find the least cost of parts, a factor on a column, and a share that is sought."""
        count, loads, rows = cost.size, int(soil.shape[1]), right.size
        matrix, bound = self._matrix(column, soil, sought=sought)
        ends: list[Cone] = [("second-order", 3)] * self._full.size
        cost = np.append(cost, np.zeros(loads))
        bounded = matrix.shape[0] - rows - bound.size
        every = np.concatenate([right, np.zeros(bounded - loads), np.ones(loads), bound])
        # What defeats the solver in one scale it solves in the other.
        for scaled_first in (True, False):
            found = solved_cones(
                sparse.csc_matrix((cost.size, cost.size)),
                cost,
                matrix,
                every,
                [("zero", rows), ("nonnegative", bounded), *ends],
                finest=FINEST,
                scaled=scaled_first,
            )
            said = str(found.status)
            # Of a strength that is sought it is wrong: that is 0 at least, and has no bound.
            if "Infeasible" in said and not sought:
                return UNBOUNDED if "Dual" in said else NONE, np.zeros(loads)
            values, prices = np.array(found.x), -np.array(found.z)
            lack = np.abs(matrix @ values + np.array(found.s) - every)
            # What forces lack may lower the cost by its price. A strength is taken with that as
            # its error.
            least = float(found.obj_val_dual) - float(np.abs(prices) @ lack)
            sure = float(found.obj_val_dual) if sought else least
            gap = (ROUGH if sought else FAITHFUL) * max(1.0, abs(float(found.obj_val)))
            if lack[:rows].max() < FAITHFUL and float(found.obj_val) - sure <= gap:
                optimum = replace(NONE, values=values[:count], prices=prices, least=least)
                return optimum, np.clip(values[count:], 0.0, 1.0)
        if self._is_hopeless(column, right, sought=sought):
            return NONE, np.zeros(loads)
        raise Unsolved

    def _is_hopeless(self, column: Any, right: Array, *, sought: bool) -> bool:
        """Tell whether no forces balance, or all that do need more strength.

        The solver has no proof of the first where any strength may be had; without bound on
        friction it often finds none of the second.
        """
        free = math.inf if column is not None else 0.0
        beside = sparse.csc_array((right.size, 1)) if column is None else column
        rigid, _ = self._bearing.most(beside, right, (-free, free))
        balances = rigid.exists or rigid.unbounded
        if sought or not balances:
            return not balances
        cost = np.zeros(self._cones.count + (column is not None) + 1)
        cost[-1] = 1.0
        found, _ = self._solve(cost, column, right, self._soil, sought=True)
        return not found.exists or found.least > 1 + FAITHFUL

    def _matrix(self, column: Any, soil: Any, *, sought: bool) -> tuple[Any, Array]:
        """Return the rows of balance, of bounds and of the law, and the right side of the last.

        But for the column they are the same again and again.
        """
        key = column is None, int(soil.shape[1]), sought
        if key not in self._kept:
            self._kept[key] = self._rows(soil, int(column is not None), int(sought))
        first, last, bound = self._kept[key]
        if column is None:
            return sparse.hstack([first, last], format="csc"), bound
        entries = column.data, column.indices, column.indptr
        middle = sparse.csc_array(entries, shape=(first.shape[0], 1))
        return sparse.hstack([first, middle, last], format="csc"), bound

    def _rows(self, soil: Any, beside: int, sought: int) -> tuple[Any, Any, Array]:
        """Return the columns before and after that of `_matrix`, and the right side."""
        cones, loads = self._cones, int(soil.shape[1])
        law, bound = self._law()
        count = cones.count + beside + sought
        shares = np.arange(count, count + loads)
        above = np.concatenate([np.flatnonzero(cones.bounded), shares])
        none = sparse.csc_array((cones.balance.shape[0], beside + sought))
        strength = np.zeros((bound.size, beside + sought + loads))
        if sought:
            strength[:, beside] = -bound
        rows = sparse.vstack(
            [
                sparse.hstack([cones.balance, none, soil]),
                _bounds(above, -1.0, count + loads),
                _bounds(shares, 1.0, count + loads),
                sparse.hstack([law, sparse.csr_array(strength)]),
            ],
            format="csc",
        )
        first, last = rows[:, : cones.count], rows[:, cones.count + beside :]
        return first, last, (1 - sought) * bound

    def _law(self) -> tuple[Any, Array]:
        """Return rows and right sides of n^2 <= 2 P m, three of each end.

        Of two numbers u and v and a third w it is w^2 <= u v: (u + v, u - v, 2 w) lies in a
        cone of the second order. With u and v of one size the solver tells how far within.
        """
        even = np.sqrt(2 * self._full / self._unit)
        u: Any = sparse.diags_array(even / self._unit) @ self._ends
        w: Any = sparse.diags_array(2 / self._unit) @ self._both
        size = self._full.size
        rows = sparse.vstack([u, u, w], format="csr")
        order = np.arange(3 * size).reshape(3, size).T.ravel()
        return -rows[order], np.concatenate([even, -even, np.zeros(size)])[order]


def strength_needed(problem: Problem) -> Needed | None:
    """Find the least compressive strength at which forces of equilibrium exist.

    None where there are none at any strength.

    `problem`: In its plane, with weights and sizes.
    Raises `InputError`: As of `Crushing`.
    Raises `Unsolved`: If the solver gives up.
    """
    problem = mobilised(problem)
    bearing = Bearing(problem)
    found = _least(problem, bearing)
    return None if found is None else _needed(bearing.cones, *found[:2])


def mobilised(problem: Problem, live: Array | None = None) -> Problem:
    """Do what `settled` does; of blocks that crush within their strength.

    `live`: As of `settled`; by default the strength that is needed is made least.
    """
    if problem.strength is None or not bears(problem):
        return settled(problem, live)
    bearing, shares = Bearing(problem), np.zeros(0)
    if live is None:
        found = _least(problem, bearing)
        shares = shares if found is None else found[2]
    else:
        cones, crushing = bearing.cones, Crushing(problem, bearing, problem.strength)
        dead = cones.loads(problem.with_load(0.0).applied_forces())
        optimum, mobile = crushing.most(sparse.csc_array(cones.loads(live)[:, None]), -dead)
        shares = mobile if optimum.exists else shares
    return bearing.added(problem, shares)


def _least(problem: Problem, bearing: Bearing) -> tuple[Optimum, float, Array] | None:
    """Find the share that is needed, of which strength, and the shares of soil with it."""
    require_sizes(problem)
    cones, pull = bearing.cones, problem.applied_forces()
    # Of which joints bear about what blocks weigh, so that its multiples are numbers near 1.
    unit = float(np.median(problem.unit_force * cones.unit / joint_areas(problem)))
    last = None
    for _ in range(TRIES):
        crushing = Crushing(problem, bearing, unit)
        try:
            found, shares = crushing.least(-cones.loads(pull))
        except Unsolved:
            if last is not None:
                return last
            unit *= FARTHER
            continue
        if not found.exists:
            return None
        share, last = float(found.values[-1]), (found, unit, shares)
        if 1 / ALIKE < share < ALIKE:
            return last
        unit *= share
    raise Unsolved


def _needed(cones: Cones, found: Optimum, unit: float) -> Needed:
    share = float(found.values[-1])
    error = max(share - found.least, FAITHFUL * share)
    return Needed(
        low=unit * max(share - error, 0.0),
        high=unit * (share + error),
        forces=cones.forces(found.values[:-1]),
        mechanism=scaled(cones.rates(found.prices[: cones.balance.shape[0]])),
    )


def require_sizes(problem: Problem) -> None:
    """Raise `InputError` where there is nothing that a strength could be compared with."""
    known = problem.weighed and problem.has_size
    value = "none" if problem.strength is None else f"{problem.strength / 1e6:g} MPa"
    require(known, "strength", value, "left out, or sizes and unit weights in m and kN/m3")
    corners = bool(problem.assembly.joint_arrays.is_corner.any())
    require(not corners, "strength", value, "left out: a corner bears a block without a width")


def _bounds(at: NDArray[np.intp], sign: float, count: int) -> Any:
    """Return rows that bound some of the values, below with a sign of -1."""
    entries = np.full(at.size, sign), (np.arange(at.size), at)
    return sparse.csc_array(entries, shape=(at.size, count))
