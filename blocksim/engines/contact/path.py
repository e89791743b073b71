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
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands, System
from blocksim.engines.contact.law import OPEN, STICKS, Contacts, beyond, cut, edges, leaning

MOST_PIECES = 20_000
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
    mu, stiffness : float
    """

    bands: Bands
    rows: Array
    bare: Array
    free: Array
    mu: float
    stiffness: float

    def glued(self, x: Array) -> Array:
        """Return the springs' forces before opening and friction cut them."""
        return self.bare - self.stiffness * self.bands.along(self.rows, x)

    def imbalance(self, x: Array, forces: Array) -> Array:
        """Return what is left of each block's acceleration times mass."""
        return x - self.free - self.bands.pull(self.rows, forces)


def shrink(balance: Balance, x: Array) -> tuple[Array | None, int]:
    """Find the balance by a short way from a guess; None if there is none."""
    random = np.random.default_rng(0).standard_normal(len(x))
    x = x + ASIDE * float(np.abs(x).max()) * random
    glued = balance.glued(x)
    forces, contacts = cut(glued, balance.mu)
    load = -balance.imbalance(x, forces)
    push = np.zeros((len(forces), 2))
    return _follow(balance, x, glued, contacts, push, load, 1.0, 1.0, max(SHORT, len(forces)))


def come_together(balance: Balance) -> tuple[Array | None, int]:
    """Find the balance from all contacts apart; None only where round-off spoils it."""
    glued = balance.glued(balance.free)
    shares = np.random.default_rng(0).uniform(1.0, 2.0, (len(glued), 2))
    push = balance.stiffness * shares
    apart = float(np.maximum(glued[:, :2] / push, 0.0).max(initial=0.0))
    glued[:, :2] -= apart * push
    contacts = np.full(push.shape, OPEN, dtype=np.int8)
    load = np.zeros_like(balance.free)
    return _follow(
        balance, balance.free, glued, contacts, push, load, apart, math.inf, MOST_PIECES
    )


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
) -> tuple[Array | None, int]:
    """Follow a path until nothing is left, over so many pieces at most.

    Parameters
    ----------
    balance : Balance
    x, forces, contacts
        At its beginning.
    push : (joints, 2) float
        Normal force that keeps a contact apart, per unit of `left`.
    load : (3 blocks,) float
        Force on the blocks, likewise.
    left : float
    turned : float
        Value of `left` at which the path has come back.

    Returns
    -------
    x : (3 blocks,) float or None
    pieces : int
    """
    bands, rows, mu, stiffness = balance.bands, balance.rows, balance.mu, balance.stiffness
    sign = 1.0
    weight = stiffness * np.concatenate([contacts != OPEN, contacts == STICKS], axis=1)
    system = System(bands, leaning(rows, contacts, mu), weight, rows, load)
    way = system.solve()
    turn = -stiffness * bands.along(rows, way)
    turn[:, :2] += push
    of_normal, of_tangential = edges(mu)
    normal = np.moveaxis(of_normal[contacts], 2, 0).copy()
    tangential = np.moveaxis(of_tangential[contacts], 2, 0).copy()
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
            return x + left * way, piece
        if not left - sign * length <= turned:
            return None, piece
        x, forces = x + length * sign * way, forces + length * sign * turn
        left -= sign * length
        gone = normal[edge, joint, end], tangential[edge, joint, end]
        now, back = beyond(int(contacts[joint, end]), edge, float(forces[joint, 2 + end]))
        for part, does in ((-1.0, contacts[joint, end]), (1.0, now)):
            contacts[joint, end] = does
            matrix, pull = _part(balance, joint, push[joint], contacts[joint])
            system.add(joint, part * matrix, part * pull)
        normal[:, joint, end], tangential[:, joint, end] = of_normal[now], of_tangential[now]
        way = system.solve()
        turn = -stiffness * bands.along(rows, way)
        turn[:, :2] += push
        onward = gone[0] * turn[joint, end] + gone[1] * turn[joint, 2 + end]
        sign = 1.0 if onward < 0 else -1.0
        crossed = back, joint, end
    return None, most


def _part(balance: Balance, joint: int, push: Array, contacts: Contacts) -> tuple[Array, Array]:
    """Return the share of one joint in the system: matrix (6, 6) and right side (6,)."""
    rows = balance.rows[joint]
    acting = leaning(rows, contacts, balance.mu)
    closed = contacts != OPEN
    weight = balance.stiffness * np.concatenate([closed, contacts == STICKS])
    return np.matmul(acting.T * weight, rows), np.matmul(push * closed, acting[:2])
