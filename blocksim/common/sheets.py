"""Tables as CSV, for spreadsheets and `pandas.read_csv`."""

from __future__ import annotations

import codecs
import csv
import io
from collections.abc import Iterable, Sequence
from typing import BinaryIO

from blocksim.common.words import printable

FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
"""What begins so, in wide letters, too, is a formula to spreadsheets: it may run programs."""


def write_sheet(file: BinaryIO, names: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    r"""Write a table as CSV in UTF-8, a heading first.

    A missing value is an empty cell. Text is made printable; one that a spreadsheet would take
    for a formula gets an apostrophe before it. Numbers stay numbers.

    `names`: Of the columns.
    `rows`: Cells in the order of the columns.

    Examples
    --------
    >>> file = io.BytesIO()
    >>> write_sheet(file, ["block", "x_m"], [["=1+1", -0.5]])
    >>> file.getvalue()
    b"block,x_m\n'=1+1,-0.5\n"
    """
    table = csv.writer(codecs.getwriter("utf-8")(file), lineterminator="\n")
    table.writerow([_cell(name) for name in names])
    table.writerows([_cell(each) for each in row] for row in rows)


def sheet_of(names: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    """Return what `write_sheet` writes."""
    file = io.BytesIO()
    write_sheet(file, names, rows)
    return file.getvalue()


def _cell(value: object) -> object:
    if not isinstance(value, str):
        return value
    shown = printable(value)
    asks = shown.lstrip().startswith(FORMULA) and not _is_number(shown)
    return f"'{shown}" if asks else shown


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
