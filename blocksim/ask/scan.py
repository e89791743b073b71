"""Where forces of equilibrium exist as friction changes, or a parameter of a kind.

More friction never harms, so the friction that stands begins at one value. Of a parameter of a
kind nothing is known beforehand: it is tried at a number of values, and each change between two
of them is found. Between two that stand there may be one that falls.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from blocksim.blocks.problem import Problem
from blocksim.common.errors import InputError
from blocksim.common.later import optimize
from blocksim.limit.intervals import Interval
from blocksim.limit.statics import standing_margin

At = Callable[[float], Problem[Any]]
"""Value to problem."""
ENOUGH = 1e-9
"""Lack of force at which limit analysis still calls blocks at rest [mean weights]."""
NEAR = 1e-6
"""How far from where force is lacking its margin is looked at, relative."""
TRIED = 25
"""Values of a parameter at which limit analysis looks for changes."""


class Scan:
    """What limit analysis says at values of a parameter.

    `at`: Value to problem.
    `ends`: Between which values.
    `now`: The value at hand. Values count up to the first on either side of it of which nothing
        can be built.
    """

    def __init__(
        self,
        at: At,
        ends: tuple[float, float],
        now: float,
    ) -> None:
        self.at = lru_cache(maxsize=2 * TRIED)(at)
        self.values = self._built(np.geomspace(*ends, TRIED).tolist(), now)

    def _built(self, values: list[float], now: float) -> list[float]:
        """Return the values around the one at hand of which something can be built."""

        def able(way: list[float]) -> list[float]:
            found: list[float] = []
            for value in way:
                try:
                    self.at(value)
                except InputError:
                    break
                found.append(value)
            return found

        below = [value for value in values if value < now]
        above = [value for value in values if value > now]
        return [*able(below[::-1])[::-1], now, *able(above)]

    @cached_property
    def standing(self) -> tuple[Interval, ...]:
        """The values at which forces of equilibrium exist, as far as those tried tell."""
        return standing_at(self.at, self.values)

    @property
    def remark(self) -> str:
        """Say how far the changes found are all there are."""
        tried = f"{len(self.values)} values from {self.values[0]:.3g} to {self.values[-1]:.3g}"
        ends = [end for each in self.standing for end in (each.low, each.high)]
        changes = sum(math.isfinite(end) for end in ends)
        if not changes:
            return f"; tried: {tried}"
        said = "the only change" if changes == 1 else f"{changes} changes"
        return f"; {said}, as far as {tried} tell"


def standing_at(at: At, values: Sequence[float]) -> tuple[Interval, ...]:
    """Find between which values forces of equilibrium exist, as far as those tried tell."""
    stood = [standing_margin(at(value)) >= -ENOUGH for value in values]
    found, low = list[Interval](), -math.inf
    for (left, before), (right, after) in pairwise(zip(values, stood, strict=True)):
        if before is after:
            continue
        end = root(at, left, right, rises=after)
        if after:
            low = end
        else:
            found.append(Interval(low=low, high=end))
    return (*found, Interval(low=low, high=math.inf)) if stood[-1] else tuple(found)


def least_friction(problem: Problem[Any], most: float) -> tuple[Interval, ...]:
    """Find the friction from which on forces of equilibrium exist, up to a bound."""

    def at(mu: float) -> Problem[Any]:
        return problem.with_friction(mu)

    if standing_margin(at(most)) < -ENOUGH:
        return ()
    needed = standing_margin(at(0.0)) < -ENOUGH
    low = root(at, 0.0, most, rises=True) if needed else -math.inf
    return (Interval(low=low, high=math.inf),)


def root(at: At, low: float, high: float, *, rises: bool) -> float:
    """Find where the margin of equilibrium vanishes between two values, one of which stands.

    `rises`: Whether it is the higher one that stands.
    """

    def margin(value: float) -> float:
        # Where nothing would hold the blocks any number will do that is far below zero.
        return max(standing_margin(at(value)), -1.0) + ENOUGH

    found = float(optimize.brentq(margin, low, high, xtol=1e-13, rtol=1e-12))
    # What is enough is a little too little: where the margin grows evenly on the standing
    # side, its zero is taken from there.
    step = NEAR * max(found, low) * (1 if rises else -1)
    one, two = (margin(min(max(found + k * step, low), high)) - ENOUGH for k in (1, 2))
    if one < 10 * ENOUGH or two <= one:
        return found
    zero = found + step - one * step / (two - one)
    # Where blocks can be wedged the margin jumps, and its zero is found already.
    return zero if abs(zero - found) <= abs(step) else found
