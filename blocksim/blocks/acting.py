"""What acts on blocks, and how supports move."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import Array, Blocks, frozen
from blocksim.blocks.shaking import shaking_record
from blocksim.common.checks import COORDINATE, FACTOR, FORCE, require_all

if TYPE_CHECKING:
    from blocksim.blocks.problem import Problem

STRAIGHT = 1e-15
"""Share of gravity that rounding leaves aside where it pulls straight down."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Load:
    """A force on a block, or on several in proportion to their weights.

    Parameters
    ----------
    force : (2,) or (3,) float
        x and y, in space also z [N]; with `per_weight` in units of each block's weight.
    blocks : tuple of int
        The blocks it acts on.
    point : (2,) or (3,) float or None
        Where it acts [m], carried by its block; None for the centre of mass.
    per_weight : bool
        Whether it is a body force.
    """

    force: Array
    blocks: tuple[int, ...]
    point: Array | None = None
    per_weight: bool = False

    def __post_init__(self) -> None:
        """Check the ranges, and make the arrays read-only."""
        dimensions = 3 if np.size(self.force) == 3 else 2
        object.__setattr__(self, "force", frozen(self.force, (dimensions,)))
        require_all(FACTOR if self.per_weight else FORCE, "force", self.force)
        if self.point is not None:
            object.__setattr__(self, "point", frozen(self.point, (dimensions,)))
            require_all(COORDINATE, "point", self.point)


def push_on_all(problem: Problem[Any], force: Sequence[float] | Array) -> Load:
    """Return a push on all blocks, x and y, in space also z, over the weight of each."""
    blocks = tuple(range(len(problem.assembly.blocks)))
    return Load(force=np.array(force, dtype=float), blocks=blocks, per_weight=True)


def sideways(problem: Problem[Any]) -> Array:
    """Return the way of pushes: to the right, in space level towards the azimuth; (2 or 3,)."""
    if problem.in_space:
        return np.array([math.cos(problem.azimuth), math.sin(problem.azimuth), 0.0])
    return np.array([1.0, 0.0])


def azimuth_words(problem: Problem[Any]) -> str:
    """Say towards where blocks in space are pushed, and their ground shakes."""
    return f"towards {round(math.degrees(problem.azimuth), 9):g} deg from x"


def shaking_words(problem: Problem[Any]) -> str:
    """Say how the ground shakes; empty where it does not."""
    if problem.shaking is None:
        return ""
    return problem.shaking.words + (f" {azimuth_words(problem)}" if problem.in_space else "")


def shake_record(problem: Problem[Any]) -> dict[str, Any] | None:
    """Return what a structure file says of ground that shakes, in space with its direction."""
    if problem.shaking is None:
        return None
    said = shaking_record(problem.shaking)
    return {**said, "azimuth_deg": math.degrees(problem.azimuth)} if problem.in_space else said


def with_push(problem: Problem[Blocks], across: float) -> Problem[Blocks]:
    """Return a problem pushed across besides, by a share of the weight of each block [g]."""
    push = push_on_all(problem, across * sideways(problem))
    return replace(problem, dead=(*problem.dead, push))


def is_push(problem: Problem[Any], load: Load) -> bool:
    """Tell whether a load acts on all blocks, by the weight of each."""
    return load.per_weight and len(load.blocks) == len(problem.assembly.blocks) > 1


def push_of(problem: Problem[Any]) -> str | None:
    """Say the push that is the only dead load of a problem, or return None."""
    if len(problem.dead) != 1 or not is_push(problem, load := problem.dead[0]):
        return None
    (across, *aside), up = load.force[:-1].tolist(), load.force[-1]
    way = f"to the {'right' if across > 0 else 'left'}"
    if aside:
        way = f"towards {math.degrees(math.atan2(aside[0], across)):.4g}° from x"
    return f"{np.linalg.norm(load.force):.4g} of each weight{'' if up else f' {way}'}"


@dataclass(frozen=True, eq=False, kw_only=True)
class Move:
    """How a support moves as supports spread or settle.

    `direction`, (2,): Way of the support over the parameter, which is in metres.
    `turn`: Rotation over the parameter [rad/m], counter-clockwise.
    `about`, (2,): Point of the support about which it turns [m].
    """

    support: int
    direction: Array
    turn: float = 0.0
    about: Array = field(default_factory=lambda: np.zeros(2))

    def __post_init__(self) -> None:
        """Check the ranges, and make the arrays read-only."""
        object.__setattr__(self, "direction", frozen(self.direction, (2,)))
        object.__setattr__(self, "about", frozen(self.about, (2,)))
        FACTOR.require("turn", self.turn)
        require_all(FACTOR, "direction", self.direction)
        require_all(COORDINATE, "about", self.about)


def tilt_and_lean(problem: Problem[Any]) -> tuple[float, float]:
    """Return by how much a table tilts, and gravity is turned out of the plane [deg]."""
    x, y, z = problem.gravity.tolist()
    if problem.in_space:
        return math.degrees(math.atan2(math.hypot(x, y), 0.0 - z)), 0.0
    # Where nothing pulls in the plane, 0.0 - y is no -0.0: it is not upside down.
    return math.degrees(math.atan2(x, 0.0 - y)), math.degrees(math.atan2(z, math.hypot(x, y)))


def towards(problem: Problem[Any]) -> float:
    """Return towards where gravity in space leans, or else would as a table tilts [deg]."""
    x, y, _ = problem.gravity.tolist()
    leans = math.hypot(x, y) > STRAIGHT
    return round(math.degrees(math.atan2(y, x) if leans else problem.azimuth), 12)
