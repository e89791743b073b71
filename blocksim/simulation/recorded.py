"""What every recording has, in the plane and in space."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Generic, Self, TypeVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.base import Engine, Quality, Settings

Asked = TypeVar("Asked")
"""The problem: one of the plane, or one in space."""
Recording = TypeVar("Recording")
Overrides = Mapping[str, float]
"""Fields of an engine's `Settings` by name, given instead of what its rule says."""


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


@dataclass(frozen=True, kw_only=True)
class Simulated(Generic[Asked]):
    """A problem, an engine and its settings, in the plane or in space.

    Parameters
    ----------
    problem : Problem or SpatialProblem
    engine : Engine
    settings : Settings
    given : mapping of str to float
        Those settings that do not follow the engine's rule.
    """

    problem: Asked
    engine: Engine
    settings: Settings
    given: Overrides = field(default_factory=dict[str, float])

    def finer(self, factor: int) -> Self:
        """Return the same with `factor` times the sweeps in each step of a moving run."""
        return replace(
            self, settings=replace(self.settings, sweeps=self.settings.sweeps * factor)
        )

    def recorded(
        self,
        kind: Callable[..., Recording],
        times: Sequence[float],
        poses: Sequence[Array],
        quality: Quality,
    ) -> Recording:
        """Return frames as a recording of a kind."""
        return kind(
            problem=self.problem,
            engine=self.engine.name,
            engine_version=self.engine.version,
            settings=self.settings,
            times=np.array(times),
            poses=np.array(poses),
            quality=quality,
        )
