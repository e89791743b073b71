"""Blocks at rest or falling, told exactly: a linear programme in rational numbers.

What contacts leave unbalanced, each part over the weight that its block carries, is made as
little as it can be. Where that is nothing there are forces of equilibrium; else its dual is a
mechanism that gains work. Doubles find a vertex that is optimal but for round-off. Whether it
is so exactly is seen by solving its equations in rational numbers, and where it is not, the
simplex method goes on in them (Applegate, Cook, Dash and Espinoza 2007).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.common.errors import Unsolved
from blocksim.common.later import flint, sparse
from blocksim.limit.exact import NOTHING, Exact, Point, apart, spun
from blocksim.limit.linear import LinearProgramme

LARGEST = 300
"""Most equations that are solved in rational numbers."""
STEPS = 500
"""Most steps of the simplex method in rational numbers."""
Column = dict[int, int]


class Bodies:
    """Bodies of blocks that move as one, and what forces at joints do to them.

    `owner`, (blocks,) sequence of int: Body of each block; `SUPPORT` where it stays at rest.
    """

    def __init__(self, exact: Exact, owner: Sequence[int]) -> None:
        self._exact, self._owner = exact, owner
        self._about: dict[int, Point] = {}
        for body, centre in zip(owner, exact.centres, strict=True):
            self._about.setdefault(body, centre)
        self.size = PLANAR * (max(owner, default=SUPPORT) + 1)
        self._right = [0] * self.size
        for body, (cx, cy), (x, y, turn) in zip(owner, exact.centres, exact.pull, strict=True):
            if body != SUPPORT:
                px, py = self._about[body]
                wrench = (x, y, turn + (cx - px) * y - (cy - py) * x)
                for at, value in enumerate(wrench, PLANAR * body):
                    self._right[at] -= value
        self._parts: list[tuple[int, int, int]] = []
        self._columns: list[Column] = []
        self._free: list[bool] = []
        for joint, mu in enumerate(exact.friction):
            one, other = exact.ends[joint]
            for end in (0,) if one == other else (0, 1):
                if mu is None:
                    self._add(joint, end, 1, 0)
                    self._add(joint, end, 0, 1, free=True)
                    continue
                p, q = mu.as_integer_ratio()
                for way in (p, -p) if p else (0,):
                    self._add(joint, end, q if p else 1, way)

    def _add(self, joint: int, end: int, a: int, b: int, *, free: bool = False) -> None:
        """Add a force a n + b t at an end of a joint."""
        (p, q), (x, y) = self._exact.normals[joint], self._exact.ends[joint][end]
        u, v = a * p - b * q, a * q + b * p
        before, after = (SUPPORT if side == SUPPORT else self._owner[side]
                         for side in self._exact.sides[joint])  # fmt: skip
        if before == after:
            return
        column: Column = {}
        for body, sign in ((before, -1), (after, 1)):
            if body != SUPPORT:
                px, py = self._about[body]
                wrench = (u, v, (x - px) * v - (y - py) * u)
                column |= {at: sign * each for at, each in enumerate(wrench, PLANAR * body)}
        self._parts.append((4 * joint + 2 * end, a, b))
        self._columns.append({at: each for at, each in column.items() if each})
        self._free.append(free)

    def solved(self, weights: Array) -> _Vertex | None:
        """Find the least that is left, by what blocks carry [N]; None where it is not known."""
        size, count = self.size, len(self._columns)
        if not 0 < size <= LARGEST:
            return None
        ease = self._ease(weights)
        rows, columns, values = zip(
            *((at, place, ease[at] * float(each))
              for place, column in enumerate(self._columns) for at, each in column.items()),
            strict=True,
        )  # fmt: skip
        matrix = sparse.csc_array((values, (rows, columns)), shape=(size, count))
        scale = 1 / np.maximum.reduceat(np.abs(matrix.data), matrix.indptr[:-1])
        unit: Any = sparse.eye_array(size)
        both = sparse.hstack([matrix @ sparse.diags_array(scale), unit, -unit], format="csc")
        right = ease * np.array([float(each) for each in self._right])
        low = np.where([*self._free, *[False] * (2 * size)], -math.inf, 0.0)
        cost = np.append(np.zeros(count), np.ones(2 * size))
        try:
            ends = (right, right), (low, np.full(len(low), math.inf))
            found = LinearProgramme().solve(cost, both, *ends)
        except Unsolved:
            return None
        whole = [*self._columns, *({at: s} for s in (1, -1) for at in range(size))]
        return _Vertex(
            whole,
            self._right,
            [flint.fmpq(0)] * count
            + [flint.fmpq(*each.as_integer_ratio()) for each in ease.tolist()] * 2,
            [*self._free, *[False] * (2 * size)],
            [*found.basic[0], *(count + at for at in found.basic[1])],
        )

    def _ease(self, weights: Array) -> Array:
        """Return one over what each equation is of: a weight, or that times a reach."""
        exact = self._exact
        reach = exact.problem.assembly.reach / float(exact.grain)
        found = np.zeros((self.size // PLANAR, PLANAR))
        for body, weight, far, centre in zip(
            self._owner, weights.tolist(), reach.tolist(), exact.centres, strict=True
        ):
            if body != SUPPORT:
                arm = math.dist(centre, self._about[body]) + far
                found[body] = np.maximum(found[body], [weight, weight, weight * arm])
        return float(exact.force) / found.ravel()

    def forces(self, vertex: _Vertex) -> list[Fraction]:
        """Return a, b at both ends of each joint, in units of force over the grain."""
        found = [NOTHING] * (4 * len(self._exact.sides))
        for at, value in vertex.basics():
            if at < len(self._parts):
                place, a, b = self._parts[at]
                found[place] += a * value
                found[place + 1] += b * value
        return found

    def motion(self, vertex: _Vertex) -> list[list[int]]:
        """Return x, y and rotation of each block, as whole numbers of any unit."""
        rates = [-_fraction(each) for each in vertex.prices]
        below = math.lcm(*(each.denominator for each in rates))
        whole = [int(each * below) for each in rates]
        of_blocks = [whole[PLANAR * body :][:PLANAR] or [0] * PLANAR for body in self._owner]
        return as_bodies(self._exact, of_blocks, self._owner)


class _Vertex:
    """A vertex of a linear programme: min cost x, where A x = right, x >= 0 or free."""

    def __init__(
        self,
        columns: list[Column],
        right: list[int],
        cost: list[Any],
        free: list[bool],
        basis: list[int],
    ) -> None:
        self._columns, self._free, self._basis = columns, free, basis
        self._size = len(right)
        self._right: Any = flint.fmpq_mat(self._size, 1, right)
        self._cost = cost
        self._solve(self._right)

    def _solve(self, right: Any) -> None:
        """Solve for the basic unknowns, and for the prices of the equations."""
        size = self._size
        flat = [0] * (size * size)
        for place, index in enumerate(self._basis):
            for at, value in self._columns[index].items():
                flat[size * at + place] = value
        self._matrix: Any = flint.fmpq_mat(size, size, flat)
        self._turned = self._matrix.transpose()
        self.values: list[Any] = self._matrix.solve(right).entries()
        cost = [self._cost[index] for index in self._basis]
        self.prices: list[Any] = self._turned.solve(flint.fmpq_mat(size, 1, cost)).entries()

    def basics(self) -> Iterator[tuple[int, Fraction]]:
        """Return the basic unknowns and their values."""
        return zip(self._basis, map(_fraction, self.values), strict=True)

    @property
    def cost(self) -> Fraction:
        """The cost of the vertex."""
        return sum((_fraction(self._cost[at]) * value for at, value in self.basics()), NOTHING)

    def improved(self) -> bool:
        """Go on to the optimum; False where that takes too long, or doubles went astray."""
        try:
            return self._primal() and self._dual()
        except ZeroDivisionError:
            return False

    def _primal(self) -> bool:
        """Lower the cost, where unknowns may stay as far below 0 as round-off left them."""
        # They count from there: with these values the vertex is feasible.
        right = self._right
        for index, value in zip(self._basis, self.values, strict=True):
            if value < 0 and not self._free[index]:
                right = right - value * self._column(index)
        self._solve(right)
        for _ in range(STEPS):
            entering, sign = self._entering()
            if entering is None:
                return True
            way: list[Any] = self._matrix.solve(self._column(entering)).entries()
            # Of equals the one that comes first: it does not go round in circles (Bland 1977).
            able = [
                (value / (sign * by), index, place)
                for place, (value, by, index) in enumerate(
                    zip(self.values, way, self._basis, strict=True)
                )
                if sign * by > 0 and not self._free[index]
            ]
            self._basis[min(able)[2]] = entering
            self._solve(right)
        return False

    def _entering(self) -> tuple[int | None, int]:
        """Return the first unknown that lowers the cost, and which way."""
        basic = set(self._basis)
        for index in range(len(self._columns)):
            if index not in basic:
                gain = self._reduced(index)
                if gain < 0 or (self._free[index] and gain != 0):
                    return index, 1 if gain < 0 else -1
        return None, 0

    def _dual(self) -> bool:
        """Bring all unknowns above 0 again: none of the others lowers the cost."""
        self._solve(self._right)
        for _ in range(STEPS):
            below = [
                (index, place)
                for place, (index, value) in enumerate(
                    zip(self._basis, self.values, strict=True)
                )
                if value < 0 and not self._free[index]
            ]
            if not below:
                return True
            place, basic = min(below)[1], set(self._basis)
            unit = [int(each == place) for each in range(self._size)]
            row = self._turned.solve(flint.fmpq_mat(self._size, 1, unit)).entries()
            able: list[tuple[Any, int]] = []
            for index, column in enumerate(self._columns):
                by = sum((row[at] * each for at, each in column.items()), flint.fmpq(0))
                if index not in basic and (by < 0 or (self._free[index] and by != 0)):
                    able.append((self._reduced(index) / abs(by), index))
            self._basis[place] = min(able)[1]
            self._solve(self._right)
        return False

    def _reduced(self, index: int) -> Any:
        """Return by how much the cost grows with an unknown that is not basic."""
        worth = (self.prices[at] * each for at, each in self._columns[index].items())
        return self._cost[index] - sum(worth, flint.fmpq(0))

    def _column(self, index: int) -> Any:
        column = self._columns[index]
        return flint.fmpq_mat(self._size, 1, [column.get(at, 0) for at in range(self._size)])


def as_bodies(
    exact: Exact, rates: Sequence[list[int]], owner: Sequence[int]
) -> list[list[int]]:
    """Return the motion of each block with the first one of its body.

    `rates`, (blocks,): Velocity and rotation of each.
    `owner`: As of `Bodies`.
    """
    first, found = dict[int, int](), list[list[int]]()
    for block, (body, centre) in enumerate(zip(owner, exact.centres, strict=True)):
        at = first.setdefault(body, block)
        rate = rates[at]
        velocity, turn = rate[: exact.axes], rate[exact.axes :]
        by_turn = spun(turn, apart(centre, exact.centres[at]))
        moved = [p + q for p, q in zip(velocity, by_turn, strict=True)]
        found.append([0] * len(rate) if body == SUPPORT else [*moved, *turn])
    return found


def _fraction(value: Any) -> Fraction:
    return Fraction(int(value.p), int(value.q))
