"""A recording: poses over time, from which everything else is derived."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, BinaryIO, Generic, Literal, cast

import numpy as np

from blocksim.blocks.assembly import PLANAR, SPATIAL, Array, Blocks
from blocksim.blocks.outlines import signed_area
from blocksim.blocks.problem import Problem
from blocksim.blocks.record import from_record, to_record
from blocksim.blocks.space.extruded import extruded, lifted
from blocksim.common.checks import infinite, is_number, require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, json_text, opened, write_whole
from blocksim.common.shown import Shown, renderer
from blocksim.engines.base import Quality, Settings
from blocksim.simulation.archive import LARGEST_INSIDE, UNREADABLE, parts_of

if TYPE_CHECKING:
    from blocksim.blocks.maker import Kind

FORMAT = 2
WRITTEN = "written by blocksim simulate"
LARGEST_FILE = 1 << 28
"""Bytes of a file."""
CHUNK = 1 << 20
"""Numbers looked at at once."""
FARTHEST, LATEST = 1e9, 1e9
"""Largest way of a block [size], and largest time [sqrt(size/g)]."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Recording(Shown, Generic[Blocks]):
    """The motion of blocks in one engine, in the plane or in space.

    Lengths are in units of the assembly's size, which is the radius r of an arch.

    Parameters
    ----------
    problem : Problem
    engine, engine_version : str
    settings : Settings
    times : (frames,) float
        In units of sqrt(size/g), from the release.
    poses : (frames, blocks, 3 or 6) float
        Centres of mass x, y in units of the size and rotations [rad]. In space: centres of mass
        x, y, z, and rotation vectors since the release.
    quality : Quality
        How well contact and friction were kept.
    """

    problem: Problem[Blocks]
    engine: str
    engine_version: str
    settings: Settings
    times: Array
    poses: Array
    quality: Quality = field(default_factory=Quality)

    def __repr__(self) -> str:
        return (
            f"Recording({len(self.times)} frames, {self.times[-1]:.4g} "
            f"sqrt(size/g), by {self.engine}, of {self.problem!r})"
        )

    @property
    def state_hash(self) -> str:
        """Fingerprint of all poses: equal if and only if the motions are, bit by bit."""
        little = np.ascontiguousarray(self.poses, dtype="<f8")
        return hashlib.sha256(little.reshape(-1).data).hexdigest()[:16]

    @property
    def assembly(self) -> Blocks:
        """Its blocks and joints."""
        return self.problem.assembly

    @property
    def mu(self) -> float:
        """Friction coefficient of all joints that have none of their own."""
        return self.problem.mu

    @property
    def displacement(self) -> Array:
        """Largest displacement of any corner since the release [r], shape (frames,)."""
        at_once = max(1, CHUNK // max(1, self.poses[0].size))
        starts = range(0, len(self.poses), at_once)
        parts = (self.poses[start : start + at_once] - self.poses[0] for start in starts)
        return np.concatenate([self.assembly.displacement(part) for part in parts])

    @property
    def unsolved(self) -> float:
        """How far contact forces were off where `direct` did not find them [g]; else 0.

        Blocks of the plane are left where they are then, which is no rest.
        """
        planar = self.engine == "direct" and not self.problem.in_space
        left = self.quality.residual or 0.0 if planar else 0.0
        return 0.0 if left <= self.settings.residual else left

    @property
    def overlap_share(self) -> float | None:
        """Deepest overlap over the width of the smallest block; None if not known.

        The width is the root of its area, or the cube root of its volume.
        """
        deepest = self.quality.penetration
        if deepest is None:
            return None
        blocks: Any = self.assembly.blocks
        if self.problem.in_space:
            width = math.cbrt(min(sum(hull.volume for hull in each.hulls) for each in blocks))
        else:
            width = math.sqrt(min(signed_area(each.vertices) for each in blocks))
        return deepest * self.assembly.size / width

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
            Of blocks of the plane; those in space are seen in perspective.
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


Header = dict[str, Any]
"""What a recording says beside its arrays."""


def read_recording(
    path: AnyPath,
    renew: Callable[[Header], Header] = dict,
    maker_of: Callable[[Mapping[str, object]], Kind[Any] | None] = lambda _: None,
) -> Recording[Any]:
    """Read a recording and check that it is one.

    `renew`: Makes the header of an older format one of today's.
    `maker_of`: As of `from_record`.
    """
    where = os.fspath(path)
    try:
        with opened(path, "recording", "an existing .npz file", LARGEST_FILE) as file:
            header, times, poses = parts_of(file)
        header = renew(header)
        require(header.get("format") == FORMAT, "recording", where, f"of format {FORMAT}")
        recording = Recording(
            problem=from_record(header["problem"], maker_of),
            engine=str(header["engine"]),
            engine_version=str(header["engine_version"]),
            settings=Settings(**_numbers(header["settings"])),
            times=times,
            poses=poses,
            quality=Quality(**_numbers(header.get("quality", {}))),
        )
        name = f"{recording.engine} {recording.engine_version}"
        named = name.isascii() and name.isprintable() and len(name) < 80
        require(named, "engine", name, "a name")
    except InputError as error:
        if error.field == "recording":
            raise
        if error.field != "array":
            raise _foreign(where) from None
        allowed = f"{error.allowed} ({error.value})"
        raise InputError("recording", where, allowed) from None
    except UNREADABLE:
        raise _foreign(where) from None
    assembly = recording.assembly
    expected = (recording.times.size, len(assembly.blocks))
    known = {(*expected, assembly.columns), (*expected, SPATIAL)}
    if recording.times.ndim != 1 or recording.poses.shape not in known:
        raise InputError(
            "recording", where, f"of poses of shape {(*expected, assembly.columns)}"
        )
    if header.get("state_hash") != recording.state_hash:
        raise InputError("recording", where, "undamaged (its state hash does not match)")
    carried = assembly.supports or (not recording.problem.in_space and assembly.springings)
    if not carried:
        raise InputError("recording", where, "of blocks that stand on something")
    if not _moves(recording):
        raise InputError("recording", where, "of finite poses at times that grow")
    return recording if poses.shape[-1] == assembly.columns else _of_its_space(recording)


def _of_its_space(recording: Recording) -> Recording[Any]:
    """Return an older recording of the plane, which told of motion out of it, as one of today.

    Where gravity leaned out of the plane, it is of prisms in space.
    """
    asked, poses = recording.problem, recording.poses
    if asked.is_planar:
        return replace(recording, poses=poses[..., :PLANAR])
    made = extruded(asked)
    share = asked.assembly.size / made.assembly.size
    in_space = lifted(poses[..., :PLANAR])
    in_space[..., [1, 3, 5]] = poses[..., PLANAR:] * [-1.0, 1.0, 1.0]
    in_space[..., :3] *= share
    times = recording.times * math.sqrt(share)
    return replace(cast("Any", recording), problem=made, times=times, poses=in_space)


def _foreign(where: str) -> InputError:
    return InputError("recording", where, WRITTEN)


def _numbers(written: Mapping[str, Any]) -> dict[str, Any]:
    """Read settings or a quality, whose numbers may be infinite."""
    inf = math.inf
    named = {name: infinite(each) for name, each in dict(written).items()}
    if not all(each is None or is_number(each, -inf, inf) for each in named.values()):
        raise TypeError
    return named


def _moves(recording: Recording) -> bool:
    """Tell whether there is a first frame, and later ones follow it in time and in space."""
    times, poses = recording.times, recording.poses
    if not times.size:
        return False
    near = poses.max(initial=0.0) < FARTHEST and poses.min(initial=0.0) > -FARTHEST
    known = times.max() < LATEST and times.min() > -LATEST
    return bool(known and near and (np.diff(times) > 0).all())
