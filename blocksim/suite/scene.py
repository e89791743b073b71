"""Scenes: bodies in the plane or in space as plain data, for engines of any language."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.space.assembly import SolidBlock
from blocksim.blocks.space.problem import SpatialProblem
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
    faces : tuple of tuple of tuple of int
        Of each polyhedron the corners around each face, counter-clockwise seen from outside.
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
    faces: tuple[tuple[tuple[int, ...], ...], ...] = ()
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
        said: dict[str, Any] = {"name": self.name, "fixed": self.fixed}
        if planar:
            said |= {"polygons": shapes, "depth": self.depth}
        else:
            said |= {"polyhedra": shapes, "faces": self.faces}
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


def bodies_of(problem: Problem | SpatialProblem) -> tuple[Body, ...]:
    """Return supports and blocks of a problem in its plane, or in space."""
    if isinstance(problem, SpatialProblem):
        return tuple(_solid(each, fixed=fixed) for fixed, each in _solids(problem))
    assembly = problem.assembly
    beds = tuple(
        Body(name=each.name, shapes=each.polygons, centre=np.zeros(2))
        for each in assembly.supports
    )
    return beds + tuple(
        Body(
            name=each.name,
            shapes=each.polygons,
            mass=each.mass,
            centre=each.centre,
            inertia=each.inertia,
            depth=each.depth,
        )
        for each in assembly.blocks
    )


def _solids(problem: SpatialProblem) -> Iterator[tuple[bool, SolidBlock]]:
    """Give supports, then blocks, and whether they are fixed."""
    yield from ((True, each) for each in problem.assembly.supports)
    yield from ((False, each) for each in problem.assembly.blocks)


def _solid(block: SolidBlock, *, fixed: bool) -> Body:
    shapes = tuple(hull.corners for hull in block.hulls)
    faces = tuple(tuple(map(tuple, hull.around)) for hull in block.hulls)
    if fixed:
        return Body(name=block.name, shapes=shapes, faces=faces, centre=np.zeros(3))
    mass = block.weight / STANDARD_GRAVITY
    return Body(
        name=block.name,
        shapes=shapes,
        faces=faces,
        mass=mass,
        centre=block.centre,
        inertia=mass * block.gyration,
        spin=np.zeros(3),
    )


def acting(problem: Problem | SpatialProblem) -> tuple[Array, tuple[Push, ...]]:
    """Return gravity [m/s^2], with body forces on all blocks, and pushes on single ones [N]."""
    spatial = isinstance(problem, SpatialProblem)
    blocks = problem.assembly.blocks
    gravity, pushes = problem.gravity[: 3 if spatial else 2].copy(), list[Push]()
    weights = (
        problem.assembly.weights
        if spatial
        else [STANDARD_GRAVITY * block.mass for block in problem.assembly.blocks]
    )
    for factor, loads in ((1.0, problem.dead), (problem.load, problem.live)):
        for load in loads:
            if load.per_weight and len(load.blocks) == len(blocks):
                gravity += factor * load.force
                continue
            for index in load.blocks:
                weight = weights[index] if load.per_weight else 1.0
                point = blocks[index].centre if load.point is None else load.point
                force = factor * weight * load.force
                pushes.append(Push(body=blocks[index].name, force=force, point=point))
    return STANDARD_GRAVITY * gravity, tuple(pushes)
