"""What every engine gives: blocks at rest, blocks let go, and their poses.

A world is scaled: lengths in units of the assembly's size, time in units of
sqrt(size/g), masses in units of the mean block's. Gravity is 1, downwards. Scale, density
and gravity therefore cannot change an answer, and no engine's absolute tolerance meets
an unexpected unit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Protocol

from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.later import Library as Library

FRICTION_CAP = 1e3
"""Most friction of an engine without a bound of its own.

Engines multiply friction by impulses that may be 0, so inf cannot be passed on.

The thrust below which an inner joint slides is about 1/(4 mu^2) for large mu: at this
cap 2.5e-7 of the weight scale, far below what an engine resolves.
"""


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What an engine is run with, scaled as its world.

    Parameters
    ----------
    step : float
        Time step.
    sweeps : int
        Sweeps over all contacts in each step of a moving run.
    hold_sweeps : int
        Most sweeps the onset test may spend.
    unaided : int or None
        Sweeps after which it begins anew with forces of limit analysis; None for never.
    still : float
        Acceleration below which an arch held at rest counts as at rest [g].
    closing : float
        Share of its motion by which joints may close in a mechanism.
    rest : float
        Displacement below which an arch let go counts as at rest [size].
    noise : float
        Displacement of an arch let go below which overlap is not looked at [size].
    residual : float
        Worst residual of the contacts at which an answer still counts.
    penetration : float
        Deepest overlap at which an answer still counts [size].
    accuracy : float
        Share by which motion may be off, where an engine follows one. Its steps are as long
        as the root of that allows.
    repeats : int
        Most repetitions, with finer sweeps, of a moving run that contacts started.
    restitution : float
        Share of the velocity with which blocks hit that they part with, where an engine lets
        them bounce.
    farthest : float
        Distance from the origin beyond which the engine is given no block [size]: coordinates
        there round off by 2e-16 of it.
    """

    step: float
    sweeps: int
    hold_sweeps: int
    unaided: int | None = None
    still: float = 1e-6
    closing: float = 1e-5
    rest: float = 1e-5
    noise: float = 1e-7
    residual: float = math.inf
    penetration: float = math.inf
    accuracy: float = 1e-3
    repeats: int = 3
    restitution: float = 0.0
    farthest: float = 1e4


@dataclass(frozen=True, kw_only=True)
class Quality:
    """How well a motion has kept contact and friction; None where the engine cannot tell.

    `residual`: Worst imbalance, penetration rate or complementarity in any step [g].
    `penetration`: Deepest overlap of two blocks, in units of the size.
    `gain`: Most by which the energy rose above the least it had been, as a share of what fell,
        and of what moved at the release; None where the ground gives and takes it.
    `error`: How far corners were off by then, estimated [size]
        (`blocksim.simulation.repeating`).
    `late`: How early or late they went by a hundredth of the size, estimated [sqrt(size/g)];
        None where they did not.
    `known`: Time from which they may be off by more than a hundredth of the size
        [sqrt(size/g)]; None where there is none.
    """

    residual: float | None = None
    penetration: float | None = None
    gain: float | None = None
    error: float | None = None
    late: float | None = None
    known: float | None = None


class World(Protocol):
    """Blocks in an engine, at rest where they were built until let go."""

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back.

        Impulses are kept, so that a further call goes on where this one stopped.

        `sweeps`: Sweeps over all contacts.
        Returns (blocks, 3 or 6): Accelerations [g] and [g/size] the blocks would start with,
            columns as poses.
        """
        ...

    def advance(self, steps: int) -> None:
        """Let the blocks move for a number of steps."""
        ...

    def poses(self) -> Array:
        """Return centres of mass x, y and rotations [rad], (blocks, 3).

        In space x, y, z and rotation vectors, (blocks, 6).
        """
        ...

    def quality(self) -> Quality:
        """Tell how well contact and friction have been kept so far."""
        ...


class TakesForces(World, Protocol):
    """A world that can be given forces to begin with; see `Engine.takes_forces`."""

    def begin(self, forces: Array) -> None:
        """Begin anew, with forces that the joints may carry.

        Coulomb's law may allow both rest and motion, and which of them is found depends on
        where the search for impulses begins.

        `forces`, (points, 3): At the inner and the outer end of each joint, along its normal
            and its tangent, as they act on `after`; in space at the points of `JointPoints`,
            along their axes [mean weights].
        """
        ...


class TakesVelocities(World, Protocol):
    """A world whose blocks may begin in motion; see `Engine.shakes`."""

    def push(self, velocities: Array) -> None:
        """Set the velocities, shape (blocks, 3) [sqrt(size g), sqrt(g/size)]."""
        ...


class TellsForces(World, Protocol):
    """A world that tells what its joints carry; see `Engine.tells_forces`."""

    def resultants(self) -> Array:
        """Return what each joint carried in the step solved last, as it acts on `after`.

        Returns (joints, 3): Force x, y and moment about the origin [mean weights, times the
            size].
        """
        ...


def trusted(world: World, settings: Settings) -> bool:
    """Tell whether the contacts of a world have kept within the bounds allowed."""
    residual, penetration = world.quality().residual, world.quality().penetration
    found = residual is None or (residual <= settings.residual and math.isfinite(residual))
    return found and (penetration is None or penetration <= settings.penetration)


@dataclass(frozen=True, kw_only=True)
class Method:
    """A way to answer, and what it can do.

    `name`: As on the command line.
    `sees`: What it can tell.
    `finest`: Smallest relative width of a bracket it can answer for; its error is less.
    `moves_supports`: Whether it can follow supports that move.
    `adjustable`: Settings that a user may give instead of what its rule says. With `accuracy`
        its motion says how right it is.
    `chart`: Settings from coarse to fine that the chart of error against time tries, by what is
        refined (`blocksim.studies.refinement`).
    `colour`, `tint`, `marker`: How it is drawn where methods are compared: Okabe and Ito's
        palette, lightened for areas, and a shape of points, so that colour never stands alone.
    """

    name: str
    sees: str
    finest: float
    moves_supports: bool = False
    adjustable: tuple[str, ...] = ()
    chart: Mapping[str, tuple[float, ...]] = field(default_factory=dict[str, tuple[float, ...]])
    colour: str = "#000000"
    tint: str = "#ffffff"
    marker: str = "*"

    @property
    def is_static(self) -> bool:
        """Whether it answers without motion."""
        return True

    @property
    def missing(self) -> str | None:
        """How to install what it needs; None where that is there, or nothing is needed."""
        return None


@dataclass(frozen=True, kw_only=True)
class Engine(Method):
    """A method that sets blocks in motion.

    `library`: Module it needs.
    `remedy`: How to install that.
    `version_of`: Gives the version of the library, which has to be there.
    `rule`: Chooses settings that suit an assembly.
    `build`: Puts the blocks of a problem into the engine, all contacts closed, at rest.
    `rule_in_space`, `build_in_space`: The same of blocks in space, in worlds that are
        `TakesForces`; None where it moves none there.
    `most_friction`, `most_friction_in_space`: Friction above which the engine takes this
        instead.
    `shakes`: Whether its ground can shake, in space too if it moves blocks there, and blocks of
        the plane may begin in motion (`TakesVelocities`).
    `finds_rest`: Whether rest is found wherever it is possible, from any beginning.
    `takes_forces`, `tells_forces`: Whether its worlds are also `TakesForces` and `TellsForces`.
        Fewer blocks than all ask for the second.
    `keeps_impulses`: Whether its worlds go on from forces that are given, also from such that
        do not balance.
    `reduces`: Whether arches are reduced where nothing else is said: shown to be right, and
        faster.
    `merges`: The same of the blocks of other structures.
    `contacts`: Contacts of a joint.
    `usual_sweeps`: Sweeps in a step that users of the library take; one where a step is solved
        to its end.
    `validates`: Parts of `validate` it is asked in where no engine is named: "arches",
        "structures".
    `validated_to`: Relative width of the brackets that `validate` asks it for, of arches.
    `aside`: Share of a known value by which `validate` goes to either side of it, of
        structures.
    `beside`: Steps of the runs by which the error of a motion is told, in those of the motion.
    `most_blocks`: Blocks up to which `validate` asks it: it takes minutes for more.
    """

    library: str
    remedy: str
    version_of: Callable[[], str]
    rule: Callable[[Assembly], Settings]
    build: Callable[[Problem, Settings], World]
    rule_in_space: Callable[[SpatialAssembly], Settings] | None = None
    build_in_space: Callable[[Problem[SpatialAssembly], Settings], World] | None = None
    most_friction: float = FRICTION_CAP
    most_friction_in_space: float = FRICTION_CAP
    shakes: bool = False
    finds_rest: bool = False
    takes_forces: bool = False
    tells_forces: bool = False
    keeps_impulses: bool = False
    reduces: bool = False
    merges: bool = False
    contacts: int = 2
    usual_sweeps: int = 1
    validates: tuple[str, ...] = ()
    validated_to: float = 0.004
    aside: float = 0.01
    beside: tuple[float, ...] = (2.0,)
    most_blocks: int = 40

    @property
    def is_static(self) -> bool:
        """Whether it answers without motion: no engine does."""
        return False

    @property
    def version(self) -> str:
        """Version of the engine's library."""
        return self.version_of()

    @property
    def missing(self) -> str | None:
        """How to install its library; None where that is there."""
        return None if find_spec(self.library) else self.remedy
