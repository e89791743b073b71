"""The map in numbers: its points (Table 1), special angles and lines, with rates of modes."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np

from blocksim.arch.circular import Weight, require_weight
from blocksim.arch.limit.collapse import collapse_of_mode
from blocksim.arch.modes import Mode
from blocksim.arch.theory import Critical, Landmark, landmarks, least_thickness, regions
from blocksim.arch.theory.arrays import ORDER
from blocksim.arch.theory.critical import inner_sliding
from blocksim.arch.theory.map import at_points, special_angles
from blocksim.blocks.assembly import Array

NAMES = {"T": "Triple point", "S": "Shift point", "J": "Junction point", "B": "Border point"}
SPECIAL = {
    "alpha_s-beta": "inner hinge of rrr farthest from the crown",
    "alpha_l": "end of rrr: no thrust, hinge at the crown",
    "alpha_L": "widest arch that stands, at eta = 2",
}
RATES = (
    ("crown", "extrados"), ("inner", "intrados"), ("inner", "slides"), ("shoulder", "extrados"),
    ("shoulder", "slides"),
)  # fmt: skip
"""What joints can do, from the crown down."""
LINES: dict[str, tuple[Mode, ...]] = {
    "divide": (Mode.SS,),
    "first sliding": (Mode.RRR,),
    "equal angles": (Mode.RRS, Mode.RSR),
    "crown hinge": (Mode.RSR, Mode.RS),
}
"""Lines between regions, and modes that are possible all along them."""
INNER = {Mode.SS, Mode.RRS, Mode.RSR, Mode.RS}
"""Modes in which an inner joint slides."""
POINTS = 41
"""On each line."""
STEEPEST = 89.0
"""Friction angle up to which lines are listed [deg]."""


def landmark_points(weight: Weight = "centreline") -> tuple[Landmark, ...]:
    """Return T, S, J and B, as in Table 1."""
    require_weight(weight)
    return tuple(
        replace(each, modes=least_thickness(each.half_angle, each.mu, weight).modes)
        for each in landmarks(weight).values()
    )


def special_points(weight: Weight = "centreline") -> tuple[Landmark, ...]:
    """Return alpha_s-beta, alpha_l and alpha_L, all at unbounded friction."""
    angles = special_angles(weight)
    places = (angles.widest_hinge, angles.zero_thrust, angles.limit)
    return tuple(
        _point(name, place, math.inf, least_thickness(place, math.inf, weight))
        for name, place in zip(SPECIAL, places, strict=True)
    )


def rates_of(point: Landmark, mode: Mode, weight: Weight) -> dict[str, float]:
    """Rates of one mode at a point, by eqs (15) and (16), with sliding that dilates.

    Returns: Of a joint of either half, `crown_extrados` and so on in the order of `RATES`;
        those of the whole arch add up to 1. Turning [rad/s] and sliding [r/s] of any scale.
    """
    beta_s = inner_sliding(point.mu)[1] if math.isfinite(point.mu) else None
    found = collapse_of_mode(
        mode, point.half_angle, point.eta, point.mu,
        beta_r=point.beta_r, beta_s=beta_s, weight=weight,
    )  # fmt: skip
    half = found.angles >= 0
    rates, last = found.rates[half], int(half.sum()) - 1
    crown = int(np.argmin(np.abs(found.angles[half])))
    at_crown = abs(float(found.angles[half][crown])) == 0
    values = (
        float(rates[crown, 0]) if at_crown else 0.0,
        float(rates[:, 1].sum()),
        float(rates[:, 3].sum()),
        float(rates[last, 0]),
        float(rates[last, 2]),
    )
    return {
        f"{joint}_{does}": value for (joint, does), value in zip(RATES, values, strict=True)
    }


@cache
def line_points(name: str, weight: Weight = "centreline") -> tuple[Landmark, ...]:
    """Return points along one of the lines between regions.

    `name`: Of `LINES`.
    """
    marks = landmarks(weight)
    if name == "first sliding":
        end = special_angles(weight).zero_thrust
        # Denser towards the end, where friction runs off to infinity.
        alpha = end * (1 - np.linspace(0.98, 0.03, POINTS) ** 2)
        curve = regions.first_sliding(alpha, weight)
    elif name == "divide":
        curve = regions.divide(_frictions(0.01, marks["B"].mu), weight)
    else:
        line, start = {
            "equal angles": (regions.equal_angles, "S"),
            "crown hinge": (regions.crown_hinge, "J"),
        }[name]
        steepest = math.tan(math.radians(STEEPEST))
        curve = line(_frictions(marks[start].mu, steepest), weight)
    found, points = at_points(curve.eta, curve.mu, weight), list[Landmark]()
    for eta, mu, angle, seen in zip(
        curve.eta.tolist(), curve.mu.tolist(), found.half_angle.tolist(), found.regions,
        strict=True,
    ):  # fmt: skip
        exact = least_thickness(angle, mu, weight)
        # The modes on both sides coincide on it, whatever round-off says.
        modes = tuple(mode for mode in ORDER if mode in {*seen, *LINES[name]})
        points.append(
            Landmark(
                name=name,
                half_angle=angle,
                mu=mu,
                eta=eta,
                thrust=exact.thrust or 0.0,
                beta_r=0.0 if name == "crown hinge" else exact.beta_r or 0.0,
                beta_s=inner_sliding(mu)[1] if INNER & {*modes} else None,
                modes=modes,
            )
        )
    return tuple(points)


def _frictions(low: float, high: float) -> Array:
    """Coefficients evenly in the friction angle, ends included to the last digit."""
    mu = np.tan(np.linspace(math.atan(low), math.atan(high), POINTS))
    mu[0], mu[-1] = low, high
    return mu


def _point(name: str, half_angle: float, mu: float, exact: Critical) -> Landmark:
    if exact.eta is None:
        raise ValueError(f"no thickness stands at a half-angle of {half_angle}")
    return Landmark(
        name=name,
        half_angle=half_angle,
        mu=mu,
        eta=exact.eta,
        thrust=exact.thrust or 0.0,
        # Overturning has its hinge at the crown, not next to it by round-off.
        beta_r=0.0 if Mode.R in exact.modes else exact.beta_r or 0.0,
        beta_s=exact.beta_s,
        modes=exact.modes,
    )
