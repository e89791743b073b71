"""Rows as one Parquet table; the only place that knows pyarrow."""

from __future__ import annotations

import json
from importlib.util import find_spec
from itertools import chain, islice
from typing import Any, BinaryIO

from blocksim.common.errors import MissingPart
from blocksim.common.files import AnyPath, write_whole
from blocksim.evidence.simulation import SETTINGS
from blocksim.many.shards import read_rows

ROWS_AT_ONCE = 50_000
"""Rows held in memory, a row group of the table."""
COLUMNS = {
    "id": "string",
    "half_angle_deg": "double",
    "mu": "double",
    "voussoirs": "int64",
    "weight": "string",
    "eta": "double",
    "ratio": "double",
    "asked": "string",
    "settings": "settings",
    "method": "string",
    "version": "string",
    "verdict": "string",
    "mode": "string",
    "mode_in_motion": "string",
    "mode_theory": "string",
    "eta_theory": "double",
    "eta_limit": "double",
    "eta_low": "double",
    "eta_high": "double",
    "confirmed": "bool",
    "reason": "string",
    "error": "string",
    "wall_s": "double",
}
"""The keys of a row of an arch, and what Arrow calls their types."""
STRUCTURE_COLUMNS = {
    "id": "string",
    "kind": "string",
    "parameters": "string",
    "mu": "double",
    "load": "double",
    "tilt_deg": "double",
    "amplitude_g": "double",
    "duration_s": "double",
    "over": "string",
    "asked": "string",
    "settings": "settings",
    "method": "string",
    "version": "string",
    "verdict": "string",
    "rest": "string",
    "load_factor": "double",
    "largest_rotation_deg": "double",
    "first_impact_s": "double",
    "limit": "double",
    "low": "double",
    "high": "double",
    "confirmed": "bool",
    "reason": "string",
    "error": "string",
    "wall_s": "double",
}
"""The same of other structures; parameters, of which each kind has its own, are JSON."""
NUMBERS = ("mu", "load_factor", "limit")
"""Those that may be infinite, which JSON writes as a text."""


def require_parquet() -> None:
    """Raise `MissingPart` unless tables can be written here."""
    if find_spec("pyarrow") is None:
        raise MissingPart("Parquet", "pip install 'blocksim[parquet]'")


def write_parquet(folder: AnyPath, path: AnyPath) -> None:
    """Write the rows of a sweep as a Parquet table, in the order of `read_rows`.

    Columns are the keys of a row; infinite friction is a number, and settings that were
    not given are null.

    Parameters
    ----------
    folder : Path
        Of the sweep.
    path : Path
        Table to write, whole or not at all.

    Raises
    ------
    InputError
        If a file is not of a sweep, or the table cannot be written.
    MissingPart
        If pyarrow is not installed.
    """
    require_parquet()
    import pyarrow  # pyright: ignore[reportMissingTypeStubs]
    from pyarrow import parquet  # pyright: ignore[reportMissingTypeStubs]

    arrow: Any = pyarrow
    tables: Any = parquet
    rows = read_rows(folder)
    empty: dict[str, object] = {}
    first = next(rows, empty)
    schema = _schema(arrow, STRUCTURE_COLUMNS if "kind" in first else COLUMNS)
    rows = chain([first] if first else [], rows)

    def write(file: BinaryIO) -> None:
        with tables.ParquetWriter(file, schema, compression="zstd") as table:
            while held := [_numbered(row) for row in islice(rows, ROWS_AT_ONCE)]:
                table.write_batch(arrow.RecordBatch.from_pylist(held, schema))

    write_whole(path, write)


def _numbered(row: dict[str, object]) -> dict[str, object]:
    """Return a row with its numbers as such, and parameters as JSON."""
    found = dict(row)
    for key in NUMBERS:
        if found.get(key) is not None:
            found[key] = float(str(found[key]))
    if "parameters" in found:
        found["parameters"] = json.dumps(found["parameters"])
    return found


def _schema(arrow: Any, columns: dict[str, str]) -> Any:
    types = {kind: arrow.type_for_alias(kind) for kind in {*columns.values()} - {"settings"}}
    fields = [
        (name, types["int64" if setting.is_whole else "double"])
        for name, setting in SETTINGS.items()
    ]
    types["settings"] = arrow.struct(fields)
    return arrow.schema([(key, types[kind]) for key, kind in columns.items()])
