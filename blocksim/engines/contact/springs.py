"""How stiff contact springs are, and when what they give counts as solved.

Contacts are springs preloaded with the forces found last, round after round, until they
yield no more. All that limits stiffness is round-off, which grows with it.
"""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.coulomb import Friction

SOFT, STIFF = 1e3, 1e9
"""Least and largest stiffness."""
STIFFNESS = 1e4
"""Stiffness times accelerations, limited by round-off."""
STEEPEST = 3.0
"""Friction above which springs are softer: the edges of its cone multiply their forces."""
BALANCE = 1e-11
"""Forces out of balance at which a system counts as solved, in mean weights."""
ROUND_OFF = 1e-14
"""The same, in units of the stiffest forces."""
STALLED = 30.0
"""Multiple of that below which an imbalance that no longer halves is round-off."""
STIFFER = 1e3
"""Largest factor on the stiffness where progress is slow."""
DRIFT = 0.9
"""Springs that yield by as much as before, within this ratio, do so without end."""
MOST_ROUNDS = 40


class Springs:
    """The stiffness of one step's springs, round after round.

    Parameters
    ----------
    friction : Friction
    precision : float
        Largest yield at which the step counts as solved [g].
    """

    def __init__(self, friction: Friction, precision: float) -> None:
        # That of steep friction multiplies nothing: it is an unknown of its own.
        self._steep = max(1.0, float(friction.lean.max(initial=0.0)) / STEEPEST)
        self._precision = precision
        self._factor, self._last = 1.0, math.inf
        self.drifts = False

    def stiffness(self, x: Array) -> float:
        """Stiffness that round-off allows at accelerations x."""
        largest = max(float(np.abs(x).max()), 1e-9)
        return self._factor * float(np.clip(STIFFNESS / self._steep / largest, SOFT, STIFF))

    def rigid(self, x: Array, change: float) -> bool:
        """Tell whether springs that have yielded by `change` are rigid; else stiffen them."""
        size = float(np.abs(x).max())
        if change <= max(self._precision * max(1.0, size), 10 * ROUND_OFF * size):
            return True
        self.drifts = DRIFT * self._last < change < self._last / DRIFT
        # Slow progress asks for stiffness, at the cost of digits.
        if change > self._last / 10 and self._factor < STIFFER and not self.drifts:
            self._factor *= 4.0
        self._last = change
        return False

    def balanced(self, size: float, last: float, x: Array, stiffness: float) -> bool:
        """Tell whether an imbalance is as small as it gets."""
        noise = ROUND_OFF * stiffness * float(np.abs(x).max())
        stalled = STALLED * self._steep * noise
        return size <= max(BALANCE, noise) or last / 2 <= size <= stalled
