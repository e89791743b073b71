"""What is asked about: blocks, friction in their joints, gravity, and loads."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, Self

import numpy as np

from blocksim.blocks.acting import Load as Load
from blocksim.blocks.acting import Move as Move
from blocksim.blocks.acting import sideways
from blocksim.blocks.assembly import STANDARD_GRAVITY as STANDARD_GRAVITY
from blocksim.blocks.assembly import Array, Blocks, frozen
from blocksim.blocks.dispersal import Dispersal
from blocksim.blocks.road import remade, require_upright
from blocksim.blocks.shaking import Shaking
from blocksim.blocks.soil import Soil
from blocksim.common.checks import (
    FACTOR,
    GRAVITY,
    LEAN,
    SMOOTH_OR_ROUGH,
    STRENGTH,
    TURN,
    VELOCITY,
    is_number,
    require,
    require_all,
)
from blocksim.common.errors import InputError
from blocksim.common.shown import Shown, short

if TYPE_CHECKING:
    from blocksim.blocks.maker import Kind

ROUNDED = 1e-15
"""Part of gravity along the axis of a table that rounding may leave."""
PLANE_ONLY = {
    "moves": "supports stay",
    "velocities": "blocks begin at rest",
    "strength": "blocks are rigid",
    **dict.fromkeys(("road", "dispersal"), "there is no road"),
    "soil": "no soil bears",
}
"""What a problem in space must not have, and what holds instead."""


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Problem(Shown, Generic[Blocks]):
    """Blocks, in the plane or in space, and everything that acts on them.

    Its assembly says which: `Problem` is of the plane, `Problem[SpatialAssembly]` in space.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    mu : float
        Friction coefficient of every joint that has none of its own, inf allowed.
    gravity : (3,) float
        Force on each block in units of its weight, by default straight down. Of the plane: x
        and y in it, z out of it. In space: x, y and z, which is up.
    dead : tuple of Load
        Loads besides gravity that stay what they are.
    live : tuple of Load
        Loads that are multiplied by `load`.
    load : float
        The load factor.
    moves : tuple of Move
        How supports move. This, velocities, strength, road, dispersal and soil are of the
        plane.
    shaking : Shaking or None
        How the ground shakes from the release on.
    velocities : (blocks, 3) float
        Of centres and rotations at the release [m/s, rad/s]; empty where all begin at rest.
    title, source : str
        What it is, and where it comes from.
    maker : Kind or None
        What made it, with its parameters; None where its blocks were given.
    azimuth : float
        In space: towards where a table tilts and the ground shakes, from x towards y [rad].
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
        If a value is out of range, or means nothing in space.
    """

    assembly: Blocks
    mu: float
    gravity: Array = field(default_factory=lambda: np.empty(0))
    dead: tuple[Load, ...] = ()
    live: tuple[Load, ...] = ()
    load: float = 0.0
    moves: tuple[Move, ...] = ()
    shaking: Shaking | None = None
    velocities: Array = field(default_factory=lambda: np.empty(0))
    title: str = ""
    source: str = ""
    maker: Kind[Blocks] | None = None
    azimuth: float = 0.0
    road: tuple[tuple[float, float, float], ...] = ()
    dispersal: Dispersal | None = None
    soil: Soil | None = None
    weighed: bool = True
    strength: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the ranges."""
        SMOOTH_OR_ROUGH.require("mu", self.mu)
        FACTOR.require("load", self.load)
        gravity = self.gravity if np.size(self.gravity) else self.assembly.down
        object.__setattr__(self, "gravity", frozen(gravity, (3,)))
        require_all(FACTOR, "gravity", self.gravity)
        velocities = self.velocities if np.size(self.velocities) else np.zeros((0, 3))
        object.__setattr__(self, "velocities", frozen(velocities, (-1, 3)))
        require_all(VELOCITY, "velocities", self.velocities)
        count, given = len(self.assembly.blocks), len(self.velocities)
        require(given in (0, count), "velocities", f"{given} rows", f"{count} rows, or none")
        size = self.assembly.dimensions
        for each in (*self.dead, *self.live):
            require(len(each.force) == size, "force", each.force.tolist(), f"{size} numbers")
        if self.strength is not None:
            STRENGTH.require("strength", self.strength)
        TURN.require("azimuth", self.azimuth)
        if self.in_space:
            for name, why in PLANE_ONLY.items():
                value = getattr(self, name)
                given = value.size if isinstance(value, np.ndarray) else value
                require(not given, name, "given", f"left out in space: {why}")
        else:
            require(not self.azimuth, "azimuth", self.azimuth, "left out in the plane")

    def __repr__(self) -> str:
        blocks, joints = len(self.assembly.blocks), len(self.assembly.joints)
        name = f"{short(self.title)!r}, " if self.title else ""
        where = " in space" if self.in_space else ""
        return f"Problem({name}{blocks} blocks{where}, {joints} joints, mu={self.mu:g})"

    @property
    def in_space(self) -> bool:
        """Whether its blocks are in space, not in the plane."""
        return self.assembly.dimensions == 3

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient of each joint, shape (joints,), inf allowed."""
        own = self.assembly.friction
        return frozen(np.where(np.isnan(own), self.mu, own), (-1,))

    @property
    def is_loaded(self) -> bool:
        """Whether anything acts besides gravity."""
        return bool(self.dead or (self.live and self.load))

    @property
    def forces_turn(self) -> bool:
        """Whether what acts on blocks changes as they turn: forces at points of them do."""
        return any(load.point is not None for load in self.dead + self.live)

    @property
    def is_planar(self) -> bool:
        """Whether it is of the plane, and nothing pulls out of that."""
        return not self.in_space and bool(self.gravity[2] == 0)

    @property
    def is_moving(self) -> bool:
        """Whether there is motion from the release on: the ground shakes, or blocks move."""
        return self.shaking is not None or bool(self.velocities.any())

    @property
    def has_statics(self) -> bool:
        """Whether limit analysis tells of it: all begins at rest, no plane is left."""
        return not self.is_moving and (self.in_space or self.is_planar)

    @property
    def unit_force(self) -> float:
        """Weight of the mean block [N], the unit of force of engines and limit analysis."""
        return self.assembly.unit_force

    @property
    def seconds(self) -> float:
        """The unit of time of engines, sqrt(size/g) [s]."""
        return math.sqrt(self.assembly.size / STANDARD_GRAVITY)

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

    @property
    def _axis(self) -> Array:
        """The axis about which a table tilts: out of the plane, or level across the azimuth."""
        if self.in_space:
            return np.array([math.sin(self.azimuth), -math.cos(self.azimuth), 0.0])
        return np.array([0.0, 0.0, 1.0])

    @property
    def across(self) -> Array:
        """Gravity turned by a right angle as a table tilts, (3,): what a tilt adds to it."""
        return np.cross(self._axis, self.gravity)

    @property
    def unturned(self) -> Array:
        """The part of gravity along the axis about which a table tilts, (3,)."""
        along = float(self._axis @ self.gravity)
        return along * self._axis if abs(along) > ROUNDED else np.zeros(3)

    def tilted(self, tilt: float) -> Self:
        """Return the same on a table that is tilted [rad].

        In the plane its right-hand side goes down, in space the side at the azimuth. The
        blocks are seen as before: it is gravity that turns.
        """
        require(is_number(tilt, -1e9, 1e9), "tilt", tilt, "an angle up to 1e9 rad")
        require_upright(self, "tilt", tilt)
        still, cos, sin = self.unturned, math.cos(tilt), math.sin(tilt)
        return replace(self, gravity=still + cos * (self.gravity - still) + sin * self.across)

    def leaning(self, lean: float) -> Self:
        """Return the same with gravity out of the plane by an angle [rad], not as it was."""
        LEAN.require("lean", lean)
        require(not self.in_space, "lean", lean, "left out in space: tilt towards an azimuth")
        require_upright(self, "lean", lean)
        strength, level = math.hypot(*self.gravity), math.hypot(*self.gravity[:2])
        leaning = [*self.gravity[:2] / level * math.cos(lean), math.sin(lean)]
        return replace(self, gravity=strength * np.array(leaning))

    def under(self, acceleration: float) -> Self:
        """Return the same where gravity accelerates otherwise than by 9.81 m/s2.

        Masses stay: weights that were given are those at 9.81 m/s2, loads are what they are.
        """
        GRAVITY.require("gravity", acceleration)
        return replace(self, gravity=self.gravity * (acceleration / STANDARD_GRAVITY))

    def with_load(self, load: float) -> Self:
        """Return the same under another load factor."""
        return replace(self, load=load)

    def with_friction(self, mu: float) -> Self:
        """Return the same with another friction coefficient; joints with their own keep it."""
        return replace(self, mu=mu)

    def but(self, **changes: Any) -> Problem[Blocks]:
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
        made, blocks = remade(self, self.maker.but(**changes)), len(self.assembly.blocks)
        same = len(made.assembly.blocks) == blocks
        require(same, name, value, f"a value that leaves {blocks} blocks, on which loads act")
        return made

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
        across, up = (gained / ((end - start) * unit)).tolist()
        ground = -up * np.array(self.assembly.down)
        ground[: self.assembly.dimensions] += across * sideways(self)
        return self.gravity - ground

    def applied_forces(self, poses: Array | None = None) -> Array:
        """Sum gravity, dead and live loads on each block, and their moments about its centre.

        Parameters
        ----------
        poses : (blocks, 3 or 6) float, optional
            Where the blocks are, in units of the size; by default where they were built.

        Returns
        -------
        (blocks, 3 or 6) float
            In units of the mean block's weight, and of that times the size.
        """
        pull = self.assembly.weights_under(self.gravity)
        return pull + self.loads(poses) if self.is_loaded else pull

    def loads(self, poses: Array | None = None) -> Array:
        """Sum dead and live loads on each block: `applied_forces` without gravity."""
        found = np.zeros((len(self.assembly.blocks), self.assembly.columns))
        for factor, loads in ((1.0, self.dead), (self.load, self.live)):
            for load in loads:
                found += factor * self.assembly.of_load(load, poses)
        return found

    @property
    def live_forces(self) -> Array:
        """Forces and moments of live loads at a factor of 1, units as of `applied_forces`."""
        return replace(self, dead=(), load=1.0).loads()
