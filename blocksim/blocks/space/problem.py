"""What is asked about in space: blocks, friction in their joints, gravity, and loads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from blocksim.blocks.acting import Load
from blocksim.blocks.anyproblem import AnyProblem
from blocksim.blocks.assembly import Array, frozen
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.checks import TURN, require

if TYPE_CHECKING:
    from blocksim.blocks.space.maker import SolidMaker

DOWN = np.array([0.0, 0.0, -1.0])
"""Gravity where nothing is tilted."""
ROUNDED = 1e-15
"""Part of gravity along the axis of a table that rounding may leave."""


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class SpatialProblem(AnyProblem[SpatialAssembly]):
    """Blocks in space and everything that acts on them.

    Parameters
    ----------
    assembly : SpatialAssembly
    mu : float
        Friction coefficient of every joint that has none of its own, inf allowed.
    gravity : (3,) float
        Force on each block in units of its weight.
    dead : tuple of Load
        Loads besides gravity that stay what they are.
    live : tuple of Load
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

    dimensions: ClassVar[int] = 3

    gravity: Array = field(default_factory=lambda: DOWN)
    maker: SolidMaker | None = None
    azimuth: float = 0.0

    def __post_init__(self) -> None:
        """Check the ranges; the ground is at rest."""
        super().__post_init__()
        TURN.require("azimuth", self.azimuth)
        require(not self.moves, "moves", "given", "left out in space: supports stay")
        allowed = "left out: the ground is at rest in space"
        require(self.shaking is None, "shake", "ground that shakes", allowed)
        rigid = "left out: blocks in space are rigid"
        require(self.strength is None, "strength", self.strength, rigid)

    @property
    def _axis(self) -> Array:
        """The axis about which a table tilts, level and across the azimuth."""
        return np.array([math.sin(self.azimuth), -math.cos(self.azimuth), 0.0])

    @property
    def across(self) -> Array:
        """Gravity turned by a right angle as a table tilts, (3,)."""
        return np.cross(self._axis, self.gravity)

    @property
    def unturned(self) -> Array:
        """The part of gravity along the axis about which a table tilts, (3,)."""
        along = float(self._axis @ self.gravity)
        return along * self._axis if abs(along) > ROUNDED else np.zeros(3)

    @property
    def unit_force(self) -> float:
        """Weight of the mean block [N]."""
        return float(self.assembly.weights.mean())

    def pull(self) -> Array:
        """Sum gravity, dead and live loads on each block, and moments about its centre.

        Returns
        -------
        (blocks, 6) float
            In units of the mean block's weight, and of that times the size.
        """
        return self.scaled(self.fixed_pull + self.load * self.live_pull)

    def scaled(self, pull: Array) -> Array:
        """Return forces [N] and moments [N m] in units of `pull`, (blocks, 6)."""
        size = self.assembly.size
        return pull / self.unit_force / np.array([1.0, 1.0, 1.0, size, size, size])

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

    def _sum(self, loads: tuple[Load, ...]) -> Array:
        found = np.zeros((len(self.assembly.blocks), 6))
        for index, force, arm in self.forces_of(loads):
            found[index] += np.concatenate([force, np.cross(arm, force)])
        return found

    def forces_of(self, loads: tuple[Load, ...]) -> Iterator[tuple[int, Array, Array]]:
        """Give the block of each force of loads, the force [N], and its arm [m].

        The arm is from the centre of mass to where it acts.
        """
        for load in loads:
            for index in load.blocks:
                own = self.assembly.blocks[index]
                arm = np.zeros(3) if load.point is None else load.point - own.centre
                yield index, load.force * (own.weight if load.per_weight else 1.0), arm
