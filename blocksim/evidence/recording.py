"""A recording: poses over time, from which everything else is derived."""

from __future__ import annotations

import hashlib
import json
import math
import tokenize
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from blocksim.blocks.assembly import PLANAR, SPATIAL, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.blocks.record import from_record, to_record
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, json_text, require_file, write_whole
from blocksim.common.shown import Shown
from blocksim.engines.base import Quality, Settings

FORMAT = 2
WRITTEN = "written by blocksim simulate"
LARGEST_FILE = 1 << 30
"""Bytes; a larger file is not opened."""
LARGEST_INSIDE = 1 << 32
"""Bytes of its arrays, which can be packed into a thousandth."""
FARTHEST = 1e100
"""Beyond this a square is no number any more [r]."""
_UNREADABLE = (
    KeyError,
    TypeError,
    ValueError,
    OSError,
    EOFError,
    MemoryError,
    RuntimeError,
    zipfile.BadZipFile,
    SyntaxError,
    tokenize.TokenError,
    zlib.error,
)
"""What an empty, damaged or foreign file makes numpy, zipfile and json raise."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording(Shown):
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

    problem: Problem
    engine: str
    engine_version: str
    settings: Settings
    times: Array
    poses: Array
    quality: Quality = field(default_factory=Quality)

    def __repr__(self) -> str:
        return (
            f"Recording({len(self.times)} frames, {self.times[-1]:.4g} sqrt(size/g), "
            f"by {self.engine}, of {self.problem!r})"
        )

    @property
    def assembly(self) -> Assembly:
        """Its blocks and joints."""
        return self.problem.assembly

    @property
    def mu(self) -> float:
        """Friction coefficient of its joints, but for those with their own."""
        return self.problem.mu

    @property
    def state_hash(self) -> str:
        """Fingerprint of all poses: equal if and only if the motions are, bit by bit."""
        little = np.ascontiguousarray(self.poses, dtype="<f8")
        return hashlib.sha256(little.tobytes()).hexdigest()[:16]

    @property
    def displacement(self) -> Array:
        """Largest displacement of any corner since the release [r], shape (frames,)."""
        return displacement(self.poses - self.poses[0], self.assembly)

    @property
    def beyond_plane(self) -> Array:
        """Largest displacement of any corner by motion out of the plane [r], (frames,)."""
        moved = self.poses - self.poses[0]
        if moved.shape[-1] == PLANAR:
            return np.zeros(len(self.times))
        moved[..., :PLANAR] = 0.0
        return displacement(moved, self.assembly)

    def seconds(self, gravity: float) -> Array:
        """Return times in seconds for a gravity in m/s^2."""
        return self.times * math.sqrt(self.assembly.size / gravity)

    def save(self, path: AnyPath) -> None:
        """Write a compressed .npz: arrays and one JSON text, nothing executable.

        Raises
        ------
        InputError
            If the file cannot be written.
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

        def write(file: BinaryIO) -> None:
            np.savez_compressed(file, header=text, times=self.times, poses=self.poses)

        write_whole(path, write)


Header = dict[str, Any]
"""What a recording says beside its arrays."""


def read_recording(path: AnyPath, renew: Callable[[Header], Header] = dict) -> Recording:
    """Read a recording and check that it is one.

    Parameters
    ----------
    path : str or path
    renew : callable, optional
        Makes the header of an older format one of today's.

    Raises
    ------
    InputError
        If the file is missing, too large, or no recording.
    """
    path = Path(path)
    where = str(path)
    require_file(path, "recording", "an existing .npz file", LARGEST_FILE)
    try:
        header, times, poses = _parts(path)
        header = renew(header)
        require(header.get("format") == FORMAT, "recording", where, f"of format {FORMAT}")
        recording = Recording(
            problem=from_record(header["problem"]),
            engine=str(header["engine"]),
            engine_version=str(header["engine_version"]),
            settings=_settings(header["settings"]),
            times=times,
            poses=poses,
            quality=Quality(**header.get("quality", {})),
        )
        _require_header(recording)
    except InputError as error:
        raise error if error.field == "recording" else _foreign(where) from None
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


def _parts(path: Path) -> tuple[dict[str, Any], Array, Array]:
    """Unpack header, times and poses; what raises here is no recording."""
    # Opened here: np.load leaves the file open where it is no archive.
    with path.open("rb") as file:
        inside = sum(part.file_size for part in zipfile.ZipFile(file).infolist())
        require(inside <= LARGEST_INSIDE, "size", inside, f"at most {LARGEST_INSIDE} bytes")
        file.seek(0)
        with np.load(file, allow_pickle=False) as archive:
            header = json.loads(str(archive["header"]))
            times, poses = archive["times"], archive["poses"]
    kinds = times.dtype.kind + poses.dtype.kind
    require(kinds == "ff", "arrays", kinds, "of numbers")
    require(isinstance(header, dict), "header", header, "a table")
    return header, times.astype(np.float64), poses.astype(np.float64)


def _require_header(recording: Recording) -> None:
    """Raise `InputError` where what is said beside the poses cannot be."""
    name = f"{recording.engine} {recording.engine_version}"
    require(name.isascii() and name.isprintable() and len(name) < 80, "engine", name, "a name")


def _moves(recording: Recording) -> bool:
    """Tell whether there is a first frame, and later ones follow it in time and in space."""
    times, poses = recording.times, recording.poses
    known = np.isfinite(times).all() and (np.abs(poses) < FARTHEST).all()
    return bool(times.size and known and (np.diff(times) > 0).all())
