"""The map of eta and mu as an object: its regions, iso-alpha lines and special angles.

At a given friction the least thickness grows with the half-angle, up to the divide, beyond
which no thickness stands. A point of the map therefore belongs to one half-angle, the
widest that stands there: on the right of the divide the one critical at that point, on
the left of it, where eta is more than critical, the one on the divide. Every function
takes mu = inf, the far end of the axis, where the purely overturning mode r is; plotted
against arctan mu, it is in sight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.arch.circular import (
    ETA_MAX,
    Weight,
    centroid_factor,
    checked_arrays,
    require_weight,
)
from blocksim.arch.modes import Mode
from blocksim.arch.roots import root
from blocksim.arch.theory.arrays import BIT, least_thicknesses, names_of, stand_at
from blocksim.arch.theory.equations import half_angle_at, meeting_hinges
from blocksim.arch.theory.regions import Curve, divide_half_angle
from blocksim.arch.theory.rotation import rotational_mode
from blocksim.arch.theory.sliding import excess, thrust_intervals
from blocksim.blocks.assembly import Array
from blocksim.common.checks import require

HALVINGS = 64
ON_DIVIDE = 1e-10
"""Thickness ratios closer to the divide than this are on it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MapPoints:
    """What is found at points of the map.

    `half_angle`, (...): Half-angle alpha of the widest arch that stands there [rad].
    `modes`, (...) uint8: Modes of the region as bits, see `CriticalArrays`; several on a line.
    """

    half_angle: Array
    modes: NDArray[np.uint8]

    @property
    def regions(self) -> NDArray[np.object_]:
        """Tuples of `Mode`, of the same shape."""
        found = np.empty(self.modes.shape, dtype=object)
        for place, bits in np.ndenumerate(self.modes):
            found[place] = names_of(int(bits))
        return found


@dataclass(frozen=True, kw_only=True)
class SpecialAngles:
    """Half-angles at which something of the map begins or ends [rad].

    `widest_hinge`: alpha_s-beta, where the inner hinge of the rotational mode is farthest from
        the crown.
    `hinge`: beta_s-beta, that hinge.
    `zero_thrust`: alpha_l, where the rotational mode ends in overturning, with its hinge at the
        crown.
    `limit`: alpha_L, beyond which no arch stands, at any friction and thickness up to 2.
    """

    widest_hinge: float
    hinge: float
    zero_thrust: float
    limit: float


def at_points(eta: ArrayLike, mu: ArrayLike, weight: Weight = "centreline") -> MapPoints:
    """Find region and half-angle of points of the map: alpha(eta, mu).

    `eta`, (...): In (0, 2].
    `mu`, (...): Above 0, inf allowed; broadcast against `eta`.
    Returns: Of the broadcast shape.
    """
    ratio, friction = checked_arrays(weight, eta=eta, mu=mu)
    shape_asked = ratio.shape
    ratio, friction = ratio.reshape(-1), friction.reshape(-1)
    low, high = np.zeros(ratio.shape), np.full(ratio.shape, math.pi)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        enough = stand_at(ratio, middle, friction, weight)
        low, high = np.where(enough, middle, low), np.where(enough, high, middle)
    critical = least_thicknesses(low, friction, weight)
    # On the left of the divide it is friction that stops wider arches, whatever their eta.
    lower, upper, _ = thrust_intervals(high, friction)
    slides = excess(upper, lower) < 0
    spare = slides & (critical.eta < ratio - ON_DIVIDE)
    modes = np.where(spare, BIT[Mode.SS], critical.modes)
    return MapPoints(half_angle=low.reshape(shape_asked), modes=modes.reshape(shape_asked))


def divide_friction(half_angle: float) -> float:
    """Friction at and below which no thickness stands: both joints slide, (8) and (9)."""
    require(0.01 <= half_angle <= 3.0, "half_angle", half_angle, "from 0.01 to 3")

    # Friction goes like the cube of a small half-angle: look for its logarithm.
    angle = root(
        lambda log: divide_half_angle(math.tan(math.exp(log))) - half_angle,
        math.log(1e-9),
        math.log(math.pi / 2 - 1e-4),
    )
    return math.tan(math.exp(angle))


def iso_half_angle(half_angle: float, mu: ArrayLike, weight: Weight = "centreline") -> Curve:
    """Line of the map along which the half-angle is the same.

    `half_angle`: alpha, in (0, pi) [rad].
    `mu`, (k,): Friction coefficients; those that need more than a thickness of 2 are left out.
    Returns: On the divide it goes on upwards, since there any thickness beyond is critical.
    """
    friction = np.asarray(mu, dtype=float)
    eta = least_thicknesses(half_angle, friction, weight).eta
    exists = ~np.isnan(eta)
    return Curve(mu=friction[exists], eta=eta[exists])


def special_angles(weight: Weight = "centreline") -> SpecialAngles:
    """Half-angles alpha_s-beta, alpha_l and alpha_L, from what defines each of them."""
    require_weight(weight)
    # Hinge and thrust at 0: eq. (4) leaves 1 = kappa/(1 - eta/2) - 1, see sector.md.
    ratio = 1.0 if weight == "centreline" else math.sqrt(48) - 6
    widest, hinge = _widest_hinge(weight)
    return SpecialAngles(
        widest_hinge=widest,
        hinge=hinge,
        zero_thrust=_overturning(ratio, weight),
        limit=_overturning(ETA_MAX, weight),
    )


def _overturning(eta: float, weight: Weight) -> float:
    """Half-angle that overturns without thrust: A = 2 kappa/(2 + eta), (3)."""
    return half_angle_at(2 * centroid_factor(eta, weight) / (2 + eta), 1.0)


def _widest_hinge(weight: Weight) -> tuple[float, float]:
    """Half-angle at which beta_r of the rotational mode is largest, and that beta_r."""
    if weight == "centreline":
        beta = root(lambda beta: float(meeting_hinges(beta)[2]), 0.5, 1.5)
        (f, g, _), sine = meeting_hinges(beta), math.sin(beta)
        return half_angle_at(float(g * f / (sine * (2 * g - sine))), 1.0), beta

    def slope(angle: float) -> float:
        step = 1e-3
        # Eighth-order central difference of beta_r^2.
        weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
        shifts: Array = step * np.arange(1.0, 5.0)
        near: Array = np.concatenate([angle + shifts, angle - shifts]).astype(float)
        ahead, behind = np.split(rotational_mode(near, weight)[2], 2)
        return float(np.dot(weights, ahead - behind))

    angle = root(slope, 1.8, 2.5)
    return angle, math.sqrt(float(rotational_mode(np.array([angle]), weight)[2][0]))
