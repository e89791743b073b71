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
from blocksim.engines.contact.coulomb import Friction
from blocksim.engines.contact.springs import MOST_ROUNDS, STEEPEST, Springs

COLD = 1e8
"""Stiffness to start with when nothing is known."""
MOST_NEWTON = 100


def associated(
    bands: Bands,
    rows: Array,
    rates: Array,
    free: Array,
    friction: Friction,
    precision: float,
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
    friction : Friction
    precision : float

    Returns
    -------
    x : (3 blocks,) float
        Accelerations.
    forces : (joints, 4) float
        Along `rows`.
    iterations : int
    """
    # Steeper edges are not scaled to length 1: normals would fade. Steep ones take what
    # normals they have, down to none, and have the normal itself as a third edge.
    steep, mu = friction.steep, friction.mu
    with np.errstate(invalid="ignore"):
        norm = np.where(steep, mu, np.minimum(np.sqrt(1 + mu**2), STEEPEST))
        lean = np.where(steep, 1.0, mu / norm)

    def of_edges(values: Array) -> Array:
        """Return along the edges what is given along normals and tangents."""
        upright, along = values[:, :2] / norm[..., None], lean[..., None] * values[:, 2:]
        found = [upright + along, upright - along]
        if friction.some_steep:
            found.append(steep[..., None] * values[:, :2])
        return np.concatenate(found, axis=1)

    edges, offset = of_edges(rows), of_edges(rates[..., None])[..., 0]
    x, forces = np.zeros_like(free), np.zeros_like(offset)
    springs, stiffness, iterations = Springs(friction, precision), COLD, 0
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
    plus, minus = forces[:, :2], forces[:, 2:4]
    pressure, rubbed = (plus + minus) / norm, (plus - minus) * lean
    if friction.some_steep:
        pressure = pressure + forces[:, 4:]
    return x, np.concatenate([pressure, rubbed], axis=1), iterations


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
