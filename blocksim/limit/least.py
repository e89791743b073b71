"""The least motion: contact forces under which blocks at rest would start as little as can be.

Of all motions the actual one differs least from that without contacts, in the norm of kinetic
energy: Gauss's principle of least constraint (1829). Its dual are the contact forces that leave
least acceleration, a problem of nonnegative least squares (Lawson and Hanson 1974). Where
forces of equilibrium exist they leave none. Where none do, and nothing slides, it is the motion
with which blocks start; joints that slide would dilate, as in `programme`.

An engine that searches for contact forces may begin with these (`blocksim.simulation.onset`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.limit.cones import Cones

ROUGH = 10.0
"""Friction from which on it counts as unbounded: in steep cones forces wedge without need."""
ROUNDS = 50
"""Most rounds of the solver, for each part of a force."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LeastMotion:
    """Contact forces, and the accelerations they leave.

    `forces`, (joints, 2, 2): As of `Equilibrium`.
    `accelerations`, (blocks, 3): x, y [g] and rotation [g/size].
    """

    forces: Array
    accelerations: Array


def least_motion(problem: Problem) -> LeastMotion | None:
    """Find the contact forces that leave blocks at rest the least acceleration.

    Returns: None where the solver does not find it.
    """
    # Imported here: few questions need it, and it takes longer to load than to solve.
    from scipy.optimize import nnls

    solve: Any = nnls
    friction = np.where(problem.friction > ROUGH, math.inf, problem.friction)
    cones = Cones(problem, friction=friction)
    balance, loads = cones.balance.toarray(), cones.loads(problem.applied_forces())
    masses = problem.assembly.masses.ravel()
    scale = 1 / (cones.ease.ravel() * np.sqrt(masses))
    matrix = balance * scale[:, None]
    # What is tangential only may have any sign.
    free = cones.bounded == 0
    matrix = np.hstack([matrix, -matrix[:, free]])
    try:
        found, _ = solve(matrix, -loads * scale, maxiter=ROUNDS * matrix.shape[1])
    except RuntimeError:
        return None
    parts = found[: cones.count].copy()
    parts[free] -= found[cones.count :]
    left = (balance @ parts + loads) / cones.ease.ravel() / masses
    return LeastMotion(forces=cones.forces(parts), accelerations=left.reshape(cones.shape))
