"""The contact problem with friction that dilates, solved to its last digits from near by.

It is a strictly convex quadratic programme. Springs along the edges of the cones turn it into
a few piecewise quadratic minimisations, and Newton's method with an exact line search ends
each of them after finitely many steps. It is asked where what contacts do is hard to tell:
a billionth from the limit, and where two contacts of a joint share friction as they please.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.coulomb import Friction
from blocksim.engines.contact.interior import central_path
from blocksim.engines.contact.step import Answer, Step, stiffness_at

MOST_ROUNDS, MOST_NEWTON = 20, 100
BALANCED, ROUND_OFF = 1e-11, 1e-14
"""Forces out of balance that are nothing: in mean weights, and over the stiffest forces."""
STALLED = 30.0
"""Multiple of that below which an imbalance that no longer halves is round-off."""
MOST_PARTINGS, PARTED = 5, 1e-8
"""How often steep friction is taken from joints that part; what counts as parting [g], and as
friction [mean weights]."""


def augmented_lagrangian(
    step: Step, cones: Cones, x: Array, pressed: Array
) -> tuple[Array, Array, int]:
    """Solve a step, beginning with accelerations x and forces along the edges.

    Parameters and results have the shapes of `central_path`.
    """
    edges, bands, free = cones.edges, step.bands, step.free
    systems, last_change = 0, math.inf
    for _ in range(MOST_ROUNDS):
        stiffness = stiffness_at(step.friction, x)
        trial = pressed - stiffness * (cones.offset + bands.along(edges, x))
        size = math.inf
        for _ in range(MOST_NEWTON):
            gradient = x - free - bands.pull(edges, np.maximum(trial, 0.0))
            size, last = float(np.abs(gradient).max()), size
            noise = ROUND_OFF * stiffness * float(np.abs(x).max())
            if size <= max(BALANCED, noise) or last / 2 <= size <= STALLED * noise:
                break
            solve = bands.factored(edges, stiffness * (trial > 0))
            if solve is None:
                return x, pressed, systems
            way = solve(-gradient)
            systems += 1
            turn = -stiffness * bands.along(edges, way)
            x = x + way * _to_the_least(way, gradient, trial, turn, stiffness)
            trial = pressed - stiffness * (cones.offset + bands.along(edges, x))
        found = np.maximum(trial, 0.0)
        change = float(np.abs(found - pressed).max()) / stiffness
        pressed = found
        # What no longer halves is round-off, or goes on without end.
        if change > last_change / 2:
            break
        last_change = change
    return x, pressed, systems


def parted(step: Step, answer: Answer) -> Iterator[Answer]:
    """Take friction from joints that hold it across a gap, until none does.

    Steep friction that dilates needs no pressure. So it goes on where joints part, which
    Coulomb's may not.
    """
    for _ in range(MOST_PARTINGS):
        least = step.velocities(answer.x)[:, :2].min(axis=1, keepdims=True)
        rubs = np.abs(answer.forces[:, 2:]).max(axis=1, keepdims=True)
        parts = step.friction.steep & (np.minimum(least, rubs) > PARTED)
        if not parts.any():
            return
        step = replace(step, friction=Friction(np.where(parts, 0.0, step.friction.mu)))
        cones = Cones.of(step)
        x, pressed, systems = central_path(step, cones, dilates=True)
        x, pressed, more = augmented_lagrangian(step, cones, x, pressed)
        answer = cones.answer(step, x, pressed, systems + more)
        yield answer


def _to_the_least(
    way: Array, gradient: Array, trial: Array, turn: Array, stiffness: float
) -> float:
    """Return how far along a way a convex, piecewise quadratic function is least.

    `way`, `gradient`, (3 blocks,).
    `trial`, `turn`, (joints, k): Forces of the constraints at the start, active where positive,
        and their change over the way.
    `stiffness`: An active constraint adds turn^2 / stiffness to the second derivative.
    """
    if not np.any((trial > 0) != (trial + turn > 0)):
        return 1.0
    slope, curvature = float(way @ gradient), float(way @ way)
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
