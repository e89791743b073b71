"""An arch in an engine: everything a recording must know to be made again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from blocksim.arch import Arch
from blocksim.assembly import Array, Assembly
from blocksim.engines import get_engine
from blocksim.engines.base import Engine, Quality, Settings, World
from blocksim.recording import Recording
from blocksim.reduction import ReducedWorld, Reduction


@dataclass(frozen=True, kw_only=True)
class Setup:
    """An arch, its friction, an engine and its settings.

    Parameters
    ----------
    arch : Arch
    mu : float
    engine : Engine
    settings : Settings
    reduction : Reduction or None
        What the engine is given in place of all voussoirs.
    """

    arch: Arch
    mu: float
    engine: Engine
    settings: Settings
    reduction: Reduction | None = None

    @classmethod
    def of(
        cls,
        arch: Arch,
        mu: float,
        engine: str,
        *,
        tilt: float = 0.0,
        plane_lock: bool = False,
        reduction: Reduction | None = None,
    ) -> Setup:
        """Take the settings that the engine chooses for the arch.

        Tilt [rad] and plane lock as in `Settings`, for engines in three dimensions.
        """
        library = get_engine(engine)
        whole = reduction.whole if reduction else arch.assembly()
        settings = replace(library.settings(whole), tilt=tilt, plane_lock=plane_lock)
        return cls(arch=arch, mu=mu, engine=library, settings=settings, reduction=reduction)

    @cached_property
    def assembly(self) -> Assembly:
        """The arch's blocks and joints."""
        return self.reduction.whole if self.reduction else self.arch.assembly()

    @property
    def blocks(self) -> int:
        """How many blocks the engine is given."""
        return len((self.reduction or self).assembly.blocks)

    def world(self) -> World:
        """Blocks in the engine, at rest."""
        if self.reduction is None:
            return self.engine.build(self.assembly, self.mu, self.settings)
        world = self.engine.build(self.reduction.assembly, self.mu, self.settings)
        return ReducedWorld(world, self.reduction)

    def finer(self, factor: int) -> Setup:
        """Return the same with `factor` times the sweeps in each step of a moving run."""
        settings = replace(self.settings, sweeps=self.settings.sweeps * factor)
        return replace(self, settings=settings)

    def record(
        self, times: Sequence[float], poses: Sequence[Array], quality: Quality
    ) -> Recording:
        """Return frames as a recording."""
        return Recording(
            arch=self.arch,
            mu=self.mu,
            engine=self.engine.name,
            engine_version=self.engine.version,
            settings=self.settings,
            times=np.array(times),
            poses=np.array(poses),
            quality=quality,
        )
