"""The ways to a solution where Newton's method runs in circles.

The springs of all contacts are brought into balance along a path on which something that
keeps them from it falls to nothing. The path is straight as long as each contact does what
it does. Where one comes to the edge of that, it changes over, and the measure of what is
left goes on falling or rises for a while: whichever carries that contact across.

- `shrink`: what is left is a share of the imbalance at the start. Short from a good guess,
  but it may come back to where it began, and is then given up.
- `come_together`: what is left keeps all contacts apart, each by a share of its own, so far
  at first that none carries anything. Contact and friction only take energy from what moves
  fast, so accelerations are bounded all along, and the solution is unique when all are far
  apart: the path cannot go back there, nor end anywhere but at 0 (Lemke's method for linear
  complementarity problems; Katzenelson's for piecewise linear systems).

Along a path friction is at most 1 / `FLATTEST`; Newton's method, which ends it, takes friction
as it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands, System
from blocksim.engines.contact.coulomb import (
    FLATTEST,
    OPEN,
    SLIDES_UP,
    STICKS,
    Contacts,
    Friction,
    beyond,
    cut,
    edges,
    leaning,
)
from blocksim.engines.contact.slides import Slides

MOST_PIECES = 20_000
STEEP_PIECES = 40
"""The same for each joint with steep friction: longer ways are round-off going in circles."""
SHORT = 60
"""Pieces after which a way from a guess is no short one; no fewer than there are joints."""
ASIDE = 1e-6
"""How far off the guess it begins, in its size, lest contacts change over together, as by
symmetry."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """The springs of all contacts, to be balanced.

    Parameters
    ----------
    bands : Bands
    rows : (joints, 4, 6) float
        Normal velocities of the two contacts, then the tangential ones.
    bare : (joints, 4) float
        Forces of the springs without acceleration, were they glued.
    free : (3 blocks,) float
        Accelerations without contact.
    friction : Friction
    stiffness : float
    """

    bands: Bands
    rows: Array
    bare: Array
    free: Array
    friction: Friction
    stiffness: float

    def glued(self, x: Array) -> Array:
        """Return the springs' forces before opening and friction cut them."""
        return self.bare - self.stiffness * self.bands.along(self.rows, x)

    def imbalance(self, x: Array, forces: Array) -> Array:
        """Return what is left of each block's acceleration times mass."""
        return x - self.free - self.bands.pull(self.rows, forces)


@dataclass(frozen=True, kw_only=True, eq=False)
class End:
    """Where a path ends.

    Parameters
    ----------
    x : (3 blocks,) float
    contacts : (joints, 2) int
    held : (joints, 2) float
        Friction of contacts that slide with steep friction.
    """

    x: Array
    contacts: Contacts
    held: Array


def shrink(balance: Balance, x: Array) -> tuple[End | None, int]:
    """Find the balance by a short way from a guess; None if there is none."""
    random = np.random.default_rng(0).standard_normal(len(x))
    x = x + ASIDE * float(np.abs(x).max()) * random
    glued = balance.glued(x)
    steepest = np.minimum(balance.friction.mu, 1 / FLATTEST)
    forces, contacts = cut(glued, steepest)
    load = -balance.imbalance(x, forces)
    push = np.zeros((len(forces), 2))
    own = balance.friction.own(contacts)
    glued[:, :2] = np.where(own, np.abs(forces[:, 2:]), glued[:, :2])
    return _follow(balance, x, glued, contacts, push, load, 1.0, 1.0, max(SHORT, len(forces)))


def come_together(balance: Balance) -> tuple[End | None, int]:
    """Find the balance from all contacts apart; None only where round-off spoils it."""
    glued = balance.glued(balance.free)
    shares = np.random.default_rng(0).uniform(1.0, 2.0, (len(glued), 2))
    push = balance.stiffness * shares
    apart = float(np.maximum(glued[:, :2] / push, 0.0).max(initial=0.0))
    glued[:, :2] -= apart * push
    contacts = np.full(push.shape, OPEN, dtype=np.int8)
    load = np.zeros_like(balance.free)
    most = STEEP_PIECES * len(glued) if balance.friction.some_steep else MOST_PIECES
    return _follow(balance, balance.free, glued, contacts, push, load, apart, math.inf, most)


def _follow(
    balance: Balance,
    x: Array,
    forces: Array,
    contacts: Contacts,
    push: Array,
    load: Array,
    left: float,
    turned: float,
    most: int,
) -> tuple[End | None, int]:
    """Follow a path until nothing is left, over so many pieces at most.

    Parameters
    ----------
    balance : Balance
    x, forces, contacts
        At its beginning; `forces` as if glued, but for steep friction that slides, whose
        size stands for the normal force.
    push : (joints, 2) float
        Normal force that keeps a contact apart, per unit of `left`.
    load : (3 blocks,) float
        Force on the blocks, likewise.
    left : float
    turned : float
        Value of `left` at which the path has come back.

    Returns
    -------
    end : End or None
    pieces : int
    """
    bands, rows, stiffness = balance.bands, balance.rows, balance.stiffness
    friction = balance.friction
    sign = 1.0
    own = friction.own(contacts)
    weight = stiffness * np.concatenate([(contacts != OPEN) & ~own, contacts == STICKS], axis=1)
    system = System(bands, leaning(rows, contacts, friction.lean), weight, rows, load)

    def onward() -> tuple[Array, Array]:
        """Return how x and the forces change."""
        if not own.any():
            way = system.solve()
            turn = -stiffness * bands.along(rows, way)
            turn[:, :2] += push
            return way, turn
        slides = Slides(bands, rows, contacts, own, flat)
        way, held = slides.solve(system.solve, push / stiffness, stiffness)
        turn = -stiffness * bands.along(rows, way)
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
            return End(x=x + left * way, contacts=contacts, held=held), piece
        if not left - sign * length <= turned:
            return None, piece
        x, forces = x + length * sign * way, forces + length * sign * turn
        left -= sign * length
        was = int(contacts[joint, end])
        now, back = beyond(was, edge, float(forces[joint, 2 + end]))
        for part, does in ((-1.0, was), (1.0, now)):
            contacts[joint, end] = does
            own[joint] = friction.steep[joint] & (contacts[joint] >= SLIDES_UP)
            matrix, pull = _part(balance, joint, push[joint], contacts[joint], own[joint])
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
    return None, most


def _part(
    balance: Balance, joint: int, push: Array, contacts: Contacts, own: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Return the share of one joint in the system: matrix (6, 6) and right side (6,)."""
    rows = balance.rows[joint]
    acting = leaning(rows, contacts, balance.friction.lean[joint])
    closed = (contacts != OPEN) & ~own
    weight = balance.stiffness * np.concatenate([closed, contacts == STICKS])
    return np.matmul(acting.T * weight, rows), np.matmul(push * closed, acting[:2])
