"""Friction that dilates: cone programmes, and those whose slip settles at Coulomb's law.

Slip that opens by mu times itself makes a step a cone programme, whose solution is unique in
the accelerations. Less a guess of that slip it is Coulomb's law, where the slip is the guess
(De Saxce and Feng 1998; Cadoux 2009).
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from blocksim.blocks.assembly import Array
from blocksim.common.conic import cones_of_friction, solved_cones
from blocksim.engines.solid.step import Step, projected

FINEST, IN_MOTION = 1e-10, 1e-12
"""Gap and residuals at which a cone programme may end: forces of rest come from well within the
cones, slip from a programme that ends where it gets no farther."""
PROGRAMMES, BEFORE = 80, 5
"""Most programmes until slip settles, and from how many before a guess is made."""
NEAR_ENOUGH = 1e-6
"""Residual from which on springs lead to a solution."""
ALIKE = 1e-8
"""Of the largest: what two guesses differ by at least."""


def dilating(step: Step, slip: Array | float = 0.0, finest: float = FINEST) -> Array | None:
    """Return forces of friction that dilates: a cone programme, and rest if there is any.

    `slip`, (points,): By mu times this much less than what slips opens.
    `finest`: Gap and residuals at which the programme may end.
    """
    points, size, mu = len(step.friction), step.bands.size, step.friction
    # (u_n + mu slip, mu u_t) in the cone of the second order.
    scale = np.ones((points, 3))
    scale[:, 1:] = mu[:, None]
    order, cones = cones_of_friction(mu)
    factor = scale.ravel()[order]
    rows = sparse.csc_matrix(-(sparse.diags(factor) @ step.matrix[order]))
    drift = step.drift.copy()
    drift[:, 0] += mu * slip
    right = factor * drift.ravel()[order]
    inertia = sparse.identity(size, format="csc")
    found = solved_cones(inertia, -step.free, rows, right, cones, finest=finest)
    z = np.array(found.z)
    if not np.isfinite(z).all():
        return None
    forces = np.zeros(3 * points)
    forces[order] = factor * z
    return projected(forces.reshape(-1, 3), mu)


def settled(step: Step, forces: Array) -> Array:
    """Return the forces nearest to Coulomb's law on the way of guesses of slip from some.

    The slip that a programme leads to is the next guess, mixed with those before it (Anderson
    1965; Walker and Ni 2011).

    `forces`, (points, 3).
    """
    x = step.pushed_by(forces)
    best, least = forces, step.residual(x, forces)
    guess = slip_of(step.velocities(x))
    guesses, changes = [guess], list[Array]()
    for _ in range(PROGRAMMES):
        found = dilating(step, guesses[-1], IN_MOTION)
        if found is None:
            break
        x = step.pushed_by(found)
        residual = step.residual(x, found)
        if residual < least:
            best, least = found, residual
        if least <= NEAR_ENOUGH:
            break
        changes.append(slip_of(step.velocities(x)) - guesses[-1])
        guess = guesses[-1] + changes[-1]
        if len(changes) > 1:
            turns, ways = np.diff(changes, axis=0).T, np.diff(guesses, axis=0).T
            guess = guess - (ways + turns) @ np.linalg.lstsq(turns, changes[-1], ALIKE)[0]
        guesses = [*guesses[-BEFORE:], np.maximum(guess, 0.0)]
        changes = changes[-BEFORE:]
    return best


def slip_of(velocities: Array) -> Array:
    """Return how fast points slip, (points,), of their velocities."""
    return np.hypot(velocities[:, 1], velocities[:, 2])
