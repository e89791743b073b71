"""Motions in which joints open by more than rounding can close: of blocks, or bodies of them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.common.later import Library
from blocksim.limit.cones import Cones
from blocksim.limit.linear import FINEST, LinearProgramme

if TYPE_CHECKING:
    import flint
    from scipy import linalg, sparse
    from scipy.sparse import csgraph
else:
    sparse, csgraph = Library("scipy.sparse"), Library("scipy.sparse.csgraph")
    linalg, flint = Library("scipy.linalg"), Library("flint")

ALIKE = 1e-7
"""Rates at a joint, over the largest, up to which its blocks move as one."""
REFINED, FINER = 3, 1e-5
"""How often a programme is refined, and by how much each time."""
RANK = 1e-9
"""Pivot below which equations count as dependent, over the largest."""
HELD = 1e-6
"""Share of a programme's price from which on a joint is one that cannot open."""
ROUNDS = 8
"""Most rounds in which joints are found that cannot open."""
LARGEST = 400
"""Most equations that are solved in rationals."""
Motion = tuple[list[int], Array, list[list[Fraction]]]


def motion_that_opens(problem: Problem, cones: Cones, rates: Array | None) -> Iterator[Motion]:
    """Find motions of bodies that no joint forbids, and in which the loads do work.

    Parameters
    ----------
    problem : Problem
    cones : Cones
        Of the same problem.
    rates : (blocks, 3) float or None
        A mechanism, which says which blocks move as one.

    Yields
    ------
    owner : list of int
        Body of each block; `SUPPORT` where it stays at rest.
    points : (bodies, 2) float
        Point of each body that its motion is about [m].
    motions : list of three Fraction
        x, y [m] and rotation of each.
    """
    count = len(problem.assembly.blocks)
    ways = [] if rates is None else [_alike(problem, cones, rates)]
    for owner in (*ways, np.arange(count)):
        found = _Bodies(problem, cones, owner).motion()
        if found is not None:
            yield found


def _alike(problem: Problem, cones: Cones, rates: Array) -> Array:
    """Return the body of each block, of those that rates do not part."""
    joints, sides = problem.assembly.joint_arrays, problem.assembly.sides
    moved = np.vstack([rates, np.zeros(PLANAR)])[sides]
    arms = joints.ends[None] - problem.assembly.built[sides, None, :2]
    across = np.stack([-arms[..., 1], arms[..., 0]], axis=-1)
    ways = moved[..., None, :2] + moved[..., None, 2:] * across
    apart = cones.unit * np.abs(ways[1] - ways[0]).max(axis=(1, 2))
    turn = cones.unit * np.abs(moved[1, :, 2] - moved[0, :, 2])
    reach = np.append(problem.assembly.reach / problem.assembly.size, math.inf)[sides].min(
        axis=0
    )
    apart = np.maximum(apart, turn * reach)
    together = apart <= ALIKE * float(apart.max())
    count = len(rates)
    one, other = (np.where(side == SUPPORT, count, side)[together] for side in sides)
    graph = sparse.coo_array((np.ones(len(one)), (one, other)), shape=(count + 1, count + 1))
    label = csgraph.connected_components(graph, directed=False)[1]
    free = label[:-1] != label[-1]
    owner = np.full(count, SUPPORT)
    owner[free] = np.unique(label[:-1][free], return_inverse=True)[1]
    return owner


class _Bodies:
    """Bodies of blocks, and what their motions do at joints; in scales of their own."""

    def __init__(self, problem: Problem, cones: Cones, owner: Array) -> None:
        assembly = problem.assembly
        self._problem, self._cones, self._owner = problem, cones, owner
        self._count = int(owner.max(initial=-1)) + 1
        self._size = size = assembly.size
        own = np.flatnonzero(owner != SUPPORT)
        body = owner[own]
        many = np.bincount(body, minlength=self._count)
        middle = np.stack(
            [np.bincount(body, at, minlength=self._count) / many
             for at in assembly.centres[own].T / size], axis=1,
        )  # fmt: skip
        # Points that rationals can be added to without growing.
        self.points = np.round(middle, 3) * size
        arm = (assembly.centres[own] - self.points[body]) / size
        weight = np.zeros(self._count)
        np.maximum.at(weight, body, 1 / cones.ease[own, 0])
        reach = np.zeros(self._count)
        far = np.hypot(*arm.T) + assembly.reach[own] / size
        np.maximum.at(reach, body, far)
        self.scale = 1 / np.stack([weight, weight, weight * reach], axis=1)
        ones = np.ones(len(own))
        rows = PLANAR * np.concatenate([own, own, own, own, own]) + np.repeat(
            [0, 1, 2, 0, 1], len(own)
        )
        columns = PLANAR * np.tile(body, 5) + np.repeat([0, 1, 2, 2, 2], len(own))
        values = np.concatenate([ones, ones, ones, -arm[:, 1], arm[:, 0]])
        shape = (PLANAR * len(owner), PLANAR * self._count)
        carried = sparse.csc_array((values, (rows, columns)), shape=shape)
        carried = carried @ sparse.diags_array(self.scale.ravel())
        # Rates at the edges of cones, and the work of loads.
        blocks = sparse.diags_array(1 / cones.ease.ravel()) @ carried
        self._edges = (cones.balance.T @ blocks).tocsr()
        self._pull = problem.pull().ravel() @ carried

    def motion(self) -> Motion | None:
        """Return the motion that opens joints by as much as the loads do work."""
        held = self._cones.bounded == 0
        moved = np.diff(self._edges.indptr) > 0
        for _ in range(ROUNDS if self._count else 0):
            opens = np.append(~held[moved], True).astype(np.float64)
            rows = sparse.vstack([self._edges[moved], sparse.csr_array(self._pull[None])])
            found = _widest(rows, opens)
            if found is None:
                return None
            motion, prices = found
            if not prices.size:
                return self._exactly(motion, np.flatnonzero(held & moved))
            price = np.zeros(len(held))
            price[moved] = np.abs(prices[:-1])
            more = (price > HELD) & ~held
            if abs(prices[-1]) > HELD or not more.any():
                return None
            held = held | more
        return None

    def _exactly(self, values: Array, held: Array) -> Motion | None:
        """Return a motion in rationals, at which parts of joints that are held do not move."""
        scale = self.scale * [self._size, self._size, 1.0]
        motion = [Fraction(each) for each in (values * scale.ravel()).tolist()]
        if len(held):
            matrix = self._edges[held].toarray()
            rank, rows, columns = _independent(matrix)
            if rank > LARGEST:
                return None
            lines = [self._line(part) for part in held[rows].tolist()]
            own = set(columns.tolist())
            rest = [-sum(c * motion[at] for at, c in line.items() if at not in own)
                    for line in lines]  # fmt: skip
            solved = _solved(
                [[line.get(at, Fraction(0)) for at in own] for line in lines], rest
            )
            if solved is None:
                return None
            for at, value in zip(own, solved, strict=True):
                motion[at] = value
        motions = [motion[at : at + PLANAR] for at in range(0, len(motion), PLANAR)]
        return self._owner.tolist(), self.points, motions

    def _line(self, part: int) -> dict[int, Fraction]:
        """Return how much each motion opens, or slides, what a part of a joint presses on."""
        joint, end, normal, tangent = self._cones.part(part)
        found = self._problem.assembly.joints[joint]
        point = [Fraction(each) for each in (found.outer if end else found.inner).tolist()]
        if found.across is None:
            x, y = (Fraction(q) - Fraction(p)
                    for p, q in zip(found.inner.tolist(), found.outer.tolist(), strict=True))  # fmt: skip
            x, y = y, -x
        else:
            x, y = (Fraction(each) for each in found.across.tolist())
        x, y = normal * x - tangent * y, normal * y + tangent * x
        line: dict[int, Fraction] = {}
        for block, sign in ((found.before, -1), (found.after, 1)):
            body = SUPPORT if block == SUPPORT else int(self._owner[block])
            if body == SUPPORT:
                continue
            px, py = (Fraction(each) for each in self.points[body].tolist())
            turn = (point[0] - px) * y - (point[1] - py) * x
            for at, value in enumerate((x, y, turn)):
                place = PLANAR * body + at
                line[place] = line.get(place, Fraction(0)) + sign * value
        return line


def _widest(rows: sparse.csr_array, opens: Array) -> tuple[Array, Array] | None:
    """Find the motion whose least rate is the largest, of those of the rows that open.

    Returns
    -------
    motion : (unknowns,) float
    prices : (rows,) float
        Empty where the rate is above `OPEN`.
    """
    size = rows.shape[1]
    matrix = sparse.hstack([rows, sparse.csr_array(-opens[:, None])], format="csc")
    high = np.where(opens > 0, math.inf, 0.0)
    cost = np.append(np.zeros(size), -1.0)
    motion, step = np.zeros(size), 1.0
    prices = np.zeros(0)
    for _ in range(REFINED):
        # What is left of the rows, and of the largest motion, in ever finer units.
        least = -(rows @ motion) / step
        bounds = (np.append((-1 - motion) / step, -math.inf),
                  np.append((1 - motion) / step, 1 / step))  # fmt: skip
        found = LinearProgramme().solve(
            cost, matrix, (least, np.where(opens > 0, math.inf, least)), bounds
        )
        if not found.exists:
            return None
        motion = motion + step * found.values[:-1]
        least_rate = step * float(found.values[-1])
        prices = found.prices
        if least_rate > 100 * step * FINEST:
            return motion, np.zeros(0)
        step *= FINER
    return motion, prices


def _independent(matrix: Array) -> tuple[int, Array, Array]:
    """Return the rank of a matrix, and rows and columns that have it."""
    qr: Any = linalg.qr
    _, upper, rows = qr(matrix.T, pivoting=True, mode="economic")
    size = np.abs(np.diag(upper))
    rank = int((size > RANK * size.max(initial=0.0)).sum())
    _, _, columns = qr(matrix[rows[:rank]], pivoting=True, mode="economic")
    return rank, rows[:rank], np.sort(columns[:rank])


def _solved(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction] | None:
    """Solve a square system of rationals; None where it is singular."""
    size = len(right)
    made: Any = flint.fmpq_mat
    one: Any = flint.fmpq
    left = made(size, size, [one(c.numerator, c.denominator) for row in matrix for c in row])
    column = made(size, 1, [one(c.numerator, c.denominator) for c in right])
    try:
        found = left.solve(column)
    except ZeroDivisionError:
        return None
    return [Fraction(int(found[at, 0].p), int(found[at, 0].q)) for at in range(size)]
