"""A step's contact problem by alternating directions: slow, from anywhere, where blocks jam.

Blocks go where forces and springs let them, then each force to what the law of its contact
allows, in turn (S. Boyd and others, Found. Trends Mach. Learn. 3, 2011, 1-122). One system is
factored once. Springs that follow the forces found so far, stiffer in turn, by Newton's method
with a line search, come from near a solution to its last digits (the method of multipliers).

Friction that is steep lets it go in circles.
"""

from __future__ import annotations

from collections.abc import Iterator
from operator import itemgetter

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.coulomb import OPEN, SLIDES_DOWN, SLIDES_UP, STICKS, Contacts
from blocksim.engines.contact.step import Answer, Linear, Step

SOFT, BEYOND = 4.0, 1.6
"""Springs, and by how much more each turn changes forces than it asks for."""
TURNS, PAUSE = 12_000, 1000
"""Most turns, and after how many springs follow."""
STIFFER = 1e2, 1e3, 1e4
ROUNDS, TRIES, HALVINGS = 12, 40, 8
"""Most times that springs follow, most of Newton's steps for each, most halvings of one."""
SLOW, WORSE = 0.3, 2
"""Share of a residual left by a round that is slow, and how many of these end it."""
SOLVED, ROUND_OFF = 1e-10, 1e-13
"""Residual at which nothing is left to do, and imbalance over the forces that is none."""


def alternated(step: Step, forces: Array) -> Iterator[Answer]:
    """Give what springs make of forces, then of those on the way of alternating directions."""
    yield _followed(step, forces)
    solve = step.bands.factored(step.rows, np.full((1, 4), SOFT))
    if solve is None:
        return
    x = step.free + step.bands.pull(step.rows, forces)
    pushed = forces - SOFT * step.velocities(x)
    for turn in range(1, TURNS + 1):
        forces = _lawful(step, pushed)
        right = 2 * forces - pushed - SOFT * step.rates
        x = solve(step.free + step.bands.pull(step.rows, right))
        pushed = pushed + BEYOND * (forces - SOFT * step.velocities(x) - pushed)
        if turn % PAUSE == 0:
            yield _followed(step, _lawful(step, pushed))


def _followed(step: Step, forces: Array) -> Answer:
    """Let springs follow forces, stiffer in turn, as long as they come nearer to the law."""
    best, systems = _answer(step, forces, forces), 0
    for stiffness in STIFFER:
        p, x, slow, least = best.forces, best.x, 0, best.residual
        for _ in range(ROUNDS):
            x, pushed, count = _balanced(step, x, p, stiffness)
            p, systems = _lawful(step, pushed), systems + count
            found = _answer(step, p, pushed, x, systems)
            slow = slow + 1 if not found.residual <= SLOW * least else 0
            least = min(least, found.residual)
            if found.residual < best.residual:
                best = found
            if best.residual <= SOLVED:
                return best
            if slow > WORSE:
                break
    return best


def _answer(
    step: Step, forces: Array, pushed: Array, x: Array | None = None, systems: int = 0
) -> Answer:
    if x is None:
        x = step.free + step.bands.pull(step.rows, forces)
    residual = step.residual(x, forces)
    # Of rest, or nearly, the residual alone says little.
    settled = residual <= SOLVED * min(1.0, float(np.abs(x).max()))
    contacts = _pieces(step, pushed)
    return Answer(
        x=x,
        forces=forces,
        contacts=contacts,
        residual=residual,
        systems=systems,
        is_settled=settled,
    )


def _lawful(step: Step, pushed: Array) -> Array:
    """Return the forces of contacts whose springs ask for some, shape (joints, 4)."""
    pressure = np.maximum(pushed[:, :2], 0.0)
    most = step.friction.mu * pressure
    return np.concatenate([pressure, np.clip(pushed[:, 2:], -most, most)], axis=1)


def _pieces(step: Step, pushed: Array) -> Contacts:
    """Return what these contacts do."""
    most, along = step.friction.mu * pushed[:, :2], pushed[:, 2:]
    contacts = np.full(most.shape, STICKS, dtype=np.int8)
    contacts[along > most] = SLIDES_UP
    contacts[along < -most] = SLIDES_DOWN
    contacts[pushed[:, :2] <= 0] = OPEN
    return contacts


def _balanced(
    step: Step, x: Array, forces: Array, stiffness: float
) -> tuple[Array, Array, int]:
    """Balance springs preloaded with forces; return x, what they ask for, and the systems."""

    def at(x: Array) -> tuple[float, Array, Array]:
        pushed = forces - stiffness * step.velocities(x)
        size = float(np.abs(step.imbalance(x, _lawful(step, pushed))).max())
        return size, x, pushed

    (size, x, pushed), systems = at(x), 0
    while systems < TRIES and size > ROUND_OFF * (1 + float(np.abs(pushed).max())):
        linear = Linear(step, _pieces(step, pushed), stiffness)
        way, _ = linear.way(x, pushed, np.zeros_like(pushed[:, 2:]))
        if not np.isfinite(way).all():
            break
        tried: list[tuple[float, Array, Array]] = []
        for halving in range(HALVINGS):
            tried.append(at(x + way / 2**halving))
            if tried[-1][0] < (1 - 0.25 / 2**halving) * size:
                break
        size, x, pushed = min(tried, key=itemgetter(0))
        systems += 1
    return x, pushed, systems
