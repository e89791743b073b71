"""Families: a problem for each value of one parameter, from which on it falls, or stands."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from blocksim.blocks.problem import Load, Problem
from blocksim.common.errors import InputError
from blocksim.limit import collapse, equilibrium

Stands = Literal["low", "high"]
LARGEST_FRICTION = 1e3
"""Friction above which more of it is not looked for."""
ENOUGH = 1e-9
"""Lack of force at which limit analysis still calls blocks at rest [mean weights]."""
HIGHEST_FACTOR = 1e6
"""Load factor above which no limit is looked for."""


@dataclass(frozen=True, kw_only=True)
class Family:
    """A problem for each value of one parameter.

    Parameters
    ----------
    name, unit : str
    at : callable
        Value to problem.
    low, high : float
        Range of values that make sense.
    stands : {"low", "high"}
        At which end of a bracket it stands.
    exact : callable
        The value at which limit analysis sees the change: None where there is none in the
        range, inf where it stands at all values.
    """

    name: str
    unit: str
    at: Callable[[float], Problem]
    low: float
    high: float
    stands: Stands
    exact: Callable[[], float | None]


def family_of(problem: Problem, over: str) -> Family:
    """Return the family of a problem over one parameter.

    Parameters
    ----------
    problem : Problem
    over : str
        `load`, `tilt`, `lean` or `mu`.

    Raises
    ------
    InputError
        If there is no such parameter, or nothing to multiply.
    """
    if over not in FAMILIES:
        raise InputError("--over", over, f"one of {', '.join(FAMILIES)}")
    return FAMILIES[over](problem)


def _over_load(problem: Problem) -> Family:
    if not problem.live:
        raise InputError("--over", "load", "another parameter: the structure has no live loads")
    return Family(
        name="load",
        unit="",
        at=problem.with_load,
        low=0.0,
        high=HIGHEST_FACTOR,
        stands="low",
        exact=lambda: collapse(problem).load_factor,
    )


def _over_tilt(problem: Problem) -> Family:
    return Family(
        name="tilt",
        unit="deg",
        at=lambda value: problem.tilted(math.radians(value)),
        low=0.0,
        high=90.0,
        stands="low",
        exact=lambda: _exact_tilt(problem),
    )


def _exact_tilt(problem: Problem) -> float | None:
    """Angle of the table, in degrees: one linear programme where gravity is all that acts.

    To tilt gravity is to add a force across it, of the tangent's size, and to scale both.
    """
    if problem.dead or (problem.live and problem.load):
        return _root(lambda value: problem.tilted(math.radians(value)), 0.0, 90.0, "low")
    x, y, _ = problem.gravity
    across = Load(
        force=np.array([-y, x]),
        blocks=tuple(range(len(problem.assembly.blocks))),
        per_weight=True,
    )
    found = collapse(replace(problem, live=(across,), load=0.0)).load_factor
    if found is None or found < 0:
        return None
    return math.inf if math.isinf(found) else math.degrees(math.atan(found))


def _over_lean(problem: Problem) -> Family:
    return Family(
        name="lean",
        unit="deg",
        at=lambda value: problem.leaning(math.radians(value)),
        low=0.0,
        high=90.0,
        stands="low",
        exact=lambda: None,
    )


def _over_mu(problem: Problem) -> Family:
    return Family(
        name="mu",
        unit="",
        at=problem.with_friction,
        low=0.0,
        high=LARGEST_FRICTION,
        stands="high",
        exact=lambda: _root(lambda mu: replace(problem, mu=mu), 0.0, LARGEST_FRICTION, "high"),
    )


FAMILIES: dict[str, Callable[[Problem], Family]] = {
    "load": _over_load,
    "tilt": _over_tilt,
    "lean": _over_lean,
    "mu": _over_mu,
}


def _root(
    at: Callable[[float], Problem], low: float, high: float, stands: Stands
) -> float | None:
    """Find where the margin of equilibrium vanishes."""

    def margin(value: float) -> float:
        # Where nothing would hold the blocks any number will do that is far below zero.
        return max(equilibrium(at(value)).margin, -1.0) + ENOUGH

    standing, falling = (low, high) if stands == "low" else (high, low)
    if margin(standing) < 0:
        return None
    if margin(falling) >= 0:
        return math.inf if stands == "low" else 0.0
    return float(brentq(margin, low, high, xtol=1e-13, rtol=1e-12))
