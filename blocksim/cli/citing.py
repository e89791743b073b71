"""The command cite."""

from __future__ import annotations

from typing import Annotated

from blocksim.ask import citing
from blocksim.ask.methods import METHODS
from blocksim.cli.arguments import Option
from blocksim.cli.options import named_options
from blocksim.cli.output import say


def cite(
    methods: Annotated[
        list[str] | None,
        Option(name="--method", about=f"Repeatable, or all: {', '.join(METHODS.shipped)}."),
    ] = None,
) -> None:
    """Print BibTeX of blocksim, of the paper, and of what methods rest on."""
    with named_options():
        say(*citing.cite(*methods or []).splitlines())
