"""The values of one parameter at which forces of equilibrium exist: all of them.

Loads that can be carried are a convex cone. So the factors on a live load that stand are one
interval, whose ends are two linear programmes. Gravity that turns goes along an arc of a
circle. Where it is all that acts its directions are a factor on a force across it. Where loads
that do not turn act besides, gravity that can be carried is a convex region of the plane, which
an arc may enter and leave several times. It is found by two kinds of proof. Where blocks fall,
their mechanism gains work along a whole part of the arc: no forces exist on it. Where they
stand at both ends of a part of the arc, and where its tangents there meet, they stand on all of
it, as the region is convex.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from blocksim.blocks.acting import push_on_all
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.limit.statics import collapse, equilibrium

FINEST = 1e-9
"""Part of an arc that is not divided further [rad]."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """Values at which forces of equilibrium exist.

    `low`, `high`: -inf and inf where they exist up to the end of what was asked.
    """

    low: float
    high: float


def over_factor(problem: Problem[Any]) -> tuple[Interval, ...]:
    """Find the factors on the live loads at which forces of equilibrium exist.

    `problem`: With live loads; a plane one with gravity in its plane. Its own load factor does
        not matter.
    Returns: One at most.
    """
    most = collapse(problem).load_factor
    if most is None:
        return ()
    turned = tuple(replace(load, force=-load.force) for load in problem.live)
    least = collapse(replace(problem, live=turned)).load_factor
    return (Interval(low=-math.inf if least is None else 0.0 - least, high=most),)


def over_tilt(problem: Problem[Any], low: float, high: float) -> tuple[Interval, ...]:
    """Find the angles by which a table tilts at which forces of equilibrium exist.

    `problem`: A plane one with gravity in its plane.
    `low`, `high`: Range of the angles [rad], within a half turn.
    Returns: By angle [rad].
    """
    if problem.is_loaded or problem.unturned.any():
        return _joined(_Arc(problem).parts(low, high), low, high)
    across = push_on_all(problem, problem.across[: problem.assembly.dimensions])
    # To tilt gravity is to add a force across it, of the tangent's size, and to scale both.
    found = over_factor(replace(problem, live=(across,), load=0.0))
    return tuple(
        Interval(low=_angle(each.low), high=_angle(each.high))
        for each in found
        if math.atan(each.low) < high and math.atan(each.high) >= low
    )


def _angle(factor: float) -> float:
    """Angle of gravity and of a force across it; a boundless factor is no end."""
    return factor if math.isinf(factor) else math.atan(factor)


class _Arc:
    """Gravity along an arc beside what does not turn with it: loads, and a part of gravity."""

    def __init__(self, problem: Problem[Any]) -> None:
        self._problem = problem
        still = problem.unturned
        self._rest = replace(problem, gravity=still).applied_forces()
        turning = problem.gravity - still, problem.across
        self._along, self._across = (
            replace(problem, gravity=still + each).applied_forces() - self._rest
            for each in turning
        )
        self._asked: dict[float, Array | None] = {}

    def parts(self, low: float, high: float) -> Iterator[tuple[float, float]]:
        """Return the parts of the arc that stand, in order, divided anywhere."""
        left = [(low, high)]
        while left:
            low, high = left.pop()
            mechanism = self._at(low)
            if mechanism is None:
                mechanism = self._at(high)
            if high - low <= FINEST:
                if mechanism is None:
                    yield low, high
                continue
            middle = (low + high) / 2
            if mechanism is None:
                mechanism = self._mechanism(middle, 1 / math.cos((high - low) / 2))
                if mechanism is None:
                    yield low, high
                    continue
            spared = self._spared(mechanism, low, high)
            if spared == [(low, high)]:
                spared = [(low, middle), (middle, high)]
            left += spared[::-1]

    def _at(self, angle: float) -> Array | None:
        """Return how blocks fall at an angle; None where they stand."""
        if angle not in self._asked:
            self._asked[angle] = self._mechanism(angle)
        return self._asked[angle]

    def _mechanism(self, angle: float, stretch: float = 1.0) -> Array | None:
        """Return how blocks fall where gravity has an angle and so many times its size."""
        tilted, still = self._problem.tilted(angle), self._problem.unturned
        turned = still + stretch * (tilted.gravity - still)
        found = equilibrium(replace(tilted, gravity=turned))
        if found.exists or found.mechanism is not None:
            return found.mechanism
        return np.zeros_like(self._rest)

    def _spared(self, mechanism: Array, low: float, high: float) -> list[tuple[float, float]]:
        """Return the parts of an arc on which a mechanism gains no work."""
        x, y, rest = (
            float((mechanism * each).sum()) for each in (self._along, self._across, self._rest)
        )
        size = math.hypot(x, y)
        if abs(rest) >= size:
            return [] if rest > 0 else [(low, high)]
        reach = math.acos(-rest / size)
        centre = math.atan2(y, x)
        centre += math.tau * round(((low + high) / 2 - centre) / math.tau)
        start, end = max(low, centre - reach), min(high, centre + reach)
        # What hardly moves an end found it before: there the mechanism gains nothing.
        self._asked |= dict.fromkeys(
            new for old, new in ((low, end), (high, start)) if abs(new - old) < FINEST
        )
        return [part for part in ((low, start), (end, high)) if part[0] < part[1]]


def _joined(
    parts: Iterator[tuple[float, float]], low: float, high: float
) -> tuple[Interval, ...]:
    """Join parts that touch; those that reach an end of the range go on beyond it."""
    found: list[list[float]] = []
    for start, end in parts:
        if found and start - found[-1][1] <= FINEST:
            found[-1][1] = end
        else:
            found.append([start, end])
    return tuple(
        Interval(
            low=-math.inf if start <= low else start,
            high=math.inf if end >= high else end,
        )
        for start, end in found
    )
