"""Checks of values that come from outside, and the sizes of real things."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, cast

from blocksim.common.errors import InputError


def require(ok: bool, field: str, value: object, allowed: str) -> None:
    """Raise `InputError` unless `ok`."""
    if not ok:
        raise InputError(field, value, allowed)


def is_number(value: object, above: float, upto: float) -> bool:
    """Tell whether `value` is a number with above < value <= upto; NaN is not."""
    return (
        isinstance(value, int | float) and not isinstance(value, bool) and above < value <= upto
    )


@dataclass(frozen=True, kw_only=True)
class Range:
    """Which values a quantity has in things that are built, far beyond what is built.

    Within them no product of several quantities is too large or too small for a number.

    Parameters
    ----------
    low, high : float
        Both allowed.
    unit : str
    signed : bool
        Whether it may be below 0: then `high` is the largest to both sides, and 0 allowed.
    zero, infinite : bool
        Whether it may be 0, or infinite, besides.
    """

    low: float
    high: float
    unit: str = ""
    signed: bool = False
    zero: bool = False
    infinite: bool = False

    def has(self, value: object) -> bool:
        """Tell whether a value is a number in the range."""
        if not isinstance(value, int | float) or isinstance(value, bool):
            return False
        size = abs(value) if self.signed else value
        other = (self.zero and value == 0) or (self.infinite and value == math.inf)
        return self.low <= size <= self.high or other

    @property
    def words(self) -> str:
        """The range in words."""
        unit = f" {self.unit}" if self.unit else ""
        if self.signed:
            return f"{-self.high:g} to {self.high:g}{unit}"
        others = [each for each, may in (("0", self.zero), ("inf", self.infinite)) if may]
        beside = f" (or {', '.join(others)})" if others else ""
        return f"{self.low:g} to {self.high:g}{unit}{beside}"

    def require(self, field: str, value: object) -> None:
        """Raise `InputError` unless a value is in the range."""
        # What is allowed takes longer to say than to check.
        if not self.has(value):
            raise InputError(field, value, self.words)


LENGTH = Range(low=1e-6, high=1e6, unit="m")
"""Radius, span, depth, and the size of a structure."""
COORDINATE = Range(low=0, high=1e9, unit="m", signed=True)
HALF_ANGLE = Range(low=1e-3, high=math.nextafter(math.pi, 0), unit="rad")
ETA = Range(low=1e-15, high=2)
"""Thickness over radius: the flattest arch stands at 1e-14."""
VOUSSOIRS = Range(low=3, high=10_000)
FRICTION = Range(low=1e-6, high=1e6, infinite=True)
SMOOTH_OR_ROUGH = Range(low=0, high=1e6, infinite=True)
"""Friction that a search may come to, and that of a joint of its own, which may be smooth."""
PER_VOLUME = Range(low=1e-6, high=1e9, unit="N/m3")
"""Weight of a unit of volume."""
WEIGHT = Range(low=1e-18, high=1e18, unit="N")
FORCE = Range(low=0, high=1e15, unit="N", signed=True)
MASS = Range(low=1e-36, high=1e36, unit="kg")
INERTIA = Range(low=1e-48, high=1e48, unit="kg m2")
FACTOR = Range(low=0, high=1e9, signed=True)
"""On live loads, on weights, and on motions of supports."""
TURN = Range(low=0, high=1e6, unit="deg", signed=True)


def require_all(known: Range, field: str, values: object) -> None:
    """Raise `InputError` unless all numbers of an array are in a range."""
    for value in cast(Any, values).ravel().tolist():
        known.require(field, value)


def require_voussoirs(count: object) -> None:
    """Raise `InputError` unless it is a whole number of voussoirs that make an arch."""
    whole = VOUSSOIRS.has(count) and count == int(cast(float, count))
    require(whole, "voussoirs", count, f"a whole number from {VOUSSOIRS.words}")


def require_friction(mu: object) -> None:
    """Raise `InputError` unless 0 < mu <= inf."""
    require(is_number(mu, 0, math.inf), "mu", mu, "above 0 (inf for unbounded friction)")


def require_lean(lean: object) -> None:
    """Raise `InputError` unless gravity leans by less than a right angle, or not at all."""
    upright = is_number(lean, -math.pi / 2, math.nextafter(math.pi / 2, 0))
    require(upright, "lean", lean, "above -pi/2 and below pi/2")
