"""Files: written whole or not at all, and to the disk; read up to a bounded size."""

from __future__ import annotations

import json
import math
import os
import re
import stat
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, is_dataclass
from errno import (
    EEXIST,
    EINVAL,
    EISDIR,
    ELOOP,
    ENAMETOOLONG,
    ENOENT,
    ENOTDIR,
    ENOTSUP,
)  # fmt: skip
from importlib.resources import files
from operator import methodcaller
from pathlib import Path
from secrets import token_hex
from tempfile import TemporaryFile
from typing import Any, BinaryIO, cast

from blocksim.common.checks import require
from blocksim.common.errors import BlocksimError, InputError, MachineError

AnyPath = str | os.PathLike[str]
"""What every public function takes for a path."""
PREFIX = 40
"""Characters of a file's name in that of what is written aside."""
WRONG_NAME = {EEXIST, EINVAL, EISDIR, ELOOP, ENAMETOOLONG, ENOENT, ENOTDIR}
"""What the system says where another name would do; all else is the machine's failure."""


def shipped_files(pattern: str) -> dict[str, Path]:
    """Return files of `scenarios/` that come with blocksim, by name.

    `pattern`: As of a path below that folder: `*.toml`.
    """
    # In a wheel they are package data, in a checkout they are beside the package.
    inside = Path(str(files("blocksim") / "_scenarios"))
    folder = inside if inside.is_dir() else Path(__file__).parents[2] / "scenarios"
    return {path.stem: path for path in sorted(folder.glob(pattern))}


def json_text(document: object, *, indent: int | None = None) -> str:
    """Return a document as JSON, which has no infinity: that is written as the text "inf".

    `float` reads it again.
    """
    text = json.dumps(_plain(document), indent=indent, allow_nan=False)
    # The one character that JSON leaves as it is and no terminal can show.
    return text.replace("\x7f", "\\u007f")


def json_bytes(document: object) -> bytes:
    """Return a document as the content of a JSON file for people to read."""
    return f"{json_text(document, indent=1)}\n".encode()


def _plain(value: object) -> object:
    if isinstance(value, float) and not math.isfinite(value):
        return str(float(value))
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, dict):
        items = cast("dict[str, object]", value).items()
        return {key: _plain(each) for key, each in items}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in cast("list[object]", value)]
    return value


def write_whole(path: AnyPath, write: Callable[[BinaryIO], object]) -> None:
    """Write a file whole or not at all: aside, synced, then renamed to what it is called.

    It is on the disk, not only in the system's memory, when this returns. Each write has a
    name of its own, which nobody can know before: of two writers of one file either is whole,
    and a link of that name is not followed but replaced. What a kill leaves ends in `.part`.

    `write`: Writes to the open binary file it is given.
    Raises `InputError`: If there can be no file of that name.
    Raises `MachineError`: If the system cannot write it.

    Examples
    --------
    >>> write_whole("answer.txt", lambda file: file.write(b"stands"))
    """
    path = Path(path)
    with _writable(path):
        _require_plain(path)
        _put(path, write)


@contextmanager
def _writable(path: Path, allowed: str = "writable") -> Generator[None]:
    """Say in one line why nothing can be written."""
    try:
        yield
    except OSError as error:
        raise refused("--out", path, allowed, error) from None


def _put(path: Path, write: Callable[[BinaryIO], object]) -> None:
    # Names have 255 bytes at most; a character may have four.
    aside = path.with_name(f".{path.name[:PREFIX]}.{token_hex(8)}.part")
    try:
        with aside.open("xb") as file, _broken_off():
            write(file)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
    finally:
        # It has another name by now, or never came to be.
        with suppress(OSError):
            aside.unlink()
    _sync_folder(path.parent)


@contextmanager
def _broken_off() -> Generator[None]:
    """Raise what the system said where a library fails at tidying up after it."""
    try:
        yield
    except (OSError, BlocksimError):
        raise
    except Exception as error:
        cause = error.__context__
        while cause is not None and not isinstance(cause, OSError):
            cause = cause.__context__
        raise cause or error from None


def _require_plain(path: Path) -> None:
    """Raise `OSError` for what is there and no file, as a device: a file would replace it."""
    if "\0" in str(path):
        raise OSError(EINVAL, "a null character in the name")
    if path.is_dir():
        raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
    if path.exists() and not path.is_file():
        raise FileExistsError(EEXIST, "it is a device, a pipe or a socket")


def refused(field: str, path: AnyPath, allowed: str, error: OSError) -> BlocksimError:
    """Return what is said of a file: that another name would do, or what the system says."""
    said, why = os.fspath(path), error.strerror or str(error)
    if error.errno in WRONG_NAME:
        return InputError(field, said, f"{allowed} ({why})")
    return MachineError(field, said, why)


@contextmanager
def opened(path: AnyPath, field: str, allowed: str, largest: int) -> Generator[BinaryIO]:
    """Open a file of a stranger: a regular one, of a bounded size, without waiting for it.

    `path`: A text that ends in a slash is no file.
    `field`: What the file is, for what is said of it.
    `allowed`: What would have been accepted, as a phrase.
    `largest`: Bytes; a larger file is refused.
    Raises `InputError`: If it is missing, no regular file, or too large.
    Raises `MachineError`: If the system cannot open or read it.
    """
    said = os.fspath(path)
    try:
        # What is no file is not even opened: a pipe waits, a device may do anything.
        if not stat.S_ISREG(os.stat(said).st_mode):  # noqa: PTH116 - Path drops the slash
            raise InputError(field, said, allowed)
        with open(said, "rb", opener=_at_once) as file:
            size = os.fstat(file.fileno()).st_size
            if size > largest:
                raise InputError(field, said, f"at most {largest} bytes")
            yield file
    except OSError as error:
        if error.errno in {ENOENT, ENOTDIR}:
            raise InputError(field, said, allowed) from None
        raise refused(field, said, allowed, error) from None
    except ValueError as error:
        if isinstance(error, InputError) or "null" not in str(error):
            raise
        raise InputError(field, said, f"{allowed} ({error})") from None


def _at_once(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))


def read_file(path: AnyPath, field: str, allowed: str, largest: int) -> bytes:
    """Read a file of a stranger as a whole; see `opened`."""
    with opened(path, field, allowed, largest) as file:
        # What says that it is empty may have no end, as in /proc.
        text = cast("bytes | None", file.read(largest + 1))
    if text is None:  # it has to be waited for
        raise InputError(field, os.fspath(path), allowed)
    if len(text) > largest:
        raise InputError(field, os.fspath(path), f"at most {largest} bytes")
    return text


def require_file(path: AnyPath, field: str, allowed: str, largest: int) -> None:
    """Check that a file is there to be read, by what opens it itself; see `opened`."""
    with opened(path, field, allowed, largest) as file:
        # What says so in /proc may have no end, or wait for one.
        require(os.fstat(file.fileno()).st_size > 0, field, os.fspath(path), "not empty")


DEEPEST_KEY = 32
"""Keys with dots between them, in TOML."""
LONGEST_WHOLE = 290
"""Digits of whole numbers that a float can hold."""
_DEEP_KEY = re.compile(
    r"""(?:[ \t]*+\.[ \t]*+(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+'))""" + f"{{{DEEPEST_KEY}}}"
)


LARGEST_TABLE = 64 * 1024
"""Bytes of a small TOML file; a larger one is not read."""


def read_toml(
    path: AnyPath, what: str, allowed: str, largest: int = LARGEST_TABLE
) -> dict[str, Any]:
    """Read a small TOML file.

    `what`, `allowed`: What the file is and has to be, for what is said of one that is not.
    """
    text = read_file(path, what, allowed, largest)
    try:
        return toml_of(text)
    except ValueError as error:
        raise InputError("file", str(error), "valid TOML", where=str(path)) from None


def toml_of(text: bytes) -> dict[str, Any]:
    """Return what a TOML file says.

    Raises `ValueError`: In one line, if it is no TOML, no UTF-8, nested too deeply, or says a
        number beyond all bounds.
    """
    # Commands that read no file need not wait for it.
    import tomllib

    said = text.decode()
    # The parser takes time and memory as the square of a key's depth, and more.
    if _DEEP_KEY.search(said):
        raise ValueError(f"a key of more than {DEEPEST_KEY} parts")
    with _in_words():
        found = tomllib.loads(said)
        _require_bounded(found)
        return found


def json_of(text: bytes, pairs: Callable[[list[tuple[str, Any]]], Any] | None = None) -> Any:
    """Return what a JSON file says; `pairs` makes something of a table.

    Raises `ValueError`: As `toml_of`.
    """
    with _in_words():
        return json.loads(text.decode("utf-8-sig"), object_pairs_hook=pairs, parse_int=_whole)


@contextmanager
def _in_words() -> Generator[None]:
    try:
        yield
    except RecursionError:
        raise ValueError("nested too deeply") from None


def _whole(digits: str) -> int | float:
    """Return a whole number, infinite where no float can hold it."""
    return (
        int(digits) if len(digits) <= LONGEST_WHOLE else math.copysign(math.inf, float(digits))
    )


def _require_bounded(found: object) -> None:
    """Raise `ValueError` for whole numbers that no float can hold, as hexadecimal ones."""
    todo = [found]
    while todo:
        each = todo.pop()
        if isinstance(each, dict):
            todo.extend(cast("dict[str, object]", each).values())
        elif isinstance(each, list):
            todo.extend(cast("list[object]", each))
        elif isinstance(each, int) and abs(each) >= 10**LONGEST_WHOLE:
            raise ValueError(f"a whole number of {each.bit_length()} bits")


def _sync_folder(path: Path) -> None:
    """Put the names of a folder's files on the disk, where the system can (Windows cannot)."""
    try:
        folder = os.open(path, os.O_RDONLY)
    except OSError:  # one that may be written but not read
        return
    try:
        os.fsync(folder)
    except OSError as error:
        if error.errno not in {EINVAL, ENOTSUP}:  # some file systems have none for folders
            raise
    finally:
        os.close(folder)


def require_place(path: Path) -> None:
    """Check that a file can be written, before the work that is to fill it.

    Raises `InputError`: If there can be no file of that name.
    Raises `MachineError`: If the system cannot write it.
    """
    with _writable(path):
        _require_plain(path)
        TemporaryFile(dir=path.parent).close()


def make_folder(path: AnyPath) -> None:
    """Create a folder for results, and check that they can be written.

    Raises `InputError`: If there can be no folder of that name.
    Raises `MachineError`: If the system cannot create or write it.
    """
    path = Path(path)
    with _writable(path, "a writable folder"):
        path.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=path).close()


def write_folder(folder: AnyPath, contents: Mapping[str, bytes]) -> list[Path]:
    """Write files, by name, into a folder that is made where it is not there."""
    folder = Path(folder)
    make_folder(folder)
    for name, content in contents.items():
        write_whole(folder / name, methodcaller("write", content))
    return [folder / name for name in contents]
