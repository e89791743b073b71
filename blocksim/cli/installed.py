"""The command doctor: what is installed."""

from __future__ import annotations

import platform

from blocksim import __version__
from blocksim.ask.doctor import examine, libraries
from blocksim.cli.output import say
from blocksim.cli.terminal import Table, show


def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table("method", "version", "here", "finest bracket", "sees")
    for finding in examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:g}"
        here = finding.remedy or "ready"
        table.add_row(finding.method, finding.version or "-", here, finest, finding.sees)
    show(table)
    say(f"blocksim {__version__}, Python {platform.python_version()}")
    say(", ".join(f"{name} {found or '-'}" for name, found in libraries().items()))
