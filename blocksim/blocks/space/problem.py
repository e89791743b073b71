"""What is asked about in space: blocks, friction in their joints, gravity, and loads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from blocksim.blocks.acting import Acting
from blocksim.blocks.assembly import Array, frozen
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.checks import (
    FACTOR,
    SMOOTH_OR_ROUGH,
    TURN,
    is_number,
    require,
    require_all,
)
from blocksim.common.shown import short

if TYPE_CHECKING:
    from blocksim.blocks.space.maker import SolidMaker

DOWN = np.array([0.0, 0.0, -1.0])
"""Gravity where nothing is tilted."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialLoad(Acting):
    """A force on a block, or on several in proportion to their weights.

    Parameters
    ----------
    force : (3,) float
        [N]; with `per_weight` in units of each block's weight.
    blocks : tuple of int
    point : (3,) float or None
        Where it acts [m]; None for the centre of mass.
    per_weight : bool
        Whether it is a body force.
    """

    dimensions: ClassVar[int] = 3


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialProblem:
    """Blocks in space and everything that acts on them.

    Parameters
    ----------
    assembly : SpatialAssembly
    mu : float
        Friction coefficient of every joint that has none of its own, inf allowed.
    gravity : (3,) float
        Force on each block in units of its weight.
    dead : tuple of SpatialLoad
        Loads besides gravity that stay what they are.
    live : tuple of SpatialLoad
        Loads that are multiplied by `load`.
    load : float
        The load factor.
    azimuth : float
        Towards where a table tilts, from x towards y [rad].
    title, source : str
    maker : SolidMaker or None
        What made it, with its parameters; None where its blocks were given.
    weighed : bool
        Whether a unit weight, or the weights of the blocks, were given.
    notes : tuple of str
        What was mended or assumed when it was read; answers repeat it.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    assembly: SpatialAssembly
    mu: float
    gravity: Array = field(default_factory=lambda: DOWN)
    dead: tuple[SpatialLoad, ...] = ()
    live: tuple[SpatialLoad, ...] = ()
    load: float = 0.0
    azimuth: float = 0.0
    title: str = ""
    source: str = ""
    maker: SolidMaker | None = None
    weighed: bool = True
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the ranges."""
        SMOOTH_OR_ROUGH.require("mu", self.mu)
        FACTOR.require("load", self.load)
        object.__setattr__(self, "gravity", frozen(self.gravity, (3,)))
        require_all(FACTOR, "gravity", self.gravity)
        TURN.require("azimuth", self.azimuth)

    def __repr__(self) -> str:
        assembly = self.assembly
        name = f"{short(self.title)!r}, " if self.title else ""
        return (
            f"SpatialProblem({name}{len(assembly.blocks)} blocks, "
            f"{len(assembly.joints)} joints, mu={self.mu:g})"
        )

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient of each joint, (joints,), inf allowed."""
        own = [each.friction for each in self.assembly.joints]
        return frozen([self.mu if each is None else each for each in own], (-1,))

    def with_load(self, load: float) -> SpatialProblem:
        """Return the same under another load factor."""
        return replace(self, load=load)

    def with_friction(self, mu: float) -> SpatialProblem:
        """Return the same with another friction coefficient; joints with their own keep it."""
        return replace(self, mu=mu)

    def tilted(self, tilt: float) -> SpatialProblem:
        """Return the same on a table of which the side at the azimuth goes down [rad]."""
        finite = is_number(tilt, -math.inf, math.inf) and math.isfinite(tilt)
        require(finite, "tilt", tilt, "a finite angle")
        return replace(self, gravity=turned(self.azimuth, tilt) @ self.gravity)

    @cached_property
    def fixed_pull(self) -> Array:
        """Gravity and dead loads on each block, (blocks, 6): forces, moments about centres.

        [N], [N m]
        """
        weights = self.assembly.weights
        found = np.zeros((len(weights), 6))
        found[:, :3] = weights[:, None] * self.gravity
        return frozen(found + self._sum(self.dead), (-1, 6))

    @cached_property
    def live_pull(self) -> Array:
        """The same of live loads at a factor of 1."""
        return frozen(self._sum(self.live), (-1, 6))

    def _sum(self, loads: tuple[SpatialLoad, ...]) -> Array:
        found = np.zeros((len(self.assembly.blocks), 6))
        for index, force, arm in self.forces_of(loads):
            found[index] += np.concatenate([force, np.cross(arm, force)])
        return found

    def forces_of(self, loads: tuple[SpatialLoad, ...]) -> Iterator[tuple[int, Array, Array]]:
        """Give the block of each force of loads, the force [N], and its arm [m].

        The arm is from the centre of mass to where it acts.
        """
        for load in loads:
            for index in load.blocks:
                own = self.assembly.blocks[index]
                arm = np.zeros(3) if load.point is None else load.point - own.centre
                yield index, load.force * (own.weight if load.per_weight else 1.0), arm


def turned(azimuth: float, tilt: float) -> Array:
    """Return the rotation that takes gravity to where a tilted table sees it, (3, 3).

    Examples
    --------
    >>> import numpy as np
    >>> bool(np.allclose(turned(0.0, np.pi / 2) @ DOWN, [1, 0, 0]))
    True
    """
    cos, sin = math.cos(azimuth), math.sin(azimuth)
    about = np.array([[0.0, 0.0, cos], [0.0, 0.0, sin], [-cos, -sin, 0.0]])
    # Rodrigues: -z goes towards the azimuth.
    return np.eye(3) - math.sin(tilt) * about + (1 - math.cos(tilt)) * about @ about
