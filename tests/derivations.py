"""Truth by another way: equations of the paper that blocksim does not use itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq, root

from blocksim import Arch, Mode
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.theory.equations import Value, normal_force, shape
from blocksim.arch.theory.lines import friction_line, section_moment, thrust_line


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


def thrust_line_slope(
    angle: Value, thrust: Value, crown_moment: Value, eta: Value, weight: str = "centreline"
) -> Value:
    """Differentiate `thrust_line` by the angle, (12)."""
    factor = 1.0 if weight == "centreline" else 1.0 + eta**2 / 12
    force = normal_force(angle, thrust)
    rate = (1 - thrust) * np.sin(angle) + angle * np.cos(angle)
    moment = section_moment(angle, thrust, crown_moment, eta, weight)
    moment_rate = factor * np.sin(angle) - rate
    return -(moment_rate * force - moment * rate) / (force**2 * eta / 2)


def friction_line_slope(angle: Value, thrust: Value, mu: Value) -> Value:
    """Differentiate `friction_line` by the angle, (14)."""
    force = normal_force(angle, thrust)
    shear = thrust * np.sin(angle) - angle * np.cos(angle)
    rate = (1 - thrust) * np.sin(angle) + angle * np.cos(angle)
    shear_rate = (thrust - 1) * np.cos(angle) + angle * np.sin(angle)
    return -(shear_rate * force - shear * rate) / (mu * force**2)


def onset_equations(
    half_angle: float, mu: float, mode: Mode, unknowns: Sequence[float], weight: str
) -> np.ndarray:
    """Residuals of those of eqs (10)-(14) that a mode fulfils.

    Parameters
    ----------
    half_angle, mu : float
        alpha [rad], friction coefficient.
    mode : Mode
        One of rrr, srr, rrs, rsr and rs.
    unknowns : (4,) or (5,) float
        eta, h, m, beta_r; for an inner sliding joint beta_s too.
    weight : {"centreline", "sector"}

    Returns
    -------
    (4,) or (5,) float
        Zero at the onset of collapse.
    """
    eta, thrust, moment, beta_r = unknowns[:4]

    def line(angle: float) -> Value:
        return thrust_line(angle, thrust, moment, eta, weight)

    slope = (
        # The line of thrust is even: it is tangent at the crown anyhow.
        beta_r if mode is Mode.RS else thrust_line_slope(beta_r, thrust, moment, eta, weight)
    )
    equations = [line(beta_r) - 1, slope]
    if mode in {Mode.RRR, Mode.SRR}:
        equations.append(line(0.0) + 1)
    if mode is not Mode.SRR:
        equations.append(line(half_angle) + 1)
    else:
        equations.append(friction_line(half_angle, thrust, mu) + 1)
    if mode in {Mode.RRS, Mode.RSR, Mode.RS}:
        beta_s = unknowns[4]
        equations.append(friction_line(beta_s, thrust, mu) - 1)
        equations.append(friction_line_slope(beta_s, thrust, mu))
    return np.array(equations, dtype=float)


def solve_onset(
    half_angle: float, mu: float, mode: Mode, start: Sequence[float], weight: str
) -> np.ndarray:
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

    def equations(unknowns: np.ndarray) -> np.ndarray:
        return onset_equations(half_angle, mu, mode, unknowns.tolist(), weight)

    return np.asarray(root(equations, np.array(start), method="hybr", tol=1e-15).x)


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
