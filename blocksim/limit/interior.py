"""Large linear programmes of forces by the interior point: exact enough where all is clear.

A vertex is not sought, which is what takes long: 10,000 blocks in the time that HiGHS takes for
2,000. The programme is put as its dual, whose unknowns are the rates of the blocks: that has
fewer. Its forces balance to round-off, well within their cones, as proofs need them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.common.conic import Cone, solved_cones
from blocksim.common.later import sparse
from blocksim.limit.cones import Cones
from blocksim.limit.linear import Optimum

FINEST = 1e-7
"""Gap and residuals at which it ends."""


def most_inside(cones: Cones, column: Any, right: Array, highest: float) -> Optimum | None:
    """Make the factor on a column as large as the balance of forces allows.

    `column`, (equations, 1) sparse.
    `right`, (equations,): What parts and column balance together.
    `highest`: The factor is at most that.
    Returns: As of `LinearProgramme`, without a basis; None where the solver does not end there.
        Where nothing balances there are no values, and prices whose motion gains work.
    """
    turned: Any = cones.balance.T.tocsr()
    presses = cones.bounded > 0
    matrix = sparse.vstack(
        [-turned[~presses], -turned[presses], sparse.csr_array(column.T)], format="csc"
    )
    free, bounded = int((~presses).sum()), int(presses.sum())
    kinds: list[Cone] = [("zero", free)] if free else []
    found = solved_cones(
        sparse.csc_array((right.size, right.size)),
        right - highest * column.toarray().ravel(),
        matrix,
        np.append(np.zeros(cones.count), 1.0),
        [*kinds, ("nonnegative", bounded + 1)],
        finest=FINEST,
        # Equations and parts have units of their own.
        scaled=False,
        refined=False,
    )
    rates = -np.array(found.x)
    if str(found.status) == "DualInfeasible":
        return Optimum(values=np.zeros(0), prices=rates, unbounded=False)
    if str(found.status) != "Solved":
        return None
    prices = np.array(found.z)
    values = np.append(np.zeros(cones.count), highest - prices[-1])
    values[:-1][~presses], values[:-1][presses] = prices[:free], prices[free:-1]
    return Optimum(values=values, prices=rates, unbounded=False)
