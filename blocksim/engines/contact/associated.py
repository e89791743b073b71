"""The contact problem with associated friction, which dilates, solved from nothing.

Forces stay in the friction cone and velocities in its dual: a strictly convex quadratic
programme. Springs along the edges of the cones turn it into a few piecewise quadratic
minimisations, and Newton's method with an exact line search ends each of them after
finitely many steps, from anywhere.
"""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.springs import MOST_ROUNDS, STEEPEST, Springs

COLD = 1e8
"""Stiffness to start with when nothing is known."""
MOST_NEWTON = 100


def associated(
    bands: Bands, rows: Array, rates: Array, free: Array, mu: float, precision: float
) -> tuple[Array, Array, int]:
    """Solve a step.

    Parameters
    ----------
    bands : Bands
    rows : (joints, 4, 6) float
        Normal velocities of the two contacts, then the tangential ones.
    rates : (joints, 4) float
        The same velocities without acceleration, over the step.
    free : (3 blocks,) float
        Accelerations without contact.
    mu, precision : float

    Returns
    -------
    x : (3 blocks,) float
        Accelerations.
    forces : (joints, 4) float
        Along `rows`.
    iterations : int
    """
    # Steeper edges are not scaled to length 1: normals would fade.
    norm = min(math.sqrt(1 + mu**2), STEEPEST)
    lean = mu / norm
    upright, along = rows[:, :2] / norm, lean * rows[:, 2:]
    edges = np.concatenate([upright + along, upright - along], axis=1)
    rate, slip = rates[:, :2] / norm, lean * rates[:, 2:]
    offset = np.concatenate([rate + slip, rate - slip], axis=1)
    x, forces = np.zeros_like(free), np.zeros_like(offset)
    springs, stiffness, iterations = Springs(mu, precision), COLD, 0
    for _ in range(MOST_ROUNDS):
        trial = forces - stiffness * (offset + bands.along(edges, x))
        size = math.inf
        for _ in range(MOST_NEWTON):
            gradient = x - free - bands.pull(edges, np.maximum(trial, 0.0))
            size, last = float(np.abs(gradient).max()), size
            if springs.balanced(size, last, x, stiffness):
                break
            way = bands.solve_symmetric(edges, stiffness * (trial > 0), -gradient)
            iterations += 1
            turn = -stiffness * bands.along(edges, way)
            length = line_search(
                float(way @ gradient), float(way @ way), trial, turn, stiffness
            )
            x = x + length * way
            trial = forces - stiffness * (offset + bands.along(edges, x))
        found = np.maximum(trial, 0.0)
        change = float(np.abs(found - forces).max()) / stiffness
        forces = found
        if springs.rigid(x, change):
            break
        stiffness = springs.stiffness(x)
    plus, minus = forces[:, :2], forces[:, 2:]
    return x, np.concatenate([(plus + minus) / norm, (plus - minus) * lean], axis=1), iterations


def line_search(
    slope: float, curvature: float, trial: Array, turn: Array, stiffness: float
) -> float:
    """Step along a direction to the minimum of a convex, piecewise quadratic function.

    Parameters
    ----------
    slope : float
        Derivative at the start.
    curvature : float
        Second derivative without the constraints.
    trial, turn : (joints, k) float
        Forces of the constraints at the start, active where positive, and their change
        over a step of length 1.
    stiffness : float
        An active constraint adds turn^2 / stiffness to the second derivative.
    """
    if not np.any((trial > 0) != (trial + turn > 0)):
        return 1.0
    moving = turn != 0
    force, change = trial[moving], turn[moving]
    weight = change * change / stiffness
    active = (force > 0) | ((force == 0) & (change > 0))
    where = -force / change
    ahead = np.flatnonzero(where > 0)
    order = ahead[np.argsort(where[ahead])]
    bends = np.append(0.0, where[order])
    curvatures = np.cumsum(
        np.append(curvature + weight[active].sum(), np.sign(change[order]) * weight[order])
    )
    slopes = slope + np.append(0.0, np.cumsum(curvatures[:-1] * np.diff(bends)))
    last = max(int(np.searchsorted(slopes, 0.0)) - 1, 0)
    return float(bends[last] - slopes[last] / curvatures[last])
