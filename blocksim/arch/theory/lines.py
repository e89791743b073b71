"""Lines of thrust and of friction along the arch, eqs (10), (11) and (13).

The second derivation of the paper's section 2.1: no mechanism is assumed. At a section
at angle x from the crown the resultant of thrust and weight is, scaled,

    N = h cos x + x sin x,    T = h sin x - x cos x,
    M = m - N + k (1 - cos x)    (positive towards the extrados),

with k = 1, or 1 + eta^2/12 for the sector. The line of thrust e_hat = -M/(N eta/2) is 1
where the intrados hinge is and -1 at the extrados; the line of friction e_s_hat =
-T/(mu N) is 1 where an inner joint slides and -1 where the shoulder does.
"""

from __future__ import annotations

import numpy as np

from blocksim.arch.circular import Weight
from blocksim.arch.theory.critical import Critical
from blocksim.arch.theory.equations import Value, normal_force


def section_moment(
    angle: Value, thrust: Value, crown_moment: Value, eta: Value, weight: Weight = "centreline"
) -> Value:
    """Moment M/(gamma t d r^2) about the centreline, positive towards the extrados."""
    factor = 1.0 if weight == "centreline" else 1.0 + eta**2 / 12
    return crown_moment - normal_force(angle, thrust) + factor * (1 - np.cos(angle))


def thrust_line(
    angle: Value, thrust: Value, crown_moment: Value, eta: Value, weight: Weight = "centreline"
) -> Value:
    """Eccentricity e_hat of the line of thrust, (10) and (11).

    `angle`: From the crown, not negative [rad].
    `thrust`, `crown_moment`: h, and the moment m of the thrust about the centre of the arch (h
        where it acts at the centre of the crown joint).
    `eta`: Thickness-to-radius ratio.
    Returns: 1 at the intrados, -1 at the extrados.
    """
    moment = section_moment(angle, thrust, crown_moment, eta, weight)
    return -moment / (normal_force(angle, thrust) * eta / 2)


def friction_line(angle: Value, thrust: Value, mu: Value) -> Value:
    """Eccentricity e_s_hat of the line of friction, (13); 0 at infinite friction.

    Returns: 1 where an inner joint slides, -1 where the shoulder does.
    """
    shear = thrust * np.sin(angle) - angle * np.cos(angle)
    return -shear / (mu * normal_force(angle, thrust))


def critical_moment(half_angle: float, critical: Critical, weight: Weight) -> float:
    """Moment m at the crown of an arch at its least thickness.

    The line of thrust touches the intrados at the inner hinge.
    """
    if critical.eta is None or critical.thrust is None or critical.beta_r is None:
        raise ValueError(f"no thickness stands at a half-angle of {half_angle}")
    beta, eta, thrust = critical.beta_r, critical.eta, critical.thrust
    unforced = section_moment(beta, thrust, 0.0, eta, weight)
    return float(-normal_force(beta, thrust) * eta / 2 - unforced)
