"""Checks of values that come from outside."""

from __future__ import annotations

import math

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


def require_friction(mu: object) -> None:
    """Raise `InputError` unless 0 < mu <= inf."""
    require(is_number(mu, 0, math.inf), "mu", mu, "above 0 (inf for unbounded friction)")


def require_lean(lean: object) -> None:
    """Raise `InputError` unless gravity leans by less than a right angle, or not at all."""
    upright = is_number(lean, -math.pi / 2, math.nextafter(math.pi / 2, 0))
    require(upright, "lean", lean, "above -pi/2 and below pi/2")
