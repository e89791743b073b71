"""The map: where in the plane of eta and mu each mode rules, and the lines between.

Every line is a curve in one parameter, found from its defining equations. Thrust and inner
sliding angle on the lines where an inner joint slides follow from the anomaly E of
`inner_sliding`; alpha then follows from (8).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from blocksim.arch.circular import Weight
from blocksim.arch.theory.critical import (
    ETA_MAX,
    TINY,
    hinge_slope,
    inner_hinge,
    inner_sliding,
    rotational_thrust,
)
from blocksim.arch.theory.equations import inner_friction, shoulder_friction
from blocksim.blocks.assembly import Array

WIDE_ARCH = 2.3
"""Half-angle below which no hinge comes near the crown [rad]."""


@dataclass(frozen=True, kw_only=True)
class Landmark:
    """A point where lines of the map meet (Table 1).

    Parameters
    ----------
    name : str
        T, S, J or B.
    half_angle, mu, eta, thrust, beta_r, beta_s : float
    """

    name: str
    half_angle: float
    mu: float
    eta: float
    thrust: float
    beta_r: float
    beta_s: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line of the map.

    Parameters
    ----------
    mu, eta : (k,) float
    """

    mu: Array
    eta: Array


def divide_half_angle(mu: float) -> float:
    """Half-angle at which shoulder and inner joint slide together, (8) and (9) [rad]."""
    thrust, friction_angle = inner_sliding(mu)[0], math.atan(mu)

    def shoulder(half_angle: float) -> float:
        excess = half_angle - friction_angle
        return thrust * math.sin(excess) - half_angle * math.cos(excess)

    return _root(shoulder, friction_angle, friction_angle + math.pi / 2)


def at_inner_sliding(mu: float, half_angle: float, weight: Weight) -> tuple[float, float]:
    """Thickness and inner hinge of an arch whose inner joint is about to slide.

    Returns
    -------
    eta, beta_r : float
    """
    thrust, _ = inner_sliding(mu)
    return max(inner_hinge(thrust, end, half_angle, weight) for end in (0.0, half_angle))


def landmarks(weight: Weight = "centreline") -> dict[str, Landmark]:
    """Points T, S, J and B of Table 1, from what defines each of them.

    All lie on the divide. At T the thrust is that of the rotational mode; at S the inner
    hinge is at the inner sliding joint; at J it reaches the crown; at B eta is 2.

    Parameters
    ----------
    weight : {"centreline", "sector"}

    Returns
    -------
    dict of str to Landmark
    """

    def triple(mu: float) -> float:
        return rotational_thrust(divide_half_angle(mu), weight) - inner_sliding(mu)[0]

    def shift(mu: float) -> float:
        return _equal_angles(mu, divide_half_angle(mu), weight)

    def junction(mu: float) -> float:
        return _crown_hinge(mu, divide_half_angle(mu), weight)

    def border(mu: float) -> float:
        return at_inner_sliding(mu, divide_half_angle(mu), weight)[0] - ETA_MAX

    mu_t = _root(triple, 1.0, 1.8)
    mu_j = _root(junction, mu_t, 2.5)
    found = {
        "T": mu_t,
        "S": _root(shift, mu_t, mu_j),
        "J": mu_j,
        "B": _root(border, mu_j, 4.0),
    }
    return {name: _landmark(name, mu, weight) for name, mu in found.items()}


def _landmark(name: str, mu: float, weight: Weight) -> Landmark:
    half_angle = divide_half_angle(mu)
    thrust, beta_s = inner_sliding(mu)
    eta, beta_r = at_inner_sliding(mu, half_angle, weight)
    return Landmark(
        name=name,
        half_angle=half_angle,
        mu=mu,
        eta=eta,
        thrust=thrust,
        # At J and beyond it the hinge is at the crown, by definition.
        beta_r=0.0 if name in {"J", "B"} else beta_r,
        beta_s=beta_s,
    )


def divide(mu: Array, weight: Weight = "centreline") -> Curve:
    """Line on the left of which no thickness stands (modes ss | others)."""
    eta = [at_inner_sliding(m, divide_half_angle(m), weight)[0] for m in mu.tolist()]
    return Curve(mu=mu, eta=np.array(eta))


def first_sliding(half_angle: Array, weight: Weight = "centreline") -> Curve:
    """Line on the right of which no joint slides (rrr | srr below T, rrs above)."""
    mu: list[float] = []
    eta: list[float] = []
    for alpha in half_angle.tolist():
        thrust = rotational_thrust(alpha, weight)
        mu.append(max(float(shoulder_friction(alpha, thrust)), float(inner_friction(thrust))))
        eta.append(max(inner_hinge(thrust, end, alpha, weight)[0] for end in (0.0, alpha)))
    return Curve(mu=np.array(mu), eta=np.array(eta))


def equal_angles(mu: Array, weight: Weight = "centreline") -> Curve:
    """Line beta_r = beta_s, from S to the right (rrs | rsr)."""
    return _inner_line(_equal_angles, mu, weight)


def crown_hinge(mu: Array, weight: Weight = "centreline") -> Curve:
    """Line beta_r = 0, from J to the right (rsr | rs)."""
    return _inner_line(_crown_hinge, mu, weight)


def _inner_line(
    condition: Callable[[float, float, Weight], float], mu: Array, weight: Weight
) -> Curve:
    eta: list[float] = []
    for m in mu.tolist():
        alpha = _root(
            lambda angle, m=m: condition(m, angle, weight), WIDE_ARCH, divide_half_angle(m)
        )
        eta.append(at_inner_sliding(m, alpha, weight)[0])
    return Curve(mu=mu, eta=np.array(eta))


def _equal_angles(mu: float, half_angle: float, weight: Weight) -> float:
    """Slope of the thickness at the inner sliding joint; 0 where the hinge is there."""
    thrust, beta_s = inner_sliding(mu)
    return hinge_slope(thrust, half_angle, beta_s, weight)


def _crown_hinge(mu: float, half_angle: float, weight: Weight) -> float:
    """Slope of the thickness at the crown; 0 where the hinge just reaches it."""
    return hinge_slope(inner_sliding(mu)[0], half_angle, 0.0, weight)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    return float(brentq(function, low, high, xtol=1e-300, rtol=TINY, maxiter=500))
