"""What every engine gives: blocks at rest, blocks let go, and their poses.

A world is scaled: lengths in units of the assembly's size, time in units of
sqrt(size/g), masses in units of the mean block's. Gravity is 1, downwards. Scale, density
and gravity therefore cannot change an answer, and no engine's absolute tolerance meets
an unexpected unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.problem import Problem

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
    """

    step: float
    sweeps: int
    hold_sweeps: int
    still: float = 1e-6
    closing: float = 1e-5
    rest: float = 1e-5
    noise: float = 1e-7
    residual: float = math.inf
    penetration: float = math.inf


@dataclass(frozen=True, kw_only=True)
class Quality:
    """How well a motion has kept contact and friction; None where the engine cannot tell.

    Parameters
    ----------
    residual : float or None
        Worst imbalance, penetration rate or complementarity in any step [g].
    penetration : float or None
        Deepest overlap at the end of a joint, in units of the size.
    """

    residual: float | None = None
    penetration: float | None = None


class World(Protocol):
    """Blocks in an engine, at rest where they were built until let go."""

    @property
    def finds_rest(self) -> bool:
        """Whether rest is found wherever it is possible, from any beginning."""
        ...

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back.

        Impulses are kept, so that a further call goes on where this one stopped.

        Parameters
        ----------
        sweeps : int
            Sweeps over all contacts.

        Returns
        -------
        (blocks, 3 or 6) float
            Accelerations [g] and [g/size] the blocks would start with, columns as poses.
        """
        ...

    def begin(self, forces: Array) -> bool:
        """Begin anew, with forces that the joints may carry.

        Coulomb's law may allow both rest and motion, and which of them is found depends on
        where the search for impulses begins.

        Parameters
        ----------
        forces : (joints, 2, 2) float
            At the inner and the outer end of each joint, along its normal and its tangent,
            as they act on `after` [mean weights].

        Returns
        -------
        bool
            False from an engine that cannot be given any.
        """
        ...

    def advance(self, steps: int) -> None:
        """Let the blocks move for a number of steps."""
        ...

    def resultants(self) -> Array:
        """Return what each joint carried in the step solved last, as it acts on `after`.

        Returns
        -------
        (joints, 3) float
            Force x, y and moment about the origin [mean weights, times the size].
        """
        ...

    def poses(self) -> Array:
        """Return centres of mass x, y and rotations [rad], shape (blocks, 3).

        In three dimensions shape (blocks, 6): then z, out of the plane, and the rotation
        vector's x and y; its z is the rotation in the plane.
        """
        ...

    def quality(self) -> Quality:
        """Tell how well contact and friction have been kept so far."""
        ...


def trusted(world: World, settings: Settings) -> bool:
    """Tell whether the contacts of a world have kept within the bounds allowed."""
    quality = world.quality()
    return (quality.residual is None or quality.residual <= settings.residual) and (
        quality.penetration is None or quality.penetration <= settings.penetration
    )


class Engine(Protocol):
    """A way to set blocks in motion."""

    @property
    def name(self) -> str:
        """Name as on the command line."""
        ...

    @property
    def version(self) -> str:
        """Version of the engine's library."""
        ...

    @property
    def most_friction(self) -> float:
        """Friction above which the engine takes this instead."""
        ...

    def settings(self, assembly: Assembly) -> Settings:
        """Choose settings that suit an assembly."""
        ...

    def build(self, problem: Problem, settings: Settings) -> World:
        """Put the blocks of a problem into the engine, all contacts closed, at rest."""
        ...
