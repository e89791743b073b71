"""What a contact may do.

Its law is piecewise linear in the forces its springs would have if it were glued, normal q
and tangential s: it is open where q <= 0, sticks where |s| <= mu q, and
slides either way beyond.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array

Contacts = NDArray[np.int8]
"""What each contact does, shape (joints, 2): one of the four pieces of its law each."""
OPEN, STICKS, SLIDES_UP, SLIDES_DOWN = range(4)
LEAN = np.array([0.0, 0.0, 1.0, -1.0])
"""Friction over its largest, on each piece where that is known."""


def cut(glued: Array, mu: float) -> tuple[Array, Contacts]:
    """Return the forces that contacts can carry, and what the contacts do.

    Parameters
    ----------
    glued : (joints, 4) float
        Normal forces of both contacts if glued, then tangential ones.
    mu : float

    Returns
    -------
    forces : (joints, 4) float
    contacts : (joints, 2) int
    """
    along = glued[:, 2:]
    pressure = np.maximum(glued[:, :2], 0.0)
    most = mu * pressure
    friction = np.minimum(np.maximum(along, -most), most)
    contacts = np.where(along > most, SLIDES_UP, STICKS)
    contacts[along < -most] = SLIDES_DOWN
    contacts[pressure == 0] = OPEN
    return np.concatenate([pressure, friction], axis=1), contacts.astype(np.int8)


def leaning(rows: Array, contacts: Contacts, mu: float) -> Array:
    """Return rows with pressure's turned to act with its friction where a contact slides.

    Parameters
    ----------
    rows : (..., 4, 6) float
        Normal velocities of the two contacts, then the tangential ones.
    contacts : (..., 2) int
    mu : float
    """
    acting = rows.copy()
    acting[..., :2, :] += (mu * LEAN[contacts])[..., None] * rows[..., 2:, :]
    return acting


def edges(mu: float) -> tuple[Array, Array]:
    """Two functions of q and s per piece, positive inside it: their factors, (pieces, 2)."""
    of_normal = np.array([(-1.0, 0.0), (mu, mu), (1.0, -mu), (1.0, -mu)])
    of_tangential = np.array([(0.0, 0.0), (-1.0, 1.0), (0.0, 1.0), (0.0, -1.0)])
    return of_normal, of_tangential


def beyond(old: int, edge: int, along: float) -> tuple[int, int]:
    """Return what a contact does beyond an edge of its piece, and which edge leads back."""
    if old == OPEN:
        return (SLIDES_UP if along > 0 else SLIDES_DOWN), 0
    if old == STICKS:
        return (SLIDES_DOWN if edge else SLIDES_UP), 1
    if edge == 0:
        return OPEN, 0
    return STICKS, 0 if old == SLIDES_UP else 1
