"""Fragility: how many of many records of the ground bring a structure down, by amplitude.

Each record is scaled to each amplitude, and asked about as `check` does, by a sweep: by several
processes, and what is in its folder is not asked again. What that leaves `undecided` is counted
by itself: the share that falls lies between without and with it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import pairwise
from tempfile import TemporaryDirectory
from typing import Unpack

import numpy as np

from blocksim.ask.methods import choose
from blocksim.ask.options import Asked, Options, problem_of, taken
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.record import from_record, to_record
from blocksim.blocks.shaking import AMPLITUDE, Shaking
from blocksim.common.checks import require
from blocksim.common.files import AnyPath
from blocksim.common.progress import Progress
from blocksim.engines.base import Method
from blocksim.simulation.verdict import Verdict
from blocksim.sweeps.answers import version_of
from blocksim.sweeps.case import Case, Overrides
from blocksim.sweeps.run import sweep
from blocksim.sweeps.shards import read_rows

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


class Recorded(Case):
    """A case whose problem is all in `rest`, as a record, and shakes with `amplitude_g`."""

    def problem(self, eta: float | None = None) -> Problem:  # noqa: ARG002 - of arches only
        """Return the problem, scaled to the amplitude."""
        found: Problem = from_record(json.loads(self.rest))
        assert found.shaking is not None  # noqa: S101
        amplitude = float(dict(self.given)["amplitude_g"])
        return replace(found, shaking=replace(found.shaking, amplitude=amplitude))


def scaled(
    problems: Iterable[Problem], amplitudes: Sequence[float], engine: str, settings: Overrides
) -> list[Recorded]:
    """Return cases of every problem, shaken by a record each, at every amplitude [g]."""
    return [
        Recorded(
            problem.title or "structure",
            (("mu", problem.mu), ("amplitude_g", float(amplitude))),
            engine,
            rest=rest,
            settings=settings,
        )
        for problem in problems
        for rest in [json.dumps(to_record(problem), sort_keys=True)]
        for amplitude in amplitudes
    ]


def fragility(
    asked: Asked,
    records: Mapping[str, Shaking],
    amplitudes: Sequence[float],
    *,
    folder: AnyPath | None = None,
    workers: int = 1,
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
    folder : Path, optional
        For the rows of the sweep, made if need be: what is there is not asked again.
    workers : int
        Number of processes; one is this one.
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
    _require_asked(records, amplitudes)
    problems = tuple(replace(problem, shaking=record) for record in records.values())
    chosen: Method = choose(given.method, problem=problems[0], settings=given.settings)
    overrides = tuple(sorted(given.settings.items()))
    cases = scaled(problems, amplitudes, chosen.name, overrides)
    said = _swept(cases, version_of(chosen.name), folder, workers, given.progress)
    wide = len(amplitudes)
    return Fragility(
        problem=problem,
        records=tuple(records),
        amplitudes=np.array(amplitudes, dtype=float),
        verdicts=tuple(tuple(said[at : at + wide]) for at in range(0, len(said), wide)),
    )


def _swept(
    cases: list[Recorded],
    version: str,
    folder: AnyPath | None,
    workers: int,
    progress: Progress,
) -> list[Verdict]:
    """Ask about all cases, and return their verdicts."""
    with ExitStack() as stack:
        alone = stack.enter_context(ThreadPoolExecutor(1)) if workers == 1 else None
        kept = folder or stack.enter_context(TemporaryDirectory())
        sweep(cases, kept, executor=alone, workers=workers, progress=progress)
        found = {str(row["id"]): row["verdict"] for row in read_rows(kept)}
    # What no process could answer has no verdict.
    return [Verdict(found[each.identity(version).hex()] or Verdict.UNDECIDED) for each in cases]


def _require_asked(records: Mapping[str, Shaking], amplitudes: Sequence[float]) -> None:
    """Raise `InputError` unless there are some and not too many, and amplitudes grow."""
    questions = len(records) * len(amplitudes)
    allowed = f"1 to {MOST}, as there are records times amplitudes"
    require(1 <= questions <= MOST, "questions", questions, allowed)
    # The farthest first.
    for each in sorted(amplitudes, key=abs, reverse=True):
        AMPLITUDE.require("amplitudes", each)
    grow = all(low < high for low, high in pairwise(amplitudes))
    require(grow, "amplitudes", list(amplitudes), "growing")
