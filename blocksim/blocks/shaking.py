"""Ground that shakes: its acceleration over time.

Blocks are seen from the ground, which moves: it is as if gravity had another part, against
the acceleration. An engine takes the gain of the ground's velocity over each of its steps, so
that a pulse may begin and end within one.
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import Array, frozen
from blocksim.common.checks import Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import same
from blocksim.common.files import AnyPath, read_file

if TYPE_CHECKING:
    from blocksim.blocks.entries import ShakeEntry

SHAPES: dict[str, Callable[[float], float]] = {
    "constant": lambda share: share,
    "half-sine": lambda share: (1 - math.cos(math.pi * share)) / math.pi,
    "full-sine": lambda share: (1 - math.cos(2 * math.pi * share)) / (2 * math.pi),
}
"""Velocity gained in a share of the duration, in units of amplitude times duration."""
PARTS = 20
"""Parts of a pulse in which its acceleration hardly changes."""
TABLE = "table"
"""The shape of an acceleration that is given over time."""
AMPLITUDE = Range(low=0, high=100, unit="g")
DURATION = Range(low=1e-6, high=600, unit="s")
MOST_ROWS, LARGEST_FILE, LONGEST_LINE = 1_000_000, 50_000_000, 200
"""Rows of a table, bytes of its file, and letters of a line."""
LATEST = 1e9
"""Largest number in a table, of either column."""
COLUMNS = ("time_s", "acceleration_g")
UPWARDS = "vertical_g"
"""A third column, which may be left out."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shaking:
    """Acceleration of the ground over time: across, above 0 to the right, and upwards.

    It begins at rest, as the blocks are let go. After it the ground keeps its velocity.

    `shape`: Of `SHAPES`, or `table`.
    `amplitude`: Largest acceleration across [g]; of ground that goes up and down only, upwards.
    `duration`: [s]
    `table`, (rows, 3): Times as shares of the duration, from 0 to 1, and accelerations across
        and upwards in units of the amplitude, with straight lines between; empty for other
        shapes, which are across.
    """

    shape: str
    amplitude: float
    duration: float
    table: Array = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        """Check the ranges."""
        known = (*SHAPES, TABLE)
        require(self.shape in known, "shake", self.shape, f"one of {', '.join(known)}")
        AMPLITUDE.require("amplitude", self.amplitude)
        DURATION.require("duration", self.duration)
        object.__setattr__(self, "table", frozen(self.table, (-1, 3)))

    @property
    def is_vertical(self) -> bool:
        """Whether the ground goes up or down as well."""
        return bool(self.table[:, 2].any())

    @property
    def across(self) -> tuple[float, float]:
        """Least and greatest acceleration across at any time, 0 among them [g]."""
        if self.shape == TABLE:
            shares = (0.0, *self.table[:, 1].tolist())
        else:
            shares = (-1.0, 1.0) if self.shape == "full-sine" else (0.0, 1.0)
        return self.amplitude * min(shares), self.amplitude * max(shares)

    def gained(self, start: float, end: float) -> Array:
        """Return by how much the ground's velocity grows between two times [s], in g s.

        Across and upwards, shape (2,).
        """
        whole = self.amplitude * self.duration
        return whole * (self._by(end) - self._by(start))

    @property
    def spacing(self) -> float:
        """Mean time between the rows of a table, or a share of a pulse's duration [s]."""
        return self.duration / max(len(self.table) - 1, PARTS)

    @property
    def words(self) -> str:
        """All of it in a few words."""
        shape = "a record" if self.shape == TABLE else self.shape.replace("-", " ")
        upwards = ""
        if self.is_vertical:
            most = self.amplitude * float(np.abs(self.table[:, 2]).max())
            upwards = f", up to {most:g} g upwards or down,"
        return (
            f"ground shakes: {shape} of {self.amplitude:g} g{upwards} for {self.duration:g} s"
        )

    def _by(self, time: float) -> Array:
        """Velocity gained since the start, over amplitude and duration, shape (2,)."""
        share = min(max(time / self.duration, 0.0), 1.0)
        if self.shape == TABLE:
            return self._along(share)
        return np.array([SHAPES[self.shape](share), 0.0])

    def _along(self, share: float) -> Array:
        times, values = self.table[:, 0], self.table[:, 1:]
        at = int(np.searchsorted(times, share, side="right")) - 1
        if at >= len(times) - 1:
            return self._sums[-1]
        step, past = times[at + 1] - times[at], share - times[at]
        slope = (values[at + 1] - values[at]) / step
        return self._sums[at] + past * (values[at] + slope * past / 2)

    @cached_property
    def _sums(self) -> Array:
        times, values = self.table[:, 0], self.table[:, 1:]
        means = (values[1:] + values[:-1]) / 2
        gained = np.cumsum(means * np.diff(times)[:, None], axis=0)
        return np.concatenate([np.zeros((1, 2)), gained])


def table_of(times: Array, accelerations: Array, upwards: Array | None = None) -> Shaking:
    """Make one of accelerations that are given over time.

    `times`, (rows,): [s]; each after the one before. The first is when the blocks are let go.
    `accelerations`, (rows,): Across [g].
    `upwards`, (rows,): [g]; by default none.
    """
    enough = 2 <= len(times) <= MOST_ROWS
    require(enough, "times_s", f"{len(times)} rows", f"2 to {MOST_ROWS} rows")
    upwards = np.zeros(len(times)) if upwards is None else upwards
    for name, values in (("accelerations_g", accelerations), ("verticals_g", upwards)):
        alike, rows = len(times) == len(values), f"{len(values)} rows"
        require(alike, name, rows, f"as many as times_s, {len(times)}")
    rows = np.column_stack([times, accelerations, upwards])
    finite = bool(np.isfinite(rows).all())
    require(finite, "times_s", "not all are numbers", "finite numbers in every row")
    largest = float(np.abs(rows).max())
    require(largest <= LATEST, "times_s", largest, f"numbers up to {LATEST:g}")
    grows = np.diff(times) > 0
    at = int(np.argmin(grows)) + 1
    later = "each later than the one before"
    require(bool(grows.all()), f"times_s[{at}]", float(times[at]), later)
    across, up = np.abs(rows[:, 1:]).max(axis=0).tolist()
    amplitude = across or up
    if amplitude:
        rows[:, 1:] /= amplitude
    rows[:, 0] = (times - times[0]) / (times[-1] - times[0])
    duration = float(times[-1] - times[0])
    return Shaking(shape=TABLE, amplitude=amplitude, duration=duration, table=rows)


def shaking_of(said: ShakeEntry) -> Shaking:
    """Make what `shake` of a structure file says: a shape, or accelerations over time."""
    pulse = same(said, "shape", "amplitude_g", "duration_s")
    table = same(said, "times_s", "accelerations_g")
    given, others = (table, pulse) if said.times_s is not None else (pulse, table)
    if given is pulse or said.verticals_g is not None:
        # It may be left out of a table.
        table["verticals_g"] = said.verticals_g
    beside = "times_s" if given is table else "shape"
    for name, value in others.items():
        require(value is None, f"shake.{name}", "given", f"left out beside {beside}")
    for name, value in given.items():
        if value is None:
            raise InputError(f"shake.{name}", MISSING, "given")
    try:
        if given is table:
            return table_of(*(np.array(each, dtype=float) for each in table.values()))
        shape, amplitude, duration = pulse.values()
        require(shape in SHAPES, "shape", shape, f"one of {', '.join(SHAPES)}")
        return Shaking(shape=shape, amplitude=amplitude, duration=duration)
    except InputError as error:
        field = {"amplitude": "amplitude_g", "duration": "duration_s"}.get(error.field)
        field = f"shake.{field or error.field}"
        raise InputError(field, error.value, error.allowed) from None


def shaking_record(shaking: Shaking) -> dict[str, Any]:
    """Return the same as a structure file says it; `shaking_of` reads it back."""
    if shaking.shape == TABLE:
        times, across, upwards = shaking.table.T
        record = {
            "times_s": (times * shaking.duration).tolist(),
            "accelerations_g": (across * shaking.amplitude).tolist(),
        }
        if shaking.is_vertical:
            record["verticals_g"] = (upwards * shaking.amplitude).tolist()
        return record
    return {
        "shape": shaking.shape,
        "amplitude_g": shaking.amplitude,
        "duration_s": shaking.duration,
    }


def read_table(path: AnyPath) -> Shaking:
    """Read accelerations of the ground from a CSV file.

    `path`: With a first line `time_s,acceleration_g`, or `time_s,acceleration_g,vertical_g`.
    """
    read = read_file(path, "shake", "an existing .csv file", LARGEST_FILE)
    where = os.fspath(path)
    try:
        # A spreadsheet may begin its files with a mark of their encoding.
        text = io.StringIO(read.decode("utf-8-sig"), newline=None)
        named = [name.strip() for name in next(text, "")[:200].split(",")]
        wanted = list(COLUMNS) if len(named) <= len(COLUMNS) else [*COLUMNS, UPWARDS]
        require(named == wanted, "first line", ",".join(named), ",".join(wanted))
        lines = list(islice(text, MOST_ROWS + 1))
        long = next((each for each in lines if len(each) > LONGEST_LINE), None)
        require(long is None, "line", (long or "")[:40], f"at most {LONGEST_LINE} letters")
        rows = (
            np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, len(wanted)))
        )
        require(rows.shape[1] == len(wanted), "columns", rows.shape[1], str(len(wanted)))
        return table_of(*rows.T)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=where) from None
    except (ValueError, OverflowError) as error:
        said = " ".join(str(error).partition(";")[0].split())[:200]
        raise InputError("file", said, "a CSV table of numbers", where=where) from None
