"""Rows as one table, Parquet, CSV or of pandas, a type a column; alone knows these libraries.

Columns are the keys of a row. The unit ends the name of a number that has one: `tilt_deg`,
`wall_s`, and of kinds of structures `radius_m`, a column for each parameter that any row has.
Each setting has one, too, such as `settings.step`. A missing value is null, or an empty cell.
`low`, `high` and `limit` of a bracket are in what its `unit` says.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from itertools import islice
from typing import Any, BinaryIO, cast

from blocksim.common.fields import Field, fields_of
from blocksim.common.files import AnyPath, write_whole
from blocksim.common.later import Library, require_library
from blocksim.common.sheets import write_sheet
from blocksim.kinds import KINDS
from blocksim.simulation.simulated import SETTINGS
from blocksim.sweeps.case import COLUMNS
from blocksim.sweeps.shards import read_rows

_pandas = Library("pandas")
ROWS_AT_ONCE = 50_000
"""Rows held in memory, a row group of the table."""
NUMBERS = ("mu", "load_factor", "limit")
"""Those that may be infinite, which JSON writes as a text."""


def require_parquet() -> None:
    """Raise `MissingPart` unless tables can be written here."""
    require_library("pyarrow", "Parquet", "parquet")


def write_parquet(folder: AnyPath, path: AnyPath) -> None:
    """Write the rows of a sweep as a Parquet table, in the order of `read_rows`.

    Infinite friction is a number.

    Parameters
    ----------
    folder : Path
        Of the sweep.
    path : Path
        Table to write, whole or not at all.

    Raises
    ------
    InputError, MachineError
        If a file is not of a sweep, or the table cannot be written.
    MissingPart
        If pyarrow is not installed.
    """
    require_parquet()
    import pyarrow  # pyright: ignore[reportMissingTypeStubs]
    from pyarrow import parquet  # pyright: ignore[reportMissingTypeStubs]

    arrow: Any = pyarrow
    tables: Any = parquet
    columns = _columns(folder)
    schema = arrow.schema(
        [(name, arrow.type_for_alias(kind)) for name, kind in columns.items()]
    )
    rows = _rows(folder, columns)

    def write(file: BinaryIO) -> None:
        with tables.ParquetWriter(file, schema, compression="zstd") as table:
            while held := list(islice(rows, ROWS_AT_ONCE)):
                table.write_batch(arrow.RecordBatch.from_pylist(held, schema))

    write_whole(path, write)


def write_csv(folder: AnyPath, path: AnyPath) -> None:
    """Write the rows of a sweep as CSV, in the order of `read_rows`: for `pandas.read_csv`.

    Infinity is `inf`.

    Parameters
    ----------
    folder : Path
        Of the sweep.
    path : Path
        Table to write, whole or not at all.

    Raises
    ------
    InputError, MachineError
        If a file is not of a sweep, or the table cannot be written.
    """
    columns = _columns(folder)
    cells = (list(row.values()) for row in _rows(folder, columns))
    write_whole(path, lambda file: write_sheet(file, list(columns), cells))


def to_pandas(rows: AnyPath | Iterable[object]) -> Any:
    """Return rows as a table of pandas.

    Parameters
    ----------
    rows : Path, or iterable
        The folder of a sweep, with the columns of `write_csv`; or rows as mappings or
        dataclasses, as `check_many` gives.

    Returns
    -------
    pandas.DataFrame

    Raises
    ------
    InputError
        If a file is not of a sweep.
    MissingPart
        If pandas is not installed.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> from tempfile import mkdtemp
    >>> from blocksim import sweep
    >>> asked = {"kind": "column", "width": [0.5, 1.0], "mu": 0.7, "method": "limit"}
    >>> with ThreadPoolExecutor(1) as executor:
    ...     done = sweep(asked, folder := mkdtemp(), executor=executor)
    >>> to_pandas(folder).sort_values("width_m").verdict.tolist()
    ['stands', 'stands']
    """
    require_library("pandas", "a table of pandas", "pandas")
    if isinstance(rows, str | os.PathLike):
        columns = _columns(rows)
        return _pandas.DataFrame(list(_rows(rows, columns)), columns=list(columns))
    return _pandas.DataFrame(
        [each if isinstance(each, Mapping) else asdict(cast("Any", each)) for each in rows]
    )


def _columns(folder: AnyPath) -> dict[str, str]:
    """Names and types of the columns: those of parameters are found in the rows."""
    parameters: dict[str, str] = {}
    for row in read_rows(folder):
        for name in _parameters(row):
            known = _known(str(row["kind"]), name)
            parameters[_column(name, known)] = _type_of(known)
    settings = {
        f"settings.{name}": "int64" if each.whole else "double"
        for name, each in SETTINGS.items()
    }
    inside = {"parameters": parameters, "settings": settings}
    columns: dict[str, str] = {}
    for name, kind in COLUMNS.items():
        columns |= inside.get(name, {name: kind})
    return columns


def _parameters(row: Mapping[str, object]) -> dict[str, object]:
    return cast("dict[str, object]", row.get("parameters") or {})


def _known(kind: str, name: str) -> Field | None:
    """Return what is known of a parameter of a kind, or of the arch in it."""
    last = name.rpartition(".")[2]
    kinds = [KINDS[kind]] if kind in KINDS and last == name else []
    found = (fields_of(each).get(last) for each in (*kinds, *KINDS.values()))
    return next((each for each in found if each is not None), None)


def _type_of(known: Field | None) -> str:
    if known is None or known.range is None:
        return "string"
    return "int64" if known.whole else "double"


def _held(value: object, kind: str) -> object:
    """Return the value of a parameter as its column holds it."""
    if value is None or isinstance(value, str):
        return value
    if kind == "string":
        return json.dumps(value)
    number = float(str(value))
    return number if kind == "double" else int(number)


def _column(name: str, known: Field | None) -> str:
    if known is None or not known.unit:
        return name
    # Of an angle the parameter itself has it.
    return f"{name.removesuffix(f'_{known.unit}')}_{known.unit}"


def _rows(folder: AnyPath, columns: Iterable[str]) -> Iterator[dict[str, object]]:
    """Give rows with their numbers as such, and with parameters and settings as columns."""
    for row in read_rows(folder):
        found: dict[str, Any] = dict(row)
        for key in NUMBERS:
            if found[key] is not None:
                found[key] = float(found[key])
        for name, value in _parameters(row).items():
            known = _known(str(row["kind"]), name)
            found[_column(name, known)] = _held(value, _type_of(known))
        given: dict[str, float] = found["settings"] or {}
        found |= {f"settings.{name}": value for name, value in given.items()}
        yield {name: found.get(name) for name in columns}
