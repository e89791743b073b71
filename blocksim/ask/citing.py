"""The references of `blocksim/references.bib`, and which of them a method rests on."""

from __future__ import annotations

import re
from importlib.resources import files

from blocksim.ask.methods import METHODS
from blocksim.common.checks import require
from blocksim.common.version import __version__


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
