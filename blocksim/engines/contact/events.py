"""When contacts close within a step, and when that matters."""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.common.later import optimize

PARTS = 64
"""Parts of a step in which the first sign of closing is looked for."""
CLOSE = 1e-13
"""Share of a step to which the moment is found."""


def first_closing(gap: Array, rate: Array, later: Array, at_end: Array, step: float) -> float:
    """Return when the first of some gaps closes in a step, shape () [the step's unit].

    Between its ends a gap follows the cubic with these values and slopes.

    `gap`, `later`, (contacts,): At the start and at the end, where all are below 0.
    `rate`, `at_end`, (contacts,): Their rates of change.
    """
    shares = np.linspace(0.0, 1.0, PARTS + 1)[1:]

    def gaps(share: Array) -> Array:
        s = share[:, None]
        return (
            gap * (1 + 2 * s) * (1 - s) ** 2
            + step * rate * s * (1 - s) ** 2
            + later * s * s * (3 - 2 * s)
            + step * at_end * s * s * (s - 1)
        ).min(axis=1)

    closed = gaps(shares) < 0
    # One that leaves from 0 has no sign at the start.
    high = float(shares[int(closed.argmax())]) if closed.any() else 1.0
    low = high - 1 / PARTS

    def least(share: float) -> float:
        return float(gaps(np.array([share]))[0])

    if not least(low) > 0 > least(high):
        return step * high
    # Beyond the zero, so that something has closed.
    found = optimize.brentq(least, low, high, xtol=CLOSE)
    return step * min(high, float(found) + CLOSE)
