"""What is loaded when it is first used, so that no command waits for what it does not need."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from functools import cached_property, partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from blocksim.common import interrupts
from blocksim.common.errors import InputError, MissingPart

Thing = TypeVar("Thing")
Makers = Mapping[str, Callable[[], Thing]]


class Later(Mapping[str, Thing]):
    """Things by name, each made when it is first asked for; their names are known before.

    `beyond`: Further things, asked only for names that `makers` has not, and where all are
        listed.

    It has:
    `shipped`: Names of `makers` that are known from the start.
    """

    def __init__(
        self,
        makers: Makers[Thing] | Callable[[], Makers[Thing]],
        beyond: Mapping[str, Thing] | None = None,
    ) -> None:
        self._given = makers
        self._made: dict[str, Thing] = {}
        self._beyond: Mapping[str, Thing] = {} if beyond is None else beyond
        self.shipped: tuple[str, ...] = () if callable(makers) else tuple(makers)

    @cached_property
    def _makers(self) -> Makers[Thing]:
        return self._given() if callable(self._given) else self._given

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


class Installed(Later[Thing]):
    """What other packages offer under an entry point group, by name.

    Packages are looked through when a name is first asked for, which takes tens of
    milliseconds; what they offer is loaded when it is asked for itself.

    `group`: As `blocksim.engines`.
    """

    def __init__(self, group: str) -> None:
        def points() -> dict[str, Callable[[], Thing]]:
            from importlib.metadata import entry_points

            found = entry_points(group=group)
            return {point.name: partial(loaded, group, point.value) for point in found}

        super().__init__(points)


def loaded(what: str, place: str) -> Any:
    """Return what a module has at a place.

    `what`: What is looked for, as errors name it.
    `place`: ``module:NAME``.
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

    `library`: As it is imported.
    `part`: What needs it.
    `extra`: What brings it.
    """
    if find_spec(library) is None:
        raise MissingPart(part, f"pip install 'blocksim[{extra}]'")


class Library:
    """A library that is imported when it is first used.

    Engines can be listed where their libraries are not installed, and nobody waits for what
    is not needed.

    `quiet`: Whether to keep what it writes to standard error on import from the terminal.
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


if TYPE_CHECKING:
    import flint as flint
    from scipy import linalg as linalg
    from scipy import optimize as optimize
    from scipy import sparse as sparse
    from scipy.optimize import elementwise as elementwise
    from scipy.sparse import csgraph as csgraph
    from scipy.sparse import linalg as sparse_linalg  # pyright: ignore[reportUnusedImport]
    from scipy.spatial import transform as transform
else:
    flint, elementwise = Library("flint"), Library("scipy.optimize.elementwise")
    linalg, optimize = Library("scipy.linalg"), Library("scipy.optimize")
    sparse, csgraph = Library("scipy.sparse"), Library("scipy.sparse.csgraph")
    sparse_linalg = Library("scipy.sparse.linalg")
    transform = Library("scipy.spatial.transform")
