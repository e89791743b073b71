"""Designs: axes of values, which structures a sweep asks about, and how."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, cast

import numpy as np
from pydantic import BeforeValidator
from pydantic import Field as Said

from blocksim.ask.methods import METHODS, STATIC
from blocksim.common.checks import infinite, require
from blocksim.common.errors import MISSING
from blocksim.common.fields import Field
from blocksim.common.tables import Written
from blocksim.engines import NAMES
from blocksim.simulation.simulated import SETTINGS, setting_of
from blocksim.sweeps.case import Case, Value, is_plain

DRAWN_AT_ONCE = 4096
"""Arches drawn together; a longer random design begins with those of a shorter one."""

Number = Annotated[float, Said(strict=True, allow_inf_nan=True), BeforeValidator(infinite)]


def _as_table(written: object) -> object:
    """Take a number or a list for an axis of values."""
    if isinstance(written, list):
        return {"values": cast("list[object]", written)}
    return cast("object", written) if isinstance(written, dict) else {"values": [written]}


@dataclass(frozen=True, kw_only=True)
class Axis(Written):
    """Values of one quantity: a list, or a range of evenly spaced ones.

    `values`: One or several; a file may say `mu = [0.5, 0.7]` for short.
    `low`, `high`: Range, both ends included.
    `steps`: Number of values in the range; a random design draws from anywhere in it.
    `log`: Evenly spaced in the logarithm.
    """

    values: Annotated[tuple[Number, ...], Said(max_length=10_000)] = ()
    low: Annotated[float, Said(strict=True, allow_inf_nan=False)] | None = None
    high: Annotated[float, Said(strict=True, allow_inf_nan=False)] | None = None
    steps: Annotated[int, Said(ge=2, le=1_000_000, strict=True)] | None = None
    log: Annotated[bool, Said(strict=True)] = False

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
        """Return values at random, evenly spread. Whole numbers include both ends."""
        count = DRAWN_AT_ONCE
        if self.low is None or self.high is None:
            return generator.choice(np.array(self.values), count).tolist()
        low, high = (self.low - 0.5, self.high + 0.5) if whole else (self.low, self.high)
        share = generator.random(count)
        drawn = low * (high / low) ** share if self.log else low + (high - low) * share
        return np.clip(drawn, self.low, self.high).tolist()


AxisField = Annotated[Axis, BeforeValidator(_as_table)]


AUTO_BAND = 0.001
"""Share of the least thickness within which `auto` simulates."""


def _as_list(written: object) -> object:
    """Take a single word for a list of one."""
    return cast("object", written) if isinstance(written, list) else [written]


Words = Annotated[tuple[str, ...], Said(min_length=1, max_length=10), BeforeValidator(_as_list)]
Values = Axis | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class RandomTable(Written):
    """Table `[random]`: draw structures instead of taking every combination.

    `count`: How many.
    `seed`: The same seed draws the same structures.
    """

    count: Annotated[int, Said(ge=1, strict=True)]
    seed: Annotated[int, Said(ge=0, strict=True)]


@dataclass(frozen=True, kw_only=True)
class How(Written):
    """How a sweep asks: the keys of a design file that are no axes.

    `over`: Parameter to bracket over; without it the question is whether it stands. Of arches
        by their half-angle it is `thickness` where none is given.
    `method`: Every structure is put to each.
    `band`: Of arches by half-angle and `eta` or `ratio`: engines simulate those within this
        share of their least thickness, and `limit` answers for the others. By default a named
        engine simulates all, and `auto` those within 0.001, with `direct`.
    `tol`: Relative width of a bracket.
    `confirm`: Let blocks go at both ends of an engine's bracket; without, the onset test alone
        answers, in about half of the time.
    `settings`: Of engines, instead of what their rules say (`Settings`): axes like any other; a
        method is given those it is run with.
    `random`: Draws structures instead.
    """

    over: str | None = None
    method: Words = ("auto",)
    band: Number | None = None
    tol: Number = 0.005
    confirm: Annotated[bool, Said(strict=True)] = True
    settings: dict[str, AxisField] = field(default_factory=dict[str, Axis])
    random: RandomTable | None = None


@dataclass(frozen=True, kw_only=True)
class Design(How):
    """Every combination of the values given, or a number of structures drawn from them.

    `axes`: By name: parameters of the kind, `arch.thickness` of its arch, `mu`, and what acts.
    `known`: What each may be.
    `rest`: What all have in common: parameters that are tables, loads, density.
    """

    kind: str
    axes: Mapping[str, Values]
    known: Mapping[str, Field]
    rest: Mapping[str, Any]

    @property
    def is_plain(self) -> bool:
        """Whether statics answer it in bulk."""
        return is_plain(self.kind, self.axes, self.over, self._common)

    @property
    def _common(self) -> str:
        # A date of TOML is a text, at which the case is refused.
        return json.dumps(self.rest, sort_keys=True, default=str)

    @property
    def size(self) -> int:
        """Number of cases, those that occur twice included."""
        if self.random is not None:
            return self.random.count * len(self.method)
        axes = *self.axes.values(), *self.settings.values()
        return math.prod(len(every(axis)) for axis in axes) * len(self.method)

    def is_whole(self, name: str) -> bool:
        """Whether an axis has whole numbers only."""
        return self.known[name].whole

    def cases(self) -> Iterator[Case]:
        """Give the cases one after the other, always in the same order."""
        names, own = tuple(self.axes), tuple(self.settings)
        whole = [at for at, name in enumerate(names) if self.is_whole(name)]
        rest = self._common
        free = [(method, *self._width(method), self.taken(method)) for method in self.method]
        for drawn in self._grid() if self.random is None else self._drawn(self.random):
            values = [*drawn]
            for at in whole:
                values[at] = round(cast("float", values[at]))
            given = tuple(zip(names, values, strict=False))
            numbers = cast("list[float]", values[len(names) :])
            settings = [
                (name, setting_of(name, value))
                for name, value in zip(own, numbers, strict=True)
            ]
            for method, band, tol, taken in free:
                mine = tuple(each for each in settings if each[0] in taken)
                # Where there is no bracket by an engine, there are no ends to confirm.
                ends = self.confirm or not tol
                yield Case(self.kind, given, method, self.over, rest, band, tol, ends, mine)

    def taken(self, method: str) -> tuple[str, ...]:
        """Names of the settings that change an answer of a method here."""
        if self.is_plain:
            engine = NAMES[0] if method == "auto" else method
            return METHODS[engine].adjustable if any(self._width(method)) else ()
        return () if method == "auto" else METHODS[method].adjustable

    def _width(self, method: str) -> tuple[float, float]:
        """Band and tolerance of one method, 0 where it has none: then they change nothing."""
        if not self.is_plain:
            return 0.0, self.tol if self.over is not None else 0.0
        if method in STATIC or (self.over is not None and method == "auto"):
            return 0.0, 0.0
        band = AUTO_BAND if method == "auto" else math.inf
        return (0.0, self.tol) if self.over is not None else (self.band or band, 0.0)

    def _grid(self) -> Iterator[tuple[Value, ...]]:
        axes = *self.axes.values(), *self.settings.values()
        return itertools.product(*map(every, axes))

    def _drawn(self, table: RandomTable) -> Iterator[tuple[Value, ...]]:
        generator = np.random.default_rng(table.seed)
        axes = [(axis, self.is_whole(name)) for name, axis in self.axes.items()]
        own = self.settings.items()
        axes += [(axis, SETTINGS[name].whole) for name, axis in own]
        for start in range(0, table.count, DRAWN_AT_ONCE):
            drawn: list[list[Any]] = []
            for axis, whole in axes:
                if isinstance(axis, Axis):
                    drawn.append(axis.draw(generator, whole=whole))
                else:
                    drawn.append(generator.choice(axis, DRAWN_AT_ONCE).tolist())
            left = table.count - start
            yield from itertools.islice(zip(*drawn, strict=True), left)


def every(axis: Values) -> Sequence[Value]:
    """Return the values of an axis in order."""
    return axis.every() if isinstance(axis, Axis) else axis


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
