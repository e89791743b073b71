"""Roots in a bracket, to the last bits."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from blocksim.common.later import optimize

ASIDE, PATIENCE = 0.2, 3
"""How far estimates are moved, and how many may narrow an interval by less than four."""
TINY = 4 * np.finfo(float).eps


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Find where a function changes sign between low and high."""
    return float(optimize.brentq(function, low, high, xtol=1e-300, rtol=TINY, maxiter=500))


def least_root(
    gap: Callable[[float], float], low: float, high: float, precision: float = 0.0
) -> float:
    """Smallest value in (low, high] at which a growing gap is not below 0.

    As precisely as asked for, or to the last bit. `high` is such a value. Each estimate is
    by a straight line through both ends, moved a little towards the middle so that the next
    one comes from the other side; where that does not narrow the interval it is halved.
    """
    whole, below, above = high - low, gap(low), gap(high)
    slow = 0
    while True:
        width, middle = high - low, (low + high) / 2
        if middle in {low, high} or width <= precision * high:
            return high
        value = middle
        if slow < PATIENCE and math.isfinite(above - below):
            line = low - below * (width / (above - below))
            aside = max(ASIDE * width**2 / whole, 2.0**slow * math.ulp(line))
            value = line + math.copysign(min(aside, abs(middle - line)), middle - line)
            if not low < value < high:
                value = middle
        found = gap(value)
        if found >= 0:
            high, above = value, found
        else:
            low, below = value, found
        slow = 0 if value == middle or high - low < width / 4 else slow + 1
