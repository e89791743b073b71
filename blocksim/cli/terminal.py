"""What rich draws on a terminal: a bar while something goes on, and tables."""

from __future__ import annotations

import sys
import textwrap
import time
from collections.abc import Container, Generator
from contextlib import contextmanager

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table as RichTable

from blocksim.common.progress import Progress as Report
from blocksim.common.words import printable

WIDE = 128
"""Characters in a line from which on no cell of a table has to be folded."""
MOMENT = 0.5
"""Time up to which no bar is shown [s]."""


@contextmanager
def bar() -> Generator[Report]:
    """Show a bar on standard error while something goes on."""
    words = TextColumn("{task.description:34}", markup=False)
    columns = (words, BarColumn(), TimeElapsedColumn())
    shown = Progress(*columns, console=Console(stderr=True), transient=True)
    task, begun = shown.add_task("", total=1.0), time.monotonic()

    def report(share: float, what: str) -> None:
        shown.update(task, completed=share, description=printable(what))
        if not shown.live.is_started and time.monotonic() - begun > MOMENT:
            shown.start()

    try:
        yield report
    finally:
        shown.stop()


class Table(RichTable):
    """A table of text. Columns of numbers are aligned to the right.

    `below`: Columns, the last ones, that go below their row where the window has no room.
    """

    def __init__(
        self, *headings: str, right: Container[str] = (), wrap: bool = True, below: int = 0
    ) -> None:
        super().__init__(box=None, header_style="bold", pad_edge=False)
        self.below = below
        for each in headings:
            side = "right" if each in right else "left"
            self.add_column(each, justify=side, no_wrap=not wrap)

    def add_row(self, *cells: str) -> None:  # type: ignore[override]
        """Add a row."""
        super().add_row(*map(printable, cells))


def show(table: Table) -> None:
    """Print a table that fits the window, or 80 characters where there is none."""
    plain = Console(markup=False, emoji=False, highlight=False)
    for column in table.columns:
        column.no_wrap = column.no_wrap and plain.width >= WIDE
        column.overflow = "fold"
    # What a row is about is one word.
    table.columns[0].no_wrap = True
    below: list[str] = []
    unlimited = plain.options.update(max_width=sys.maxsize)
    if table.below and plain.measure(table, options=unlimited).maximum > plain.width:
        below = _below(table, plain.width)
    with plain.capture() as captured:
        plain.print(table)
    shown = captured.get().splitlines()
    # A row that is folded goes on below the word it begins with; so do the headings.
    first = table.columns[0]
    wide = max(len(str(each)) for each in (first.header, *first.cells))
    begins = [at for at, line in enumerate(shown) if line[:wide].strip()]
    ends = dict(zip([at - 1 for at in begins[2:]] + [len(shown) - 1], below, strict=False))
    for at, line in enumerate(shown):
        click.echo(line.rstrip())
        if ends.get(at):
            click.echo(ends[at])


def _below(table: Table, width: int) -> list[str]:
    """Take columns out of a table, and return what goes below each row in their place."""
    told = table.columns[-table.below :]
    del table.columns[-table.below :]
    names = [f"{each.header}: " if each.header else "" for each in told]
    indent = " " * 4
    return [
        textwrap.fill(
            "; ".join(name + cell for name, cell in zip(names, row, strict=True) if cell),
            width, initial_indent=indent, subsequent_indent=indent,
        )
        for row in zip(*(map(str, each.cells) for each in told), strict=True)
    ]  # fmt: skip
