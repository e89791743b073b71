"""What every recording has, in the plane and in space."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.base import Quality, Settings

Asked = TypeVar("Asked")
"""The problem: one of the plane, or one in space."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Recorded(Generic[Asked]):
    """The motion of blocks in one engine.

    Parameters
    ----------
    problem : Problem or SpatialProblem
    engine, engine_version : str
    settings : Settings
    times : (frames,) float
        In units of sqrt(size/g), from the release.
    poses : (frames, blocks, columns) float
    quality : Quality
        How well contact and friction were kept.
    """

    problem: Asked
    engine: str
    engine_version: str
    settings: Settings
    times: Array
    poses: Array
    quality: Quality = field(default_factory=Quality)

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({len(self.times)} frames, {self.times[-1]:.4g} "
            f"sqrt(size/g), by {self.engine}, of {self.problem!r})"
        )

    @property
    def displacement(self) -> Array:
        """Largest displacement of any corner since the release [size], (frames,)."""
        raise NotImplementedError

    @property
    def state_hash(self) -> str:
        """Fingerprint of all poses: equal if and only if the motions are, bit by bit."""
        little = np.ascontiguousarray(self.poses, dtype="<f8")
        return hashlib.sha256(little.reshape(-1).data).hexdigest()[:16]
