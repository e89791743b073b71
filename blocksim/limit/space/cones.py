"""Forces within friction by cone programmes: the largest value of an unknown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from blocksim.blocks.assembly import Array
from blocksim.common.conic import Cone, cones_of_friction, solved_cones
from blocksim.common.errors import Unsolved

FINEST = 1e-11
"""Gap and residuals at which Clarabel may end; it ends where it gets no farther."""
CERTAIN = ("Solved", "PrimalInfeasible", "DualInfeasible")
SOLVED = ("Solved", "AlmostSolved", "InsufficientProgress", "MaxIterations", "NumericalError")
"""What it says where it has values, which are judged by what they are."""
REFUTED = {
    "PrimalInfeasible": 1e-9,
    "DualInfeasible": 1e-9,
    "AlmostPrimalInfeasible": 1.0,
    "AlmostDualInfeasible": 1.0,
}
"""Residual of a solution, by the other way of scaling, that refutes that there is none."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What came of a programme.

    `forces`, (3 points,): Empty where there is none.
    `value`: The largest value of what was sought; inf where nothing bounds it, -inf where no
        forces balance at any value.
    `rates`, (rows,): Prices of equilibrium: rates at which blocks move.
    """

    forces: Array
    value: float
    rates: Array


def most(
    matrix: Any,
    pull: Array,
    friction: Array,
    live: Array | None = None,
    lift: float | Array = 0.0,
) -> Answer:
    """Find forces within friction that balance, at the largest value of one unknown.

    `matrix`, (rows, 3 points) sparse: What forces at the points do: along the normal, and two
        ways across.
    `pull`, (rows,): What they balance.
    `friction`, (points,): inf allowed.
    `live`, (rows,): Pulls times the unknown besides. Without, the unknown is what each point
        presses by more than friction needs, and at most 1.
    `lift`: What each normal force adds to the unknown: rates then open every point by that
        much.
    """
    rows, points = int(matrix.shape[0]), len(friction)
    presses = live is None
    column = np.zeros(rows) if live is None else live
    equal = sparse.hstack([matrix, sparse.csc_matrix(column[:, None])], format="csc")
    law, kinds = _law(friction, 1.0 if presses else 0.0)
    blocks, right = [equal, -law], [-pull, np.zeros(law.shape[0])]
    cones: list[Cone] = [("zero", rows), *kinds]
    if presses:
        blocks.append(sparse.csc_matrix(([1.0], ([0], [3 * points])), (1, 3 * points + 1)))
        right.append(np.ones(1))
        cones.append(("nonnegative", 1))
    cost = np.zeros(3 * points + 1)
    cost[-1], cost[:-1:3] = -1.0, -lift
    programme = cost, sparse.vstack(blocks, format="csc"), np.concatenate(right), cones
    # Equations come in units of their own: the solver's scaling mostly does harm.
    found = _solved(programme, scaled=False)
    if str(found.status) not in CERTAIN:
        found = min(found, _solved(programme, scaled=True), key=_left_over)
    said = str(found.status)
    values: Array = np.array(found.x)
    prices: Array = np.array(found.z)
    if "PrimalInfeasible" in said:
        return Answer(np.zeros(0), -np.inf, prices[:rows])
    if "DualInfeasible" in said:
        return Answer(np.zeros(0), np.inf, np.zeros(rows))
    if said not in SOLVED or not np.isfinite(values).all() or not np.isfinite(prices).all():
        raise Unsolved
    return Answer(values[:-1], float(values[-1]), prices[:rows])


def _solved(programme: tuple[Any, ...], *, scaled: bool) -> Any:
    """Solve a programme, scaled by the solver or not."""
    cost, matrix, right, cones = programme
    empty = sparse.csc_matrix((len(cost), len(cost)))
    return solved_cones(empty, cost, matrix, right, cones, finest=FINEST, scaled=scaled)


def _left_over(found: Any) -> tuple[bool, float]:
    """Return how far from solved a programme was left, to choose between two."""
    said = str(found.status)
    gap = abs(float(found.obj_val) - float(found.obj_val_dual))
    left = REFUTED.get(said) or max(float(found.r_prim), float(found.r_dual), gap)
    return said != "Solved", left if np.isfinite(left) else np.inf


def _law(friction: Array, press: float) -> tuple[Any, list[Cone]]:
    """Return what friction asks of the forces, and the cones in which that lies."""
    # (normal - press * unknown, across / mu) in a cone, then what has no cone of its own.
    rows, kinds = cones_of_friction(friction)
    slippery = np.flatnonzero(friction == 0)
    if len(slippery):
        rows = np.concatenate([rows, 3 * slippery + 1, 3 * slippery + 2])
        kinds.append(("zero", 2 * len(slippery)))
    bounded = (friction > 0) & np.isfinite(friction)
    points = len(friction)
    scale, normal = np.ones((points, 3)), (3 * np.arange(points), np.zeros(points, np.int64))
    scale[bounded, 1:] = 1 / friction[bounded, None]
    last = sparse.csc_matrix((np.full(points, -press), normal), shape=(3 * points, 1))
    every = [sparse.diags(scale.ravel()), last]
    return sparse.csc_matrix(sparse.hstack(every, format="csr")[rows]), kinds
