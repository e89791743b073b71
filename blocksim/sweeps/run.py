"""A sweep: cases to an executor, a bounded number in flight, rows to disk as they come."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from blocksim.ask.methods import STATIC
from blocksim.common.checks import require
from blocksim.common.errors import MissingPart
from blocksim.common.files import AnyPath, make_folder
from blocksim.common.processes import Hands
from blocksim.common.progress import Progress, silent
from blocksim.sweeps.answers import (
    Answered,
    Asked,
    Tally,
    answer,
    failed,
    reason_of,
    version_of,
)
from blocksim.sweeps.case import Case, Pace
from blocksim.sweeps.design import Design
from blocksim.sweeps.load import design_of, load_design
from blocksim.sweeps.shards import identities, locked, write_shard

SHARE = 0.05
"""Time a chunk is meant to take, as a share of that gone by: what a kill loses is small."""
SHORTEST, LONGEST = 0.2, 10.0
"""Bounds of that time [s]."""
LARGEST_CHUNK = 20_000
STATIC_SECONDS = 1e-4
"""First guess of the time of a static case; that of an engine is a whole chunk's."""

Chunk = list[Asked]
Questions = Design | AnyPath | Mapping[str, Any] | Sequence[Case]
"""A design, its file or what such a file says, or cases."""


@dataclass(frozen=True, kw_only=True)
class Summary:
    """The result of a sweep.

    Parameters
    ----------
    cases : int
        In the design, those that occur twice counted once.
    found : int
        Of those, rows that were there already.
    tally : Tally
        Of the rows made now.
    wall_s : float
    """

    cases: int
    found: int
    tally: Tally
    wall_s: float

    @property
    def saved_s(self) -> float | None:
        """About how long it would have taken to simulate the spared arches, too [s].

        Each is taken to cost the mean of those simulated; None where none was.
        """
        if not self.tally.simulated:
            return None
        return self.tally.spared * self.tally.simulated_s / self.tally.simulated


def sweep(
    design: Questions,
    folder: AnyPath,
    *,
    executor: Executor | None = None,
    workers: int = 2,
    in_flight: int | None = None,
    progress: Progress = silent,
) -> Summary:
    """Ask about many structures. Rows that are there already are not asked for again.

    Parameters
    ----------
    design : Design, path, mapping or sequence of Case
        What to ask: a design, its file, what such a file says, or cases.
    folder : Path
        For the rows, made if need be; `read_rows` reads them.
    executor : Executor, optional
        Runs the work; by default processes of this machine, replaced where one dies.
    workers : int
        Number of processes, where there is no executor.
    in_flight : int, optional
        Chunks handed out at once, at least one a worker; by default two.
    progress : Progress, optional

    Returns
    -------
    Summary

    Raises
    ------
    InputError, MachineError
        If the folder cannot be written, holds something else, or another sweep uses it.
    MissingPart
        If an engine is not installed, here or at a worker.
    BrokenExecutor
        If the executor given breaks; what is done is on disk.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> from tempfile import mkdtemp
    >>> asked = {"kind": "column", "width": [0.5, 1.0], "mu": 0.7, "method": "limit"}
    >>> with ThreadPoolExecutor(1) as executor:
    ...     sweep(asked, mkdtemp(), executor=executor).cases
    2
    """
    started, todo = time.perf_counter(), _Todo(design)
    require(workers >= 1, "workers", workers, "at least 1")
    require(in_flight is None or in_flight >= 1, "in_flight", in_flight, "at least 1")
    make_folder(folder := Path(folder))
    with locked(folder), Hands(workers, executor) as hands:
        todo.done = identities(folder)
        tally = _answered(todo, folder, hands, in_flight or 2 * workers, progress)
    return Summary(
        cases=todo.found + tally.rows,
        found=todo.found,
        tally=tally,
        wall_s=time.perf_counter() - started,
    )


def _answered(todo: _Todo, folder: Path, hands: Hands, many: int, progress: Progress) -> Tally:
    """Answer all cases and write their rows."""
    tally, started = Tally(), time.perf_counter()
    progress(0.0, "")

    def keep(answered: Answered) -> None:
        write_shard(folder, answered.lines)
        tally.add(answered.tally)
        todo.learn(answered)
        rate = tally.rows / (time.perf_counter() - started)
        said = f"{tally.rows} rows, {rate:.3g} a second"
        progress((todo.found + tally.rows) / todo.size, said)

    _work(todo, hands, many, keep)
    return tally


class _Todo:
    """Cases still to be answered, in chunks sized by the time they take.

    `size`: Cases in all.
    `versions`: Of the methods that are asked.
    `done`: Cases whose rows are there.
    `found`: Of those, how many were passed over.
    """

    def __init__(self, design: Questions) -> None:
        if isinstance(design, str | os.PathLike):
            design = load_design(design)
        elif isinstance(design, Mapping):
            design = design_of(design)
        if isinstance(design, Design):
            self._cases, self.size, methods = design.cases(), design.size, {*design.method}
        else:
            self._cases, self.size = iter(design), len(design)
            methods = {case.method for case in design}
        self.versions = {method: version_of(method) for method in methods}
        self.done: set[bytes] = set()
        self._seen: set[bytes] = set()
        self._pace: dict[Pace, tuple[int, float]] = {}
        self._started = time.perf_counter()
        self.found = 0

    def learn(self, answered: Answered) -> None:
        """Note how long cases took."""
        for pace, (count, seconds) in answered.seconds.items():
            before = self._pace.get(pace, (0, 0.0))
            self._pace[pace] = before[0] + count, before[1] + seconds

    def chunk(self) -> Chunk:
        """Return the next cases, none at the end."""
        chunk: Chunk = []
        elapsed = time.perf_counter() - self._started
        left = min(max(elapsed * SHARE, SHORTEST), LONGEST)
        for case in self._cases:
            identity = case.identity(self.versions[case.method])
            if identity in self._seen:
                continue
            self._seen.add(identity)
            if identity in self.done:
                self.found += 1
                continue
            chunk.append(Asked(identity, case))
            left -= self._seconds(case)
            if left <= 0 or len(chunk) >= LARGEST_CHUNK:
                break
        return chunk

    def _seconds(self, case: Case) -> float:
        """Time a case will take, by those of its pace so far."""
        count, seconds = self._pace.get(case.pace, (0, 0.0))
        if count:
            return seconds / count
        return STATIC_SECONDS if case.method in STATIC else LONGEST


def _work(todo: _Todo, hands: Hands, many: int, keep: Callable[[Answered], None]) -> None:
    """Hand out so many chunks at once and keep what comes back, until there are no more.

    A chunk that fails is halved until the case at fault is alone, which becomes a row.
    Where a process dies, any chunk in flight may be the cause: they go again, one by one.
    """
    pending: dict[Future[Answered], Chunk] = {}
    again: deque[Chunk] = deque()
    suspects: deque[Chunk] = deque()

    def give_up(chunk: Chunk, why: str, others: deque[Chunk]) -> None:
        if len(chunk) == 1:
            keep(failed(chunk[0], todo.versions, why))
        else:
            middle = len(chunk) // 2
            others.extend((chunk[:middle], chunk[middle:]))

    while True:
        alone = bool(suspects)
        try:
            while len(pending) < (1 if alone else many):
                queue = suspects if alone else again
                chunk = queue.popleft() if queue else [] if alone else todo.chunk()
                if not chunk:
                    break
                try:
                    pending[hands.submit(answer, chunk, todo.versions)] = chunk
                except BrokenExecutor:
                    queue.appendleft(chunk)
                    raise
            if not pending:
                return
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                chunk = pending[future]
                try:
                    answered = future.result()
                except (BrokenExecutor, MissingPart):
                    raise
                except Exception as error:
                    give_up(chunk, reason_of(error), again)
                else:
                    keep(answered)
                del pending[future]
        except BrokenExecutor:
            if not hands.renew():
                raise
            chunks = list(pending.values())
            pending.clear()
            if alone and chunks:
                give_up(chunks[0], "its process died, twice", suspects)
            else:
                suspects.extend(chunks)
