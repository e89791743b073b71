"""A recording: poses over time, from which everything else is derived."""

from __future__ import annotations

import math
import os
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO, Literal

import numpy as np
from numpy.lib.format import read_array_header_1_0, read_magic

from blocksim.blocks.assembly import PLANAR, SPATIAL, Array, Assembly, Block, displacement
from blocksim.blocks.problem import Problem
from blocksim.blocks.record import from_record, to_record
from blocksim.common.checks import is_number, require
from blocksim.common.errors import InputError, in_line
from blocksim.common.files import AnyPath, json_of, json_text, opened, write_whole
from blocksim.common.shown import Shown, renderer
from blocksim.engines.base import Quality, Settings
from blocksim.simulation.recorded import Recorded

if TYPE_CHECKING:
    from blocksim.blocks.maker import Maker

FORMAT = 2
WRITTEN = "written by blocksim simulate"
LARGEST_FILE = LARGEST_INSIDE = 1 << 28
"""Bytes of a file, and of its arrays, which can be packed into a thousandth."""
LARGEST_HEADER = 1 << 26
"""Bytes of what is said beside the arrays."""
LARGEST_CONTENTS = 1 << 16
"""Bytes of the list of what an archive has."""
BEFORE_END, END = 20, 22
"""Bytes at the end of that list, and of its long form before them."""
CHUNK = 1 << 20
"""Bytes that are unpacked at once, and numbers looked at."""
FARTHEST, LATEST = 1e9, 1e9
"""Largest way of a block [size], and largest time [sqrt(size/g)]."""
_UNREADABLE = (
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


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Recording(Recorded[Problem], Shown):
    """The motion of blocks in one engine.

    Lengths are in units of the assembly's size, which is the radius r of an arch.

    Parameters
    ----------
    problem : Problem
    engine, engine_version : str
    settings : Settings
    times : (frames,) float
        In units of sqrt(size/g), from the release.
    poses : (frames, blocks, 3 or 6) float
        Centres of mass x, y in units of the size and rotations [rad]; from engines in three
        dimensions also z, out of the plane, and the rotation vector's x and y.
    quality : Quality
        How well contact and friction were kept.
    """

    @property
    def assembly(self) -> Assembly:
        """Its blocks and joints."""
        return self.problem.assembly

    @property
    def mu(self) -> float:
        """Friction coefficient of all joints that have none of their own."""
        return self.problem.mu

    @property
    def displacement(self) -> Array:
        """Largest displacement of any corner since the release [r], shape (frames,)."""
        return self._moved(self.poses.shape[-1])

    @property
    def beyond_plane(self) -> Array:
        """Largest displacement of any corner by motion out of the plane [r], (frames,)."""
        if self.poses.shape[-1] == PLANAR:
            return np.zeros(len(self.times))
        return self._moved(PLANAR, beyond=True)

    @property
    def overlap_share(self) -> float | None:
        """Deepest overlap over the root of the smallest block's area; None if not known."""
        deepest = self.quality.penetration
        if deepest is None:
            return None
        return deepest * self.assembly.size / min(map(_width, self.assembly.blocks))

    def _moved(self, count: int, *, beyond: bool = False) -> Array:
        """Displacements by the first columns of the poses, or by those beyond them."""
        at_once = max(1, CHUNK // max(1, self.poses[0].size))
        found: list[Array] = []
        for start in range(0, len(self.poses), at_once):
            moved = self.poses[start : start + at_once] - self.poses[0]
            if beyond:
                moved[..., :count] = 0.0
            found.append(displacement(moved, self.assembly))
        return np.concatenate(found)

    def seconds(self, gravity: float) -> Array:
        """Return times in seconds for a gravity in m/s^2."""
        return self.times * math.sqrt(self.assembly.size / gravity)

    def film(
        self,
        path: AnyPath,
        *,
        view: Literal["2d", "3d"] = "2d",
        slow: float | None = None,
        height: int = 720,
    ) -> None:
        """Write it as a film, or a frame of it as a picture, as `blocksim render` does.

        Parameters
        ----------
        path : Path
            Ending in .mp4 or .gif for a film, .png, .svg or .pdf for its last frame.
        view : {"2d", "3d"}
        slow : float, optional
            How many times slower than it happened.
        height : int
            In pixels; frames are 16:9.

        Raises
        ------
        InputError, MachineError
            If the film is too long or too large, or the file cannot be written.
        """
        renderer().film_of(self, path, view=view, slow=slow, height=height)

    def save(self, path: AnyPath) -> None:
        """Write a compressed .npz: arrays and one JSON text, nothing executable.

        Raises
        ------
        InputError, MachineError
            If the file cannot be written, or would be too large to be read.
        """
        header = {
            "format": FORMAT,
            "problem": to_record(self.problem),
            "engine": self.engine,
            "engine_version": self.engine_version,
            "settings": to_record(self.settings),
            "quality": to_record(self.quality),
            "state_hash": self.state_hash,
        }
        text = np.array(json_text(header))
        inside = self.times.nbytes + self.poses.nbytes + text.nbytes
        allowed = f"at most {LARGEST_INSIDE} (a shorter time, or fewer blocks)"
        require(inside <= LARGEST_INSIDE, "bytes of the recording", inside, allowed)

        def write(file: BinaryIO) -> None:
            np.savez_compressed(file, header=text, times=self.times, poses=self.poses)

        write_whole(path, write)


def _width(block: Block) -> float:
    """Return the root of a block's area [m]."""
    x, y = block.vertices.T
    return math.sqrt(abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2)


Header = dict[str, Any]
"""What a recording says beside its arrays."""


def read_recording(
    path: AnyPath,
    renew: Callable[[Header], Header] = dict,
    maker_of: Callable[[Mapping[str, object]], Maker | None] = lambda _: None,
) -> Recording:
    """Read a recording and check that it is one.

    Parameters
    ----------
    path : str or path
    renew : callable, optional
        Makes the header of an older format one of today's.
    maker_of : callable, optional
        As of `from_record`.

    Raises
    ------
    InputError
        If the file is missing, too large, or no recording.
    """
    where = os.fspath(path)
    try:
        with opened(path, "recording", "an existing .npz file", LARGEST_FILE) as file:
            header, times, poses = _parts(file)
        header = renew(header)
        require(header.get("format") == FORMAT, "recording", where, f"of format {FORMAT}")
        recording = Recording(
            problem=from_record(header["problem"], maker_of),
            engine=str(header["engine"]),
            engine_version=str(header["engine_version"]),
            settings=_settings(header["settings"]),
            times=times,
            poses=poses,
            quality=_quality(header.get("quality", {})),
        )
        _require_header(recording)
    except InputError as error:
        if error.field == "recording":
            raise
        if error.field != "array":
            raise _foreign(where) from None
        allowed = f"{error.allowed} ({error.value})"
        raise InputError("recording", where, allowed) from None
    except _UNREADABLE:
        raise _foreign(where) from None
    expected = (recording.times.size, len(recording.assembly.blocks))
    shaped = recording.times.ndim == 1 and recording.poses.shape in {
        (*expected, PLANAR),
        (*expected, SPATIAL),
    }
    if not shaped:
        raise InputError("recording", where, f"of poses of shape {(*expected, PLANAR)}")
    if header.get("state_hash") != recording.state_hash:
        raise InputError("recording", where, "undamaged (its state hash does not match)")
    assembly = recording.assembly
    if not assembly.supports and not assembly.springings:
        raise InputError("recording", where, "of blocks that stand on something")
    if not _moves(recording):
        raise InputError("recording", where, "of finite poses at times that grow")
    return recording


def _foreign(where: str) -> InputError:
    return InputError("recording", where, WRITTEN)


def _settings(written: dict[str, Any]) -> Settings:
    """Read settings, whose numbers may be infinite."""
    inf = math.inf
    given = dict(written).items()
    named: dict[str, Any] = {name: inf if each == "inf" else each for name, each in given}
    if not all(each is None or isinstance(each, int | float) for each in named.values()):
        raise TypeError
    return Settings(**named)


def _quality(written: dict[str, Any]) -> Quality:
    inf = math.inf
    named = {name: inf if each == "inf" else each for name, each in dict(written).items()}
    if not all(each is None or is_number(each, -inf, inf) for each in named.values()):
        raise TypeError
    return Quality(**named)


def _parts(file: BinaryIO) -> tuple[dict[str, Any], Array, Array]:
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


def _require_header(recording: Recording) -> None:
    """Raise `InputError` where what is said beside the poses cannot be."""
    name = f"{recording.engine} {recording.engine_version}"
    require(name.isascii() and name.isprintable() and len(name) < 80, "engine", name, "a name")


def _moves(recording: Recording) -> bool:
    """Tell whether there is a first frame, and later ones follow it in time and in space."""
    times, poses = recording.times, recording.poses
    if not times.size:
        return False
    near = poses.max(initial=0.0) < FARTHEST and poses.min(initial=0.0) > -FARTHEST
    known = times.max() < LATEST and times.min() > -LATEST
    return bool(known and near and (np.diff(times) > 0).all())
