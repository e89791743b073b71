"""Processes that work for this one, and end with it."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Generator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from typing import ParamSpec, TypeVar

from blocksim.common.interrupts import KeptBack

Asked = ParamSpec("Asked")
Found = TypeVar("Found")


class Crew(ProcessPoolExecutor):
    """An executor of that many processes, started as they are needed, that can end at once."""

    def __init__(self, count: int) -> None:
        self._others = set(active_children())
        # spawn: engines are libraries with state of their own, which fork would share.
        super().__init__(count, mp_context=get_context("spawn"), initializer=_begin)

    def submit(
        self,
        fn: Callable[Asked, Found],
        /,
        *args: Asked.args,
        **kwargs: Asked.kwargs,
    ) -> Future[Found]:
        """Hand out work, for which a process may be started."""
        with _undisturbed():
            return super().submit(fn, *args, **kwargs)

    def end(self) -> None:
        """End all work, unfinished as it is."""
        for child in set(active_children()) - self._others:
            child.terminate()
        # Waited for: a pool that breaks while Python ends may say so.
        self.shutdown(cancel_futures=True)


class Hands:
    """The executor given, or processes: started at the first work, and anew if one dies."""

    def __init__(self, workers: int, given: Executor | None = None) -> None:
        self._workers, self._given = workers, given
        self._executor = given

    def submit(
        self, fn: Callable[Asked, Found], /, *args: Asked.args, **kwargs: Asked.kwargs
    ) -> Future[Found]:
        """Hand out work."""
        if self._executor is None:
            self._executor = Crew(self._workers)
        return self._executor.submit(fn, *args, **kwargs)

    def renew(self) -> bool:
        """Replace broken processes; an executor given is not ours to replace."""
        if self._given is not None:
            return False
        if self._executor is not None:
            self._executor.shutdown(wait=False, cancel_futures=True)
        self._executor = None
        return True

    def leave(self, *, wait: bool = False) -> None:
        """Let go of processes, after their work or at once."""
        if self._given is not None or self._executor is None:
            return
        if not wait and isinstance(self._executor, Crew):
            self._executor.end()
        else:
            self._executor.shutdown()


@contextmanager
def crew(count: int) -> Generator[Executor]:
    """Lend processes; where the block is left by an exception their work ends at once."""
    executor = Crew(count)
    try:
        yield executor
    except BaseException:
        executor.end()
        raise
    executor.shutdown()


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
