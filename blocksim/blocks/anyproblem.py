"""What is asked about, in the plane and in space alike: blocks, friction, gravity, loads."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Self, TypeVar

import numpy as np

from blocksim.blocks.acting import Load, Move
from blocksim.blocks.assembly import Array, frozen
from blocksim.blocks.shaking import Shaking
from blocksim.common.checks import FACTOR, SMOOTH_OR_ROUGH, is_number, require, require_all
from blocksim.common.errors import InputError
from blocksim.common.shown import Shown, short

if TYPE_CHECKING:
    from blocksim.blocks.assembly import Assembly
    from blocksim.blocks.maker import Kind
    from blocksim.blocks.space.assembly import SpatialAssembly

STANDARD_GRAVITY = 9.81
"""To turn weight into mass [m/s^2]."""


Blocks = TypeVar("Blocks", bound="Assembly | SpatialAssembly")


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class AnyProblem(Shown, ABC, Generic[Blocks]):
    """Blocks and everything that acts on them; see `Problem` and `SpatialProblem`."""

    dimensions: ClassVar[int]

    assembly: Blocks
    mu: float
    gravity: Array
    dead: tuple[Load, ...] = ()
    live: tuple[Load, ...] = ()
    load: float = 0.0
    moves: tuple[Move, ...] = ()
    shaking: Shaking | None = None
    title: str = ""
    source: str = ""
    maker: Kind | None = None
    weighed: bool = True
    strength: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the ranges."""
        SMOOTH_OR_ROUGH.require("mu", self.mu)
        FACTOR.require("load", self.load)
        object.__setattr__(self, "gravity", frozen(self.gravity, (3,)))
        require_all(FACTOR, "gravity", self.gravity)
        for each in (*self.dead, *self.live):
            right = len(each.force) == self.dimensions
            require(right, "force", each.force.tolist(), f"{self.dimensions} numbers")

    def __repr__(self) -> str:
        assembly = self.assembly
        name = f"{short(self.title)!r}, " if self.title else ""
        return (
            f"{type(self).__name__}({name}{len(assembly.blocks)} blocks, "
            f"{len(assembly.joints)} joints, mu={self.mu:g})"
        )

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
    def has_statics(self) -> bool:
        """Whether limit analysis tells of it: the ground is at rest."""
        return self.shaking is None

    @property
    @abstractmethod
    def unit_force(self) -> float:
        """Weight of the mean block [N], the unit of force of engines and limit analysis."""

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
    @abstractmethod
    def across(self) -> Array:
        """Gravity turned by a right angle as a table tilts, (3,): what a tilt adds to it."""

    @property
    def unturned(self) -> Array:
        """The part of gravity that stays what it is as a table tilts, (3,)."""
        return np.zeros(3)

    def tilted(self, tilt: float) -> Self:
        """Return the same on a table that is tilted [rad].

        In the plane its right-hand side goes down, in space the side at the azimuth. The
        blocks are seen as before: it is gravity that turns.
        """
        finite = is_number(tilt, -math.inf, math.inf) and math.isfinite(tilt)
        require(finite, "tilt", tilt, "a finite angle")
        still, cos, sin = self.unturned, math.cos(tilt), math.sin(tilt)
        turned = still + cos * (self.gravity - still) + sin * self.across
        return replace(self, gravity=turned)

    def with_load(self, load: float) -> Self:
        """Return the same under another load factor."""
        return replace(self, load=load)

    def with_friction(self, mu: float) -> Self:
        """Return the same with another friction coefficient; joints with their own keep it."""
        return replace(self, mu=mu)

    def but(self, **changes: Any) -> Self:
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

    def remade(self, maker: Kind) -> Self:
        """Return the same by another maker, or by one with other parameters.

        Loads stay as they are but for the weight of fill, which comes first among the dead
        ones.
        """
        before = 0 if self.maker is None else len(self.maker.built.fills)
        built = maker.built
        dead = (*built.fills, *self.dead[before:])
        return replace(self, assembly=built.assembly, dead=dead, maker=maker)

    @abstractmethod
    def pull(self) -> Array:
        """Sum gravity, dead and live loads on each block, and moments about its centre."""
