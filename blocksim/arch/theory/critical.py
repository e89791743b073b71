"""Least thickness of the continuous arch, for any half-angle and friction.

At a given thrust h the arch needs the larger of two thicknesses: eta_crown(h), which
keeps the line of thrust between crown extrados and an intrados hinge, falls with h;
eta_shoulder(h), between shoulder extrados and an intrados hinge, grows with h. They
meet at the thrust of the purely rotational mode. Friction confines h to
[h_inner, h_shoulder]; the least thickness is found at the thrust of that interval
nearest to the meeting point, and where it lies names the mode.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from blocksim.arch.circular import Arch, Weight, centroid_factor
from blocksim.arch.modes import Mode
from blocksim.arch.theory.equations import touching_eta
from blocksim.common.checks import require_friction

ETA_MAX = 2.0
TIE = 1e-12
"""Thrusts and angles closer than this coincide."""
CROWN_TIE = 1e-6
"""Inner hinges closer to the crown are at it: the angle goes as the root of a thrust."""
NO_THRUST = 1e-20
"""Thrust that counts as none: it grows as the square of the distance from alpha_l."""
FLAT = 0.05
"""Half-angle below which eta ~ alpha^4/48 drowns in the round-off of these formulas [rad]."""
CROWN_ETA: dict[Weight, float] = {"centreline": 1.0, "sector": 6 * (math.sqrt(4 / 3) - 1)}
"""eta_crown without thrust: the limit of `touching_eta` as the inner hinge nears the crown."""
TINY = 4 * np.finfo(float).eps


@dataclass(frozen=True, kw_only=True)
class Critical:
    """The continuous arch at its least thickness.

    Parameters
    ----------
    eta : float or None
        Least thickness-to-radius ratio; None where none up to 2 stands.
    modes : tuple of Mode
        Collapse modes: several on a line of the map, where they coincide within `TIE`.
        Where `eta` is None, what no thickness prevents.
    thrust : float or None
        h; None where no thrust is compatible with friction.
    beta_r, beta_s : float or None
        Angles from the crown of the inner hinge and of the inner sliding joint [rad];
        None where the mode has none.
    """

    eta: float | None
    modes: tuple[Mode, ...]
    thrust: float | None
    beta_r: float | None
    beta_s: float | None

    @property
    def mode(self) -> Mode:
        """The collapse mode, the first of several that coincide."""
        return self.modes[0]


def inner_sliding(mu: float) -> tuple[float, float]:
    """Thrust and angle at which an inner joint slides.

    With h = cos^2(E/2), eq. (9) becomes E - sin E = 2 arctan mu, Kepler's equation at
    eccentricity one, and beta_s = sin(E)/2. In pi - E it is well conditioned where E is
    not.

    Parameters
    ----------
    mu : float
        Friction coefficient, above 0, inf allowed.

    Returns
    -------
    thrust, beta_s : float
    """
    if mu < 1.0:
        target = 2 * math.atan(mu)
        anomaly = _root(lambda e: e - math.sin(e) - target, 0.0, math.pi)
        return math.cos(anomaly / 2) ** 2, math.sin(anomaly) / 2
    target = 2 * math.atan(1 / mu)
    rest = _root(lambda d: d + math.sin(d) - target, 0.0, math.pi)
    return math.sin(rest / 2) ** 2, math.sin(rest) / 2


def thrust_interval(half_angle: float, mu: float) -> tuple[float, float]:
    """Thrusts that no joint of the continuous arch resists by sliding.

    Parameters
    ----------
    half_angle : float
        alpha [rad].
    mu : float
        Friction coefficient, inf allowed.

    Returns
    -------
    lower, upper : float
        Inner sliding below `lower`, shoulder sliding above `upper` (may be inf); empty
        where lower > upper.
    """
    friction_angle = math.atan(mu)
    lower, beta_s = inner_sliding(mu)
    if beta_s > half_angle:
        lower = half_angle / math.tan(half_angle + friction_angle)
    excess = half_angle - friction_angle
    if excess <= 0:
        return lower, math.inf
    return lower, half_angle / math.tan(excess)


def inner_hinge(
    thrust: float, extrados: float, half_angle: float, weight: Weight
) -> tuple[float, float]:
    """Thickness needed at a given thrust, and the intrados hinge that demands it.

    Parameters
    ----------
    thrust : float
        h.
    extrados : float
        Angle of the extrados hinge: 0 for the crown, alpha for the shoulder [rad].
    half_angle : float
        alpha [rad].
    weight : {"centreline", "sector"}

    Returns
    -------
    eta, beta_r : float
        The largest `touching_eta` over the intrados, where eq. (4) holds.
    """
    if extrados == 0 and thrust == 0:
        return CROWN_ETA[weight], 0.0
    start = TINY if extrados == 0 else 0.0

    def eta_at(beta: float) -> float:
        return float(touching_eta(thrust, extrados, beta, weight))

    def slope(beta: float) -> float:
        return hinge_slope(thrust, extrados, beta, weight)

    # Where eta > 2 is asked for anywhere it is at the crown too, and nothing will do.
    if eta_at(start) > ETA_MAX or slope(start) <= 0:
        return eta_at(start), 0.0
    if slope(half_angle) >= 0:
        return eta_at(half_angle), half_angle
    beta = _root(slope, start, half_angle)
    return eta_at(beta), beta


def hinge_slope(thrust: float, extrados: float, beta: float, weight: Weight) -> float:
    """Tell on which side of beta the intrados asks for more thickness.

    It is h_e - h of (4), times 2 - eta, with the weight at its own radius.

    Parameters
    ----------
    thrust, extrados, beta : float
        h; angles of the extrados hinge and of the place asked about [rad].
    weight : {"centreline", "sector"}

    Returns
    -------
    float
        Positive where `touching_eta` grows with beta, 0 at the inner hinge.
    """
    eta = float(touching_eta(thrust, extrados, beta, weight))
    turn = 1.0 + (beta / math.tan(beta) if beta > 0 else 1.0) - thrust
    return turn * (2.0 - eta) - 2.0 * centroid_factor(eta, weight)


def least_thickness(half_angle: float, mu: float, weight: Weight = "centreline") -> Critical:
    """Least thickness, mode, thrust, hinge and sliding angles of the continuous arch.

    Parameters
    ----------
    half_angle : float
        In (0, pi) [rad].
    mu : float
        Friction coefficient, above 0, inf allowed.
    weight : {"centreline", "sector"}
        The paper treats the centreline; the sector follows from the same equations
        with the weight at radius 1 + eta^2/12.

    Returns
    -------
    Critical

    Raises
    ------
    InputError
        If a value is out of range.
    """
    Arch(half_angle=half_angle, eta=1.0, voussoirs=3, weight=weight)
    require_friction(mu)
    if half_angle < FLAT:
        return _flat(half_angle, mu, weight)
    lower, upper = thrust_interval(half_angle, mu)
    beta_s = inner_sliding(mu)[1]
    if lower > upper + TIE:
        return Critical(eta=None, modes=(Mode.SS,), thrust=None, beta_r=None, beta_s=beta_s)
    free = rotational_thrust(half_angle, weight)
    thrust = min(max(free, lower), upper)
    crown, crown_hinge = inner_hinge(thrust, 0.0, half_angle, weight)
    shoulder, shoulder_hinge = inner_hinge(thrust, half_angle, half_angle, weight)
    eta, beta_r = max((crown, crown_hinge), (shoulder, shoulder_hinge))
    modes: list[Mode] = []
    if abs(thrust - free) <= TIE:
        modes.append(Mode.RRR if free > NO_THRUST else Mode.R)
    if upper <= free + TIE:
        modes.append(Mode.SRR)
    if lower >= free - TIE and thrust > TIE:
        modes += _inner_modes(beta_r, beta_s)
    if upper - lower <= TIE:
        modes.append(Mode.SS)
    sliding = set(modes) & {Mode.RRS, Mode.RSR, Mode.RS, Mode.SS}
    return Critical(
        eta=min(eta, ETA_MAX) if eta <= ETA_MAX * (1 + TIE) else None,
        modes=tuple(modes),
        thrust=thrust,
        beta_r=beta_r,
        beta_s=beta_s if sliding else None,
    )


def _flat(half_angle: float, mu: float, weight: Weight) -> Critical:
    """Solve a flat arch by the array formulas, in which nothing cancels."""
    from blocksim.arch.theory.arrays import least_thicknesses  # built on this module

    found = least_thicknesses(half_angle, mu, weight)
    eta, thrust, beta_r, beta_s = (
        None if math.isnan(value) else float(value)
        for value in (found.eta, found.thrust, found.beta_r, found.beta_s)
    )
    return Critical(eta=eta, modes=found.names, thrust=thrust, beta_r=beta_r, beta_s=beta_s)


def _inner_modes(beta_r: float, beta_s: float) -> list[Mode]:
    """Modes with a sliding inner joint; two of them where the angles coincide."""
    if beta_r <= CROWN_TIE:
        return [Mode.RS] if beta_r == 0 else [Mode.RS, Mode.RSR]
    if abs(beta_r - beta_s) <= TIE:
        return [Mode.RRS, Mode.RSR]
    return [Mode.RRS if beta_r > beta_s else Mode.RSR]


def rotational_thrust(half_angle: float, weight: Weight) -> float:
    """Thrust at which crown and shoulder ask for the same thickness.

    The solution of eqs (1), (3) and (4), or 0 where each half overturns by itself.
    """

    def difference(thrust: float) -> float:
        crown, _ = inner_hinge(thrust, 0.0, half_angle, weight)
        shoulder, _ = inner_hinge(thrust, half_angle, half_angle, weight)
        return shoulder - crown

    return 0.0 if difference(0.0) >= 0 else _root(difference, 0.0, 1.0)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root in a bracket, to the last bits."""
    return float(brentq(function, low, high, xtol=1e-300, rtol=TINY, maxiter=500))
