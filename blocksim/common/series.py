"""Entire functions of y = x^2 in which nothing cancels at small angles; quadrature by Gauss.

With

    1 - cos x = y C(y),    x sin x = y S(y),    C = 1/2 - y R(y),    S = 1 - y (2 R + P),
    x sin x - 2 (1 - cos x) = -y^2 P(y),

P and R are entire functions whose power series reach the last bit up to x = pi.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Value = TypeVar("Value", float, NDArray[np.float64])

TERMS = 14

_R = [(-1) ** k / math.factorial(2 * k) for k in range(2, TERMS)]
_P = [(-1) ** k * (2 * k - 2) / math.factorial(2 * k) for k in range(2, TERMS)]


def r_series(y: Value) -> Value:
    """R(y)."""
    return _series(_R, y)


def p_series(y: Value) -> Value:
    """P(y)."""
    return _series(_P, y)


def sine_series(y: Value) -> Value:
    """(x - sin x)/x^3."""
    return 2 * _series(_R, y) + _series(_P, y)


def lag_series(y: Value) -> Value:
    """(sin x - x cos x)/x^3."""
    return 0.5 - (2 + y) * _series(_R, y) - _series(_P, y)


@cache
def gauss(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights of Gauss and Legendre on the interval from 0 to 1, (count,) each."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (nodes + 1) / 2, weights / 2


def _series(coefficients: list[float], y: Value) -> Value:
    # To the same bits, and for a single number ten times as fast.
    if isinstance(y, np.ndarray) and y.size == 1:
        return np.full(y.shape, _series(coefficients, float(y.item())))
    value = y * coefficients[-1] + coefficients[-2]
    for coefficient in reversed(coefficients[:-2]):
        value *= y
        value += coefficient
    return value
