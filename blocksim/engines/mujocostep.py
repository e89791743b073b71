"""A step of MuJoCo with Coulomb's friction, not that which opens joints.

MuJoCo solves a convex problem, and in that what slips parts: with friction times the velocity
of the slip. So where a stack lands and its blocks begin to slip all at once, they are thrown
up. A contact that is to approach by as much as slipping opens it does not open. How fast it
slips is known only then: a fixed point, found by solving again (De Saxce and Feng 1998).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from blocksim.engines.mujocoblocks import library

ROUNDS = 50
"""Most times that a step is solved."""
OPENING = 1e-4
"""Velocity with which contacts may open by slipping [sqrt(g size)]."""


def coulomb_step(model: Any, state: Any) -> None:
    """Take a step in which slipping opens no contact."""
    library.mj_step1(model, state)
    library.mj_fwdActuation(model, state)
    library.mj_fwdAcceleration(model, state)
    library.mj_fwdConstraint(model, state)
    touching = state.contact.efc_address >= 0
    rows, friction = state.contact.efc_address[touching], state.contact.friction[touching, 0]
    if len(rows):
        wanted, slips = state.efc_aref[rows].copy(), np.zeros(state.nefc)
        opening = np.zeros(len(rows))
        for _ in range(ROUNDS):
            library.mj_mulJacVec(model, state, slips, state.qacc)
            slips += state.efc_R * state.efc_force - state.efc_aref
            found = friction * np.hypot(slips[rows + 1], slips[rows + 2])
            if np.abs(found - opening).max() * model.opt.timestep < OPENING:
                break
            opening = found
            state.efc_aref[rows] = wanted - opening
            # Forces of the round before are nearer than those of the step before.
            state.qacc_warmstart[:] = state.qacc
            library.mj_fwdConstraint(model, state)
    library.mj_Euler(model, state)
