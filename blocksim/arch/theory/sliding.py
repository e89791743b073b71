"""Thrusts that friction allows, over arrays.

Flat arches need the shortfall 1 - h to its last digits, arches near overturning the thrust h
itself. Both are kept, each found without a difference of nearly equal numbers: with

    sin x - x cos x = x^3 G(x^2),

G being entire, (8) and (9) hold no such difference.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.common.series import lag_series, sine_series


class Thrusts(NamedTuple):
    """Scaled thrusts h, and 1 - h, each to its last digits.

    `thrust`, `short`, (k,): h may be inf, 1 - h then -inf.
    """

    thrust: Array
    short: Array


def excess(first: Thrusts, second: Thrusts) -> Array:
    """First thrust less the second, which is finite."""
    return np.where(
        second.short < 0.5, second.short - first.short, first.thrust - second.thrust
    )


def inner_slidings(mu: Array) -> tuple[Thrusts, Array]:
    """Thrust and angle at which an inner joint slides.

    With h = cos^2(E/2), eq. (9) becomes E - sin E = 2 arctan mu, Kepler's equation at
    eccentricity one, and beta_s = sin(E)/2. It is solved for E below mu = 1 and for
    pi - E above, where each is well conditioned.

    `mu`, (k,): Friction coefficients, above 0, inf allowed.
    Returns `beta_s`, (k,): [rad]
    """
    rough = mu < 1.0
    target = 2 * np.arctan(np.where(rough, mu, 1 / mu))
    # E - sin E = E^3/6 (1 - E^2/20 ...) and d + sin d = 2 d - d^3/6 ...
    root = np.cbrt(6 * target)
    half = target / 2
    angle = np.where(rough, root * (1 + root**2 / 60), half + half**3 / 12)
    sign = np.where(rough, -1.0, 1.0)
    for _ in range(4):
        sine, cosine = np.sin(angle), np.cos(angle)
        square = angle * angle
        value = np.where(rough, angle * square * sine_series(square), angle + sine) - target
        slope = np.where(rough, 2 * np.sin(angle / 2) ** 2, 1 + cosine)
        # Halley's step; the second derivative is -sign sin.
        angle = angle - value / (slope + sign * sine * value / (2 * slope))
    sine, cosine = np.sin(angle / 2) ** 2, np.cos(angle / 2) ** 2
    found = Thrusts(np.where(rough, cosine, sine), np.where(rough, sine, cosine))
    return found, np.sin(angle) / 2


def thrust_intervals(alpha: Array, mu: Array) -> tuple[Thrusts, Thrusts, Array]:
    """Give the thrusts that no joint of the continuous arch resists by sliding.

    `alpha`, (k,): Half-angles [rad].
    `mu`, (k,): Friction coefficients, above 0, inf allowed.
    Returns `lower`, `upper`: Inner sliding below `lower`, shoulder sliding above `upper` (may
        be inf), (8); empty where lower > upper.
    Returns `beta_s`, (k,): As `inner_slidings`.
    """
    friction_angle = np.arctan(mu)
    lower, beta_s = inner_slidings(mu)
    # A joint beyond the springing cannot slide: the springing does.
    flat = np.flatnonzero(beta_s > alpha)
    if flat.size:
        bent = alpha[flat] + friction_angle[flat]
        lower.thrust[flat] = alpha[flat] / np.tan(bent)
        lower.short[flat] = _shortfall(bent, -friction_angle[flat])
    bent = alpha - friction_angle
    held = np.flatnonzero(bent > 0)
    upper = Thrusts(np.full(alpha.shape, np.inf), np.full(alpha.shape, -np.inf))
    upper.thrust[held] = alpha[held] / np.tan(bent[held])
    upper.short[held] = _shortfall(bent[held], friction_angle[held])
    return lower, upper, beta_s


def _shortfall(bent: Array, friction_angle: Array) -> Array:
    """1 - h where h = (bent + friction_angle) cot(bent)."""
    lag = bent**3 * lag_series(bent**2)
    return (lag - friction_angle * np.cos(bent)) / np.sin(bent)


def shoulder_slip(half_angle: float, mu: float, short: float) -> float:
    """Tell how far the shoulder is from sliding at a thrust, (8) times its denominators.

    `half_angle`, `mu`, `short`: alpha [rad], friction coefficient, 1 - h.
    Returns: Above 0 where it slides; 0 at the half-angle of the divide.
    """
    friction_angle = math.atan(mu)
    bent = half_angle - friction_angle
    lag = bent**3 * lag_series(bent**2)
    return lag - friction_angle * math.cos(bent) - short * math.sin(bent)


def shoulder_frictions(alpha: Array, short: Array) -> Array:
    """Friction at which the shoulder slides, mu_ss (8), from 1 - h."""
    sine, cosine = np.sin(alpha), np.cos(alpha)
    lag = alpha**3 * lag_series(alpha**2)
    return (lag - short * sine) / ((1 - short) * cosine + alpha * sine)


def inner_frictions(thrusts: Thrusts) -> Array:
    """Friction at which an inner joint slides, mu_is (9)."""
    thrust, short = thrusts
    square = thrust * short
    beta = np.sqrt(square)
    # sin(beta)/beta
    sine = 1 - square * sine_series(square)
    rise = sine - thrust * lag_series(square)
    return short**2 * rise / (beta * (short * sine + np.cos(beta)))
