"""A root in a bracket, to the last bits."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from blocksim.common.later import Library

if TYPE_CHECKING:
    from scipy import optimize
else:
    optimize = Library("scipy.optimize")

TINY = 4 * np.finfo(float).eps


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Find where a function changes sign between low and high."""
    return float(optimize.brentq(function, low, high, xtol=1e-300, rtol=TINY, maxiter=500))
