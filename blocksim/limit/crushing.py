"""Blocks that crush: the thrust needs a width, at the strength of the material.

A joint that carries a normal force n presses evenly on as much of its width as that force needs
at the compressive strength, as near to its end as can be (a rectangular block of stress). So
with P the force that crushes all of it, either end carries at least n^2 / (2 P). That is a cone
of the second order, also where the strength is sought, in proportion to which P is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.conic import Cone, solved_cones
from blocksim.common.errors import Unsolved
from blocksim.common.later import sparse
from blocksim.limit.bearing import bears
from blocksim.limit.cones import Cones, joint_areas
from blocksim.limit.linear import NONE, UNBOUNDED, Optimum
from blocksim.limit.programme import scaled

FINEST = 1e-11
"""Gap and residuals at which the solver may end; it ends where it gets no farther."""
FAITHFUL = 1e-7
"""Gap and residuals up to which its answer is taken."""
NOTHING = 1e-6
"""Force that is none, over what the joint carries."""
ALIKE = 10.0
"""Ratio of the strength that is needed to that of which a share is sought, up to which it is
exact."""
TRIES, FARTHER = 6, 100.0
"""How often another strength is tried, and how much more where nothing is told."""
SPARED = (0.9, 0.5, 0.2, 0.05)
"""Shares of forces that are tried beside those that need least strength."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Needed:
    """The least compressive strength at which forces of equilibrium exist.

    `low`, `high`: Between which it is [Pa]: no forces need less, and those that were found need
        the most.
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
    `cones`: Of the problem.
    `strength`: Compressive strength [Pa], of any size.
    Raises `InputError`: If there are no weights or sizes to compare the strength with, or a
        corner bears a block: a point bears nothing then.
    """

    def __init__(self, problem: Problem, cones: Cones, strength: float) -> None:
        require_sizes(problem)
        crushing = strength * joint_areas(problem) / problem.unit_force
        # Both ends of each joint.
        self._cones, self._full = cones, np.repeat(crushing, 2)
        self._unit = np.repeat(cones.unit, 2)
        self._ends = ends = cones.pressing
        self._both = (ends[0::2] + ends[1::2])[np.repeat(np.arange(crushing.size), 2)]

    def most(self, column: Any, right: Array) -> Optimum:
        """Make the factor on a column as large as balance, friction and strength allow.

        The factor is the last of its values; the first prices are those of the balance.

        Raises `Unsolved`: If the solver gives up.
        """
        cost = np.append(np.zeros(self._cones.count), -1.0)
        return self._solve(cost, column, right)

    def extreme(self, cost: Array, right: Array) -> Optimum:
        """Find forces of equilibrium within the strength, at the least cost."""
        return self._solve(cost, None, right)

    def least(self, right: Array) -> Optimum:
        """Find the least share of the strength that balance and friction need.

        The share is the last of the values.
        """
        cost = np.append(np.zeros(self._cones.count), 1.0)
        return self._solve(cost, None, right, sought=True)

    def spared(self, parts: Array, right: Array) -> Array | None:
        """Return forces between some and those that need least strength, which need not all."""
        found = self.least(right)
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
        self, cost: Array, column: Any, right: Array, *, sought: bool = False
    ) -> Optimum:
        """Find the least cost; beside the parts a factor, or a share that is sought."""
        cones, count = self._cones, cost.size
        beside = sparse.csc_array((right.size, 1)) if sought else column
        balance: Any = cones.balance
        if count > cones.count:
            balance = sparse.hstack([balance, beside], format="csc")
        presses = np.flatnonzero(cones.bounded)
        ones = np.ones(presses.size)
        pressing = sparse.csc_array(
            (-ones, (np.arange(presses.size), presses)), shape=(presses.size, count)
        )
        law, bound = self._law(count, sought=sought)
        matrix = sparse.csc_matrix(sparse.vstack([balance, pressing, law]))
        ends: list[Cone] = [("second-order", 3)] * self._full.size
        found = solved_cones(
            sparse.csc_matrix((count, count)),
            cost,
            matrix,
            np.concatenate([right, np.zeros(presses.size), bound]),
            [("zero", right.size), ("nonnegative", presses.size), *ends],
            finest=FINEST,
        )
        said, values = str(found.status), np.array(found.x)
        if "Infeasible" in said:
            return UNBOUNDED if "Dual" in said else NONE
        balanced = bool(np.isfinite(values).all())
        balanced = balanced and np.abs(balance @ values - right).max() < FAITHFUL
        gap = abs(float(found.obj_val) - float(found.obj_val_dual))
        if not balanced or gap > FAITHFUL * max(1.0, abs(float(found.obj_val))):
            raise Unsolved
        return Optimum(values=values, prices=-np.array(found.z), unbounded=False)

    def _law(self, count: int, *, sought: bool) -> tuple[Any, Array]:
        """Return rows and right sides of n^2 <= 2 P m, three of each end.

        Of two numbers u and v and a third w it is w^2 <= u v: (u + v, u - v, 2 w) lies in a
        cone of the second order.
        """
        ease = sparse.diags_array(1 / self._unit)
        u: Any = sparse.diags_array(2 * self._full / self._unit**2) @ self._ends
        w: Any = 2 * ease @ self._both
        size = self._full.size
        rows = sparse.vstack([u, u, w], format="csr")
        v = np.concatenate([np.ones(size), -np.ones(size), np.zeros(size)])
        order = np.arange(3 * size).reshape(3, size).T.ravel()
        if count > self._cones.count:
            last = sparse.csr_array(v[:, None] if sought else np.zeros((3 * size, 1)))
            rows = sparse.hstack([rows, last], format="csr")
        return -rows[order], (0.0 if sought else 1.0) * v[order]


def strength_needed(problem: Problem) -> Needed | None:
    """Find the least compressive strength at which forces of equilibrium exist.

    None where there are none at any strength.

    `problem`: In its plane, with weights and sizes.
    Raises `InputError`: As of `Crushing`.
    Raises `Unsolved`: If the solver gives up.
    """
    require_sizes(problem)
    cones, pull = Cones(problem), problem.applied_forces()
    # Of which joints bear about what blocks weigh, so that its multiples are numbers near 1.
    unit = float(np.median(problem.unit_force * cones.unit / joint_areas(problem)))
    for _ in range(TRIES):
        crushing = Crushing(problem, cones, unit)
        try:
            found = crushing.least(-cones.loads(pull))
        except Unsolved:
            unit *= FARTHER
            continue
        if not found.exists:
            return None
        share = float(found.values[-1])
        if 1 / ALIKE < share < ALIKE:
            return _needed(cones, crushing, found, unit)
        unit *= share
    raise Unsolved


def _needed(cones: Cones, crushing: Crushing, found: Optimum, unit: float) -> Needed:
    parts, low = found.values[:-1], float(found.values[-1])
    return Needed(
        low=unit * low * (1 - FAITHFUL),
        high=unit * max(low, crushing.needed(parts)),
        forces=cones.forces(parts),
        mechanism=scaled(cones.rates(found.prices[: cones.balance.shape[0]])),
    )


def require_sizes(problem: Problem) -> None:
    """Raise `InputError` where there is nothing that a strength could be compared with."""
    known = problem.weighed and problem.has_size
    value = "none" if problem.strength is None else f"{problem.strength / 1e6:g} MPa"
    require(known, "strength", value, "left out, or sizes and unit weights in m and kN/m3")
    allowed = "left out beside --fill-passive: what soil bears is not sought with it"
    require(not bears(problem), "strength", value, allowed)
    corners = bool(problem.assembly.joint_arrays.is_corner.any())
    require(not corners, "strength", value, "left out: a corner bears a block without a width")
