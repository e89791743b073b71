"""Contacts that slide with steep friction: friction is found with the accelerations.

Their pressure is a small share of their friction (none if mu = inf). Taken from pressure,
friction would be a tiny number times a huge one. So it is an unknown w of its own, and the
equation that goes with it is pressure's: -k n = w / mu. There are few such contacts; they
border the banded system of the others.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.coulomb import LEAN, Contacts


class Slides:
    """The border of a system (1 + matrix) x = right.

    Parameters
    ----------
    bands : Bands
    rows : (joints, 4, 6) float
        Normal velocities of the two contacts, then the tangential ones.
    contacts : (joints, 2) int
    own : (joints, 2) bool
        Which of them these are.
    flat : (joints, 1) float
        Pressure per friction.
    """

    def __init__(
        self,
        bands: Bands,
        rows: Array,
        contacts: Contacts,
        own: NDArray[np.bool_],
        flat: Array,
    ) -> None:
        self._bands, self._own = bands, own
        joint, end = np.nonzero(own)
        self._joint, self._seen = joint, rows[joint, end]
        self._flat = flat[joint, 0]
        self._acting = LEAN[contacts[own]][:, None] * rows[joint, 2 + end]
        self._acting += self._flat[:, None] * self._seen

    def solve(
        self, solve: Callable[[Array], Array], target: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Solve the bordered system.

        Parameters
        ----------
        solve : callable
            Takes what comes besides the right side, shape (3 blocks, k), and returns the
            solutions of the system with the right side first, shape (3 blocks, 1 + k).
        target : (joints, 2) float
            Normal velocities that would leave contacts without pressure.
        stiffness : float

        Returns
        -------
        x : (3 blocks,) float
        held : (joints, 2) float
            Friction of these contacts, 0 elsewhere. All is nan where the system is singular.
        """
        count, place = len(self._joint), self._bands.place[self._joint]
        columns = np.zeros((self._bands.size + 1, count))
        np.add.at(columns, (place, np.arange(count)[:, None]), self._acting)
        found = solve(columns[:-1])
        padded = np.vstack([found, np.zeros(1 + count)])
        seen = (self._seen[:, :, None] * padded[place]).sum(axis=1)
        small = seen[:, 1:] + np.diag(self._flat / stiffness)
        held = np.zeros(self._own.shape)
        try:
            held[self._own] = np.linalg.solve(small, target[self._own] - seen[:, 0])
        except np.linalg.LinAlgError:
            held[self._own] = np.nan
        return found[:, 0] + found[:, 1:] @ held[self._own], held
