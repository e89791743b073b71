"""What is installed, and what each method can do here."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version

from blocksim.ask.methods import METHODS, Method
from blocksim.common.errors import InputError
from blocksim.common.version import __version__
from blocksim.engines import get_engine


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One method on this machine.

    Parameters
    ----------
    method : str
    sees : str
    finest : float
        Smallest relative width of a bracket it can answer for.
    remedy : str or None
        How to get what is missing; None where it can run.
    version : str or None
        Of its library, or of blocksim where it is blocksim's own.
    """

    method: str
    sees: str
    finest: float
    remedy: str | None
    version: str | None


def examine() -> list[Finding]:
    """Look at every method of the ladder."""
    return [_finding(name) for name in METHODS]


def _finding(name: str) -> Finding:
    """Look at one method; an engine of another package may be beyond loading."""
    try:
        method = METHODS[name]
    except InputError as error:
        return Finding(method=name, sees="", finest=0.0, remedy=str(error), version=None)
    return Finding(
        method=method.name,
        sees=method.sees,
        finest=method.finest,
        remedy=method.missing,
        version=_version(method),
    )


def libraries() -> dict[str, str | None]:
    """Return the versions of the libraries blocksim can use; None where one is not there."""
    try:
        wanted = requires("blocksim") or []
    except PackageNotFoundError:  # run from its source, not installed
        wanted = []
    names = {
        re.split(r"[^\w.-]", each, maxsplit=1)[0]
        for each in wanted
        if not re.search(r"extra *== *['\"](dev|docs|release)", each)
    }
    return {name: _installed(name) for name in sorted(names)}


def _version(method: Method) -> str | None:
    if method.is_static:
        return __version__
    return None if method.missing else get_engine(method.name).version


def _installed(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None
