"""Truth by another way: equations of the paper that blocksim does not use itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq, root

from blocksim.arch.circular import Arch, Weight
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode
from blocksim.arch.theory.equations import Value, shape
from blocksim.arch.theory.lines import onset_equations
from blocksim.blocks.assembly import Array


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


def solve_onset(
    half_angle: float, mu: float, mode: Mode, start: Sequence[float], weight: Weight
) -> Array:
    """Solve eqs (10)-(14) for a mode, with no use of eqs (1)-(9).

    Parameters
    ----------
    half_angle, mu, mode, weight
        As in `onset_equations`.
    start : (4,) or (5,) float
        First guess of its unknowns; a per cent off will do.

    Returns
    -------
    (4,) or (5,) float
        eta, h, m, beta_r and, for an inner sliding joint, beta_s.
    """

    def equations(unknowns: Array) -> Array:
        return onset_equations(half_angle, mu, mode, unknowns.tolist(), weight)

    return np.asarray(root(equations, np.array(start), method="hybr", tol=1e-15).x)


def least_thickness_by_program(
    half_angle: float, mu: float, voussoirs: int, weight: Weight = "centreline", **asked: bool
) -> float | None:
    """Least thickness at which the program (16) has the value zero; None if above 2.

    Keywords are those of `mechanism`.
    """
    arch = Arch(half_angle=half_angle, eta=1.0, voussoirs=voussoirs, weight=weight)

    def missing(eta: float) -> float:
        return mechanism(replace(arch, eta=eta), mu, **asked).extra_strength

    if missing(2.0) > 0:
        return None
    return float(brentq(missing, 1e-9, 2.0, xtol=1e-15, rtol=1e-14))
