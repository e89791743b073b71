"""What Cocchetti and Rizzi (2024) print, computed from what defines it.

Every constant of the text, of Table 1 and of the captions is computed, and compared with the
printed one; the arches of Figs 13-25 are found from the lines and points of the map on which
they lie. Fig. 15's eta for 145 deg, 0.764335711953571, lacks a digit that Fig. 16 prints,
0.7643357111953571; it is compared with the latter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.optimize import brentq

from blocksim.arch.modes import Mode
from blocksim.arch.theory import Critical, landmarks, least_thickness, regions
from blocksim.arch.theory.critical import inner_sliding
from blocksim.arch.theory.equations import hinge_slope
from blocksim.arch.theory.map import divide_friction, special_angles

FIGURES = range(1, 26)
ARCHES = range(13, 26)
"""Figures that show arches as they collapse."""

TABLE_1 = {
    "T": (0.6796047320988860, 1.415270827756886, 2.487161163767182, 0.09780581933963814,
          1.037485213550072, 0.2970519164101457),
    "S": (0.9533663968209255, 1.765868462744654, 2.600211150484514, 0.06791978142522512,
          0.2516081968386061, 0.2516081968386061),
    "J": (0.9652414772084208, 1.777213608388237, 2.603266515104794, 0.06718190191428895,
          0.0, 0.2503367611228279),
    "B": (2.0, 2.690297881776622, 2.774176793356034, 0.03200476409857036,
          0.0, 0.1760126676508405),
}  # fmt: skip
"""Table 1 as printed, in the order of `SYMBOLS`."""
SYMBOLS = ("eta", "mu", "alpha", "h", "beta_r", "beta_s")


@dataclass(frozen=True, kw_only=True)
class PaperArch:
    """One arch of Figs 13-25 at its least thickness [rad], in the mode that is drawn."""

    half_angle: float
    mu: float
    mode: Mode
    critical: Critical


@dataclass(frozen=True, kw_only=True)
class Printed:
    """A number of the paper, as computed and as printed."""

    name: str
    value: float
    printed: float

    @property
    def difference(self) -> float:
        """Relative difference, which is absolute of a printed 0."""
        return abs(self.value - self.printed) / (abs(self.printed) or 1.0)


def numbers() -> tuple[Printed, ...]:
    """Return every number the paper prints with all its digits."""
    found: dict[str, tuple[float, float]] = {}
    for name, published in TABLE_1.items():
        mark = landmarks()[name]
        values = (
            mark.eta,
            mark.mu,
            mark.half_angle,
            mark.thrust,
            mark.beta_r,
            mark.beta_s or 0.0,
        )
        for symbol, value, printed in zip(SYMBOLS, values, published, strict=True):
            found[f"Table 1 {symbol}_{name}"] = (value, printed)
    special = special_angles()
    found["beta_s-beta"] = (special.hinge, 1.129085087576187)
    found["alpha_s-beta"] = (special.widest_hinge, 2.230312828619947)
    found["alpha_l"] = (special.zero_thrust, 2.648388899151005)
    found["alpha_L"] = (special.limit, 2.786498150651177)
    for degrees, *printed in (
        (125, 0.8477497839674316, 0.5081418006878796, 0.9245590639478306, 0.3849612500740051),
        (145, 1.536310506737699, 0.7643357111953571, 1.761938080825641, 0.7406376307743147),
    ):
        alpha = math.radians(degrees)
        mu = divide_friction(alpha)
        eta, _ = regions.at_inner_sliding(mu, alpha, "centreline")
        first = regions.first_sliding(np.array([alpha]))
        values = (mu, eta, float(first.mu[0]), float(first.eta[0]))
        names = ("mu at the divide", "eta at the divide", "mu at first sliding", "eta there")
        for name, value, one in zip(names, values, printed, strict=True):
            found[f"{degrees} deg, {name}"] = (value, one)
    found["Fig. 17 eta, 145 deg"] = (_eta(math.radians(145), 1.6), 0.7566761737936022)
    found["Fig. 17 eta, 125 deg"] = (_eta(math.radians(125), 0.9), 0.4208869235292454)
    wide = landmarks()["J"].half_angle
    found["Fig. 21 eta at mu = 1.79"] = (_eta(wide, 1.79), 0.9630759684607590)
    equal = _equal_angles_friction(wide)
    found["Fig. 21 mu, equal angles"] = (equal, 1.832508693777595)
    found["Fig. 21 eta, equal angles"] = (_eta(wide, equal), 0.9563124518512550)
    first = regions.first_sliding(np.array([wide]))
    found["Fig. 22 mu"] = (float(first.mu[0]), 3.385846504480999)
    found["Fig. 22 eta"] = (float(first.eta[0]), 0.8679273523649103)
    mu = _unit_friction()
    found["Fig. 23 mu"] = (mu, 1.809583028035458)
    found["Fig. 23 alpha"] = (regions.divide_half_angle(mu), 2.611810358168302)
    return tuple(
        Printed(name=name, value=value, printed=one) for name, (value, one) in found.items()
    )


def _eta(half_angle: float, mu: float) -> float:
    eta = least_thickness(half_angle, mu).eta
    return math.nan if eta is None else eta


def _equal_angles_friction(half_angle: float) -> float:
    """Friction at which beta_r = beta_s, at a given half-angle."""

    def slope(mu: float) -> float:
        thrust, beta_s = inner_sliding(mu)
        return hinge_slope(thrust, half_angle, beta_s, "centreline")

    return float(brentq(slope, 1.8, 1.9, xtol=1e-15))


def _unit_friction() -> float:
    """Friction at which the divide passes eta = 1."""

    def excess(mu: float) -> float:
        return regions.at_inner_sliding(mu, regions.divide_half_angle(mu), "centreline")[0] - 1

    return float(brentq(excess, 1.79, 1.9, xtol=1e-15))


@cache
def paper_arches() -> dict[int, tuple[PaperArch, ...]]:
    """Return the arches of Figs 13-25 by figure, from top to bottom."""
    marks = landmarks()
    special = special_angles()
    pond, basin, wide = math.radians(125), math.radians(145), marks["J"].half_angle
    sides = {
        alpha: (divide_friction(alpha), float(regions.first_sliding(np.array([alpha])).mu[0]))
        for alpha in (pond, basin, wide)
    }
    unit = _unit_friction()
    unit_angle = regions.divide_half_angle(unit)
    t, j, b = marks["T"], marks["J"], marks["B"]
    arches: dict[int, list[tuple[float, float, Mode]]] = {
        13: [(pond, sides[pond][0], Mode.SS), (pond, sides[pond][1], Mode.RRR)],
        14: [(pond, sides[pond][0], Mode.SRR), (pond, sides[pond][1], Mode.SRR)],
        15: [(basin, sides[basin][0], Mode.SS), (basin, sides[basin][1], Mode.RRR)],
        16: [(basin, sides[basin][0], Mode.RRS), (basin, sides[basin][1], Mode.RRS)],
        17: [(basin, 1.6, Mode.RRS), (pond, 0.9, Mode.SRR)],
        18: [(t.half_angle, t.mu, Mode.SS), (t.half_angle, t.mu, Mode.RRR)],
        19: [(t.half_angle, t.mu, Mode.RRS), (t.half_angle, t.mu, Mode.SRR)],
        20: [(wide, j.mu, Mode.SS), (wide, j.mu, Mode.RS)],
        21: [(wide, 1.79, Mode.RSR), (wide, _equal_angles_friction(wide), Mode.RRS)],
        22: [(wide, sides[wide][1], Mode.RRS), (wide, sides[wide][1], Mode.RRR)],
        23: [(unit_angle, unit, Mode.SS), (unit_angle, unit, Mode.RS)],
        24: [(b.half_angle, b.mu, Mode.SS), (b.half_angle, b.mu, Mode.RS)],
        25: [(special.limit, math.inf, Mode.R), (special.zero_thrust, math.inf, Mode.R)],
    }
    return {
        figure: tuple(
            PaperArch(half_angle=a, mu=mu, mode=mode, critical=least_thickness(a, mu))
            for a, mu, mode in rows
        )
        for figure, rows in arches.items()
    }


CONTENTS = {
    1: "The arch and its measures",
    2: "The purely rotational mode, and what acts at a shoulder hinge",
    3: "Purely rotational mode: inner hinge, thickness and thrust over the half-angle",
    4: "Sliding of an inner joint: thrust and place over friction",
    5: "Purely sliding mode: place, friction and thrust over the half-angle",
    6: "Dividing lines and lines of equal half-angle",
    7: "The same, up to eta = 1",
    8: "The same, from eta = 0.6",
    9: "The regions, and the equations that rule in each",
    10: "The regions, filled",
    11: "The regions, filled: the middle",
    12: "Strength of a joint, and how it moves",
    13: "125 deg at both lines of sliding: purely sliding, purely rotational",
    14: "The same two arches: sliding-rotational",
    15: "145 deg at both lines of sliding: purely sliding, purely rotational",
    16: "The same two arches: rotational-sliding",
    17: "Between the lines: rotational-sliding at 145 deg, sliding-rotational at 125 deg",
    18: "Triple point T: purely sliding, purely rotational",
    19: "Triple point T: rotational-sliding, sliding-rotational",
    20: "Junction point J: purely sliding, overturning-sliding",
    21: "Half-angle of J: inner hinge above the sliding joint, and at it",
    22: "Half-angle of J at first sliding: rotational-sliding, purely rotational",
    23: "Where the divide passes eta = 1: purely sliding, overturning-sliding",
    24: "Border point B: purely sliding, overturning-sliding",
    25: "Unbounded friction: purely overturning, at eta = 2 and at eta = 1",
}
"""Words for each figure."""
