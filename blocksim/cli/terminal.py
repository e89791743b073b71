"""What rich draws on a terminal: a bar while something goes on, and tables."""

from __future__ import annotations

from collections.abc import Container, Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table as RichTable

from blocksim.common.progress import Progress as Report
from blocksim.common.words import printable

WIDE = 128
"""Characters in a line of the widest table."""


@contextmanager
def bar() -> Generator[Report]:
    """Show a bar on standard error while something goes on."""
    words = TextColumn("{task.description:34}", markup=False)
    columns = (words, BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task("", total=1.0)

        def report(share: float, what: str) -> None:
            shown.update(task, completed=share, description=printable(what))

        yield report


class Table(RichTable):
    """A table of columns with headings, those of numbers to the right; cells are text."""

    def __init__(self, *headings: str, right: Container[str] = (), wrap: bool = True) -> None:
        super().__init__(box=None, header_style="bold", pad_edge=False)
        for each in headings:
            side = "right" if each in right else "left"
            self.add_column(each, justify=side, no_wrap=not wrap)

    def add_row(self, *cells: str) -> None:  # type: ignore[override]
        """Add a row."""
        super().add_row(*map(printable, cells))


def show(table: Table) -> None:
    """Print a table; a narrow window wraps its lines rather than losing columns."""
    plain = Console(width=max(Console().width, WIDE), markup=False, emoji=False)
    plain.print(table)
