"""The way to a solution that cannot fail to arrive, and may be long.

All contacts are springs, and something keeps them apart, each by a share of its own, so far at
first that none carries anything. As it falls to nothing, blocks come together along a path. It
is straight as long as each contact does what it does. Where one comes to the edge of that, it
changes over, and what is left goes on falling or rises for a while: whichever carries that
contact across.

Contact and friction only take energy from what moves fast, so accelerations are bounded all
along, and the solution is unique when all are far apart: the path cannot go back there, nor
end anywhere but at 0. That is pivoting for linear complementarity problems (C. E. Lemke,
Management Sci. 11, 1965, 681-689; for friction D. E. Stewart and J. C. Trinkle, Int. J. Numer.
Methods Eng. 39, 1996, 2673-2691, and M. Anitescu and F. A. Potra, Nonlinear Dyn. 14, 1997,
231-247), on the piecewise linear law itself (J. Katzenelson, Bell Syst. Tech. J. 44, 1965,
1605-1620).

Along the path friction is at most 1 / `FLATTEST`; what ends it takes friction as it is.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import System
from blocksim.engines.contact.coulomb import (
    FLATTEST,
    OPEN,
    SLIDES_UP,
    STICKS,
    Contacts,
    beyond,
    edges,
    leaning,
)
from blocksim.engines.contact.slides import Slides
from blocksim.engines.contact.step import Answer, Step

STIFF = 1e8
"""Stiffness of the springs: what they yield then is mended in a few systems."""
MOST_PIECES = 20_000
STEEP_PIECES = 40
"""The same for each joint with steep friction: longer ways are round-off going in circles."""


def come_together(step: Step, preload: Array | None = None) -> Answer:
    """Balance stiff springs, from all contacts apart.

    Their forces without motion may be given: near the limit it is they that tell what contacts
    do, to more digits than springs yield.
    """
    preload = np.zeros_like(step.rates) if preload is None else preload
    glued = preload - STIFF * step.velocities(step.free)
    shares = np.random.default_rng(0).uniform(1.0, 2.0, (len(glued), 2))
    push = STIFF * shares
    apart = float(np.maximum(glued[:, :2] / push, 0.0).max(initial=0.0))
    glued[:, :2] -= apart * push
    contacts = np.full(push.shape, OPEN, dtype=np.int8)
    most = STEEP_PIECES * len(glued) if step.friction.some_steep else MOST_PIECES
    found = _follow(step, glued, contacts, push, apart, most)
    if found is None:
        return Answer.of_nothing(step)
    x, held, pieces = found
    forces = step.friction.as_said(preload - STIFF * step.velocities(x), contacts, held)
    return Answer(x=x, forces=forces, contacts=contacts, systems=pieces)


def _follow(
    step: Step,
    forces: Array,
    contacts: Contacts,
    push: Array,
    left: float,
    most: int,
) -> tuple[Array, Array, int] | None:
    """Follow the path until nothing is left, over so many pieces at most.

    Parameters
    ----------
    step : Step
    forces, contacts
        At its beginning, with all contacts open; `forces` as if glued, but for steep friction
        that slides, whose size stands for the normal force. Contacts are changed in place.
    push : (joints, 2) float
        Normal force that keeps a contact apart, per unit of `left`.
    left : float
    most : int

    Returns
    -------
    x : (3 blocks,) float
    held : (joints, 2) float
        Friction of contacts that slide with steep friction.
    pieces : int
    """
    bands, rows, friction, x = step.bands, step.rows, step.friction, step.free
    sign = 1.0
    own = np.zeros(contacts.shape, dtype=np.bool_)
    system = System(bands)

    def onward() -> tuple[Array, Array]:
        """Return how x and the forces change."""
        if not own.any():
            way = system.solve()
            turn = -STIFF * bands.along(rows, way)
            turn[:, :2] += push
            return way, turn
        slides = Slides(bands, rows, contacts, own, flat)
        way, held = slides.solve(system.solve, push / STIFF, STIFF)
        turn = -STIFF * bands.along(rows, way)
        turn[:, :2] = np.where(own, held, turn[:, :2] + push)
        return way, turn

    mu, flat = np.minimum(friction.mu, 1 / FLATTEST), friction.flattest
    factors = [
        edges(float(m), bool(s)) for m, s in zip(mu[:, 0], friction.steep[:, 0], strict=True)
    ]
    of_normal, of_tangential = (np.array(each) for each in zip(*factors, strict=True))
    joints = np.arange(len(mu))[:, None]
    normal = np.moveaxis(of_normal[joints, contacts], 2, 0).copy()
    tangential = np.moveaxis(of_tangential[joints, contacts], 2, 0).copy()
    way, turn = onward()
    crossed: tuple[int, int, int] | None = None
    for piece in range(1, most):
        slope = normal * turn[:, :2] + tangential * turn[:, 2:]
        slope *= sign
        if crossed is not None:
            slope[crossed] = 0.0
        value = normal * forces[:, :2] + tangential * forces[:, 2:]
        lengths = np.full(value.shape, math.inf)
        np.divide(np.maximum(value, 0.0), -slope, out=lengths, where=slope < 0)
        edge, joint, end = (int(i) for i in np.unravel_index(lengths.argmin(), value.shape))
        length = float(lengths[edge, joint, end])
        if sign > 0 and length >= left:
            held = np.where(own, forces[:, :2] + left * turn[:, :2], 0.0)
            return x + left * way, held, piece
        if not math.isfinite(length):
            return None
        x, forces = x + length * sign * way, forces + length * sign * turn
        left -= sign * length
        was = int(contacts[joint, end])
        now, back = beyond(was, edge, float(forces[joint, 2 + end]))
        for part, does in ((-1.0, was), (1.0, now)):
            contacts[joint, end] = does
            own[joint] = friction.steep[joint] & (contacts[joint] >= SLIDES_UP)
            matrix, pull = _part(step, joint, push[joint], contacts[joint], own[joint])
            system.add(joint, part * matrix, part * pull)
        if friction.steep[joint]:
            size = abs(forces[joint, 2 + end])
            closed = size if own[joint, end] else flat[joint, 0] * size
            forces[joint, end] = 0.0 if OPEN in {was, now} else closed
        normal[:, joint, end] = of_normal[joint, now]
        tangential[:, joint, end] = of_tangential[joint, now]
        way, turn = onward()
        crossed = back, joint, end
        rising = normal[crossed] * turn[joint, end] + tangential[crossed] * turn[joint, 2 + end]
        sign = 1.0 if rising > 0 else -1.0
    return None


def _part(
    step: Step,
    joint: int,
    push: Array,
    contacts: Contacts,
    own: NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Return the share of one joint in the system: matrix (6, 6) and right side (6,)."""
    rows = step.rows[joint]
    acting = leaning(rows, contacts, step.friction.lean[joint])
    closed = (contacts != OPEN) & ~own
    weight = STIFF * np.concatenate([closed, contacts == STICKS])
    return np.matmul(acting.T * weight, rows), np.matmul(push * closed, acting[:2])
