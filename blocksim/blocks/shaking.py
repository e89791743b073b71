"""Ground that shakes: its acceleration over time.

Blocks are seen from the ground, which moves: it is as if gravity had a part across, against
the acceleration. An engine takes the gain of the ground's velocity over each of its steps, so
that a pulse may begin and end within one.
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array, frozen
from blocksim.common.checks import Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import AnyPath, read_file

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


@dataclass(frozen=True, eq=False, kw_only=True)
class Shaking:
    """Horizontal acceleration of the ground over time, above 0 to the right.

    It begins at rest, as the blocks are let go. After it the ground keeps its velocity.

    Parameters
    ----------
    shape : str
        Of `SHAPES`, or `table`.
    amplitude : float
        Largest acceleration [g].
    duration : float
        [s]
    table : (rows, 2) float
        Times as shares of the duration, from 0 to 1, and accelerations in units of the
        amplitude, with straight lines between; empty for other shapes.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    shape: str
    amplitude: float
    duration: float
    table: Array = field(default_factory=lambda: np.zeros((0, 2)))

    def __post_init__(self) -> None:
        """Check the ranges."""
        known = (*SHAPES, TABLE)
        require(self.shape in known, "shake", self.shape, f"one of {', '.join(known)}")
        AMPLITUDE.require("amplitude", self.amplitude)
        DURATION.require("duration", self.duration)
        object.__setattr__(self, "table", frozen(np.reshape(self.table, (-1, 2)), (-1, 2)))

    def with_amplitude(self, amplitude: float) -> Shaking:
        """Return the same with another largest acceleration [g]."""
        return replace(self, amplitude=amplitude)

    def with_duration(self, duration: float) -> Shaking:
        """Return the same, stretched or shortened in time [s]."""
        return replace(self, duration=duration)

    def gained(self, start: float, end: float) -> float:
        """Return by how much the ground's velocity grows between two times [s], in g s."""
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
        return f"ground shakes: {shape} of {self.amplitude:g} g for {self.duration:g} s"

    def _by(self, time: float) -> float:
        """Velocity gained since the start, over amplitude and duration."""
        share = min(max(time / self.duration, 0.0), 1.0)
        return self._along(share) if self.shape == TABLE else SHAPES[self.shape](share)

    def _along(self, share: float) -> float:
        times, values = self.table.T
        at = int(np.searchsorted(times, share, side="right")) - 1
        if at >= len(times) - 1:
            return float(self._sums[-1])
        step, past = times[at + 1] - times[at], share - times[at]
        slope = (values[at + 1] - values[at]) / step
        return float(self._sums[at] + past * (values[at] + slope * past / 2))

    @cached_property
    def _sums(self) -> Array:
        times, values = self.table.T
        means = (values[1:] + values[:-1]) / 2
        return np.concatenate([[0.0], np.cumsum(means * np.diff(times))])


def table_of(times: Array, accelerations: Array) -> Shaking:
    """Make one of accelerations that are given over time.

    Parameters
    ----------
    times : (rows,) float
        [s]; each after the one before. The first is when the blocks are let go.
    accelerations : (rows,) float
        [g]

    Raises
    ------
    InputError
        If they are no such table.
    """
    enough = 2 <= len(times) <= MOST_ROWS
    require(enough, "times_s", f"{len(times)} rows", f"2 to {MOST_ROWS} rows")
    alike = len(times) == len(accelerations)
    rows = f"{len(accelerations)} rows"
    require(alike, "accelerations_g", rows, f"as many as times_s, {len(times)}")
    known = np.isfinite(times).all() and np.isfinite(accelerations).all()
    require(bool(known), "times_s", "not all are numbers", "finite numbers in every row")
    largest = float(max(np.abs(times).max(), np.abs(accelerations).max()))
    require(largest <= LATEST, "times_s", largest, f"numbers up to {LATEST:g}")
    grows = np.diff(times) > 0
    at = int(np.argmin(grows)) + 1
    later = "each later than the one before"
    require(bool(grows.all()), f"times_s[{at}]", float(times[at]), later)
    amplitude = float(np.abs(accelerations).max())
    values = accelerations / amplitude if amplitude else accelerations
    shares = (times - times[0]) / (times[-1] - times[0])
    return Shaking(
        shape=TABLE,
        amplitude=amplitude,
        duration=float(times[-1] - times[0]),
        table=np.column_stack([shares, values]),
    )


def shaking_of(
    *,
    shape: str | None = None,
    amplitude_g: float | None = None,
    duration_s: float | None = None,
    times_s: Sequence[float] | None = None,
    accelerations_g: Sequence[float] | None = None,
) -> Shaking:
    """Make what `shake` of a structure file says: a shape, or accelerations over time.

    Raises
    ------
    InputError
        If both or neither are given, or a value is out of range.
    """
    pulse = {"shape": shape, "amplitude_g": amplitude_g, "duration_s": duration_s}
    table = {"times_s": times_s, "accelerations_g": accelerations_g}
    given, others = (table, pulse) if times_s is not None else (pulse, table)
    beside = "times_s" if given is table else "shape"
    for name, value in others.items():
        require(value is None, f"shake.{name}", "given", f"left out beside {beside}")
    for name, value in given.items():
        if value is None:
            raise InputError(f"shake.{name}", MISSING, "given")
    try:
        if given is table:
            return table_of(np.array(times_s), np.array(accelerations_g))
        require(shape in SHAPES, "shape", shape, f"one of {', '.join(SHAPES)}")
        return Shaking(
            shape=str(shape), amplitude=amplitude_g or 0.0, duration=duration_s or 0.0
        )
    except InputError as error:
        field = {"amplitude": "amplitude_g", "duration": "duration_s"}.get(error.field)
        field = f"shake.{field or error.field}"
        raise InputError(field, error.value, error.allowed) from None


def shaking_record(shaking: Shaking) -> dict[str, Any]:
    """Return the same as a structure file says it; `shaking_of` reads it back."""
    if shaking.shape == TABLE:
        times, values = shaking.table.T
        return {
            "times_s": (times * shaking.duration).tolist(),
            "accelerations_g": (values * shaking.amplitude).tolist(),
        }
    return {
        "shape": shaking.shape,
        "amplitude_g": shaking.amplitude,
        "duration_s": shaking.duration,
    }


def read_table(path: AnyPath) -> Shaking:
    """Read accelerations of the ground from a CSV file.

    Parameters
    ----------
    path : Path or str
        With a first line `time_s,acceleration_g`.

    Raises
    ------
    InputError
        In one line, if it is no such file.
    """
    read = read_file(path, "shake", "an existing .csv file", LARGEST_FILE)
    where = os.fspath(path)
    try:
        # A spreadsheet may begin its files with a mark of their encoding.
        text = io.StringIO(read.decode("utf-8-sig"), newline=None)
        named = [name.strip() for name in next(text, "")[:200].split(",")]
        right = named == list(COLUMNS)
        require(right, "first line", ",".join(named), ",".join(COLUMNS))
        lines = list(islice(text, MOST_ROWS + 1))
        long = next((each for each in lines if len(each) > LONGEST_LINE), None)
        require(long is None, "line", (long or "")[:40], f"at most {LONGEST_LINE} letters")
        rows = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, 2))
        require(rows.shape[1] == len(COLUMNS), "columns", rows.shape[1], str(len(COLUMNS)))
        return table_of(*rows.T)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=where) from None
    except (ValueError, OverflowError) as error:
        said = " ".join(str(error).partition(";")[0].split())[:200]
        raise InputError("file", said, "a CSV table of numbers", where=where) from None
