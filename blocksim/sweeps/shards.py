"""Rows on disk: JSON Lines in files that are whole or not there."""

from __future__ import annotations

import json
import re
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import cast

from filelock import FileLock, Timeout

from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, refused, write_whole
from blocksim.sweeps.case import EMPTY, SweepRow

HEAD = b'{"id": "'
ID_LENGTH = 24
ROW = re.compile(rb'\{"id": "[0-9a-f]{24}", .*\}\n')
PATTERN = "rows-*.jsonl"
UNFINISHED = ".rows-*.part"
LOCK = ".sweep.lock"


@contextmanager
def locked(folder: Path) -> Generator[None]:
    """Keep a folder for one sweep. The system lets go of it however the process ends."""
    lock = FileLock(folder / LOCK, blocking=False)
    try:
        lock.acquire()
    except Timeout:
        allowed = "a folder no other sweep is at work in (wait until it ends, or name another)"
        raise InputError("--out", str(folder), allowed) from None
    except OSError as error:
        raise refused("--out", folder, "writable", error) from None
    try:
        yield
    finally:
        lock.release()


def write_shard(folder: Path, lines: list[bytes]) -> None:
    """Add rows to a folder: all of them or, after a kill, none.

    The name is that of the first row: rows that are done are never asked for again, so
    that no later shard has the same.
    """
    path = folder / f"rows-{_identity(lines[0])}.jsonl"
    write_whole(path, lambda file: file.writelines(lines))


def identities(folder: Path) -> set[bytes]:
    """Return identities of the rows in a folder, and remove what a kill left half-written."""
    for part in folder.glob(UNFINISHED):
        with suppress(OSError):
            part.unlink()
    for path in folder.glob(PATTERN):
        _mend(path)
    # The identity leads the line, which spares decoding millions of rows.
    return {bytes.fromhex(_identity(line)) for line in _lines(folder)}


def _mend(path: Path) -> None:
    """Drop a last line that was cut, as after a power failure: its row is asked for again."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(max(0, size - 1))
        if file.read() == b"\n":
            return
        file.seek(0)
        whole = [line for line in file if line.endswith(b"\n")]
    if whole:
        write_whole(path, lambda file: file.writelines(whole))
    else:
        path.unlink()


def read_rows(folder: AnyPath) -> Iterator[SweepRow]:
    """Read the rows of a sweep, in no particular order.

    Parameters
    ----------
    folder : Path

    Yields
    ------
    SweepRow
        The question (`kind`, `parameters`, `mu`, what acts, `over`, `asked`, `settings`),
        `method` that answered and its `version`, and the answer; `error` says why there is no
        answer. What there is nothing of is None: all rows have the same keys. Half-angle,
        voussoirs, weight, eta and ratio of a circular arch have keys of their own. Infinity is
        the text "inf".

    Raises
    ------
    InputError
        If a file is not of a sweep.
    """
    for line in _lines(Path(folder)):
        yield cast("SweepRow", EMPTY | json.loads(line))


def _lines(folder: Path) -> Iterator[bytes]:
    """Rows of all shards, undecoded."""
    for path in sorted(folder.glob(PATTERN)):
        with path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                if not ROW.fullmatch(line):
                    start = line[:40].decode(errors="replace")
                    allowed = "a row of a sweep (take the file away, and its rows are redone)"
                    raise InputError(f"line {number}", start, allowed, where=str(path))
                yield line


def _identity(line: bytes) -> str:
    return line[len(HEAD) : len(HEAD) + ID_LENGTH].decode()
