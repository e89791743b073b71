"""Axes of a design: the values of one quantity, as a TOML file gives them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, cast

import numpy as np
from pydantic import BeforeValidator, Field

from blocksim.common.checks import infinite, require
from blocksim.common.errors import MISSING
from blocksim.common.tables import Written

DRAWN_AT_ONCE = 4096
"""Arches drawn together; a longer random design begins with those of a shorter one."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=True), BeforeValidator(infinite)]


def _as_table(written: object) -> object:
    """Take a number or a list for an axis of values."""
    if isinstance(written, list):
        return {"values": cast("list[object]", written)}
    return cast("object", written) if isinstance(written, dict) else {"values": [written]}


@dataclass(frozen=True, kw_only=True)
class Axis(Written):
    """Values of one quantity: a list, or a range of evenly spaced ones.

    Parameters
    ----------
    values : tuple of float
        One or several; a file may say `mu = [0.5, 0.7]` for short.
    low, high : float, optional
        Range, both ends included.
    steps : int, optional
        Number of values in the range; a random design draws from anywhere in it.
    log : bool
        Evenly spaced in the logarithm.
    """

    values: Annotated[tuple[Number, ...], Field(max_length=10_000)] = ()
    low: Annotated[float, Field(strict=True, allow_inf_nan=False)] | None = None
    high: Annotated[float, Field(strict=True, allow_inf_nan=False)] | None = None
    steps: Annotated[int, Field(ge=2, le=1_000_000, strict=True)] | None = None
    log: Annotated[bool, Field(strict=True)] = False

    @property
    def ends(self) -> tuple[float, ...]:
        """Values, or the ends of the range: all are in range where these are."""
        if self.low is not None and self.high is not None:
            return self.low, self.high
        return self.values

    def every(self) -> list[float]:
        """Values in order."""
        if self.low is None or self.high is None or self.steps is None:
            return list(self.values)
        spaced = np.geomspace if self.log else np.linspace
        return spaced(self.low, self.high, self.steps).tolist()

    def draw(self, generator: np.random.Generator, whole: bool) -> list[float]:
        """Values at random, evenly spread; whole numbers include both ends."""
        count = DRAWN_AT_ONCE
        if self.low is None or self.high is None:
            return generator.choice(np.array(self.values), count).tolist()
        low, high = (self.low - 0.5, self.high + 0.5) if whole else (self.low, self.high)
        share = generator.random(count)
        drawn = low * (high / low) ** share if self.log else low + (high - low) * share
        return np.clip(drawn, self.low, self.high).tolist()


AxisField = Annotated[Axis, BeforeValidator(_as_table)]


def require_axis(field: str, axis: Axis, spaced: bool) -> None:
    """Raise `InputError` unless an axis is either a list or a whole range."""
    if axis.low is None and axis.high is None and axis.steps is None:
        require(bool(axis.values), field, list(axis.values), "a value, a list or a range")
        require(not axis.log, f"{field}.log", axis.log, "left out of a list")
        return
    require(not axis.values, f"{field}.values", list(axis.values), "left out of a range")
    for name, value in (("low", axis.low), ("high", axis.high)):
        require(value is not None, f"{field}.{name}", MISSING, "given in a range")
    low, high = axis.low or 0.0, axis.high or 0.0
    require(low < high, f"{field}.high", high, f"above low = {low}")
    require(low > 0 or not axis.log, f"{field}.low", low, "above 0 where log is true")
    if spaced:
        require(axis.steps is not None, f"{field}.steps", MISSING, "given in a grid")
