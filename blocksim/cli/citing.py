"""The command cite."""

from __future__ import annotations

from typing import Annotated

from blocksim.ask.methods import METHODS
from blocksim.cli.arguments import Option
from blocksim.cli.output import say
from blocksim.common.checks import require
from blocksim.common.references import references


def cite(
    methods: Annotated[
        list[str] | None,
        Option(name="--method", help=f"Repeatable, or all: {', '.join(METHODS)}."),
    ] = None,
) -> None:
    """Print BibTeX of blocksim, of the paper, and of what methods rest on."""
    asked = list(METHODS) if methods == ["all"] else methods or []
    for each in asked:
        require(each in METHODS, "--method", each, f"all, or one of {', '.join(METHODS)}")
    say(*"\n\n".join(references(asked)).splitlines())
