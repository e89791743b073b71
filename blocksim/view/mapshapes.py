"""The mode map as shapes to draw: regions and the lines between them (Fig. 9)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from blocksim.arch import theory
from blocksim.arch.circular import ETA_MAX, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.theory import Curve, Landmark, regions
from blocksim.arch.theory.critical import rotational_thrust
from blocksim.arch.theory.equations import inner_friction
from blocksim.arch.theory.map import divide_friction, iso_half_angle, special_angles
from blocksim.blocks.assembly import Array

SMALLEST_MU, LARGEST_MU = 0.002, 4.0
LARGEST_PHI = 89.9
"""Friction angle up to which lines are computed, on an axis that goes on to 90 [deg]."""
POINTS = 160
"""Points on each line."""
ISO_DEGREES = (60, 90, 110, 125, 135, 142.504, 145, 149.156, 155, 158.949)
"""Half-angles whose lines the explorer draws. `iso_angles` has all digits of them."""
ROUND_DEGREES = (60, 90, 110, 125, 135, 145, 155)
ISO_POINTS = 1200
LEVEL = 1e-9
"""Thickness ratios closer than this to that of unbounded friction are the same."""


@dataclass(frozen=True)
class FrictionAxis:
    """The axis of friction: mu, or the angle arctan mu up to 90 [deg]."""

    angle: bool = False

    @property
    def largest(self) -> float:
        """Largest coefficient at which lines are computed."""
        return math.tan(math.radians(LARGEST_PHI)) if self.angle else LARGEST_MU

    @property
    def end(self) -> float:
        """The end of the axis."""
        return 90.0 if self.angle else LARGEST_MU

    @property
    def label(self) -> str:
        """The words below it."""
        return (
            r"friction angle $\varphi$ [deg]" if self.angle else r"friction coefficient $\mu$"
        )

    def place(self, mu: ArrayLike) -> Array:
        """Return the places of coefficients on it."""
        values = np.asarray(mu, dtype=float)
        return np.degrees(np.arctan(values)) if self.angle else values

    def frictions(self, start: float, count: int) -> Array:
        """Coefficients evenly along it, from `start` to the largest."""
        if not self.angle:
            return np.linspace(start, LARGEST_MU, count)
        return np.tan(np.radians(np.linspace(self.place(start), LARGEST_PHI, count)))


COEFFICIENT, ANGLE = FrictionAxis(), FrictionAxis(angle=True)


class Region(NamedTuple):
    """The region of one mode, between two thickness ratios at every friction, (k,) each."""

    mode: Mode
    mu: Array
    bottom: Array
    top: Array


class MapShapes(NamedTuple):
    """The map up to the end of its friction axis and eta = 2.

    `regions`: Of the six modes at finite friction.
    `lines`: Between them: `divide`, `first`, `equal`, `crown`, as `regions` of the theory has
        them.
    """

    regions: tuple[Region, ...]
    lines: dict[str, Curve]
    landmarks: dict[str, Landmark]


@cache
def map_shapes(weight: Weight = "centreline", axis: FrictionAxis = COEFFICIENT) -> MapShapes:
    """Sample the map's regions and lines from their equations, once."""
    marks = theory.landmarks(weight)
    corners = [marks[name].mu for name in "TSJ"]
    mu = np.sort([*axis.frictions(SMALLEST_MU, 4 * POINTS), *corners])
    before_border = np.linspace(SMALLEST_MU, marks["B"].mu, POINTS)
    divide = regions.divide(np.sort([*before_border, *corners]), weight)
    # Denser towards the wide arches, where friction runs off to infinity.
    angles = _last_angle(weight, axis) * (1 - np.linspace(0.95, 0.0, POINTS) ** 2)
    first = regions.first_sliding(np.sort([*angles, marks["T"].half_angle]), weight)
    right_of = {name: axis.frictions(marks[name].mu + 1e-6, POINTS // 2) for name in "SJ"}
    equal = regions.equal_angles(right_of["S"], weight)
    crown = regions.crown_hinge(right_of["J"], weight)

    top = np.where(mu <= marks["B"].mu, np.interp(mu, divide.mu, divide.eta), 2.0)
    low = np.minimum(np.interp(mu, first.mu, first.eta), top)
    over = np.where(mu < marks["J"].mu, top, np.interp(mu, crown.mu, crown.eta))
    over = np.minimum(over, top)
    between = np.where(mu < marks["S"].mu, top, np.interp(mu, equal.mu, equal.eta))
    between = np.minimum(between, over)
    left, right = mu <= marks["T"].mu, mu >= marks["T"].mu
    parts = (
        (Mode.RRR, np.zeros_like(mu), low, mu > 0),
        (Mode.SRR, low, top, left),
        (Mode.RRS, low, between, right),
        (Mode.RSR, between, over, right),
        (Mode.RS, over, top, right),
        (Mode.SS, top, np.full_like(mu, 2.0), mu > 0),
    )
    found = tuple(
        Region(mode, mu[where], bottom[where], ceiling[where])
        for mode, bottom, ceiling, where in parts
    )
    lines = {"divide": divide, "first": first, "equal": equal, "crown": crown}
    return MapShapes(found, lines, marks)


@cache
def iso_angles(weight: Weight = "centreline") -> tuple[float, ...]:
    """Half-angles of which the map has lines: round ones and special ones, in order [rad].

    The special ones are those of T, J and B, that at which eta is 1 on the divide (Fig. 23),
    alpha_l and alpha_L: 142.504, 149.156, 158.949, 149.646, 151.742 and 159.655 deg.
    """
    marks, special = theory.landmarks(weight), special_angles(weight)

    def above_one(mu: float) -> float:
        return regions.at_inner_sliding(mu, regions.divide_half_angle(mu), weight)[0] - 1

    unit = float(brentq(above_one, marks["T"].mu, marks["B"].mu, xtol=1e-15))
    found = {math.radians(degrees) for degrees in ROUND_DEGREES}
    found |= {marks[name].half_angle for name in "TJB"}
    found |= {regions.divide_half_angle(unit), special.zero_thrust, special.limit}
    return tuple(sorted(found))


@cache
def iso_line(
    half_angle: float, weight: Weight = "centreline", axis: FrictionAxis = COEFFICIENT
) -> Curve:
    """Line of equal half-angle, with its upright part on the divide.

    `half_angle`: From 0.01 to 3 [rad].
    Returns: Empty where the half-angle stands at no friction on the map.
    """
    line = iso_half_angle(half_angle, axis.frictions(0.02, ISO_POINTS), weight)
    if not line.mu.size:
        return line
    divide = divide_friction(half_angle)
    foot, _ = regions.at_inner_sliding(divide, half_angle, weight)
    if foot > ETA_MAX:
        return line
    # Sliding both ways, any thickness beyond is critical: the line goes on upwards.
    return Curve(
        mu=np.concatenate([[divide, divide], line.mu]),
        eta=np.concatenate([[ETA_MAX, foot], line.eta]),
    )


@cache
def iso_continued(
    half_angle: float, weight: Weight = "centreline", axis: FrictionAxis = COEFFICIENT
) -> Curve:
    """Continue a line of equal half-angle to where its equations rule no more.

    Without sliding the least thickness would be that of unbounded friction, and without
    turning the line would be upright: both go on to the corner where they meet.

    `half_angle`: From 0.01 to alpha_L [rad].
    Returns: From the foot of the upright part down, and to the right to the first sliding.
    """
    level = theory.least_thickness(half_angle, math.inf, weight).eta
    if level is None:
        return Curve(mu=np.empty(0), eta=np.empty(0))
    divide = divide_friction(half_angle)
    foot, _ = regions.at_inner_sliding(divide, half_angle, weight)
    line = iso_half_angle(half_angle, axis.frictions(divide, ISO_POINTS), weight)
    slides = line.mu[line.eta > level + LEVEL]
    if line.mu.size and not slides.size:
        return Curve(mu=np.empty(0), eta=np.empty(0))  # at T the corner is on the line
    last = float(slides[-1]) if slides.size else axis.largest
    return Curve(
        mu=np.array([divide, divide, last]), eta=np.array([min(foot, ETA_MAX), level, level])
    )


def _last_angle(weight: Weight, axis: FrictionAxis) -> float:
    """Half-angle at which the line of first sliding leaves the map on the right [rad]."""

    def beyond(half_angle: float) -> float:
        return float(inner_friction(rotational_thrust(half_angle, weight))) - axis.largest

    widest = special_angles(weight).zero_thrust
    return float(brentq(beyond, widest - 0.2, widest - 1e-9))
