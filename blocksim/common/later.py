"""What is loaded when it is first used, so that no command waits for what it does not need."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeVar

from blocksim.common import interrupts
from blocksim.common.errors import MissingPart

Thing = TypeVar("Thing")


class Later(Mapping[str, Thing]):
    """Things by name, each made when it is first asked for; their names are known before.

    Parameters
    ----------
    makers : mapping of str to callable
    """

    def __init__(self, makers: Mapping[str, Callable[[], Thing]]) -> None:
        self._makers = dict(makers)
        self._made: dict[str, Thing] = {}

    def __getitem__(self, name: str) -> Thing:
        """Return what has that name."""
        if name not in self._made:
            # An interrupt in the middle of an import may be swallowed there.
            with interrupts.KeptBack():
                self._made[name] = self._makers[name]()
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        """Tell whether there is a thing of that name, without making it."""
        return name in self._makers

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        return iter(self._makers)

    def __len__(self) -> int:
        """Count the names."""
        return len(self._makers)


def require_library(library: str, part: str, extra: str) -> None:
    """Raise `MissingPart` unless a library of an extra of blocksim is installed.

    Parameters
    ----------
    library : str
        As it is imported.
    part : str
        What needs it.
    extra : str
        What brings it.
    """
    if find_spec(library) is None:
        raise MissingPart(part, f"pip install 'blocksim[{extra}]'")


class Library:
    """A library that is imported when it is first used.

    Engines can be listed where their libraries are not installed, and nobody waits for what
    is not needed.

    Parameters
    ----------
    name : str
    quiet : bool
        Whether to keep what it writes to standard error on import from the terminal.
    """

    def __init__(self, name: str, *, quiet: bool = False) -> None:
        self._name, self._quiet = name, quiet

    def __getattr__(self, name: str) -> Any:
        """Import the library, and keep what was asked for."""
        with interrupts.KeptBack(), _silence() if self._quiet else nullcontext():
            found = getattr(import_module(self._name), name)
        setattr(self, name, found)
        return found


@contextmanager
def _silence() -> Generator[None]:
    """Keep what a C library writes to standard error from the terminal."""
    sys.stderr.flush()
    kept = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    os.close(nowhere)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
