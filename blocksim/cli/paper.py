"""The command paper: every figure of the paper, with a page that shows them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import click

from blocksim.cli.arguments import Argument, Option
from blocksim.cli.output import progress, say
from blocksim.common.checks import Range
from blocksim.common.errors import MISSING, InputError
from blocksim.common.words import counted

MET = 1e-12
"""Relative difference up to which a printed number is met."""


def paper(
    out: Annotated[
        Path | None,
        Argument(about="Folder for the figures and a page, index.html; required.", folder=True),
    ] = None,
    figures: Annotated[
        list[int] | None,
        Option(
            name="--figure",
            metavar="N",
            range=Range(low=1, high=25, whole=True),
            about="Only this one; repeatable.",
        ),
    ] = None,
    kind: Annotated[
        Literal["svg", "png"], Option(name="--format", about="Of the pictures.")
    ] = "svg",
) -> None:
    """Draw every figure of the paper, and compare every number that it prints.

    Exit code 1 where a number is not met.
    """
    if out is None:
        raise InputError("OUT", MISSING, "a folder")
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.paperpage import write_paper

    with progress() as report:
        paths, worst = write_paper(out, figures, kind, progress=report)
    say(
        f"every number printed is met to {worst:.0e}"
        if worst <= MET
        else f"MISSES a number: {worst:.0e}"
    )
    say(f"wrote {paths[0]}, with {counted(len(paths) - 2, 'figure')} and {paths[1].name}")
    raise click.exceptions.Exit(int(worst > MET))
