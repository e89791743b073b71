"""The references of `blocksim/references.bib`, and which of them a method rests on."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.resources import files

from blocksim.common.version import __version__


def references(methods: Sequence[str] = ()) -> list[str]:
    """Return BibTeX entries: blocksim, the paper, and what methods rest on.

    Parameters
    ----------
    methods : sequence of str
        Names as in `blocksim.ask.methods.METHODS`.

    Returns
    -------
    list of str
        In the order of the file.
    """
    text = (files("blocksim") / "references.bib").read_text(encoding="utf-8")
    entries = re.findall(r"^@.*?^\}$", text, flags=re.MULTILINE | re.DOTALL)
    wanted = [each for each in entries if not _of(each) or _of(each) & {*methods}]
    return [each.replace("VERSION", __version__) for each in wanted]


def _of(entry: str) -> set[str]:
    """Return the methods that an entry is cited for."""
    found = re.search(r"keywords\s*=\s*\{([^}]*)\}", entry)
    return {each.strip() for each in found[1].split(",")} if found else set()
