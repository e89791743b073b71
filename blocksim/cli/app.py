"""The program: its name, its options, and the commands that are hung into it."""

from __future__ import annotations

from typing import Annotated

import typer

from blocksim.cli.console import say
from blocksim.common.version import __version__

app = typer.Typer(
    name="blocksim",
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def start(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Answer whether a masonry arch stands, how thin it can be and how it falls."""
    if version:
        say(f"blocksim {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        say(context.get_help())
