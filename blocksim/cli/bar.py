"""A bar on the terminal while something goes on."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from blocksim.common.progress import Progress as Report


@contextmanager
def bar() -> Generator[Report]:
    """Show a bar on standard error while something goes on."""
    columns = (TextColumn("{task.description:34}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task("", total=1.0)

        def report(share: float, what: str) -> None:
            shown.update(task, completed=share, description=what)

        yield report
