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

A path may begin at a guess as well: `path_from_guess`.

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
    ContactStatus,
    beyond,
    edges,
    leaning,
)
from blocksim.engines.contact.step import Answer, Linear, Slides, Step

STIFF = 1e8
"""Stiffness of the springs: what they yield then is mended in a few systems."""
MOST_PIECES = 20_000
STEEP_PIECES = 40
"""The same for each joint with steep friction: longer ways are round-off going in circles."""

NEAREST_PIECES, NEAR_PIECES, LAST_PIECES = 2, 3, 1
"""The same for each joint from a guess: the best one leads there soon or hardly ever, and from
others all apart is then as near; of those from the last step that arrive 95 % take 0.9."""


def path_from_apart(step: Step, preload: Array | None = None) -> Answer | None:
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


def path_from_guess(step: Step, guess: Answer, most: int = NEAR_PIECES) -> Answer | None:
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
    forces = ContactStatus(step.friction, contacts).forces(pressed, held)
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

    `x`, (3 blocks,).
    `forces`, (joints, 4): As if glued, but for steep friction that slides, whose size stands
        for the normal force.
    `contacts`, (joints, 2): What they do; changed along the path.
    `push`, (joints, 4): How forces as if glued change at x as `left` falls by 1.
    `pull`, (3 blocks,): How forces on blocks do.
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
    forces = linear.status.forces(preload - STIFF * step.velocities(x), held)
    return Answer(x=x, forces=forces, contacts=start.contacts, systems=pieces)


def _follow(step: Step, start: _Start, most: int) -> tuple[Array, Array, int] | None:
    """Follow a path until nothing is left, over so many pieces at most.

    Returns `x`, (3 blocks,).
    Returns `held`, (joints, 2): Friction of contacts that slide with steep friction.
    """
    path = _Path(step, start)
    for piece in range(1, most):
        length, at = path.to_edge()
        if path.falls and length >= path.left:
            return (*path.ended(), piece)
        if not math.isfinite(length):
            return None
        path.cross(length, at)
    return None


Edge = tuple[int, int, int]
"""One of the two edges of what a contact does, its joint, and its end."""


class _Path:
    """Where a path has come to, and its way on."""

    def __init__(self, step: Step, start: _Start) -> None:
        self._step, self._push = step, start.push
        self._x, self._forces, self.left = start.x, start.forces, start.left
        self._contacts, friction = start.contacts, step.friction
        self.falls, self._crossed = True, None
        self._own, self._flat = friction.own(self._contacts), friction.flattest
        acting, weight = _acting(step.rows, self._contacts, friction.lean, self._own)
        right = start.pull + step.bands.pull(acting, self._push * (weight > 0))
        self._system = System(step.bands, step.bands.band(acting, weight, step.rows), right)
        mu = np.minimum(friction.mu, 1 / FLATTEST)
        self._of_normal, self._of_tangential = edges(mu[:, 0], friction.steep[:, 0])
        joints, done = np.arange(len(mu))[:, None], self._contacts
        self._normal = np.moveaxis(self._of_normal[joints, done], 2, 0).copy()
        self._tangential = np.moveaxis(self._of_tangential[joints, done], 2, 0).copy()
        self._onward()

    def _onward(self) -> None:
        """Find how x and the forces change."""
        bands, rows, push = self._step.bands, self._step.rows, self._push
        if not self._own.any():
            self._way = self._system.solve()
            self._turn = push - STIFF * bands.along(rows, self._way)
            return
        slides = Slides(bands, rows, self._contacts, self._own, self._flat)
        self._way, held = slides.solve(self._system.solve, push[:, :2] / STIFF, STIFF)
        self._turn = push - STIFF * bands.along(rows, self._way)
        self._turn[:, :2] = np.where(self._own, held, self._turn[:, :2])

    def to_edge(self) -> tuple[float, Edge]:
        """Return how far it is to where a contact changes over, and which edge that is."""
        turn, forces = self._turn, self._forces
        slope = self._normal * turn[:, :2] + self._tangential * turn[:, 2:]
        if not self.falls:
            slope = -slope
        if self._crossed is not None:
            slope[self._crossed] = 0.0
        value = self._normal * forces[:, :2] + self._tangential * forces[:, 2:]
        lengths = np.full(value.shape, math.inf)
        np.divide(np.maximum(value, 0.0), -slope, out=lengths, where=slope < 0)
        edge, joint, end = (int(i) for i in np.unravel_index(lengths.argmin(), value.shape))
        return float(lengths[edge, joint, end]), (edge, joint, end)

    def ended(self) -> tuple[Array, Array]:
        """Return x where nothing is left, and friction that is an unknown of its own."""
        held = np.where(self._own, self._forces[:, :2] + self.left * self._turn[:, :2], 0.0)
        return self._x + self.left * self._way, held

    def cross(self, length: float, at: Edge) -> None:
        """Go on to an edge, and across."""
        gone = length if self.falls else -length
        self._x = self._x + gone * self._way
        self._forces = self._forces + gone * self._turn
        self.left -= gone
        edge, joint, end = at
        was = int(self._contacts[joint, end])
        now, back = beyond(was, edge, float(self._forces[joint, 2 + end]))
        self._change(joint, end, now)
        if self._step.friction.steep[joint]:
            size = abs(self._forces[joint, 2 + end])
            closed = size if self._own[joint, end] else self._flat[joint, 0] * size
            self._forces[joint, end] = 0.0 if OPEN in {was, now} else closed
        self._normal[:, joint, end] = self._of_normal[joint, now]
        self._tangential[:, joint, end] = self._of_tangential[joint, now]
        self._onward()
        self._crossed = back, joint, end
        turn = self._turn[joint]
        rising = self._normal[self._crossed] * turn[end]
        self.falls = bool(rising + self._tangential[self._crossed] * turn[2 + end] > 0)

    def _change(self, joint: int, end: int, now: int) -> None:
        """Let a contact do something else, and change the system by what that changes."""
        rows, push = self._step.rows[joint], self._push[joint]
        contacts = np.stack([self._contacts[joint]] * 2)
        own = np.stack([self._own[joint]] * 2)
        contacts[1, end] = now
        own[1] = self._step.friction.steep[joint] & (contacts[1] >= SLIDES_UP)
        self._contacts[joint], self._own[joint] = contacts[1], own[1]
        both = np.broadcast_to(rows, (2, *rows.shape))
        acting, weight = _acting(both, contacts, self._step.friction.lean[joint], own)
        matrix = np.matmul(acting.swapaxes(1, 2) * weight[:, None], rows)
        right = np.matmul((push * (weight > 0))[:, None], acting)[:, 0]
        self._system.add(joint, matrix[1] - matrix[0], right[1] - right[0])


def _acting(
    rows: Array, contacts: Contacts, lean: Array, own: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Return how forces of springs act, and the stiffness of springs.

    `rows`, (..., 4, 6).
    `contacts`, (..., 2).
    `lean`, (..., 1).
    `own`, (..., 2): Contacts whose friction is an unknown of its own.
    """
    closed = (contacts != OPEN) & ~own
    weight = STIFF * np.concatenate([closed, contacts == STICKS], axis=-1)
    return leaning(rows, lean * LEAN[contacts]), weight
