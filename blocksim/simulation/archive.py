"""What the file of a recording holds, unpacked within bounds: it may be a stranger's."""

from __future__ import annotations

import math
import os
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Sequence
from typing import Any, BinaryIO

import numpy as np
from numpy.lib.format import read_array_header_1_0, read_magic

from blocksim.blocks.assembly import Array
from blocksim.common.checks import require
from blocksim.common.errors import in_line
from blocksim.common.files import json_of

LARGEST_INSIDE = 1 << 28
"""Bytes of the arrays of a file, which can be packed into a thousandth."""
LARGEST_HEADER = 1 << 26
"""Bytes of what is said beside the arrays."""
LARGEST_CONTENTS = 1 << 16
"""Bytes of the list of what an archive has."""
BEFORE_END, END = 20, 22
"""Bytes at the end of that list, and of its long form before them."""
CHUNK = 1 << 20
"""Bytes that are unpacked at once."""
UNREADABLE = (
    LookupError,
    ArithmeticError,
    AttributeError,
    TypeError,
    ValueError,
    OSError,
    EOFError,
    MemoryError,
    RuntimeError,
    zipfile.BadZipFile,
    SyntaxError,
    struct.error,
    NotImplementedError,
    tokenize.TokenError,
    zlib.error,
)
"""What an empty, damaged or foreign file makes numpy, zipfile and json raise."""


def parts_of(file: BinaryIO) -> tuple[dict[str, Any], Array, Array]:
    """Unpack header, times and poses; what raises here is no recording.

    What sizes are said is looked at before anything is unpacked.
    """
    _require_contents(file)
    with zipfile.ZipFile(file) as archive:
        inside = sum(part.file_size for part in archive.infolist())
        allowed = f"of at most {LARGEST_INSIDE} bytes unpacked"
        require(inside <= LARGEST_INSIDE, "array", f"it has {inside}", allowed)
        said = _array(archive, "header", "U", LARGEST_HEADER)
        times = _array(archive, "times", "f", LARGEST_INSIDE)
        poses = _array(archive, "poses", "f", LARGEST_INSIDE)
    header = json_of(str(said).encode())
    require(isinstance(header, dict), "header", type(header).__name__, "a table")
    return header, times.astype(np.float64, copy=False), poses.astype(np.float64, copy=False)


def _require_contents(file: BinaryIO) -> None:
    """Refuse an archive with a long list of contents, all of which would be read."""
    file.seek(max(0, file.seek(0, os.SEEK_END) - BEFORE_END - END))
    last = file.read()
    # As numpy writes it: without a comment, and with the short form of the list's end.
    *_, size, _, comment = struct.unpack("<4s4H2LH", last[-END:])
    short = last[-END:].startswith(b"PK\5\6") and comment == 0
    short = short and b"PK\6\7" not in last[:-END]
    if not short or size > LARGEST_CONTENTS:
        raise zipfile.BadZipFile


def _array(archive: zipfile.ZipFile, name: str, kind: str, largest: int) -> Array:
    """Unpack an array whose size is what its header says."""
    part = archive.getinfo(f"{name}.npy")
    with archive.open(part) as stream:
        if read_magic(stream) != (1, 0):
            raise TypeError
        shape, fortran, dtype = read_array_header_1_0(stream)
        size = math.prod(shape) * dtype.itemsize
        honest = min(shape, default=0) >= 0 and size == part.file_size - stream.tell()
        said = f"{name}: {_in_words(shape)}"
        if dtype.kind != kind:
            raise TypeError
        require(honest, "array", said, "of arrays as long as they say")
        require(size <= largest, "array", said, f"of arrays of at most {largest} bytes")
        held = bytearray(size)
        view, at = memoryview(held), 0
        while at < size:
            read = stream.read(min(CHUNK, size - at))
            if not read:
                raise EOFError
            view[at : at + len(read)] = read
            at += len(read)
        # The end is asked for, so that the sum of all is looked at.
        stream.read(1)
    return np.ndarray(shape, dtype, held, order="F" if fortran else "C")


def _in_words(shape: Sequence[int]) -> str:
    return in_line(" x ".join(f"{each:.4g}" for each in map(_as_float, shape)) or "one", 60)


def _as_float(size: int) -> float:
    return float(size) if size.bit_length() < 1000 else math.inf
