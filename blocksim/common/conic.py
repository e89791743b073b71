"""Cone programmes by Clarabel; the only place that knows it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from blocksim.common.later import Library

# It has no types.
clarabel = cast("Any", Library("clarabel"))

Cone = tuple[Literal["zero", "nonnegative", "second-order"], int]
"""A kind of cone, and how many rows of a programme lie in it."""
KINDS = {
    "zero": "ZeroConeT",
    "nonnegative": "NonnegativeConeT",
    "second-order": "SecondOrderConeT",
}


def cones_of_friction(
    friction: NDArray[np.float64],
) -> tuple[NDArray[np.int64], list[Cone]]:
    """Return the rows of forces at points that lie in cones, and these cones in their order.

    `friction`, (points,): Where it is 0 or inf the normal force alone is bounded.
    Returns `rows`, (k,): Of three a point: along its normal, and two ways across.
    """
    rubs = (friction > 0) & np.isfinite(friction)
    round_, flat = np.flatnonzero(rubs), np.flatnonzero(~rubs)
    cones: list[Cone] = [("second-order", 3)] * len(round_)
    if len(flat):
        cones.append(("nonnegative", len(flat)))
    return np.append(3 * round_[:, None] + np.arange(3), 3 * flat), cones


def solved_cones(
    quadratic: Any,
    cost: Any,
    matrix: Any,
    right: Any,
    cones: Sequence[Cone],
    *,
    finest: float,
    scaled: bool = True,
    refined: bool = True,
) -> Any:
    """Minimise ``x Q x / 2 + c x`` with ``b - A x`` in cones.

    `quadratic`, (n, n) sparse.
    `cost`, (n,).
    `matrix`, (rows, n) sparse.
    `right`, (rows,).
    `cones`: In the order of the rows.
    `finest`: Gap and residuals at which it may end.
    `scaled`: Whether the solver scales the programme first.
    `refined`: Whether equations are solved to round-off; else a tenth as finely as `finest`,
        which takes half the time.
    Returns: Clarabel's: `x`, the prices `z` of the rows, `status`, values and residuals.
    """
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.equilibrate_enable = scaled
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = finest
    if not refined:
        settings.iterative_refinement_reltol = finest / 10
        settings.iterative_refinement_abstol = finest / 10
    made = {kind: getattr(clarabel, name) for kind, name in KINDS.items()}
    kinds = [made[kind](rows) for kind, rows in cones]
    return clarabel.DefaultSolver(quadratic, cost, matrix, right, kinds, settings).solve()
