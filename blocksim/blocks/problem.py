"""What is asked about: blocks, friction in their joints, gravity, and loads."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.acting import Load as Load
from blocksim.blocks.acting import Move as Move
from blocksim.blocks.assembly import PLANAR, SPATIAL, Array, Assembly, frozen
from blocksim.blocks.dispersal import Dispersal
from blocksim.blocks.road import road_of, with_road
from blocksim.blocks.shaking import Shaking
from blocksim.common.checks import (
    FACTOR,
    LEAN,
    SMOOTH_OR_ROUGH,
    STRENGTH,
    is_number,
    require,
    require_all,
)
from blocksim.common.errors import InputError
from blocksim.common.shown import Shown, short

if TYPE_CHECKING:
    from blocksim.blocks.maker import Maker

STANDARD_GRAVITY = 9.81
"""To turn weight into mass [m/s^2]."""
DOWN = np.array([0.0, -1.0, 0.0])
"""Gravity where nothing is tilted: x, y, and z out of the plane."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Problem(Shown):
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

    assembly: Assembly
    mu: float
    gravity: Array = field(default_factory=lambda: DOWN)
    dead: tuple[Load, ...] = ()
    live: tuple[Load, ...] = ()
    load: float = 0.0
    moves: tuple[Move, ...] = ()
    shaking: Shaking | None = None
    title: str = ""
    source: str = ""
    maker: Maker | None = None
    road: tuple[tuple[float, float, float], ...] = ()
    dispersal: Dispersal | None = None
    weighed: bool = True
    strength: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the ranges."""
        SMOOTH_OR_ROUGH.require("mu", self.mu)
        FACTOR.require("load", self.load)
        if self.strength is not None:
            STRENGTH.require("strength", self.strength)
        object.__setattr__(self, "gravity", frozen(self.gravity, (3,)))
        require_all(FACTOR, "gravity", self.gravity)

    def __repr__(self) -> str:
        assembly = self.assembly
        name = f"{short(self.title)!r}, " if self.title else ""
        return (
            f"Problem({name}{len(assembly.blocks)} blocks, {len(assembly.joints)} joints, "
            f"mu={self.mu:g})"
        )

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient of each joint, shape (joints,), inf allowed."""
        own = self.assembly.joint_arrays.friction
        return frozen(np.where(np.isnan(own), self.mu, own), (-1,))

    @property
    def is_loaded(self) -> bool:
        """Whether anything acts besides gravity."""
        return bool(self.dead or (self.live and self.load))

    @property
    def turns_pull(self) -> bool:
        """Whether what acts on blocks changes as they turn: forces at points of them do."""
        return any(load.point is not None for load in self.dead + self.live)

    @property
    def is_planar(self) -> bool:
        """Whether nothing pulls out of the plane."""
        return bool(self.gravity[2] == 0)

    @property
    def unit_force(self) -> float:
        """Weight of the mean block [N], the unit of force of engines and limit analysis."""
        masses = [block.mass for block in self.assembly.blocks]
        return float(np.mean(masses)) * STANDARD_GRAVITY

    def leaning(self, lean: float) -> Problem:
        """Return the same with gravity leaning out of the plane by an angle [rad]."""
        LEAN.require("lean", lean)
        x, y, _ = self.gravity
        down = math.cos(lean)
        return replace(self, gravity=np.array([x * down, y * down, math.sin(lean)]))

    def tilted(self, tilt: float) -> Problem:
        """Return the same on a table tilted in the plane [rad]; its right-hand side goes down.

        The blocks are seen as before: it is gravity that turns.
        """
        finite = is_number(tilt, -math.inf, math.inf) and math.isfinite(tilt)
        require(finite, "tilt", tilt, "a finite angle")
        (x, y, z), cos, sin = self.gravity, math.cos(tilt), math.sin(tilt)
        return replace(self, gravity=np.array([x * cos - y * sin, x * sin + y * cos, z]))

    def but(self, **changes: Any) -> Problem:
        """Return the same, made with other parameters under the same loads.

        Parameters
        ----------
        **changes
            Parameters of its maker; `**{"arch.thickness": 0.2}` is one of its arch.

        Raises
        ------
        InputError
            If a value is out of range, changes the number of blocks, or there is no maker.
        """
        name, value = next(iter(changes.items()))
        if self.maker is None:
            raise InputError(name, value, "left out: the blocks were given")
        made, blocks = self.remade(self.maker.but(**changes)), len(self.assembly.blocks)
        same = len(made.assembly.blocks) == blocks
        require(same, name, value, f"a value that leaves {blocks} blocks, on which loads act")
        return made

    def remade(self, maker: Maker) -> Problem:
        """Return the same by another maker, or by one with other parameters.

        Loads stay as they are but for the weight of fill, which comes first among the dead
        ones, and for those on the road.
        """
        before = 0 if self.maker is None else len(self.maker.built.fills)
        built = maker.built
        remade = replace(
            self,
            assembly=built.assembly,
            dead=(*built.fills, *self.dead[before:]),
            maker=maker,
        )
        if (road := road_of(remade)) is not None and self.dispersal is not None:
            remade = replace(remade, dispersal=replace(self.dispersal, road=road))
        return with_road(remade, self.road) if self.road else remade

    @property
    def length_name(self) -> str:
        """What the unit of length of engines is called: the radius r, or the size L."""
        return "L" if self.maker is None else self.maker.length_name

    @property
    def is_arch(self) -> bool:
        """Whether it is one arch, whose joints follow each other from left to right."""
        return self.maker is not None and self.maker.is_arch

    @property
    def has_size(self) -> bool:
        """Whether lengths are metres, and no multiples of a radius that was not given."""
        return self.maker is None or self.maker.has_size

    @property
    def measures(self) -> tuple[str, ...]:
        """What its maker is known by, for drawings: half-angle and ratio of an arch."""
        return () if self.maker is None else self.maker.measures

    def with_load(self, load: float) -> Problem:
        """Return the same under another load factor."""
        return replace(self, load=load)

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

    @property
    def seconds(self) -> float:
        """The unit of time of engines, sqrt(size/g) [s]."""
        return math.sqrt(self.assembly.size / STANDARD_GRAVITY)

    def with_friction(self, mu: float) -> Problem:
        """Return the same with another friction coefficient; joints with their own keep it."""
        return replace(self, mu=mu)

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
