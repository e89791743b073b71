"""Motions of blocks in which joints open by more than rounding can close."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.common.errors import Unsolved
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
FAR = 1e5
"""Largest motion in which a joint is said to be able to open by 1."""
SURELY = 100.0
"""Rate that counts as one, over what the solver leaves open."""
LARGEST = 400
"""Most equations that are solved in rationals."""
Flags = NDArray[np.bool_]
Places = NDArray[np.int64]
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
    # Bodies may be held where their blocks are not: they are asked about last.
    for owner in (np.arange(count), None if rates is None else _alike(problem, cones, rates)):
        if owner is None:
            return
        try:
            found = _Bodies(problem, cones, owner).motion()
        except Unsolved:
            return
        if found is not None:
            yield found


def _alike(problem: Problem, cones: Cones, rates: Array) -> Places:
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
    owner = np.full(count, SUPPORT, dtype=np.int64)
    owner[free] = np.unique(label[:-1][free], return_inverse=True)[1]
    return owner


class _Bodies:
    """Bodies of blocks, and what their motions do at joints; in scales of their own."""

    def __init__(self, problem: Problem, cones: Cones, owner: Places) -> None:
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
        edges: Any = cones.balance.T @ blocks
        self._edges: Any = edges.tocsr()
        work: Any = problem.pull().ravel() @ carried
        self._pull: Array = work

    def motion(self) -> Motion | None:
        """Return the motion that opens joints by as much as the loads do work."""
        if not self._count:
            return None
        moved = np.diff(self._edges.indptr) > 0
        rows = sparse.vstack(
            [self._edges[moved], sparse.csr_array(self._pull[None, :])]
        ).tocsr()
        opens = np.append(self._cones.bounded[moved] > 0, True)
        motion = _widest(rows, opens)
        if motion is None:
            # Some joints cannot open, whatever moves.
            able = _opening(rows, opens)
            if not able[-1] or (able == opens).all():
                return None
            opens, motion = able, _widest(rows, able)
        if motion is None:
            return None
        return self._exactly(motion, np.flatnonzero(moved)[~opens[:-1]].astype(np.int64))

    def _exactly(self, values: Array, held: Places) -> Motion | None:
        """Return a motion in rationals, at which parts of joints that are held do not move."""
        scale = self.scale * [self._size, self._size, 1.0]
        motion = [Fraction(each) for each in (values * scale.ravel()).tolist()]
        if len(held):
            matrix = self._edges[held].toarray()
            rank, rows, columns = _independent(matrix)
            if rank > LARGEST:
                return None
            lines = [self._line(part) for part in held[rows].tolist()]
            own: list[int] = columns.tolist()
            rest: list[Fraction] = []
            for line in lines:
                known = (c * motion[at] for at, c in line.items() if at not in own)
                rest.append(-sum(known, Fraction(0)))
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
            ends = found.inner.tolist() + found.outer.tolist()
            x1, y1, x2, y2 = (Fraction(each) for each in ends)
            x, y = y2 - y1, x1 - x2
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


def _widest(rows: Any, opens: Flags) -> Array | None:
    """Find the motion whose least rate is the largest, of those of the rows that open.

    None where that is not above 0. The others must be 0.
    """
    size = rows.shape[1]
    column = sparse.csr_array(-opens.astype(np.float64)[:, None])
    matrix = sparse.hstack([rows, column], format="csc")
    cost = np.append(np.zeros(size), -1.0)
    high = np.where(opens, math.inf, 0.0)
    equal: Array = rows[~opens].toarray()
    motion, step = np.zeros(size), 1.0
    for _ in range(REFINED):
        # What is left of the rows, and of the largest motion, in ever finer units.
        least = np.where(opens, -(rows @ motion) / step, 0.0)
        bounds = (
            np.append((-1 - motion) / step, -math.inf),
            np.append((1 - motion) / step, 1 / step),
        )
        found = LinearProgramme().solve(cost, matrix, (least, high), bounds)
        if not found.exists:
            return None
        motion = motion + step * found.values[:-1]
        if len(equal):
            solve: Any = linalg.lstsq
            motion = motion - solve(equal, equal @ motion, cond=RANK)[0]
        if found.values[-1] > SURELY * FINEST:
            return motion
        step *= FINER
    return None


def _opening(rows: Any, opens: Flags) -> Flags:
    """Tell which rows can be above 0: all of them at once, as motions can be added."""
    count, size = rows.shape
    able, low_rows = np.flatnonzero(opens), np.zeros(len(opens))
    pick = sparse.csr_array(
        (-np.ones(len(able)), (able, np.arange(len(able)))), shape=(count, len(able))
    )
    cost = np.append(np.zeros(size), -np.ones(len(able)))
    ends = np.append(np.full(size, FAR), np.ones(len(able)))
    low = np.append(np.full(size, -FAR), np.zeros(len(able)))
    matrix: Any = sparse.hstack([rows, pick], format="csc")
    found = LinearProgramme().solve(
        cost,
        matrix,
        (low_rows, np.where(opens, math.inf, 0.0)),
        (low, ends),
    )
    can = np.zeros(count, dtype=bool)
    if found.exists:
        can[able] = found.values[size:] > 1 / 2
    return can


def _independent(matrix: Array) -> tuple[int, Places, Places]:
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
