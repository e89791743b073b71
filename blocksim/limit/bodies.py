"""Motions of blocks: which blocks move as one, and what opens every joint a little."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.bodies import bodies_of, parting
from blocksim.blocks.problem import Problem
from blocksim.common.conic import solved_cones
from blocksim.common.later import sparse
from blocksim.limit.cones import Cones

ALIKE = 1e-7
"""Rates at a joint, over the largest, up to which its blocks move as one."""
ENOUGH = 0.5
"""Part of the rate asked for at which a joint counts as open."""
FINEST = 1e-3
"""How finely a motion is sought that opens every joint: any will do."""
SHARE = 0.25
"""Most of the work of the loads that opening all joints may take."""


def alike(problem: Problem, cones: Cones, rates: Array) -> list[int]:
    """Return the body of each block, of those that rates do not part; `SUPPORT` at rest."""
    ways, turns = parting(problem.assembly, rates)
    ways = cones.unit * np.abs(ways).max(axis=(1, 2))
    return bodies_of(problem.assembly, ways, cones.unit * np.abs(turns), ALIKE).tolist()


def widened(problem: Problem, cones: Cones, rates: Array) -> Array | None:
    """Add a little of a motion that opens every joint, so that rounding closes none.

    `cones`: Of the same problem.
    `rates`, (blocks, 3): A mechanism, which joints allow but for round-off.
    Returns (blocks, 3) or None: None where no such motion is known, as with friction without
        bound.
    """
    pull = problem.applied_forces()
    work = float((pull * rates).sum())
    if (cones.bounded == 0).any() or work <= 0:
        return None
    opening = _opening(cones)
    if opening is None:
        return None
    taken = abs(float((pull * opening).sum()))
    return rates + opening * (SHARE * work / max(taken, work))


def _opening(cones: Cones) -> Array | None:
    """Return the least motion that opens every joint at a rate, None where none does."""
    rows: Any = cones.balance.T.tocsr()
    rows = sparse.diags_array(1 / np.sqrt(rows.multiply(rows).sum(axis=1))) @ rows
    joints, rates = rows.shape
    found = solved_cones(
        sparse.eye_array(rates, format="csc"),
        np.zeros(rates),
        sparse.csc_array(-rows),
        -np.ones(joints),
        [("nonnegative", joints)],
        finest=FINEST,
        scaled=False,
        refined=False,
    )
    motion: Array = np.array(found.x)
    opens = str(found.status) == "Solved" and (rows @ motion).min(initial=math.inf) > ENOUGH
    return motion.reshape(cones.shape) * cones.ease if opens else None
