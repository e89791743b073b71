"""Rows of a study as CSV, each with what measured it: version, date, machine and code."""

from __future__ import annotations

import csv
import gzip
import hashlib
import io
import os
import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import blocksim
from blocksim import __version__
from blocksim.common.files import make_folder, write_whole
from blocksim.report.tables import processor

CODE = Path(blocksim.__file__).parent
FIGURES = Path(__file__).parent / "figures"
"""Where rows and figures of studies are kept."""


def code_hash(folder: Path = CODE) -> str:
    """Return a hash of all Python files below a folder: their names and what they say."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def provenance() -> dict[str, str]:
    """Return what every row says of its making."""
    return {
        "version": __version__,
        "date": datetime.now(UTC).date().isoformat(),
        "machine": f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}",
        "code": code_hash(),
    }


def write_rows(path: Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Write rows as CSV, with the columns of `provenance` at their end.

    Parameters
    ----------
    path : Path
        Packed where it ends in .gz.
    rows : sequence of mapping
        At least one; all with the same keys. Rows that say what made them keep that.
    """
    made = {} if "code" in rows[0] else provenance()
    text = io.StringIO()
    table = csv.DictWriter(text, [*rows[0], *made], lineterminator="\n")
    table.writeheader()
    table.writerows({**row, **made} for row in rows)
    make_folder(path.parent)
    written = text.getvalue().encode()
    # Without a time, the same rows are the same file.
    whole = gzip.compress(written, mtime=0) if path.suffix == ".gz" else written
    write_whole(path, lambda file: file.write(whole))


def read_kept(path: Path, *texts: str) -> list[dict[str, Any]]:
    """Read rows that `write_rows` wrote: numbers, truths, None where a cell is empty, text.

    `texts`: Columns that are text, whatever it looks like.
    """
    text = gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()
    table = csv.DictReader(io.StringIO(text.decode()))
    return [
        {name: cell if name in texts else _value(cell) for name, cell in row.items()}
        for row in table
    ]


def _value(cell: str) -> Any:
    plain = {"": None, "True": True, "False": False}
    if cell in plain:
        return plain[cell]
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell
