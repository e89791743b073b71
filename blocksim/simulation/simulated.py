"""A problem in an engine: everything a recording must know to be made again."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, Protocol, Self, cast

import numpy as np

from blocksim.blocks.assembly import Array, Blocks
from blocksim.blocks.problem import Problem
from blocksim.common.checks import Range
from blocksim.engines import get_engine
from blocksim.engines.base import Engine, Quality, Settings, TakesForces, TellsForces, World
from blocksim.simulation.recording import Recording

if TYPE_CHECKING:
    from blocksim.simulation.looking import Looking
    from blocksim.simulation.onset import Onset

Overrides = Mapping[str, float]
"""Fields of an engine's `Settings` by name, given instead of what its rule says."""
BY_RULE: Overrides = {}
"""None given."""


SETTINGS = {
    "step": Range(low=1e-6, high=0.2),
    "accuracy": Range(low=1e-8, high=0.05),
    "sweeps": Range(low=1, high=1e7, whole=True),
    "hold_sweeps": Range(low=1, high=1e9, whole=True),
    "still": Range(low=1e-15, high=1e-2),
    "rest": Range(low=1e-15, high=1e-2),
    "restitution": Range(low=0, high=1),
}
"""Of `engines.base.Settings`, which says what each is."""


def require_setting(name: str, value: float) -> None:
    """Raise `InputError` unless a setting is within its range."""
    SETTINGS[name].require(f"settings.{name}", value)


def setting_of(name: str, value: float) -> float:
    """Return the value of a setting, as an `int` where it is a whole number."""
    return round(value) if SETTINGS[name].whole else value


def settings_by(rule: Settings, given: Overrides) -> Settings:
    """Return the settings of a rule, but those given; an accuracy alone sets the step, too.

    Errors of motion grow as the step squared.
    """
    settings = replace(rule, **{name: setting_of(name, value) for name, value in given.items()})
    if "accuracy" not in given or "step" in given:
        return settings
    return replace(settings, step=rule.step * math.sqrt(settings.accuracy / rule.accuracy))


def given_words(settings: Overrides) -> str:
    """Say which settings were given, to be added to the reason of an answer."""
    return "".join(f"; {name} {value:g} as given" for name, value in settings.items())


LONGER, FEWER = 2.0, 0.5
"""Steps and sweeps, over the rule's, up to which moving runs of every engine were right."""


class Reduced(Protocol):
    """What stands for all blocks of a problem in an engine: fewer, that move alike."""

    @property
    def by(self) -> str:
        """What it does, in words."""
        ...

    @property
    def kept(self) -> tuple[int, ...]:
        """Joints that may move."""
        ...

    @property
    def forces(self) -> Array | None:
        """What its world begins with; None for nothing."""
        ...

    def of_problem(self, problem: Problem) -> Problem:
        """Return the problem that is simulated, from that of all blocks."""
        ...

    def asked(self, problem: Problem) -> Problem:
        """Return the problem whose forces its world takes, from that of all blocks."""
        ...

    def poses(self, poses: Array) -> Array:
        """Return the poses of all blocks, from those of the blocks simulated."""
        ...

    def rates(self, rates: Array) -> Array:
        """Return velocities or accelerations at rest likewise."""
        ...

    def resultants(self, resultants: Array) -> Array:
        """Return what joints carry at rest, from what those simulated do; see `revised`."""
        ...

    def handed(self, forces: Array) -> Array:
        """Return the forces in the joints simulated, from those of `asked`."""
        ...

    def revised(
        self, first: Onset, resultants: Array, simulation: Simulation[Any]
    ) -> Reduced | None:
        """Return this where it stands for all blocks, else what does; None: all blocks.

        `first`: What was seen.
        `resultants`, (joints, 3): What `ReducedWorld.resultants` says.
        `simulation`: With this; `still` of its settings is the force beyond the strength of a
            joint that counts as none [mean weights].
        """
        ...


class ReducedWorld:
    """The world of all blocks, of which an engine knows fewer.

    `world`: Of the blocks simulated.
    """

    def __init__(self, world: World, reduction: Reduced) -> None:
        self._world, self._reduction = world, reduction

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest."""
        return self._reduction.rates(self._world.hold(sweeps))

    def begin(self, forces: Array) -> None:
        """Begin anew, with forces."""
        cast("TakesForces", self._world).begin(self._reduction.handed(forces))

    def advance(self, steps: int) -> None:
        """Let the blocks move."""
        self._world.advance(steps)

    def poses(self) -> Array:
        """Return the poses of all blocks."""
        return self._reduction.poses(self._world.poses())

    def resultants(self) -> Array:
        """Return what joints carry, at rest."""
        return self._reduction.resultants(cast("TellsForces", self._world).resultants())

    def quality(self) -> Quality:
        """Tell how well contact and friction have been kept so far."""
        return self._world.quality()


@dataclass(frozen=True, kw_only=True)
class Simulation(Generic[Blocks]):
    """A problem, in the plane or in space, an engine and its settings.

    `given`: Those settings that do not follow the engine's rule.
    `reduction`: What the engine is given in place of all blocks, in the plane.
    """

    problem: Problem[Blocks]
    engine: Engine
    settings: Settings
    given: Overrides = field(default_factory=dict[str, float])
    reduction: Reduced | None = None

    @classmethod
    def of(
        cls,
        problem: Problem[Blocks],
        engine: str | Engine,
        *,
        settings: Overrides = BY_RULE,
        reduction: Reduced | None = None,
    ) -> Simulation[Blocks]:
        """Take the settings that the engine chooses for the blocks, or those given."""
        found = get_engine(engine)
        rule: Any = found.rule_in_space if problem.in_space else found.rule
        return cls(
            problem=problem,
            engine=found,
            settings=settings_by(rule(problem.assembly), settings),
            given=settings,
            reduction=reduction,
        )

    @property
    def assembly(self) -> Blocks:
        """All blocks and joints."""
        return self.problem.assembly

    @property
    def most_friction(self) -> float:
        """Friction above which the engine takes this instead."""
        engine = self.engine
        in_space = engine.most_friction_in_space if self.problem.in_space else math.inf
        return min(engine.most_friction, in_space)

    @cached_property
    def taken(self) -> Problem[Blocks]:
        """The problem with the friction the engine takes, which may be bounded."""
        problem, most = self.problem, self.engine.most_friction
        # In space engines bound it by themselves.
        return problem if problem.in_space or problem.mu <= most else replace(problem, mu=most)

    @cached_property
    def simulated(self) -> Problem[Blocks]:
        """The same of the blocks the engine is given."""
        if self.reduction is None:
            return self.taken
        return cast("Problem[Blocks]", self.reduction.of_problem(cast("Problem", self.taken)))

    @cached_property
    def rougher(self) -> Problem[Blocks] | None:
        """The problem with the friction asked for, where the engine takes less of it."""
        least = (self.problem.friction <= self.most_friction).all()
        return None if least else self.problem

    @property
    def look(self) -> Looking:
        """The problem as it is looked at where blocks move."""
        # Questions without motion do without what this loads.
        from blocksim.simulation.looking import Looking

        return Looking(self.problem)

    @property
    def length(self) -> str:
        """What the unit of length is called: the radius of an arch, or the size of others."""
        return self.problem.length_name

    @property
    def takes_forces(self) -> bool:
        """Whether its world can be given forces to begin with."""
        return self.engine.takes_forces or self.problem.in_space

    @property
    def blocks(self) -> int:
        """How many blocks the engine is given."""
        return len(self.simulated.assembly.blocks)

    def world(self) -> World:
        """Blocks in the engine, at rest."""
        build: Any = self.engine.build_in_space if self.problem.in_space else self.engine.build
        world: World = build(self.simulated, self.settings)
        return ReducedWorld(world, self.reduction) if self.reduction else world

    @property
    def unsure(self) -> str:
        """What of the settings lies where moving runs were seen to fail; else empty.

        Measured over five arches in pymunk and pybullet: blocks begin to overlap at four times
        the step with half the sweeps, and at a quarter of the sweeps, in a step or in the same
        time. `tests/test_onset.py` has both sides.
        """
        if self.problem.in_space:
            return ""
        rule = self.engine.rule(cast("Any", self.assembly))
        longer = self.settings.step / rule.step
        fewer = self.settings.sweeps / rule.sweeps / max(1.0, longer)
        said: list[str] = []
        if longer > LONGER:
            said.append(f"a time step {longer:.3g} times the rule's is too long to be sure")
        if fewer < FEWER:
            said.append(f"sweeps {fewer:.2g} times the rule's are too few to be sure")
        return "; ".join(said)

    def finer(self, factor: int) -> Self:
        """Return the same with `factor` times the sweeps in each step of a moving run."""
        return replace(
            self, settings=replace(self.settings, sweeps=self.settings.sweeps * factor)
        )

    def at_step(self, step: float) -> Self:
        """Return the same with another time step."""
        return replace(self, settings=replace(self.settings, step=step))

    def record(
        self, times: Sequence[float], poses: Sequence[Array], quality: Quality
    ) -> Recording[Blocks]:
        """Return frames as a recording."""
        return Recording(
            problem=self.problem,
            engine=self.engine.name,
            engine_version=self.engine.version,
            settings=self.settings,
            times=np.array(times),
            poses=np.array(poses),
            quality=quality,
        )
