"""Load factors of blocks that crush: the thrust needs a width, at the strength of the material.

A joint that carries a normal force n presses evenly on as much of its width as that force needs
at the compressive strength, as near to its end as can be (a rectangular block of stress). So
with P the force that crushes all of it, either end carries at least n^2 / (2 P). Of that convex
bound planes that touch it are kept where forces would pass it, until none does but for
round-off.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.checks import is_number, require
from blocksim.common.errors import Unsolved
from blocksim.common.later import Library
from blocksim.limit.cones import Cones
from blocksim.limit.linear import LinearProgramme, Optimum

if TYPE_CHECKING:
    from scipy import sparse
else:
    sparse = Library("scipy.sparse")

STRONGEST = 1e12
"""Compressive strength [Pa]."""
PASSED = 1e-9
"""Force by which the bound is passed that is none, over what the joint carries."""
ROUNDS = 100


def crushing_forces(problem: Problem, strength: float) -> Array:
    """Return the force that crushes all of each joint, (joints,) float [mean weights].

    Raises
    ------
    InputError
        If the strength is out of range, there are no weights or sizes to compare it with, or a
        corner bears a block: a point bears nothing then.
    """
    ok = is_number(strength, 0, STRONGEST)
    require(ok, "strength", strength, f"above 0 and at most {STRONGEST:g} Pa")
    known = problem.weighed and problem.has_size
    require(known, "strength", strength, "left out, or sizes and unit weights in m and N/m3")
    joints = problem.assembly.joint_arrays
    allowed = "left out: a corner bears a block, and has no width"
    require(not joints.is_corner.any(), "strength", strength, allowed)
    depths = np.array([*(block.depth for block in problem.assembly.blocks), np.inf])
    depth = depths[problem.assembly.sides].min(axis=0)
    return strength * joints.length * problem.assembly.size * depth / problem.unit_force


def most_before_crushing(cones: Cones, crushing: Array, live: Array, dead: Array) -> Optimum:
    """Make the factor on live loads as large as balance, friction and strength allow.

    Parameters
    ----------
    cones : Cones
    crushing : (joints,) float
        As of `crushing_forces`.
    live, dead : (blocks, 3) float

    Returns
    -------
    Optimum
        The factor is the last of its values; the first prices are those of the balance.

    Raises
    ------
    Unsolved
        If the bound is still passed after many rounds.
    """
    ends, low = cones.pressing, np.append(cones.bounds[0], -np.inf)
    bounds = low, np.full(low.size, np.inf)
    balance: Any = sparse.hstack(
        [cones.balance, sparse.csc_array(cones.loads(live)[:, None])], format="csr"
    )
    right = -cones.loads(dead)
    both = (ends[0::2] + ends[1::2])[np.repeat(np.arange(len(crushing)), 2)]
    full, unit = np.repeat(crushing, 2), np.repeat(cones.unit, 2)
    solver, cost = LinearProgramme(), np.append(np.zeros(cones.count), -1.0)
    matrix: Any = balance
    least = most = right
    end, share = np.arange(full.size), np.ones(full.size)
    for _ in range(ROUNDS):
        # A plane touches the bound where the joint bears that share of its strength.
        planes: Any = sparse.diags_array(1 / unit[end]) @ (
            ends[end] - sparse.diags_array(share) @ both[end]
        )
        none: Any = sparse.csr_array((end.size, 1))
        matrix = sparse.vstack([matrix, sparse.hstack([planes, none])], format="csr")
        least = np.append(least, -(share**2) * full[end] / (2 * unit[end]))
        most = np.append(most, np.full(end.size, np.inf))
        found = solver.solve(cost, matrix, (least, most), bounds)
        if not found.exists:
            return found
        parts = found.values[:-1]
        force = both @ parts
        passed = force**2 / (2 * full) - ends @ parts
        end = np.flatnonzero(passed > PASSED * np.maximum(force, unit))
        if not end.size:
            return found
        share = force[end] / full[end]
    raise Unsolved
