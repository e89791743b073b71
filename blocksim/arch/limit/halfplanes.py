"""Strength of joints as bounds on the thrust, over arrays.

At a joint at angle x the resultant of the thrust h, its moment m about the centre of the arch
and of the weight between crown and joint is

    N = h cos x + x sin x,    T = h sin x - x cos x,
    M = m - h cos x - x sin x + k (1 - cos x)      (positive towards the extrados),

all scaled, with k the radius of the weight over the mean radius. In flat arches the thickness
goes like the fourth power of the angles, and h and m are all but the same for every arch.
Therefore the bounds are those of the shortfall 1 - h: with it, and with the entire functions
of `blocksim.common.series`, nothing cancels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.common.series import lag_series, p_series


class Bounds(NamedTuple):
    """Conditions rate (1 - h) <= level; the same ones say level_h <= rate h.

    Parameters
    ----------
    rate, level, level_h : float
        Arrays of one shape.
    """

    rate: Array
    level: Array
    level_h: Array

    def most(self) -> Array:
        """Largest 1 - h of each condition, inf where it sets none."""
        return np.where(self.rate > 0, self._crossing(), np.inf)

    def least(self) -> Array:
        """Smallest 1 - h of each condition, -inf where it sets none."""
        return np.where(self.rate < 0, self._crossing(), -np.inf)

    def thrust(self, place: tuple[int, ...]) -> float:
        """Thrust h at which one condition is met exactly."""
        return float(self.level_h[place] / self.rate[place])

    def broken(self) -> Array:
        """Whether a condition no thrust can change is not met."""
        return (self.rate == 0) & (self.level < 0)

    def _crossing(self) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.level / self.rate


def turning(angles: Array, depth: Array, spread: Array) -> Bounds:
    """Pairs of joints where the line of thrust touches extrados (i) and intrados (j).

    No tension asks |M| <= (eta/2) N of both; between them m is eliminated.

    Parameters
    ----------
    angles : (k, j) float
        Joints of one half of each arch [rad].
    depth : (k,) float
        Thickness over radius that the line of thrust may use.
    spread : (k,) float
        Radius of the weight over the mean radius, less 1.

    Returns
    -------
    Bounds
        Shape (k, j, j).
    """
    half, extra = depth[:, None, None] / 2, spread[:, None]
    cosine, lift = np.cos(angles), 2 * np.sin(angles / 2) ** 2
    vertical, square = angles * np.sin(angles), angles**2
    # x sin x - 2 (1 - cos x) and the rest of the weight's lever
    bow = -(square**2) * p_series(square) - extra * lift
    force = cosine + vertical
    rate = _less(-lift) + half * _sum(cosine)
    level = _less(bow) + half * _sum(force)
    level_h = -(_less(vertical - (1 + extra) * lift) + half * _sum(vertical))
    return Bounds(rate, level, level_h)


def sliding(angles: Array, mu: Array, sign: float) -> Bounds:
    """Joints of which friction asks sign T <= mu N.

    Parameters
    ----------
    angles : (k, j) float
        Joints of one half of each arch [rad].
    mu : (k,) float
        Friction coefficients, finite.
    sign : float
        1 or -1.

    Returns
    -------
    Bounds
        Shape (k, j).
    """
    grip = mu[:, None]
    sine, cosine = np.sin(angles), np.cos(angles)
    force = cosine + angles * sine
    lag = angles**3 * lag_series(angles**2)
    rate = grip * cosine - sign * sine
    level_h = -angles * (sign * cosine + grip * sine)
    return Bounds(rate, grip * force - sign * lag, level_h)


def _less(values: Array) -> Array:
    """First less second, of all pairs."""
    return values[:, :, None] - values[:, None, :]


def _sum(values: Array) -> Array:
    return values[:, :, None] + values[:, None, :]
