"""Least thickness of the continuous arch over arrays of half-angle and friction.

The same reasoning as in `critical`, arranged for many arches at once; inner hinges and
the rotational mode are in `rotation`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.arch.circular import WEIGHTS, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.theory.critical import CROWN_TIE, ETA_MAX, TIE
from blocksim.arch.theory.rotation import (
    inner_hinges,
    rotational_mode,
    sine_series,
    widest_rotational,
)
from blocksim.blocks.assembly import Array
from blocksim.common.checks import require

CHUNK = 8192
"""Points worked on at once; their temporaries stay in the cache."""

ORDER = (Mode.RRR, Mode.R, Mode.SRR, Mode.RS, Mode.RRS, Mode.RSR, Mode.SS)
"""Mode k is bit k of `CriticalArrays.modes`; the first of a tie is the lowest bit."""
BIT = {mode: np.uint8(1 << k) for k, mode in enumerate(ORDER)}


@dataclass(frozen=True, kw_only=True, eq=False)
class CriticalArrays:
    """Continuous arches at their least thickness; see `Critical` for one.

    Parameters
    ----------
    eta : (...) float
        Least thickness-to-radius ratio; nan where none up to 2 stands.
    modes : (...) uint8
        Collapse modes as bits, `ORDER` naming them; several bits on a line of the map.
    thrust : (...) float
        h; nan where no thrust is compatible with friction.
    beta_r, beta_s : (...) float
        Angles of the inner hinge and of the inner sliding joint [rad]; nan where the
        mode has none.
    """

    eta: Array
    modes: NDArray[np.uint8]
    thrust: Array
    beta_r: Array
    beta_s: Array

    @property
    def mode(self) -> NDArray[np.str_]:
        """Names of the modes, of the first where several coincide."""
        lowest = self.modes & (~self.modes + np.uint8(1))
        names = np.zeros(129, dtype="U3")
        for mode, bit in BIT.items():
            names[bit] = mode.value
        return names[lowest]

    @property
    def names(self) -> tuple[Mode, ...]:
        """Modes of a single arch."""
        return names_of(int(self.modes))

    @property
    def tied(self) -> NDArray[np.bool_]:
        """Where several modes coincide."""
        return (self.modes & (self.modes - np.uint8(1))) != 0


def names_of(bits: int) -> tuple[Mode, ...]:
    """Modes of one entry of `CriticalArrays.modes`."""
    return tuple(mode for mode in ORDER if bits & int(BIT[mode]))


def least_thicknesses(
    half_angle: ArrayLike, mu: ArrayLike, weight: Weight = "centreline"
) -> CriticalArrays:
    """Least thickness, mode, thrust, hinge and sliding angles of many arches.

    Parameters
    ----------
    half_angle : (...) float
        In (0, pi) [rad].
    mu : (...) float
        Friction coefficient, above 0, inf allowed; broadcast against `half_angle`.
    weight : {"centreline", "sector"}

    Returns
    -------
    CriticalArrays
        Of the broadcast shape.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    angles, frictions = np.broadcast_arrays(
        np.asarray(half_angle, dtype=float), np.asarray(mu, dtype=float)
    )
    for field, values, upto, allowed in (
        ("half_angle", angles, math.nextafter(math.pi, 0), "above 0 and below pi"),
        ("mu", frictions, math.inf, "above 0 (inf for unbounded friction)"),
    ):
        wrong = ~((values > 0) & (values <= upto))
        if wrong.any():
            require(False, field, float(values[wrong].flat[0]), allowed)
    require(weight in WEIGHTS, "weight", weight, f"one of {', '.join(WEIGHTS)}")
    shape, size = angles.shape, angles.size
    numbers = np.empty((4, size))
    modes = np.empty(size, dtype=np.uint8)
    alpha, friction = angles.reshape(-1), frictions.reshape(-1)
    for start in range(0, size, CHUNK):
        part = slice(start, start + CHUNK)
        numbers[:, part], modes[part] = _solve(alpha[part], friction[part], weight)
    eta, thrust, beta_r, beta_s = numbers.reshape(4, *shape)
    return CriticalArrays(
        eta=eta, modes=modes.reshape(shape), thrust=thrust, beta_r=beta_r, beta_s=beta_s
    )


def _solve(alpha: Array, mu: Array, weight: Weight) -> tuple[Array, NDArray[np.uint8]]:
    """Solve one chunk: rows eta, thrust, beta_r, beta_s, and the modes as bits."""
    lower, upper, beta_s = thrust_intervals(alpha, mu)
    short, eta, square = rotational_mode(alpha, weight)
    free = 1.0 - short
    stands = lower <= upper + TIE
    thrust = np.where(stands, np.minimum(np.maximum(free, lower), upper), np.nan)
    # Below the rotational thrust the crown asks for more thickness, above it the shoulder.
    for moved, at_crown in ((thrust < free, True), (thrust > free, False)):
        where = np.flatnonzero(moved)
        if where.size:
            extrados = np.zeros(where.size) if at_crown else alpha[where]
            eta[where], square[where] = inner_hinges(
                1.0 - thrust[where], extrados, alpha[where], weight
            )
    beta_r = np.where(stands, np.sqrt(square), np.nan)
    left = widest_rotational(weight) - alpha
    modes = _modes(free, left, thrust, lower, upper, beta_r, beta_s)
    eta = np.where(stands & (eta <= ETA_MAX * (1 + TIE)), np.minimum(eta, ETA_MAX), np.nan)
    inner = BIT[Mode.RS] | BIT[Mode.RRS] | BIT[Mode.RSR] | BIT[Mode.SS]
    beta_s = np.where(modes & inner, beta_s, np.nan)
    return np.stack([eta, thrust, beta_r, beta_s]), modes


def _modes(
    free: Array,
    short_of_overturning: Array,
    thrust: Array,
    lower: Array,
    upper: Array,
    beta_r: Array,
    beta_s: Array,
) -> NDArray[np.uint8]:
    """Name the modes by where the thrust lies; comparisons with nan are False."""
    turns = np.abs(thrust - free) <= TIE
    inner = (lower >= free - TIE) & (thrust > TIE)
    at_crown = beta_r <= CROWN_TIE
    below = beta_r >= beta_s - TIE
    above = (beta_r <= beta_s + TIE) & (beta_r > 0)
    conditions = {
        # The thrust falls to nothing like a square: it is told from 0 by the angle.
        Mode.RRR: turns & (short_of_overturning >= -TIE),
        Mode.R: turns & (short_of_overturning <= TIE),
        Mode.SRR: (upper <= free + TIE) & ~np.isnan(thrust),
        Mode.RS: inner & at_crown,
        Mode.RRS: inner & ~at_crown & below,
        Mode.RSR: inner & above,
        Mode.SS: upper - lower <= TIE,
    }
    modes = np.zeros(free.shape, dtype=np.uint8)
    for mode, holds in conditions.items():
        modes |= np.where(holds, BIT[mode], np.uint8(0))
    return modes


def inner_slidings(mu: Array) -> tuple[Array, Array]:
    """Thrust and angle at which an inner joint slides, of many frictions.

    Kepler's equation of `inner_sliding`, in E below mu = 1 and in pi - E above.

    Parameters
    ----------
    mu : (k,) float
        Friction coefficients, above 0, inf allowed.

    Returns
    -------
    thrust, beta_s : (k,) float
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
    thrust = np.where(rough, np.cos(angle / 2), np.sin(angle / 2)) ** 2
    return thrust, np.sin(angle) / 2


def thrust_intervals(alpha: Array, mu: Array) -> tuple[Array, Array, Array]:
    """Give the thrusts that friction allows, as `thrust_interval`, and the sliding angle."""
    friction_angle = np.arctan(mu)
    lower, beta_s = inner_slidings(mu)
    flat = np.flatnonzero(beta_s > alpha)
    lower[flat] = alpha[flat] / np.tan(alpha[flat] + friction_angle[flat])
    excess = alpha - friction_angle
    upper = np.full(alpha.shape, np.inf)
    held = excess > 0
    upper[held] = alpha[held] / np.tan(excess[held])
    return lower, upper, beta_s
