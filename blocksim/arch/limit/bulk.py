"""Limit analysis of many arches at once, with the same arithmetic as `statics`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.arch.circular import ETA_MAX, Weight, checked_arrays
from blocksim.arch.limit.halfplanes import FEW, Joints, half_joints, sliding, spread_of, turning
from blocksim.arch.limit.statics import least_of, thrust_bounds
from blocksim.blocks.assembly import Array
from blocksim.common.checks import VOUSSOIRS

WORKING_SET = 25_000
"""Pairs of joints held at once; their temporaries stay in the cache."""
HALVINGS = 52


def which_stand(
    half_angle: ArrayLike,
    eta: ArrayLike,
    mu: ArrayLike,
    voussoirs: int,
    weight: Weight = "centreline",
) -> NDArray[np.bool_]:
    """Tell which arches have an equilibrium within strength (static theorem).

    `half_angle`, (...): In (0, pi) [rad].
    `eta`, (...): In (0, 2].
    `mu`, (...): Above 0, inf allowed; the three broadcast against each other.
    `voussoirs`: Number of voussoirs of every arch, 3 to 10000.
    Returns (...).
    """
    VOUSSOIRS.require("voussoirs", voussoirs)
    alpha, depth, friction = checked_arrays(weight, half_angle=half_angle, eta=eta, mu=mu)
    found = np.empty(alpha.size, dtype=bool)
    flat = alpha.reshape(-1), depth.reshape(-1), friction.reshape(-1)
    size = chunk_size(voussoirs // 2 + 1)
    for start in range(0, alpha.size, size):
        part = slice(start, start + size)
        a, e, m = (values[part] for values in flat)
        joints = Joints(half_joints(a, voussoirs))
        most, least = short_intervals(joints, e, m, spread_of(e, weight))
        found[part] = most >= least
    return found.reshape(alpha.shape)


def chunk_size(joints: int) -> int:
    """Arches to work on at once where each has that many joints a half."""
    return max(1, WORKING_SET // joints**2)


def short_intervals(joints: Joints, depth: Array, mu: Array, spread: Array) -> Array:
    """Intervals of thrusts in equilibrium with strength at every joint.

    `joints`: Of one half of each arch.
    `depth`, `mu`, `spread`, (k,): As in `thrust_bounds`.
    Returns (2, k): 1 - h, of the lowest thrust and of the highest; none where the first is the
        less.
    """
    if joints.angles.shape[1] > FEW:
        known = zip(np.sort(joints.angles), depth, mu, spread, strict=True)
        bounds = [
            thrust_bounds(Joints(a[None]), float(d), float(m), float(s)) for a, d, m, s in known
        ]
        return np.array([[low.short, high.short] for low, high in bounds]).T
    turns = turning(joints, depth, spread)
    highest, lowest = turns.ends()
    most, least = highest.min(axis=(1, 2)), lowest.max(axis=(1, 2))
    # Parallel half-planes leave nothing where the upper one is below the lower one.
    most[turns.broken().any(axis=(1, 2))] = -np.inf
    held = np.flatnonzero(np.isfinite(mu))
    if len(held) < len(mu):
        joints = Joints(joints.angles[held])
    highest, lowest = sliding(joints, mu[held]).ends()
    most[held] = np.minimum(most[held], highest.min(axis=1))
    least[held] = np.maximum(least[held], lowest.max(axis=1))
    return np.stack([most, least])


def least_thickness_of_joints(angles: Array, mu: Array, weight: Weight) -> Array:
    """Least thickness of many arches whose joints may be anywhere.

    `angles`, (k, j): Joints of one half of each arch, in any order [rad].
    `mu`, (k,): Friction coefficients, inf allowed.
    Returns (k,): 0 where any thickness stands, nan where none up to 2 does.
    """
    if angles.shape[1] > FEW:
        each = zip(np.sort(angles), mu.tolist(), strict=True)
        least = [least_of(Joints(a[None]), friction, weight)[0] for a, friction in each]
        return np.array(least, dtype=float)
    found = np.empty(mu.size)
    size = chunk_size(angles.shape[1])
    for start in range(0, mu.size, size):
        part = slice(start, start + size)
        joints, friction = Joints(angles[part]), mu[part]
        low, high = np.zeros(friction.size), np.full(friction.size, ETA_MAX)
        never = _empty(joints, high, friction, weight)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            falls = _empty(joints, middle, friction, weight)
            low, high = np.where(falls, middle, low), np.where(falls, high, middle)
        always = ~_empty(joints, np.zeros_like(high), friction, weight)
        found[part] = np.where(never, np.nan, np.where(always, 0.0, high))
    return found


def _empty(joints: Joints, eta: Array, mu: Array, weight: Weight) -> NDArray[np.bool_]:
    most, least = short_intervals(joints, eta, mu, spread_of(eta, weight))
    return most < least
