"""An arch in an engine: everything a recording must know to be made again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from blocksim.arch.circular import Arch
from blocksim.arch.reduction import ReducedWorld, Reduction
from blocksim.blocks.assembly import Array, Assembly
from blocksim.common.checks import is_number, require
from blocksim.engines import get_engine
from blocksim.engines.base import Engine, Quality, Settings, World
from blocksim.evidence.recording import Recording

Overrides = Mapping[str, float]
"""Fields of an engine's `Settings` by name, given instead of what its rule says."""
BY_RULE: Overrides = {}
"""None given."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Range of a setting that can be given.

    Parameters
    ----------
    low, high : float
        Both allowed.
    is_whole : bool
    """

    low: float
    high: float
    is_whole: bool = False

    @property
    def allowed(self) -> str:
        """The range in words."""
        return f"a {'whole ' * self.is_whole}number from {self.low:g} to {self.high:g}"


SETTINGS = {
    "step": Setting(low=1e-6, high=0.2),
    "sweeps": Setting(low=1, high=1e7, is_whole=True),
    "hold_sweeps": Setting(low=1, high=1e9, is_whole=True),
    "still": Setting(low=1e-15, high=1e-2),
    "rest": Setting(low=1e-15, high=1e-2),
}
"""Of `engines.base.Settings`, which says what each is."""


def require_setting(name: str, value: float) -> None:
    """Raise `InputError` unless a setting is within its range."""
    setting = SETTINGS[name]
    ok = is_number(value, 0, setting.high) and value >= setting.low
    ok = ok and not (setting.is_whole and value != int(value))
    require(ok, f"settings.{name}", value, setting.allowed)


def given_words(settings: Overrides) -> str:
    """Say which settings were given, to be added to the reason of an answer."""
    return "".join(f"; {name} {value:g} as given" for name, value in settings.items())


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
    given : mapping of str to float
        Those settings that do not follow the engine's rule.
    reduction : Reduction or None
        What the engine is given in place of all voussoirs.
    """

    arch: Arch
    mu: float
    engine: Engine
    settings: Settings
    given: Overrides = field(default_factory=dict[str, float])
    reduction: Reduction | None = None

    @classmethod
    def of(
        cls,
        arch: Arch,
        mu: float,
        engine: str,
        *,
        lean: float = 0.0,
        settings: Overrides = BY_RULE,
        reduction: Reduction | None = None,
    ) -> Setup:
        """Take the settings that the engine chooses for the arch, or those given.

        Lean [rad] as in `Settings`, for engines in three dimensions.
        """
        library = get_engine(engine)
        given = {
            name: int(value) if SETTINGS[name].is_whole else value
            for name, value in settings.items()
        }
        chosen = library.settings(reduction.whole if reduction else arch.assembly())
        return cls(
            arch=arch,
            mu=mu,
            engine=library,
            settings=replace(chosen, lean=lean, **given),
            given=settings,
            reduction=reduction,
        )

    @cached_property
    def assembly(self) -> Assembly:
        """The arch's blocks and joints."""
        return self.reduction.whole if self.reduction else self.arch.assembly()

    @property
    def simulated(self) -> Assembly:
        """The blocks and joints the engine is given."""
        return (self.reduction or self).assembly

    @property
    def blocks(self) -> int:
        """How many blocks the engine is given."""
        return len(self.simulated.blocks)

    def world(self) -> World:
        """Blocks in the engine, at rest."""
        world = self.engine.build(self.simulated, self.mu, self.settings)
        return ReducedWorld(world, self.reduction) if self.reduction else world

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
