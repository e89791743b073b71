"""Fragility: how many of many records of the ground bring a structure down, by amplitude.

Each record is scaled to each amplitude, and asked about as `check` does. What that leaves
`undecided` is counted by itself: the share that falls lies between without and with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Unpack

import numpy as np

from blocksim.ask.check import check
from blocksim.ask.options import Asked, Options, problem_of, taken
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import AMPLITUDE, Shaking
from blocksim.common.checks import require
from blocksim.common.progress import silent
from blocksim.simulation.verdict import Verdict

MOST = 10_000
"""Questions at once: each takes about a second and more."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fragility:
    """Which records bring a structure down, at which amplitudes.

    Parameters
    ----------
    problem : Problem
    records : tuple of str
        Their names.
    amplitudes : (amplitudes,) float
        [g]
    verdicts : tuple of tuple of Verdict
        For each record, those at each amplitude.
    """

    problem: Problem
    records: tuple[str, ...]
    amplitudes: Array
    verdicts: tuple[tuple[Verdict, ...], ...]

    def share(self, verdict: Verdict) -> Array:
        """Return the share of records that end so at each amplitude, shape (amplitudes,)."""
        counted = [[each is verdict for each in row] for row in self.verdicts]
        return np.mean(counted, axis=0)


def fragility(
    asked: Asked,
    records: Mapping[str, Shaking],
    amplitudes: Sequence[float],
    **options: Unpack[Options],
) -> Fragility:
    """Find the share of records that bring a structure down, amplitude by amplitude.

    Parameters
    ----------
    asked : Problem, or a maker of one
        In the plane.
    records : mapping of str to Shaking
        By name.
    amplitudes : sequence of float
        Largest accelerations across to which each record is scaled [g], growing.
    **options
        `method`, `settings`, `progress` (`blocksim.ask.options.Options`).

    Raises
    ------
    InputError
        If there are none or too many, amplitudes do not grow, or the method knows no ground
        that shakes.

    Examples
    --------
    >>> from blocksim import Column
    >>> from blocksim.blocks.shaking import table_of
    >>> record = table_of(np.array([0.0, 0.1]), np.array([0.3, 0.3]))
    >>> found = fragility(Column(friction=2.0, drums=1), {"pulse": record}, [0.01])
    >>> found.share(Verdict.STANDS).tolist()
    [1.0]
    """
    given, problem = taken(options, "reduce", "tol", "confirm"), problem_of(asked)
    progress = given.progress
    questions = len(records) * len(amplitudes)
    allowed = f"1 to {MOST}, as there are records times amplitudes"
    require(1 <= questions <= MOST, "questions", questions, allowed)
    # The farthest first.
    for each in sorted(amplitudes, key=abs, reverse=True):
        AMPLITUDE.require("amplitudes", each)
    grow = all(low < high for low, high in pairwise(amplitudes))
    require(grow, "amplitudes", list(amplitudes), "growing")
    options = {"method": given.method, "settings": given.settings, "progress": silent}
    verdicts = list[tuple[Verdict, ...]]()
    for name, record in records.items():
        row = list[Verdict]()
        for amplitude in amplitudes:
            done = len(verdicts) * len(amplitudes) + len(row)
            progress(done / questions, f"{name} at {amplitude:g} g")
            shaken = replace(problem, shaking=replace(record, amplitude=amplitude))
            row.append(check(shaken, **options).verdict)
        verdicts.append(tuple(row))
    return Fragility(
        problem=problem,
        records=tuple(records),
        amplitudes=np.array(amplitudes, dtype=float),
        verdicts=tuple(verdicts),
    )
