"""Linear algebra by one thread.

The systems of a step are too small to be shared out: with two threads that of 500 blocks takes
as long as with one where nothing else runs, and a hundred times as long where something does,
as threads wait for each other by turning round.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from functools import cache
from typing import Any


def one_thread(*, wide: bool) -> AbstractContextManager[Any]:
    """Keep BLAS to one thread, where systems are wide enough for it to take more."""
    return _pools().limit(limits=1, user_api="blas") if wide else nullcontext()


@cache
def _pools() -> Any:
    """Find the libraries loaded, once: it takes as long as a step."""
    from threadpoolctl import ThreadpoolController  # pyright: ignore[reportMissingTypeStubs]

    return ThreadpoolController()
