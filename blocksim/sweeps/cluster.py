"""Work handed to a dask cluster; the only place that knows dask."""

from __future__ import annotations

import logging
import re
from collections.abc import Generator
from concurrent.futures import Executor
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

from blocksim.common.checks import require
from blocksim.common.errors import InputError, MissingPart

CONNECT_SECONDS = 60


@contextmanager
def cluster(address: str) -> Generator[tuple[Executor, int]]:
    """Connect to a dask scheduler.

    `address`: As the scheduler prints it, tcp://host:8786.
    Yields `threads`: Of all workers.
    """
    if find_spec("distributed") is None:
        raise MissingPart("dask", "pip install 'blocksim[dask]'")
    from distributed import Client

    # What is left of a connection when it is broken off is told there, by lines of its own.
    for name in ("tornado.application", "distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    # One that is none leaves a client behind that complains when it is collected.
    known = re.fullmatch(r"(tcp://|tls://)?[^\s/]+:\d{1,5}", address) is not None
    require(known, "--scheduler", address, "the address of a dask scheduler, tcp://host:8786")
    try:
        client: Any = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        why = f"the address of a dask scheduler ({str(error) or 'no answer'})"
        raise InputError("--scheduler", address, why) from None
    with client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise InputError("--scheduler", address, "one with workers")
        yield client.get_executor(pure=False), threads
