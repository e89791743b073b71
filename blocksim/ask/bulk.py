"""Many structures, asked one after the other whether they stand, on all processors.

For who filters or labels scenes that a program made. What is asked is limit analysis. Forces
and margins of stacks and of towers follow from statics alone (`limit.determinate`); else, and
near 0, the ordinary check decides. Answers in the plane are proved.
"""

from __future__ import annotations

import math
import os
import threading
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Future
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from queue import Empty, Queue
from typing import Any, Literal

from blocksim.ask.check import check
from blocksim.blocks.problem import Problem
from blocksim.common.errors import BlocksimError, InputError, in_line
from blocksim.common.processes import Hands
from blocksim.kinds.changes import with_friction
from blocksim.kinds.files import AS_DRAWN, is_drawing, load_structure, structure_of, written
from blocksim.kinds.offers import offers_of
from blocksim.limit.determinate import margin_of_tower, statics_of_stack
from blocksim.limit.exact import Exact
from blocksim.limit.proof import proof_of_parting, proof_of_rest
from blocksim.reading.asked import Reading

Structure = str | bytes | Path | Mapping[str, object] | Problem[Any]
"""A line of JSON, a file, what such a file says, or a problem."""
NEAR = 1e-6
"""Margin up to which the ordinary check decides."""
FARTHEST = 100.0
"""How far below 0 a margin is told by statics alone: from there on programmes stop counting."""
ALONE = 40
"""Structures that are answered before processes are started."""
BATCH = 32
"""Structures that a process is handed at once."""
AHEAD = 4
"""Batches that are read ahead, and handed out for each process."""
LARGEST = 20_000_000
"""Bytes of a line."""


@dataclass(frozen=True, kw_only=True)
class Told:
    """What was found of one structure of many.

    Parameters
    ----------
    verdict : {"stands", "collapses", "undecided"} or None
        None where there is an error.
    margin : float or None
        As of `blocksim.check`: above 0 it stands, below it falls. In the plane the least part
        of a force along an edge of a cone of friction, over what its joint carries, about;
        in space how hard each corner of each face presses, over the share of the lighter
        block's weight. At most 1; -inf where no forces would do. None of kinds without one.
    proved : bool
        Whether the verdict is proved in rational numbers, as of `check`; those of towers in
        space are told without.
    title : str
        What the structure is called.
    error : str or None
        What is wrong with it, in one line.
    """

    verdict: Literal["stands", "collapses", "undecided"] | None = None
    margin: float | None = None
    proved: bool = False
    title: str = ""
    error: str | None = None


@dataclass(frozen=True, kw_only=True)
class _How:
    """How files and lines are read; as of `check_many`."""

    friction: float | None
    reading: Reading
    tolerance: float | None


def check_many(
    structures: Iterable[Structure],
    *,
    friction: float | None = None,
    reading: Reading = AS_DRAWN,
    tolerance: float | None = None,
    workers: int | None = None,
) -> Iterator[Told]:
    """Tell of many structures whether they stand, by limit analysis, in their order.

    What is wrong with one is its answer, and those after it are answered nevertheless. They
    are read as they are needed, and a bounded number is held at once.

    Parameters
    ----------
    structures : iterable
        Lines of JSON, paths of files, what structure files say as dicts, or problems.
    friction : float, optional
        Coefficient of those that have none of their own.
    reading : Reading
        Unit and layers of drawings and meshes among files.
    tolerance : float, optional
        Gaps and overlaps of these up to which they are closed [m].
    workers : int, optional
        Processes; by default one a processor, started after the first 40 structures. A program
        that asks for more than that has to guard its main module, as `multiprocessing` says.

    Yields
    ------
    Told

    Examples
    --------
    >>> floor = {"id": 0, "fixed": True, "vertices": [[-2, -1], [2, -1], [2, 0], [-2, 0]]}
    >>> box = {"id": 1, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}
    >>> for told in check_many([{"friction": 0.5, "blocks": [floor, box]}, "no JSON"]):
    ...     print(told.verdict, told.margin, told.error is None)
    stands 0.125 True
    None None False
    """
    each = iter(structures)
    batches = iter(lambda: tuple(islice(each, BATCH)), ())
    yield from check_batches(
        batches, friction=friction, reading=reading, tolerance=tolerance, workers=workers
    )


def check_batches(
    batches: Iterable[Iterable[Structure]],
    *,
    friction: float | None = None,
    reading: Reading = AS_DRAWN,
    tolerance: float | None = None,
    workers: int | None = None,
) -> Iterator[Told]:
    """Tell of many structures whether they stand; see `check_many`.

    `batches`: Structures; each batch is answered as soon as it is there, as by `check_many`.
    `friction`, `reading`, `tolerance`, `workers`: As of `check_many`.
    """
    count = workers or os.cpu_count() or 1
    how = _How(friction=friction, reading=reading, tolerance=tolerance)
    handed = deque[tuple[tuple[Structure, ...], Future[list[Told]]]]()
    with Hands(count) as hands, closing(_Coming(batches)) as coming:
        pool = _Pool(count, hands)
        while coming.more or handed:
            while coming.more and len(handed) < AHEAD * count:
                batch = coming.next(wait=not handed)
                if batch is None:
                    break
                handed.append((batch, pool.submit(batch, how)))
            if not handed:
                continue
            batch, found = handed.popleft()
            try:
                yield from found.result()
            except BrokenExecutor:
                yield from _one_by_one(batch, how)


class _Coming:
    """Batches read by a thread: answers are given while the next is waited for."""

    def __init__(self, batches: Iterable[Iterable[Structure]]) -> None:
        self.more, self._ended = True, threading.Event()
        self._queue: Queue[tuple[Structure, ...] | BaseException | None] = Queue(AHEAD)
        threading.Thread(target=self._read, args=(batches,), daemon=True).start()

    def _read(self, batches: Iterable[Iterable[Structure]]) -> None:
        last: BaseException | None = None
        try:
            for batch in batches:
                self._queue.put(tuple(batch))
                if self._ended.is_set():
                    return
        except BaseException as error:
            last = error
        self._queue.put(last)

    def next(self, *, wait: bool) -> tuple[Structure, ...] | None:
        """Return the next batch; None where there is none yet, or no more."""
        try:
            found = self._queue.get(block=wait)
        except Empty:
            return None
        if isinstance(found, BaseException):
            raise found
        self.more = found is not None
        return found

    def close(self) -> None:
        """Read no more."""
        self._ended.set()
        with suppress(Empty):
            while True:
                self._queue.get_nowait()


class _Pool:
    """Processes that are started once more than a few structures came."""

    def __init__(self, count: int, hands: Hands) -> None:
        self._count, self._seen, self._hands = count, 0, hands

    def submit(self, batch: tuple[Structure, ...], how: _How) -> Future[list[Told]]:
        """Hand out a batch, or answer it here."""
        self._seen += len(batch)
        if self._count == 1 or self._seen <= ALONE:
            done = Future[list[Told]]()
            done.set_result(_answered(batch, how))
            return done
        try:
            return self._hands.submit(_answered, batch, how)
        except BrokenExecutor:
            self._hands.renew()
            return self._hands.submit(_answered, batch, how)


def _one_by_one(batch: tuple[Structure, ...], how: _How) -> Iterator[Told]:
    """Answer structures in a process of their own, which may die of one."""
    with Hands(1) as own:
        for each in batch:
            try:
                yield own.submit(_told, each, how).result()
            except BrokenExecutor:
                yield Told(error="the process that answered it died: is there enough memory?")
                own.renew()


def _answered(batch: tuple[Structure, ...], how: _How) -> list[Told]:
    return [_told(each, how) for each in batch]


def _told(structure: Structure, how: _How) -> Told:
    """Answer one structure; what is wrong with it is its answer."""
    try:
        problem = _read(structure, how)
        return replace(_answer(problem), title=problem.title)
    except BlocksimError as error:
        return Told(error=str(error))
    except (ValueError, RecursionError, MemoryError) as error:
        return Told(error=in_line(" ".join(str(error).split()) or type(error).__name__))


def _read(structure: Structure, how: _How) -> Problem[Any]:
    """Make a problem of a line, a file, or what one says."""
    if isinstance(structure, Problem):
        return structure
    if isinstance(structure, Path):
        drawn = is_drawing(structure)
        return load_structure(
            structure,
            friction=how.friction,
            tolerance=how.tolerance if drawn else None,
            reading=how.reading if drawn else AS_DRAWN,
        )
    if isinstance(structure, str | bytes):
        text = structure.encode() if isinstance(structure, str) else structure
        if len(text) > LARGEST:
            raise InputError("line", f"{len(text)} bytes", f"at most {LARGEST} bytes")
        try:
            said = written(text, "JSON")
        except InputError:
            raise
        except (ValueError, RecursionError) as error:
            words = " ".join(str(error).split())
            raise InputError("line", words, "one JSON object in a line") from None
    else:
        said = structure
    return structure_of(said if how.friction is None else with_friction(said, how.friction))


def _answer(problem: Problem[Any]) -> Told:
    """Tell what statics alone shows to be so, else what the ordinary check does."""
    if problem.in_space:
        margin = margin_of_tower(problem)
        if margin is not None and abs(margin) > NEAR:
            return Told(verdict="stands" if margin > 0 else "collapses", margin=margin)
    elif problem.has_statics and problem.strength is None and offers_of(problem) is None:
        stack = statics_of_stack(problem)
        if stack is not None and abs(stack.margin) > NEAR and stack.margin > -FARTHEST:
            exact = Exact(problem)
            if stack.margin > 0:
                proof = proof_of_rest(exact, stack.forces)
            else:
                proof = proof_of_parting(exact, stack.weakest, stack.above, stack.way)
            if proof is not None:
                return Told(verdict=proof.claim, margin=stack.margin, proved=True)
    answer = check(problem, method="limit")
    margin = math.nan if answer.static is None else answer.static.margin
    known = None if math.isnan(margin) else margin
    return Told(verdict=answer.verdict.value, margin=known, proved=answer.proved)
