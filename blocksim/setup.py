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

LONGER, FEWER = 2.0, 0.5
"""Steps and sweeps, over the rule's, up to which moving runs of every engine were right."""


@dataclass(frozen=True, kw_only=True)
class Setup:
    """An arch, its friction, an engine and its settings.

    Parameters
    ----------
    arch : Arch
    mu : float
    engine : Engine
    settings : Settings
    """

    arch: Arch
    mu: float
    engine: Engine
    settings: Settings

    @classmethod
    def of(
        cls,
        arch: Arch,
        mu: float,
        engine: str,
        *,
        tilt: float = 0.0,
        plane_lock: bool = False,
    ) -> Setup:
        """Take the settings that the engine chooses for the arch.

        Tilt [rad] and plane lock as in `Settings`, for engines in three dimensions.
        """
        library = get_engine(engine)
        settings = replace(library.settings(arch.assembly()), tilt=tilt, plane_lock=plane_lock)
        return cls(arch=arch, mu=mu, engine=library, settings=settings)

    @cached_property
    def assembly(self) -> Assembly:
        """The arch's blocks and joints."""
        return self.arch.assembly()

    def world(self) -> World:
        """Blocks in the engine, at rest."""
        return self.engine.build(self.assembly, self.mu, self.settings)

    @property
    def unsure(self) -> str:
        """What of the settings lies where moving runs were seen to fail; else empty.

        Measured by `analysis/stability.py`: blocks begin to overlap at four times the step
        with half the sweeps, and at a quarter of the sweeps, in a step or in the same time.
        """
        rule = self.engine.settings(self.assembly)
        longer = self.settings.step / rule.step
        fewer = self.settings.sweeps / rule.sweeps / max(1.0, longer)
        said: list[str] = []
        if longer > LONGER:
            said.append(f"a time step {longer:.3g} times the rule's is too long to be sure")
        if fewer < FEWER:
            said.append(f"sweeps {fewer:.2g} times the rule's are too few to be sure")
        return "; ".join(said)

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
