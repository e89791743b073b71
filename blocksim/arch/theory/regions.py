"""The map: where in the plane of eta and mu each mode rules, and the lines between.

Every line is a curve in one parameter, found from its defining equations. Thrust and inner
sliding angle on the lines where an inner joint slides follow from the anomaly E of
`inner_sliding`; alpha then follows from (8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from blocksim.arch.circular import ETA_MAX, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.roots import root
from blocksim.arch.theory.critical import inner_sliding, rotational_thrust
from blocksim.arch.theory.equations import hinge_slope
from blocksim.arch.theory.rotation import inner_hinges, rotational_mode, widest_rotational
from blocksim.arch.theory.sliding import (
    inner_frictions,
    inner_slidings,
    shoulder_frictions,
    shoulder_slip,
)
from blocksim.blocks.assembly import Array
from blocksim.common.checks import require

WIDE_ARCH = 2.3
"""Half-angle below which no hinge comes near the crown [rad]."""


@dataclass(frozen=True, kw_only=True)
class Landmark:
    """A point of the map: where lines meet (Table 1), of a special angle, or on a line.

    `name`: Letter of Table 1, name of a special angle, or of a line.
    `half_angle`, `mu`, `eta`: alpha [rad]; friction coefficient, inf allowed;
        thickness-to-radius ratio.
    `thrust`, `beta_r`: h; angle of the inner hinge [rad].
    `beta_s`: Angle of the inner sliding joint [rad]; None where no mode has it.
    `modes`: All that coincide there, where they are told.
    """

    name: str
    half_angle: float
    mu: float
    eta: float
    thrust: float
    beta_r: float
    beta_s: float | None
    modes: tuple[Mode, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line of the map.

    `mu`, `eta`, (k,).
    """

    mu: Array
    eta: Array


def divide_half_angle(mu: float) -> float:
    """Half-angle at which shoulder and inner joint slide together, (8) and (9) [rad].

    `mu`: Friction coefficient, above 0 and finite.
    """
    require(0 < mu < math.inf, "mu", mu, "above 0 and finite")
    thrusts, friction_angle = inner_slidings(np.array([mu]))[0], math.atan(mu)
    short = float(thrusts.short[0])
    if short > 0.5:
        # Here it is h that is small.
        thrust, largest = float(thrusts.thrust[0]), friction_angle + math.pi / 2

        def slips(angle: float) -> float:
            aside = angle - friction_angle
            return thrust * math.sin(aside) - angle * math.cos(aside)

        # With friction above 1e7 the thrust is less than what cosines round off.
        return largest if slips(largest) <= 0 else root(slips, friction_angle, largest)
    return root(
        lambda a: shoulder_slip(a, mu, short), friction_angle, friction_angle + math.pi / 2
    )


def at_inner_sliding(mu: float, half_angle: float, weight: Weight) -> tuple[float, float]:
    """Thickness and inner hinge of an arch whose inner joint is about to slide.

    Returns `eta`, `beta_r`: The thickness may exceed 2, and then no arch has it.
    """
    eta, beta_r = _at_inner_sliding(np.array([mu]), np.array([half_angle]), weight)
    return float(eta[0]), float(beta_r[0])


def _at_inner_sliding(mu: Array, half_angle: Array, weight: Weight) -> tuple[Array, Array]:
    """Larger of the thicknesses that crown and shoulder ask for, with its inner hinge."""
    short = inner_slidings(mu)[0].short
    (crown, near), (shoulder, far) = (
        inner_hinges(short, extrados, half_angle, weight)
        for extrados in (0 * half_angle, half_angle)
    )
    higher = shoulder > crown
    return np.where(higher, shoulder, crown), np.sqrt(np.where(higher, far, near))


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
    return dict(_landmarks(weight))


@cache
def _landmarks(weight: Weight) -> dict[str, Landmark]:
    def triple(mu: float) -> float:
        return rotational_thrust(divide_half_angle(mu), weight) - inner_sliding(mu)[0]

    def shift(mu: float) -> float:
        thrust, beta_s = inner_sliding(mu)
        return hinge_slope(thrust, divide_half_angle(mu), beta_s, weight)

    def junction(mu: float) -> float:
        return hinge_slope(inner_sliding(mu)[0], divide_half_angle(mu), 0.0, weight)

    def border(mu: float) -> float:
        return at_inner_sliding(mu, divide_half_angle(mu), weight)[0] - ETA_MAX

    mu_t = root(triple, 1.0, 1.8)
    mu_j = root(junction, mu_t, 2.5)
    found = {
        "T": mu_t,
        "S": root(shift, mu_t, mu_j),
        "J": mu_j,
        "B": root(border, mu_j, 4.0),
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
        # By definition, not to round-off: eta is 2 at B, from J on the hinge is at the crown.
        eta=ETA_MAX if name == "B" else eta,
        thrust=thrust,
        beta_r=0.0 if name in {"J", "B"} else beta_r,
        beta_s=beta_s,
    )


def divide(mu: ArrayLike, weight: Weight = "centreline") -> Curve:
    """Line on the left of which no thickness stands (modes ss | others).

    `mu`, (k,): Friction coefficients, above 0 and at most that of point B.
    """
    end = landmarks(weight)["B"].mu
    friction = _within(mu, 0.0, end, f"above 0 and at most {end:.10g}, where eta is 2")
    half_angle = np.array([divide_half_angle(m) for m in friction.tolist()])
    eta, _ = _at_inner_sliding(friction, half_angle, weight)
    return Curve(mu=friction, eta=np.minimum(eta, ETA_MAX))


def first_sliding(half_angle: ArrayLike, weight: Weight = "centreline") -> Curve:
    """Line on the right of which no joint slides (rrr | srr below T, rrs above).

    `half_angle`, (k,): Half-angles above 0 and below alpha_l, where the purely rotational mode
        ends [rad].
    """
    alpha, end = np.asarray(half_angle, dtype=float), widest_rotational(weight)
    for angle in alpha.flat:
        allowed = f"above 0 and below {end:.10g}, where the arch overturns without thrust"
        require(0 < angle < end, "half_angle", float(angle), allowed)
    thrusts, eta, _ = rotational_mode(alpha, weight)
    shoulder, inner = shoulder_frictions(alpha, thrusts.short), inner_frictions(thrusts)
    return Curve(mu=np.maximum(shoulder, inner), eta=eta)


def equal_angles(mu: ArrayLike, weight: Weight = "centreline") -> Curve:
    """Line beta_r = beta_s, from S to the right (rrs | rsr).

    `mu`, (k,): Friction coefficients, that of point S or more, finite.
    """
    return _inner_line("S", mu, weight)


def crown_hinge(mu: ArrayLike, weight: Weight = "centreline") -> Curve:
    """Line beta_r = 0, from J to the right (rsr | rs), as `equal_angles`."""
    return _inner_line("J", mu, weight)


def _inner_line(start: str, mu: ArrayLike, weight: Weight) -> Curve:
    """Line where the thickness has no slope: at beta_s from S on, at the crown from J on."""
    point = landmarks(weight)[start]
    allowed = f"at least {point.mu:.10g}, where the line starts at {start}, and finite"
    friction = _within(mu, math.nextafter(point.mu, 0), math.nextafter(math.inf, 0), allowed)
    half_angle: list[float] = []
    for m in friction.tolist():
        end, (thrust, beta_s) = divide_half_angle(m), inner_sliding(m)
        hinge = beta_s if start == "S" else 0.0

        def slope(angle: float, thrust: float = thrust, hinge: float = hinge) -> float:
            return hinge_slope(thrust, angle, hinge, weight)

        # At its start, to round-off, the line is on the divide.
        meets = slope(end) * slope(WIDE_ARCH) < 0
        half_angle.append(root(slope, WIDE_ARCH, end) if meets else end)
    return Curve(mu=friction, eta=_at_inner_sliding(friction, np.array(half_angle), weight)[0])


def _within(mu: ArrayLike, above: float, upto: float, allowed: str) -> Array:
    """Friction coefficients as an array, all within a range."""
    friction = np.asarray(mu, dtype=float)
    for m in friction.flat:
        require(above < m <= upto, "mu", float(m), allowed)
    return friction
