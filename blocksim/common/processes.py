"""Processes that work for this one, and end with it."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Generator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process


def processes(count: int) -> ProcessPoolExecutor:
    """Return an executor of that many processes, started as they are needed."""
    # spawn: engines are libraries with state of their own, which fork would share.
    return ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=_begin)


@contextmanager
def crew(count: int) -> Generator[Executor]:
    """Lend processes; where the block is left by an exception their work ends at once."""
    others = set(active_children())
    executor = processes(count)
    try:
        yield executor
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        for child in set(active_children()) - others:
            child.terminate()
        raise
    executor.shutdown()


def _begin() -> None:
    """See that a worker ends with its parent, and without a word where both are interrupted.

    It would wait for work for ever after a kill of its parent.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=lambda: (parent.join(), os._exit(1)), daemon=True).start()
