"""How stiff contact springs are.

Preloaded with the forces found last, they give those of rigid contact within a few rounds,
however soft they are. All that limits stiffness is round-off, which grows with it.
"""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.coulomb import Friction

SOFT, STIFF = 1e3, 1e9
"""Least and largest stiffness."""
STIFFNESS = 1e4
"""Stiffness times accelerations, limited by round-off."""
MOVING, ROUGH = 4e5, 1e-12
"""The same where no contact has to yield by less than that: forces are asked for 1e-10 only."""
STEEPEST = 3.0
"""Friction above which springs are softer: friction multiplies their forces."""


def stiffness_at(friction: Friction, x: Array, precision: float = 0.0) -> float:
    """Return the stiffness that round-off allows at accelerations x.

    The stiffer springs are, the fewer systems they take; yields are wanted to a precision [g].
    """
    rough = precision >= ROUGH and not friction.some_steep
    # Steep friction multiplies nothing: it is an unknown of its own.
    softer = max(1.0, friction.most_lean / STEEPEST)
    largest = max(float(np.abs(x).max()), 1e-9)
    return min(max((MOVING if rough else STIFFNESS) / softer / largest, SOFT), STIFF)
