"""Least thickness of the continuous arch over arrays of half-angle and friction.

Without friction the thrust would be that of the purely rotational mode (`rotation`).
Friction confines it to an interval (`sliding`); the least thickness is found at the thrust
of that interval nearest to the rotational one, and where it lies names the mode.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.arch.circular import ETA_MAX, Weight, checked_arrays
from blocksim.arch.modes import Mode
from blocksim.arch.theory.rotation import inner_hinges, rotational_mode, widest_rotational
from blocksim.arch.theory.sliding import Thrusts, excess, thrust_intervals
from blocksim.blocks.assembly import Array

TIE = 1e-12
"""Angles closer than this coincide, and thrusts whose h and 1 - h differ relatively by less."""
CROWN_TIE = 1e-6
"""Inner hinges closer to the crown are at it: the angle goes as the root of a thrust."""
CHUNK = 8192
"""Points worked on at once; their temporaries stay in the cache."""

ORDER = (Mode.RRR, Mode.R, Mode.SRR, Mode.RS, Mode.RRS, Mode.RSR, Mode.SS)
"""Mode k is bit k of `CriticalArrays.modes`; the first of a tie is the lowest bit."""
BIT = {mode: np.uint8(1 << k) for k, mode in enumerate(ORDER)}


@dataclass(frozen=True, kw_only=True, eq=False)
class CriticalArrays:
    """Continuous arches at their least thickness; see `Critical` for one.

    `eta`, (...): Least thickness-to-radius ratio; nan where none up to 2 stands.
    `modes`, (...) uint8: Collapse modes as bits, `ORDER` naming them; several bits on a line of
        the map.
    `thrust`, (...): h; nan where no thrust is compatible with friction.
    `beta_r`, `beta_s`, (...): Angles of the inner hinge and of the inner sliding joint [rad];
        nan where the mode has none.
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
    angles, frictions = checked_arrays(weight, half_angle=half_angle, mu=mu)
    shape, size = angles.shape, angles.size
    numbers = np.empty((4, size))
    modes = np.empty(size, dtype=np.uint8)
    alpha, friction = angles.reshape(-1), frictions.reshape(-1)
    for start in range(0, size, CHUNK):
        part = slice(start, start + CHUNK)
        numbers[:, part], modes[part] = _solve(alpha[part], friction[part], weight)
    eta, thrust, beta_r, beta_s = numbers.reshape(4, *shape)
    # The border is reached where round-off goes beyond it.
    eta = np.where(eta <= ETA_MAX * (1 + TIE), np.minimum(eta, ETA_MAX), np.nan)
    return CriticalArrays(
        eta=eta, modes=modes.reshape(shape), thrust=thrust, beta_r=beta_r, beta_s=beta_s
    )


def stand_at(eta: Array, alpha: Array, mu: Array, weight: Weight) -> NDArray[np.bool_]:
    """Tell which arches stand at given ratios, with nothing allowed for round-off.

    `eta`, `alpha`, `mu`, (k,): As in `least_thicknesses`, unchecked.
    Returns (k,).
    """
    found = np.empty(alpha.size, dtype=bool)
    for start in range(0, alpha.size, CHUNK):
        part = slice(start, start + CHUNK)
        lower, upper, _ = thrust_intervals(alpha[part], mu[part])
        enough = _solve(alpha[part], mu[part], weight)[0][0] <= eta[part]  # False for nan
        found[part] = enough & (excess(upper, lower) >= 0)
    return found


def _solve(alpha: Array, mu: Array, weight: Weight) -> tuple[Array, NDArray[np.uint8]]:
    """Solve one chunk: rows eta (beyond 2, too), thrust, beta_r, beta_s; modes as bits."""
    lower, upper, beta_s = thrust_intervals(alpha, mu)
    free, eta, square = rotational_mode(alpha, weight)
    over, under, room = excess(lower, free), excess(upper, free), excess(upper, lower)
    stands = room >= -_tie(lower)
    # Below the rotational thrust the crown asks for more thickness, above it the shoulder.
    at_crown = under < 0
    at_shoulder = ((over > 0) | np.isnan(eta)) & ~at_crown
    thrust, short = (
        np.where(at_crown, most, np.where(at_shoulder, least, unforced))
        for least, most, unforced in zip(lower, upper, free, strict=True)
    )
    for moved, extrados in ((at_crown, 0 * alpha), (at_shoulder, alpha)):
        where = np.flatnonzero(moved & stands)
        if where.size:
            eta[where], square[where] = inner_hinges(
                short[where], extrados[where], alpha[where], weight
            )
    eta, thrust, beta_r = (
        np.where(stands, value, np.nan) for value in (eta, thrust, np.sqrt(square))
    )
    left = widest_rotational(weight) - alpha
    tie = _tie(free)
    inner = (over >= -tie) & (thrust > 0)
    turns = (over <= tie) & (under >= -tie) & stands
    conditions = {
        # The thrust falls to nothing like a square: it is told from 0 by the angle.
        Mode.RRR: turns & (left > TIE),
        Mode.R: turns & (left <= TIE),
        Mode.SRR: (under <= tie) & stands,
        Mode.RS: inner & (beta_r <= CROWN_TIE),
        Mode.RRS: inner & (beta_r > CROWN_TIE) & (beta_r >= beta_s - TIE),
        Mode.RSR: inner & (beta_r > 0) & (beta_r <= beta_s + TIE),
        Mode.SS: room <= _tie(lower),
    }
    modes = np.zeros(alpha.shape, dtype=np.uint8)
    for mode, holds in conditions.items():
        modes |= np.where(holds, BIT[mode], np.uint8(0))
    slides = BIT[Mode.RS] | BIT[Mode.RRS] | BIT[Mode.RSR] | BIT[Mode.SS]
    beta_s = np.where(modes & slides, beta_s, np.nan)
    return np.stack([eta, thrust, beta_r, beta_s]), modes


def _tie(thrusts: Thrusts) -> Array:
    return TIE * np.minimum(np.abs(thrusts.thrust), thrusts.short)
