"""Mechanisms of the continuous arch: those of a named mode, with joints where theory says.

On a line of the map several modes are possible at once; each is found here by itself, as
the rates at its own joints that fit together (A' rates = 0, see `mechanism`).
"""

from __future__ import annotations

import numpy as np

from blocksim.arch.circular import Weight, centroid_factor
from blocksim.arch.limit.mechanism import Collapse, conditions, of_half
from blocksim.arch.modes import Mode

EXTRADOS, INTRADOS, OUT, IN = range(4)
COMPATIBLE = 1e-6
"""Misfit of rates that add up to one beyond which a mode is not possible."""

SAME = 1e-9
"""Angle within which hinge and sliding joint are one joint [rad]."""


def collapse_of_mode(
    mode: Mode,
    half_angle: float,
    eta: float,
    mu: float,
    *,
    beta_r: float | None = None,
    beta_s: float | None = None,
    weight: Weight = "centreline",
) -> Collapse:
    """Find the mechanism of one mode of the continuous arch.

    `half_angle`, `eta`, `mu`, `beta_r`, `beta_s`: As `least_thickness` of the theory gives
        them; `beta_r` and `beta_s` where the mode has such a joint [rad].
    Returns: With associated sliding; rates add up to one.
    """
    active = _active(mode, half_angle, beta_r, beta_s)
    angles = np.unique([angle for angle, _ in active])
    program = conditions(angles, eta, mu, centroid_factor(eta, weight))
    rows = [4 * int(np.searchsorted(angles, angle)) + kind for angle, kind in active]
    # The null vector: one more rate than there are equations, or a dependence among them.
    found = np.linalg.svd(program.matrix[rows].T)[2][-1]
    found = found / found.sum()
    misfit = np.abs(program.matrix[rows].T @ found).max()
    if found.min() < -COMPATIBLE or misfit > COMPATIBLE:
        raise ValueError(f"no mechanism {mode} with these joints")
    rates = np.zeros((angles.size, 4))
    rates.reshape(-1)[rows] = np.maximum(found, 0.0)
    return of_half(angles, rates, eta, mu)


def _active(
    mode: Mode, half_angle: float, beta_r: float | None, beta_s: float | None
) -> list[tuple[float, int]]:
    """Joints of one half and what they do."""
    hinge, slide = beta_r or 0.0, beta_s or 0.0
    if abs(hinge - slide) < SAME:
        slide = hinge  # one joint does both, not a sliver between two
    joints = {
        Mode.RRR: [(0.0, EXTRADOS), (hinge, INTRADOS), (half_angle, EXTRADOS)],
        Mode.R: [(0.0, EXTRADOS), (0.0, INTRADOS), (half_angle, EXTRADOS)],
        Mode.SRR: [(0.0, EXTRADOS), (hinge, INTRADOS), (half_angle, OUT)],
        Mode.RRS: [(hinge, INTRADOS), (slide, IN), (half_angle, EXTRADOS)],
        Mode.RSR: [(hinge, INTRADOS), (slide, IN), (half_angle, EXTRADOS)],
        Mode.RS: [(0.0, INTRADOS), (slide, IN), (half_angle, EXTRADOS)],
        Mode.SS: [(slide, IN), (half_angle, OUT)],
    }
    return joints[mode]
