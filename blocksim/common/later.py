"""What is loaded when it is first used, so that no command waits for what it does not need."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from blocksim.common import interrupts
from blocksim.common.errors import InputError, MissingPart

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

Thing = TypeVar("Thing")


class Later(Mapping[str, Thing]):
    """Things by name, each made when it is first asked for; their names are known before.

    Parameters
    ----------
    makers : mapping of str to callable
    beyond : mapping, optional
        Further things, asked only for names that `makers` has not, and where all are listed.

    Attributes
    ----------
    shipped : tuple of str
        Names of `makers`.
    """

    def __init__(
        self,
        makers: Mapping[str, Callable[[], Thing]],
        beyond: Mapping[str, Thing] | None = None,
    ) -> None:
        self._makers = dict(makers)
        self._made: dict[str, Thing] = {}
        self._beyond: Mapping[str, Thing] = {} if beyond is None else beyond
        self.shipped = tuple(makers)

    def __getitem__(self, name: str) -> Thing:
        """Return what has that name."""
        if name not in self._makers:
            return self._beyond[name]
        if name not in self._made:
            # An interrupt in the middle of an import may be swallowed there.
            with interrupts.KeptBack():
                self._made[name] = self._makers[name]()
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        """Tell whether there is a thing of that name, without making it."""
        return name in self._makers or name in self._beyond

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        yield from self._makers
        yield from (name for name in self._beyond if name not in self._makers)

    def __len__(self) -> int:
        """Count the names."""
        return sum(1 for _ in self)


class Installed(Mapping[str, Thing], Generic[Thing]):
    """What other packages offer under an entry point group, by name.

    Packages are looked through when a name is first asked for, which takes tens of
    milliseconds; what they offer is loaded when it is asked for itself.

    Parameters
    ----------
    group : str
        As `blocksim.engines`.
    """

    def __init__(self, group: str) -> None:
        self.group = group

    @cached_property
    def _points(self) -> dict[str, EntryPoint]:
        from importlib.metadata import entry_points

        return {point.name: point for point in entry_points(group=self.group)}

    def __getitem__(self, name: str) -> Thing:
        """Load what has that name.

        Raises
        ------
        InputError
            If it cannot be loaded.
        """
        point = self._points[name]
        return loaded(self.group, point.value)

    def __contains__(self, name: object) -> bool:
        """Tell whether a package offers that name, without loading it."""
        return name in self._points

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        return iter(self._points)

    def __len__(self) -> int:
        """Count the names."""
        return len(self._points)


def loaded(what: str, place: str) -> Any:
    """Return what a module has at a place.

    Parameters
    ----------
    what : str
        What is looked for, as errors name it.
    place : str
        ``module:NAME``.

    Raises
    ------
    InputError
        If the module cannot be imported, or has no such name.
    """
    module, _, name = place.partition(":")
    try:
        with interrupts.KeptBack():
            return getattr(import_module(module), name)
    except Exception as error:
        # Whatever code of others raises is told in one line.
        why = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(what, place, f"MODULE:NAME that can be loaded ({why})") from error


def loaded_here(what: str, place: str) -> Any:
    """Return what a module has at a place, as `loaded`, one in the working directory, too."""
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.append(here)
    return loaded(what, place)


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
