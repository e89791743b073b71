"""Files: written whole or not at all, and to the disk; read up to a bounded size."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from contextlib import suppress
from errno import EISDIR
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO, cast

from blocksim.common.errors import InputError

AnyPath = str | os.PathLike[str]
"""What every public function takes for a path."""


def shipped_files(pattern: str) -> dict[str, Path]:
    """Return files of `scenarios/` that come with blocksim, by name.

    Parameters
    ----------
    pattern : str
        As of a path below that folder: `*.toml`.
    """
    # In a wheel they are package data, in a checkout they are beside the package.
    inside = Path(str(files("blocksim") / "_scenarios"))
    folder = inside if inside.is_dir() else Path(__file__).parents[2] / "scenarios"
    return {path.stem: path for path in sorted(folder.glob(pattern))}


def json_text(document: object, *, indent: int | None = None) -> str:
    """Return a document as JSON, which has no infinity: that is written as the text "inf".

    `float` reads it again.
    """
    return json.dumps(_plain(document), indent=indent, allow_nan=False)


def _plain(value: object) -> object:
    if isinstance(value, float) and not math.isfinite(value):
        return str(float(value))
    if isinstance(value, dict):
        items = cast("dict[str, object]", value).items()
        return {key: _plain(each) for key, each in items}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in cast("list[object]", value)]
    return value


def write_whole(path: AnyPath, write: Callable[[BinaryIO], object]) -> None:
    """Write aside, then rename, so that nobody ever sees half a file.

    It is on the disk, not only in the system's memory, when this returns.

    Parameters
    ----------
    path : str or path
    write : callable
        Writes to the open binary file it is given.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    path = Path(path)
    aside = path.with_name(f".{path.name}.part")
    try:
        with aside.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
        _sync_folder(path.parent)
    except OSError as error:
        raise InputError("--out", str(path), f"writable ({error.strerror})") from None
    finally:
        # Where the folder itself is missing or a file, there is nothing to take away.
        with suppress(OSError):
            aside.unlink()


def require_file(path: AnyPath, field: str, allowed: str, largest: int) -> None:
    """Check that a file is there to be read.

    Parameters
    ----------
    path : Path
    field : str
        What the file is, for what is said of it.
    allowed : str
        What would have been accepted, as a phrase.
    largest : int
        Bytes; a larger file is refused.

    Raises
    ------
    InputError
        If it is no file, cannot be read, or is too large.
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise InputError(field, str(path), allowed)
        with path.open("rb") as file:
            size = os.fstat(file.fileno()).st_size
    except OSError as error:
        raise InputError(field, str(path), f"{allowed} ({error.strerror})") from None
    if size > largest:
        raise InputError(field, str(path), f"at most {largest} bytes")


def _sync_folder(path: Path) -> None:
    """Put the names of a folder's files on the disk, where the system can (Windows cannot)."""
    if os.name != "posix":
        return
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def require_place(path: Path) -> None:
    """Check that a file can be written, before the work that is to fill it.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    try:
        if path.is_dir():
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
        with TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise InputError("--out", str(path), f"writable ({error.strerror})") from None


def make_folder(path: AnyPath) -> None:
    """Create a folder for results, and check that they can be written.

    Raises
    ------
    InputError
        If it cannot be created or written.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise InputError("--out", str(path), f"a writable folder ({error.strerror})") from None
