"""A root in a bracket, to the last bits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

TINY = 4 * np.finfo(float).eps


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Find where a function changes sign between low and high."""
    return float(brentq(function, low, high, xtol=1e-300, rtol=TINY, maxiter=500))
