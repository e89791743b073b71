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
