"""What rich draws on a terminal: a bar while something goes on, and tables."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from blocksim.common.progress import Progress as Report

WIDE = 128
"""Characters in a line of the widest table."""


@contextmanager
def bar() -> Generator[Report]:
    """Show a bar on standard error while something goes on."""
    columns = (TextColumn("{task.description:34}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task("", total=1.0)

        def report(share: float, what: str) -> None:
            shown.update(task, completed=share, description=what)

        yield report


def show(table: Table) -> None:
    """Print a table; a narrow window wraps its lines rather than losing columns."""
    Console(width=max(Console().width, WIDE)).print(table)
