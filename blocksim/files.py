"""Write a file whole or not at all, and to the disk."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from blocksim.errors import InputError


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write aside, then rename, so that nobody ever sees half a file.

    It is on the disk, not only in the system's memory, when this returns.

    Parameters
    ----------
    path : Path
    write : callable
        Writes to the open binary file it is given.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
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


def _sync_folder(path: Path) -> None:
    """Put the names of a folder's files on the disk, where the system can (Windows cannot)."""
    if os.name != "posix":
        return
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def make_folder(path: Path) -> None:
    """Create a folder for results.

    Raises
    ------
    InputError
        If it cannot be created.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError("--out", str(path), f"a writable folder ({error.strerror})") from None
