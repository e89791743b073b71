"""Processes that work for this one, and end with it."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from typing import ParamSpec, Self, TypeVar

from blocksim.common.interrupts import KeptBack

Asked = ParamSpec("Asked")
Found = TypeVar("Found")
Job = TypeVar("Job")


class Hands:
    """The executor given, or processes: started at the first work, and anew if one dies.

    To be used as a context: processes end after their work, or at once where it is left by an
    exception.
    """

    def __init__(self, workers: int, given: Executor | None = None) -> None:
        self._workers, self._given = workers, given
        self._own: ProcessPoolExecutor | None = None
        self._others = set[object]()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, broken_off: type[BaseException] | None, *_: object) -> None:
        if self._own is None:
            return
        if broken_off:
            for child in active_children():
                if child not in self._others:
                    child.terminate()
        # Waited for: a pool that breaks while Python ends may say so.
        self._own.shutdown(cancel_futures=bool(broken_off))

    def submit(
        self, fn: Callable[Asked, Found], /, *args: Asked.args, **kwargs: Asked.kwargs
    ) -> Future[Found]:
        """Hand out work, for which a process may be started."""
        if self._given is not None:
            return self._given.submit(fn, *args, **kwargs)
        if self._own is None:
            self._others = set(active_children())
            # spawn: engines are libraries with state of their own, which fork would share.
            context = get_context("spawn")
            self._own = ProcessPoolExecutor(self._workers, context, initializer=_begin)
        with _undisturbed():
            return self._own.submit(fn, *args, **kwargs)

    def renew(self) -> bool:
        """Replace broken processes; an executor given is not ours to replace."""
        if self._own is not None:
            self._own.shutdown(wait=False, cancel_futures=True)
            self._own = None
        return self._given is None


def done(
    ask: Callable[[Job], Found], jobs: Sequence[Job], workers: int
) -> Iterator[tuple[int, Found]]:
    """Do jobs by so many processes, one is this one; give the place and result of each."""
    if workers == 1:
        yield from enumerate(map(ask, jobs))
        return
    with Hands(workers) as hands:
        places = {hands.submit(ask, job): at for at, job in enumerate(jobs)}
        for future in as_completed(places):
            yield places[future], future.result()


@contextmanager
def _undisturbed() -> Generator[None]:
    """Keep Ctrl-C from what is started inside, for good, and from starting half of it.

    A terminal sends it to all processes; only this one answers, and ends the others. A
    process being started would print a traceback.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    with KeptBack():
        # A process that is started inherits what is blocked.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """See that a worker ends with its parent, and is ended by nobody else's Ctrl-C.

    It would wait for work for ever after a kill of its parent.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=lambda: (parent.join(), os._exit(1)), daemon=True).start()
