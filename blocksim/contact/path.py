"""The way to a solution from all contacts apart, which cannot fail to arrive.

All contacts are kept apart by a common measure times a share of their own, so large at
first that none carries anything. As the measure falls to 0 the accelerations follow a path
that is straight as long as each contact does what it does. Where one comes to the edge of
that, it changes over, and the measure goes on falling or rises for a while: whichever
carries that contact across.

Contact and friction only take energy from what moves fast, so accelerations are bounded all
along, and beyond the start the solution is unique: the path cannot come back there, nor end
anywhere but at 0 (Lemke's method for linear complementarity problems; Katzenelson's for
piecewise linear systems).
"""

from __future__ import annotations

import math

import numpy as np

from blocksim.assembly import Array
from blocksim.contact.banded import Bands, System
from blocksim.contact.law import OPEN, STICKS, Contacts, beyond, edges, leaning

MOST_PIECES = 20_000


def come_together(
    bands: Bands, rows: Array, glued: Array, free: Array, mu: float, stiffness: float
) -> tuple[Array, int]:
    """Find the accelerations at which contact springs balance.

    Parameters
    ----------
    bands : Bands
    rows : (joints, 4, 6) float
        Normal velocities of the two contacts, then the tangential ones.
    glued : (joints, 4) float
        Forces of the springs at the accelerations without contact, before they are cut.
    free : (3 blocks,) float
        Those accelerations.
    mu, stiffness : float

    Returns
    -------
    x : (3 blocks,) float
        Where the path has come to, if not to its end.
    pieces : int
        Systems solved.
    """
    joints = len(rows)
    # Shares differ, lest two contacts change over at once, as by symmetry.
    push = stiffness * np.random.default_rng(0).uniform(1.0, 2.0, (joints, 2))
    apart = float(np.maximum(glued[:, :2] / push, 0.0).max(initial=0.0))
    x, forces = free.copy(), glued.copy()
    forces[:, :2] -= apart * push
    turn = np.zeros_like(forces)
    turn[:, :2] = push
    way, sign = np.zeros_like(x), 1.0
    of_normal, of_tangential = edges(mu)
    contacts = np.zeros((joints, 2), dtype=np.int8)
    normal = np.broadcast_to(of_normal[OPEN][:, None, None], (2, joints, 2)).copy()
    tangential = np.broadcast_to(of_tangential[OPEN][:, None, None], (2, joints, 2)).copy()
    system = System(bands)
    crossed: tuple[int, int, int] | None = None
    for piece in range(MOST_PIECES):
        slope = normal * turn[:, :2] + tangential * turn[:, 2:]
        slope *= sign
        if crossed is not None:
            slope[crossed] = 0.0
        value = normal * forces[:, :2] + tangential * forces[:, 2:]
        lengths = np.full(value.shape, math.inf)
        np.divide(np.maximum(value, 0.0), -slope, out=lengths, where=slope < 0)
        edge, joint, end = (int(i) for i in np.unravel_index(lengths.argmin(), value.shape))
        length = float(lengths[edge, joint, end])
        if (sign > 0 and length >= apart) or not math.isfinite(length):
            return x + apart * way, piece
        x, forces = x + length * sign * way, forces + length * sign * turn
        apart -= length * sign
        left = normal[edge, joint, end], tangential[edge, joint, end]
        now, back = beyond(int(contacts[joint, end]), edge, float(forces[joint, 2 + end]))
        for sign, does in ((-1.0, contacts[joint, end]), (1.0, now)):
            contacts[joint, end] = does
            matrix, pull = _part(rows[joint], push[joint], contacts[joint], mu, stiffness)
            system.add(joint, sign * matrix, sign * pull)
        normal[:, joint, end], tangential[:, joint, end] = of_normal[now], of_tangential[now]
        way = system.solve()
        turn = -stiffness * bands.along(rows, way)
        turn[:, :2] += push
        onward = left[0] * turn[joint, end] + left[1] * turn[joint, 2 + end]
        sign = 1.0 if onward < 0 else -1.0
        crossed = back, joint, end
    return x, MOST_PIECES


def _part(
    rows: Array, push: Array, contacts: Contacts, mu: float, stiffness: float
) -> tuple[Array, Array]:
    """Share of one joint in the system: matrix (6, 6) and right side (6,)."""
    acting = leaning(rows, contacts, mu)
    closed = contacts != OPEN
    weight = stiffness * np.concatenate([closed, contacts == STICKS])
    return np.matmul(acting.T * weight, rows), np.matmul(push * closed, acting[:2])
