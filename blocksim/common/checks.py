"""Checks of values that come from outside, and the sizes of real things."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
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

    `low`, `high`: Both allowed, an infinite end is not.
    `above`: Whether the low end is not allowed.
    `whole`: Whether it is a whole number.
    `infinite`: Whether it may be infinite besides; files say "inf".
    """

    low: float
    high: float
    unit: str = ""
    above: bool = False
    whole: bool = False
    infinite: bool = False

    def has(self, value: object) -> bool:
        """Tell whether a value is a number in the range."""
        if not isinstance(value, int | float) or isinstance(value, bool):
            return False
        if value == math.inf:
            return self.infinite
        inside = self.low < value if self.above else self.low <= value
        return inside and value <= self.high and (not self.whole or value == int(value))

    @property
    def words(self) -> str:
        """The range in words."""
        unit = f" {self.unit}" if self.unit else ""
        beside = " (or inf)" if self.infinite else ""
        low, high = f"{self.low:.6g}", f"{self.high:.6g}"
        if self.whole:
            return f"a whole number from {low} to {high}{unit}{beside}"
        if math.isinf(self.high):
            return f"{f'above {low}' if self.above else f'{low} or more'}{unit}{beside}"
        after = math.nextafter(self.high, math.inf)
        # The last number below a round one is not said as that.
        below = after.is_integer() and not float(self.high).is_integer()
        if self.above:
            end = f"below {after:g}" if below else f"at most {high}"
            return f"above {low} and {end}{unit}{beside}"
        end = f"below {after:g}" if below else high
        return f"{low} to {end}{unit}{beside}"

    def require(self, field: str, value: object) -> None:
        """Raise `InputError` unless a value is in the range."""
        # What is allowed takes longer to say than to check.
        if not self.has(value):
            raise InputError(field, value, self.words)

    def within(self, low: float, high: float) -> Range:
        """Return a narrower range, of which a low end of its own is not allowed."""
        return replace(self, low=low, high=high, above=self.above or low != self.low)

    def __get_pydantic_core_schema__(self, _: Any, handler: Any) -> dict[str, Any]:
        """Tell pydantic, by which files are read, what a number annotated by it may be."""
        number: dict[str, Any] = {"type": "int" if self.whole else "float", "strict": True}
        number["gt" if self.above else "ge"] = int(self.low) if self.whole else self.low
        if math.isfinite(self.high):
            number["le"] = int(self.high) if self.whole else self.high
        if not self.whole:
            number["allow_inf_nan"] = False
        if self.infinite:
            text = {"type": "literal", "expected": ["inf"]}
            taken = {"type": "no-info", "function": infinite}
            endless = {"type": "function-after", "function": taken, "schema": text}
            number = {"type": "union", "choices": [number, endless]}
            # TOML has infinity as a number.
            said = {"type": "no-info", "function": endless_text}
            number = {"type": "function-before", "function": said, "schema": number}
        return {
            "type": "custom-error",
            "schema": number,
            "custom_error_type": "range",
            "custom_error_message": self.words,
        }


def endless_text(written: object) -> object:
    """Say infinity, "inf" or "-inf", as the text that files of JSON have."""
    return str(written) if isinstance(written, float) and math.isinf(written) else written


def infinite(written: object) -> object:
    """Take the text "inf" for infinity, as JSON has it."""
    return math.inf if written == "inf" else written


LENGTH = Range(low=1e-6, high=1e6, unit="m")
"""Radius, span, depth, and the size of a structure."""
COORDINATE = Range(low=-1e9, high=1e9, unit="m")
HALF_ANGLE = Range(low=1e-3, high=math.nextafter(math.pi, 0), unit="rad")
HALF_ANGLE_DEG = Range(low=0.06, high=math.nextafter(180, 0), unit="deg")
ETA = Range(low=1e-15, high=2)
"""Thickness over radius: the flattest arch stands at 1e-14."""
RATIO = Range(low=0, high=100, above=True)
"""Of a thickness to the least one that stands, as built."""
VOUSSOIRS = Range(low=3, high=10_000, whole=True)
FRICTION = Range(low=1e-6, high=1e6, infinite=True)
SMOOTH_OR_ROUGH = Range(low=0, high=1e6, infinite=True)
"""Friction that a search may come to, and that of a joint of its own, which may be smooth."""
FRICTION_ANGLE = Range(low=0, high=90, unit="deg", above=True)
ANY_FRICTION = Range(low=0, high=math.inf, above=True, infinite=True)
"""What theory and the statics of an arch take."""
LEAN = Range(low=-math.pi / 2, high=math.nextafter(math.pi / 2, 0), unit="rad", above=True)
LEAN_DEG = Range(low=-90, high=math.nextafter(90, 0), unit="deg", above=True)
TILT_DEG = Range(low=-180, high=180, unit="deg")
WIDTH = Range(low=0, high=0.5, above=True)
"""Of a bracket, relative."""
PER_VOLUME = Range(low=1e-6, high=1e9, unit="N/m3")
"""Weight of a unit of volume."""
WEIGHT = Range(low=1e-18, high=1e18, unit="N")
FORCE = Range(low=-1e15, high=1e15, unit="N")
AXLE = Range(low=0, high=1e6, unit="kN", above=True)
"""Weight of an axle."""
MOST_AXLES = 100
"""Axles of a vehicle."""
STRENGTH = Range(low=0, high=1e9, unit="Pa", above=True)
"""Compressive strength."""
MASS = Range(low=1e-36, high=1e36, unit="kg")
INERTIA = Range(low=1e-48, high=1e48, unit="kg m2")
FACTOR = Range(low=-1e9, high=1e9)
"""On live loads, on weights, and on motions of supports."""
GRAVITY = Range(low=0.1, high=100, unit="m/s2")
VELOCITY = Range(low=-1e4, high=1e4)
"""Of blocks at the release [m/s], and of their rotation [rad/s]."""
PUSH = Range(low=0, high=10, unit="g")
"""Sideways, over the weight of each block."""
TURN = Range(low=-1e6, high=1e6, unit="deg")


def require_all(known: Range, field: str, values: object) -> None:
    """Raise `InputError` unless all numbers of an array are in a range."""
    for value in cast(Any, values).ravel().tolist():
        known.require(field, value)
