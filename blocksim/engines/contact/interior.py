"""A step's contact problem solved from nothing, to half of its digits.

Forces stay in the friction cone, and each edge of a cone has a velocity that may not be
negative. With friction that dilates, the edges are the cone's own, and the problem is a
strictly convex quadratic programme. Coulomb friction, which does not, adds to each the
slip that dilatation would turn into lift (de Saxce's bipotential: G. de Saxce and Z.-Q. Feng,
Math. Comput. Modelling 28, 1998, 225-245).

Mehrotra's predictor and corrector follow the central path of either (a primal-dual
interior-point method: S. Mehrotra, SIAM J. Optim. 2, 1992, 575-601): ten to thirty banded
systems, for few blocks and for many. Ours differs in the slip, which is smoothed by as much
as the path still has to go, as V. Acary, P. Armand, H. M. Nguyen and M. Shpakovych
(Optim. Methods Softw. 2024) follow it for cones that are round.

Of all forces of equilibrium it ends with some at the edge of no cone, if there are any.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.step import Step

CLOSE, CLOSEST = 1e-12, 1e-17
"""Mean product of force and velocity at the edges at which the contacts tell what they do, and
at which they need not, as forces and velocities are known."""
YIELD = 1e-10
"""Yield of contacts over their force in motion, where no friction is steep. Faces that do not
quite fit contradict each other: where nothing yields forces grow without end, and none but huge
ones solve a step."""
MOST_STEPS = 80
BOLD, BOLDEST = 0.995, 1 - 1e-12
"""Least and largest share of the way to the bounds that a step goes."""
START, STEEP_START = (0.1, 3.0), (1.0, 1.0)
"""Least room [g] and forces [mean weights] to begin with, at rest. The first are about those of
what stands, and save a third of the systems; steep friction would be wedged by them."""
SHORTEST = 1e-4
"""Least part of a step that counts as progress."""
SMOOTH = 0.01
"""Smoothing of slip, over the root of that product."""
CAREFUL = 0.1, 0.7, 0.3
"""Least part of the product that a step with slip aims at: at first, then where that leads
nowhere, and in motion."""


def central_path(
    step: Step,
    cones: Cones,
    *,
    dilates: bool,
    careful: float = CAREFUL[0],
    moves: bool = False,
) -> tuple[Array, Array, int]:
    """Follow the central path.

    `dilates`: Whether friction does; Coulomb's must not be steep.
    `careful`: Least part of the product that a step aims at, where friction does not dilate.
    `moves`: Whether blocks are in motion, whose faces may not quite fit. Of rest nothing is
        asked but forces: contacts that yield would miss it.
    Returns `x`, (3 blocks,): Accelerations.
    Returns `pressed`, (joints, 4 or 6): Forces along the edges.
    Returns `systems`: Banded systems factored.
    """
    edges, offset = cones.edges, cones.offset
    bands, free = step.bands, step.free
    x, lift, turned = np.zeros_like(free), 0.0, None
    if not dilates:
        lift, turned = _lift(step, x, cones, SMOOTH)
    apart = bands.along(edges, x) + offset + lift
    steep = step.friction.some_steep
    least, pressed = STEEP_START if steep else START
    yields, close = (0.0 if steep else YIELD, CLOSEST) if moves else (0.0, CLOSE)
    room: Array = np.maximum(np.abs(apart), least)
    # What is far open presses little: all products begin alike.
    forces: Array = least * pressed / room
    short, count = apart + yields * forces - room, 0
    for count in range(MOST_STEPS):  # noqa: B007
        product = float(np.vdot(room, forces)) / room.size
        if product < close:
            break
        solve = bands.factored(edges, forces / (room + yields * forces), turned)
        if solve is None:
            break
        toward = _toward(solve, bands, edges, turned, free - x, (room, short, forces, yields))
        _, wider, more = toward(0.0)
        ahead = _length(room, wider, forces, more)
        after = float(np.vdot(room + ahead * wider, forces + ahead * more)) / room.size
        aim = max((after / product) ** 3, 0.0 if dilates else careful) * product
        way, wider, more = toward((aim - wider * more) / room)
        # Near its end the path is straight.
        bold = min(max(BOLD, 1 - product), BOLDEST)
        length = min(1.0, bold * _length(room, wider, forces, more))
        if not (length >= SHORTEST and np.isfinite(way).all()):
            break
        x = x + length * way
        room, forces = room + length * wider, forces + length * more
        if not dilates:
            smooth = SMOOTH * math.sqrt(float(np.vdot(room, forces)) / room.size)
            lift, turned = _lift(step, x, cones, smooth)
        # Not as it follows from the last one: round-off would add up where friction is steep.
        short = bands.along(edges, x) + offset + lift + yields * forces - room
    return x, forces, count


def _toward(
    solve: Callable[[Array], Array],
    bands: Bands,
    edges: Array,
    turned: Array | None,
    left: Array,
    at: tuple[Array, Array, Array, float],
) -> Callable[[Array | float], tuple[Array, Array, Array]]:
    """Return what changes x, room and forces to products of so much, over the room."""
    room, short, forces, yields = at
    weight: Array = forces / (room + yields * forces)
    seen, share = edges if turned is None else turned, 1 - yields * weight

    def found(target: Array | float) -> tuple[Array, Array, Array]:
        more: Array = share * (target - forces) - weight * short
        way = solve(left + bands.pull(edges, forces + more))
        wider = bands.along(seen, way)
        more = more - weight * wider
        return way, wider + short + yields * more, more

    return found


def _lift(step: Step, x: Array, cones: Cones, smooth: float) -> tuple[Array, Array]:
    """Return the slips, smoothed, that each edge adds; and edges with how these change."""
    slip = step.rates[:, 2:] + step.bands.along(step.rows[:, 2:], x)
    size = np.sqrt(slip * slip + smooth * smooth)
    turning = (cones.lean * slip / size)[..., None] * step.rows[:, 2:]
    lift = cones.lean * (size - smooth)
    return np.concatenate([lift, lift], axis=1), cones.edges + np.tile(turning, (1, 2, 1))


def _length(room: Array, wider: Array, forces: Array, more: Array) -> float:
    """Return how far both stay positive."""
    least = min(float((wider / room).min()), float((more / forces).min()))
    return 1.0 if least >= -1.0 else -1.0 / least
