"""Scenes: bodies in the plane or in space as plain data, for engines of any language."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.reading.scenes import FORMAT

BOUND = 0.05
"""Way up to which a body counts as standing, in sizes of the mean body."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A rigid body, homogeneous, of one convex shape or several that move as one.

    Parameters
    ----------
    name : str
    shapes : tuple of (k, 2 or 3) float
        Corners [m]: of polygons, counter-clockwise; of polyhedra, whose hull they are.
    mass : float
        [kg]; 0 of a body that is fixed.
    centre : (2 or 3,) float
        Centre of mass [m].
    inertia : float or (3, 3) float
        About the centre of mass [kg m^2].
    depth : float
        Of a polygon, out of the plane [m].
    velocity : (2 or 3,) float
        At the start [m/s].
    spin : float or (3,) float
        Angular velocity at the start [rad/s].
    """

    name: str
    shapes: tuple[Array, ...]
    mass: float = 0.0
    centre: Array
    inertia: float | Array = 0.0
    depth: float = 1.0
    velocity: Array | None = None
    spin: float | Array = 0.0

    @property
    def fixed(self) -> bool:
        """Whether it stays where it is."""
        return self.mass == 0

    def record(self) -> dict[str, Any]:
        """Return what the file says of it."""
        planar = len(self.centre) == 2
        shapes = [shape.tolist() for shape in self.shapes]
        said = {"name": self.name, "fixed": self.fixed}
        said |= {"polygons": shapes, "depth": self.depth} if planar else {"polyhedra": shapes}
        if self.fixed:
            return said
        still = np.zeros(len(self.centre))
        return said | {
            "mass": self.mass,
            "centre": self.centre.tolist(),
            "inertia": np.asarray(self.inertia).tolist(),
            "velocity": (still if self.velocity is None else self.velocity).tolist(),
            "spin": np.asarray(self.spin).tolist(),
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Push:
    """A force that stays the same, at a point that its body carries along."""

    body: str
    force: Array
    point: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """What an engine is given.

    Parameters
    ----------
    name, group : str
    level : float or None
        How far it is from the limit [%]; None where its motion is asked for.
    gravity : (2 or 3,) float
        [m/s^2]
    friction : float
        Coefficient between any two bodies.
    bodies : tuple of Body
    pushes : tuple of Push
    times : (frames,) float
        When poses are asked for [s]; the last is the scene's duration.
    bound : float
        Way of a corner up to which a body counts as standing [m]; 0 where motion is asked for.
    """

    name: str
    group: str
    level: float | None
    gravity: Array
    friction: float
    bodies: tuple[Body, ...]
    pushes: tuple[Push, ...] = ()
    times: Array
    bound: float

    @property
    def moving(self) -> tuple[Body, ...]:
        """The bodies that are not fixed, in the order of the answers' poses."""
        return tuple(body for body in self.bodies if not body.fixed)

    @property
    def size(self) -> float:
        """Size of the mean body [m]; 0 where motion is asked for."""
        return self.bound / BOUND

    @property
    def dimensions(self) -> int:
        """Tell the plane, 2, from space, 3."""
        return len(self.gravity)

    def record(self) -> dict[str, Any]:
        """Return the scene's file."""
        return {
            "format": FORMAT,
            "name": self.name,
            "group": self.group,
            "level": self.level,
            "question": "motion" if self.level is None else "stands",
            "dimensions": self.dimensions,
            "gravity": self.gravity.tolist(),
            "friction": self.friction,
            "restitution": 0.0,
            "bodies": [body.record() for body in self.bodies],
            "pushes": [
                {
                    "body": push.body,
                    "force": push.force.tolist(),
                    "point": push.point.tolist(),
                }
                for push in self.pushes
            ],
            "duration": float(self.times[-1]),
            "times": self.times.tolist(),
            "bound": self.bound,
        }


def bodies_of(problem: Problem) -> tuple[Body, ...]:
    """Return supports and blocks of a problem in its plane."""
    assembly = problem.assembly
    names = [each.name for each in (*assembly.supports, *assembly.blocks)]
    beds = tuple(
        Body(name=name, shapes=each.polygons, centre=np.zeros(2))
        for name, each in zip(names, assembly.supports, strict=False)
    )
    return beds + tuple(
        Body(
            name=name,
            shapes=each.polygons,
            mass=each.mass,
            centre=each.centre,
            inertia=each.inertia,
            depth=each.depth,
        )
        for name, each in zip(names[len(beds) :], assembly.blocks, strict=True)
    )


def acting(problem: Problem) -> tuple[Array, tuple[Push, ...]]:
    """Return gravity [m/s^2], with body forces on all blocks, and pushes on single ones [N]."""
    blocks = problem.assembly.blocks
    gravity, pushes = problem.gravity[:2].copy(), list[Push]()
    for factor, loads in ((1.0, problem.dead), (problem.load, problem.live)):
        for load in loads:
            if load.per_weight and len(load.blocks) == len(blocks):
                gravity += factor * load.force
                continue
            for block in (blocks[index] for index in load.blocks):
                weight = block.mass * STANDARD_GRAVITY if load.per_weight else 1.0
                point = block.centre if load.point is None else load.point
                force = factor * weight * load.force
                pushes.append(Push(body=block.name, force=force, point=point))
    return STANDARD_GRAVITY * gravity, tuple(pushes)
