"""What is installed, what each method can do here, and what it rests on.

References are those of `blocksim/references.bib`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.resources import files

from blocksim.ask.methods import METHODS
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.version import __version__
from blocksim.engines import get_engine


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One method on this machine.

    `finest`: Smallest relative width of a bracket it can answer for.
    `remedy`: How to get what is missing; None where it can run.
    `version`: Of its library, or of blocksim where it is blocksim's own.
    """

    method: str
    sees: str
    finest: float
    remedy: str | None
    version: str | None


def examine() -> Iterator[Finding]:
    """Look at every method of the ladder; an engine of others may be beyond loading."""
    for name in METHODS:
        try:
            method = METHODS[name]
        except InputError as error:
            yield Finding(method=name, sees="", finest=0.0, remedy=str(error), version=None)
            continue
        found = __version__
        if not method.is_static:
            found = None if method.missing else get_engine(method.name).version
        yield Finding(
            method=method.name,
            sees=method.sees,
            finest=method.finest,
            remedy=method.missing,
            version=found,
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


def _installed(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None


def cite(*methods: str) -> str:
    """Return BibTeX of blocksim, of the paper, and of what methods rest on.

    Parameters
    ----------
    *methods : str
        `theory`, `limit`, `direct`, `pymunk`, `pybullet` or `mujoco`; or `all`.

    Returns
    -------
    str
        Entries in the order of the file, an empty line between them.

    Raises
    ------
    InputError
        If there is no such method.

    Examples
    --------
    >>> import blocksim
    >>> [line for line in blocksim.cite("mujoco").splitlines() if line[:1] == "@"]
    ['@software{blocksim,', '@article{CocchettiRizzi2024,', '@inproceedings{Todorov2012,']
    """
    for each in methods:
        known = each == "all" or each in METHODS
        require(known, "method", each, f"all, or one of {', '.join(METHODS)}")
    wanted = {*METHODS} if "all" in methods else {*methods}
    text = (files("blocksim") / "references.bib").read_text(encoding="utf-8")
    entries = re.findall(r"^@.*?^\}$", text, flags=re.MULTILINE | re.DOTALL)
    chosen = [each for each in entries if not _of(each) or _of(each) & wanted]
    return "\n\n".join(chosen).replace("VERSION", __version__)


def _of(entry: str) -> set[str]:
    """Return the methods that an entry is cited for."""
    found = re.search(r"keywords\s*=\s*\{([^}]*)\}", entry)
    return {each.strip() for each in found[1].split(",")} if found else set()
