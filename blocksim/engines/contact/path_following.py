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

A path may begin at a guess as well: `put_right`.

Along a path friction is at most 1 / `FLATTEST`; what ends it takes friction as it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import System
from blocksim.engines.contact.coulomb import (
    FLATTEST,
    LEAN,
    OPEN,
    SLIDES_DOWN,
    SLIDES_UP,
    STICKS,
    Contacts,
    beyond,
    edges,
    leaning,
)
from blocksim.engines.contact.slides import Slides
from blocksim.engines.contact.step import Answer, Linear, Step

STIFF = 1e8
"""Stiffness of the springs: what they yield then is mended in a few systems."""
MOST_PIECES = 20_000
STEEP_PIECES = 40
"""The same for each joint with steep friction: longer ways are round-off going in circles."""

NEAREST_PIECES, NEAR_PIECES, LAST_PIECES = 2, 3, 1
"""The same for each joint from a guess: the best one leads there soon or hardly ever, and from
others all apart is then as near; of those from the last step that arrive 95 % take 0.9."""


def come_together(step: Step, preload: Array | None = None) -> Answer | None:
    """Balance stiff springs, from all contacts apart.

    Their forces without motion may be given: near the limit it is they that tell what contacts
    do, to more digits than springs yield.
    """
    preload = np.zeros_like(step.rates) if preload is None else preload
    glued = preload - STIFF * step.velocities(step.free)
    shares = np.random.default_rng(0).uniform(1.0, 2.0, (len(glued), 2))
    push = np.concatenate([STIFF * shares, np.zeros_like(shares)], axis=1)
    apart = float(np.maximum(glued[:, :2] / push[:, :2], 0.0).max(initial=0.0))
    most = STEEP_PIECES * len(glued) if step.friction.some_steep else MOST_PIECES
    start = _Start(
        x=step.free,
        forces=glued - apart * push,
        contacts=np.full(shares.shape, OPEN, dtype=np.int8),
        push=push,
        pull=np.zeros_like(step.free),
        left=apart,
    )
    return _end(step, start, preload, most)


def put_right(step: Step, guess: Answer, most: int = NEAR_PIECES) -> Answer | None:
    """Balance stiff springs, from what a guess says.

    Velocities that its contacts may not have and forces that do not balance are taken for
    given, and fall to nothing along the path. It is the shorter the better the guess, a tenth
    of that from all apart. Nothing tells that it arrives: after so many systems a joint it is
    given up. So it is with steep friction.
    """
    if step.friction.some_steep:
        return None
    x, contacts, velocities = guess.x, guess.contacts.copy(), step.velocities(guess.x)
    held = np.abs(guess.forces[:, 2:])
    pressed = np.maximum(guess.forces, [0.0, 0.0, -math.inf, -math.inf])
    forces = step.friction.as_said(pressed, contacts, held)
    normal, slip = velocities[:, :2], velocities[:, 2:]
    against = np.select(
        [contacts == STICKS, contacts == SLIDES_UP, contacts == SLIDES_DOWN],
        [slip, np.maximum(slip, 0.0), np.minimum(slip, 0.0)],
        0.0,
    )
    into = np.where(contacts == OPEN, np.minimum(normal, 0.0), normal)
    wrong = STIFF * np.concatenate([into, against], axis=1)
    start = _Start(
        x=x,
        forces=forces - STIFF * velocities + wrong,
        contacts=contacts,
        push=-wrong,
        pull=-step.imbalance(x, forces),
        left=1.0,
    )
    return _end(step, start, forces, most * len(forces))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Start:
    """Where a path begins.

    Parameters
    ----------
    x : (3 blocks,) float
    forces : (joints, 4) float
        As if glued, but for steep friction that slides, whose size stands for the normal force.
    contacts : (joints, 2) int
        What they do; changed along the path.
    push : (joints, 4) float
        How forces as if glued change at x as `left` falls by 1.
    pull : (3 blocks,) float
        How forces on blocks do.
    left : float
    """

    x: Array
    forces: Array
    contacts: Contacts
    push: Array
    pull: Array
    left: float


def _end(step: Step, start: _Start, preload: Array, most: int) -> Answer | None:
    """Return the end of a path, of springs that had these forces without motion, if any."""
    found = _follow(step, start, most)
    if found is None:
        return None
    x, held, pieces = found
    # What has been summed up over the pieces is off by round-off; what contacts do is not.
    linear = Linear(step, start.contacts, STIFF)
    way, more = linear.way(x, preload - STIFF * step.velocities(x), held)
    if np.isfinite(way).all():
        x, held = x + way, held + more
    forces = linear.doing.forces(preload - STIFF * step.velocities(x), held)
    return Answer(x=x, forces=forces, contacts=start.contacts, systems=pieces)


def _follow(step: Step, start: _Start, most: int) -> tuple[Array, Array, int] | None:
    """Follow a path until nothing is left, over so many pieces at most.

    Returns
    -------
    x : (3 blocks,) float
    held : (joints, 2) float
        Friction of contacts that slide with steep friction.
    pieces : int
    """
    bands, rows, friction = step.bands, step.rows, step.friction
    x, forces, contacts, left = start.x, start.forces, start.contacts, start.left
    push, sign = start.push, 1.0
    own = friction.own(contacts)
    acting, weight = _acting(rows, contacts, friction.lean, own)
    right = start.pull + bands.pull(acting, push * (weight > 0))
    system = System(bands, bands.band(acting, weight, rows), right)

    def onward() -> tuple[Array, Array]:
        """Return how x and the forces change."""
        if not own.any():
            way = system.solve()
            return way, push - STIFF * bands.along(rows, way)
        slides = Slides(bands, rows, contacts, own, flat)
        way, held = slides.solve(system.solve, push[:, :2] / STIFF, STIFF)
        turn = push - STIFF * bands.along(rows, way)
        turn[:, :2] = np.where(own, held, turn[:, :2])
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
        gone = _of_joint(step, joint, contacts, own, push)
        contacts[joint, end] = now
        own[joint] = friction.steep[joint] & (contacts[joint] >= SLIDES_UP)
        here = _of_joint(step, joint, contacts, own, push)
        system.add(joint, here[0] - gone[0], here[1] - gone[1])
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


def _of_joint(
    step: Step, joint: int, contacts: Contacts, own: NDArray[np.bool_], push: Array
) -> tuple[Array, Array]:
    """Return what a joint adds to the system: a matrix (6, 6), and a right side (6,)."""
    rows, lean = step.rows[joint], step.friction.lean[joint]
    acting, weight = _acting(rows, contacts[joint], lean, own[joint])
    return np.matmul(acting.T * weight, rows), (push[joint] * (weight > 0)) @ acting


def _acting(
    rows: Array, contacts: Contacts, lean: Array, own: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Return how forces of springs act, and the stiffness of springs.

    Parameters
    ----------
    rows : (..., 4, 6) float
    contacts : (..., 2) int
    lean : (..., 1) float
    own : (..., 2) bool
        Contacts whose friction is an unknown of its own.
    """
    closed = (contacts != OPEN) & ~own
    weight = STIFF * np.concatenate([closed, contacts == STICKS], axis=-1)
    return leaning(rows, lean * LEAN[contacts]), weight
