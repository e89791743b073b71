"""What is asked about in the plane: blocks, friction in their joints, gravity, and loads."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Self, cast

import numpy as np

from blocksim.blocks.acting import Load as Load
from blocksim.blocks.acting import Move as Move
from blocksim.blocks.anyproblem import STANDARD_GRAVITY as STANDARD_GRAVITY
from blocksim.blocks.anyproblem import AnyProblem
from blocksim.blocks.assembly import PLANAR, SPATIAL, Array, Assembly
from blocksim.blocks.dispersal import Dispersal
from blocksim.blocks.road import road_of, with_road, with_soil
from blocksim.blocks.soil import Soil
from blocksim.common.checks import LEAN, STRENGTH

if TYPE_CHECKING:
    from blocksim.blocks.maker import Kind, Maker

DOWN = np.array([0.0, -1.0, 0.0])
"""Gravity where nothing is tilted: x, y, and z out of the plane."""


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Problem(AnyProblem[Assembly]):
    """Blocks and everything that acts on them.

    Parameters
    ----------
    assembly : Assembly
    mu : float
        Friction coefficient of every joint that has none of its own, inf allowed.
    gravity : (3,) float
        Force on each block in units of its weight: x and y in the plane, z out of it.
    dead : tuple of Load
        Loads besides gravity that stay what they are.
    live : tuple of Load
        Loads that are multiplied by `load`.
    load : float
        The load factor.
    moves : tuple of Move
    shaking : Shaking or None
        How the ground shakes from the release on.
    title, source : str
        What it is, and where it comes from.
    maker : Maker or None
        What made it, with its parameters; None where its blocks were given.
    road : tuple of (float, float, float)
        Live loads on the road above, which stay where they are as blocks are made otherwise:
        from one x to another [m], and the weight [N].
    dispersal : Dispersal or None
        How fill spreads what stands on the road; None where it goes straight down.
    soil : Soil or None
        What the fill is made of and how it presses from the side; None where it is of one
        weight and presses downwards only.
    weighed : bool
        Whether a unit weight, or the weights of the blocks, were given. If not, only ratios of
        forces have a meaning.
    strength : float or None
        Compressive strength of the blocks [Pa], beyond which they crush at their joints; None
        where they are rigid. Limit analysis alone knows it (`limit.crushing`).
    notes : tuple of str
        What was mended or assumed when it was read; answers repeat it.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    dimensions: ClassVar[int] = 2

    gravity: Array = field(default_factory=lambda: DOWN)
    maker: Maker | None = None
    road: tuple[tuple[float, float, float], ...] = ()
    dispersal: Dispersal | None = None
    soil: Soil | None = None

    def __post_init__(self) -> None:
        """Check the ranges."""
        super().__post_init__()
        if self.strength is not None:
            STRENGTH.require("strength", self.strength)

    @property
    def turns_pull(self) -> bool:
        """Whether what acts on blocks changes as they turn: forces at points of them do."""
        return any(load.point is not None for load in self.dead + self.live)

    @property
    def is_planar(self) -> bool:
        """Whether nothing pulls out of the plane."""
        return bool(self.gravity[2] == 0)

    @property
    def has_statics(self) -> bool:
        """Whether limit analysis tells of it: the ground is at rest, gravity in the plane."""
        return self.is_planar and super().has_statics

    @property
    def unit_force(self) -> float:
        """Weight of the mean block [N], the unit of force of engines and limit analysis."""
        masses = [block.mass for block in self.assembly.blocks]
        return float(np.mean(masses)) * STANDARD_GRAVITY

    @property
    def across(self) -> Array:
        """Gravity turned by a right angle in the plane, (3,): what a tilt adds to it."""
        x, y, _ = self.gravity
        return np.array([-y, x, 0.0])

    @property
    def unturned(self) -> Array:
        """The part of gravity that stays what it is as a table tilts, (3,)."""
        return np.array([0.0, 0.0, self.gravity[2]])

    def leaning(self, lean: float) -> Self:
        """Return the same with gravity leaning out of the plane by an angle [rad]."""
        LEAN.require("lean", lean)
        x, y, _ = self.gravity
        down = math.cos(lean)
        return replace(self, gravity=np.array([x * down, y * down, math.sin(lean)]))

    def remade(self, maker: Kind) -> Self:
        """Return the same by another maker; what is on the road stays where it is."""
        if self.soil is not None:
            plain = with_soil(cast("Problem", self), None).remade(maker)
            return cast("Self", with_soil(plain, self.soil))
        made = super().remade(maker)
        if (road := road_of(made)) is not None and self.dispersal is not None:
            made = replace(made, dispersal=replace(self.dispersal, road=road))
        return cast("Self", with_road(made, self.road)) if self.road else made

    def shaken(self, start: float, end: float) -> Array:
        """Return gravity as it is seen from the ground, on average between two times.

        Parameters
        ----------
        start, end : float
            Since the release [sqrt(size/g)].

        Returns
        -------
        (3,) float
            As `gravity`.
        """
        if self.shaking is None:
            return self.gravity
        unit = self.seconds
        gained = self.shaking.gained(start * unit, end * unit)
        return self.gravity - np.array([gained / ((end - start) * unit), 0.0, 0.0])

    def pull(self, poses: Array | None = None) -> Array:
        """Sum gravity, dead and live loads on each block, and their moments about its centre.

        Parameters
        ----------
        poses : (blocks, 3 or 6) float, optional
            Where the blocks are, in units of the size; by default where they were built.

        Returns
        -------
        (blocks, 3 or 6) float
            In units of the mean block's weight, and of that times the size. Six columns
            (z, and moments about x and y) where the poses have them.
        """
        columns = PLANAR if poses is None else poses.shape[1]
        pull = self._weights[:, :columns].copy()
        if self.is_loaded:
            pull[:, :PLANAR] += self.loads(poses)
        return pull

    @cached_property
    def _weights(self) -> Array:
        """Gravity on each block, shape (blocks, 6)."""
        weight = self.assembly.masses[:, :1]
        found = np.zeros((len(weight), SPATIAL))
        found[:, :2] = weight * self.gravity[:2]
        found[:, PLANAR] = weight[:, 0] * self.gravity[2]
        return found

    def loads(self, poses: Array | None = None) -> Array:
        """Sum dead and live loads on each block: `pull` without gravity, shape (blocks, 3)."""
        found = np.zeros((len(self.assembly.blocks), PLANAR))
        for factor, loads in ((1.0, self.dead), (self.load, self.live)):
            for load in loads:
                found += factor * self.of_load(load, poses)
        return found

    def of_load(self, load: Load, poses: Array | None = None) -> Array:
        """Return forces and moments of one load, shape (blocks, 3), units as of `pull`."""
        assembly = self.assembly
        found = np.zeros((len(assembly.blocks), PLANAR))
        chosen = list(load.blocks)
        if load.per_weight:
            found[chosen, :2] = assembly.masses[chosen, :1] * load.force
            return found
        force = load.force / self.unit_force
        for index in chosen:
            found[index, :2] += force
            if load.point is not None:
                arm = (load.point - assembly.centres[index]) / assembly.size
                turn = 0.0 if poses is None else float(poses[index, 2])
                cos, sin = math.cos(turn), math.sin(turn)
                x, y = cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]
                found[index, 2] += x * force[1] - y * force[0]
        return found
