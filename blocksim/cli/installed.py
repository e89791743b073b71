"""The commands doctor and cite: what is installed, and what it rests on."""

from __future__ import annotations

import platform

import click

from blocksim import __version__
from blocksim.ask import doctor as installed
from blocksim.ask.methods import METHODS
from blocksim.cli.arguments import option
from blocksim.cli.options import named_options
from blocksim.cli.output import say
from blocksim.cli.terminal import Table, show

EVERY = ", ".join(METHODS.shipped)


def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table("method", "version", "here", "finest bracket", "sees")
    for finding in installed.examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:g}"
        here = finding.remedy or "ready"
        table.add_row(finding.method, finding.version or "-", here, finest, finding.sees)
    show(table)
    say(f"blocksim {__version__}, Python {platform.python_version()}")
    say(", ".join(f"{name} {found or '-'}" for name, found in installed.libraries().items()))


def cite(
    methods: list[str] | None = option(f"Repeatable, or all: {EVERY}.", name="--method"),
) -> None:
    """Print BibTeX of blocksim, of the paper, and of what methods rest on."""
    with named_options():
        # It is for programs: no line of it is folded.
        click.echo(installed.cite(*methods or []))
