"""Truth by another way: equations of the paper that blocksim does not use itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from blocksim import Arch
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.theory.equations import Value, shape


def lower_thrust(beta: Value, eta: Value) -> Value:
    """Thrust with hinges at crown extrados and haunch intrados, h_L (1)."""
    numerator = (2 - eta) * beta * np.sin(beta) - 2 * (1 - np.cos(beta))
    return numerator / (2 + eta - (2 - eta) * np.cos(beta))


def upper_thrust(half_angle: Value, beta: Value, eta: Value) -> Value:
    """Thrust with hinges at shoulder extrados and haunch intrados, h_U (2)."""
    numerator = (
        (2 + eta) * half_angle * np.sin(half_angle)
        - (2 - eta) * beta * np.sin(beta)
        - 2 * (np.cos(beta) - np.cos(half_angle))
    )
    return numerator / ((2 - eta) * np.cos(beta) - (2 + eta) * np.cos(half_angle))


def whole_thrust(half_angle: Value, eta: Value) -> Value:
    """Thrust with hinges at crown and shoulder extrados, h_2 (3)."""
    return shape(half_angle) - 2 / (2 + eta)


def tangency_thrust(beta: Value, eta: Value) -> Value:
    """Thrust whose line is tangent to the intrados at beta, h_e (4)."""
    return beta / np.tan(beta) - eta / (2 - eta)


def least_thickness_by_program(
    half_angle: float, mu: float, voussoirs: int, weight: str = "centreline"
) -> float | None:
    """Least thickness at which the program (16) has the value zero; None if above 2."""
    arch = Arch(half_angle=half_angle, eta=1.0, voussoirs=voussoirs, weight=weight)

    def missing(eta: float) -> float:
        return mechanism(replace(arch, eta=eta), mu).extra_strength

    if missing(2.0) > 0:
        return None
    return float(brentq(missing, 1e-9, 2.0, xtol=1e-15, rtol=1e-14))
