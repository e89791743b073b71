"""Scenes: bodies in the plane or in space as plain data, and their poses.

They are for engines of any language.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.space.assembly import SolidBlock
from blocksim.reading.scenes import FORMAT

BOUND = 0.05
"""Way up to which a body counts as standing, in sizes of the mean body."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A rigid body, homogeneous, of one convex shape or several that move as one.

    `shapes`: Corners [m]: of polygons, counter-clockwise; of polyhedra, whose hull they are.
    `mass`: [kg]; 0 of a body that is fixed.
    `faces`: Of each polyhedron the corners around each face, counter-clockwise seen from
        outside.
    `centre`, (2 or 3,): Centre of mass [m].
    `inertia`, float or (3, 3): About the centre of mass [kg m^2].
    `depth`: Of a polygon, out of the plane [m].
    `velocity`, (2 or 3,): At the start [m/s].
    `spin`, float or (3,): Angular velocity at the start [rad/s].
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
    """A scene, as an engine is given it.

    `level`: How far it is from the limit [%]; None where its motion is asked for.
    `gravity`, (2 or 3,): [m/s^2]
    `friction`: Coefficient between any two bodies.
    `times`, (frames,): When poses are asked for [s]; the last is the scene's duration.
    `bound`: Way of a corner up to which a body counts as standing [m]; 0 where motion is asked
        for.
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
        """Size of the mean body [m], or 0 where motion is asked for."""
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


def bodies_of(problem: Problem[Any]) -> tuple[Body, ...]:
    """Return supports and blocks of a problem in its plane, or in space."""
    if problem.in_space:
        return (
            *(_solid(each, fixed=True) for each in problem.assembly.supports),
            *(_solid(each, fixed=False) for each in problem.assembly.blocks),
        )
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


def acting(problem: Problem[Any]) -> tuple[Array, tuple[Push, ...]]:
    """Return gravity [m/s^2], with body forces on all blocks, and pushes on single ones [N]."""
    spatial = problem.in_space
    blocks, weights = problem.assembly.blocks, problem.assembly.weights.tolist()
    gravity, pushes = problem.gravity[: 3 if spatial else 2].copy(), list[Push]()
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


PLANAR, SPATIAL = 3, 7
"""Numbers of a pose: x, y and angle; x, y, z and a quaternion w, x, y, z."""
NEARLY = 1e-6
"""How far corners may be from their mirror images, in sizes of the mean body."""


def turned(arms: Array, poses: Array) -> Array:
    """Turn arms as poses say, (..., d) float for poses (..., 3 or 7)."""
    if poses.shape[-1] == PLANAR:
        cos, sin = np.cos(poses[..., 2]), np.sin(poses[..., 2])
        x, y = arms[..., 0], arms[..., 1]
        return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
    quaternion = poses[..., 3:]
    length = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    unit = quaternion / np.where(length > 0, length, 1.0)
    real, axis = unit[..., :1], unit[..., 1:]
    once = 2 * np.cross(axis, arms)
    return arms + real * once + np.cross(axis, once)


class Bodies:
    """The bodies that move in a scene, with their corners as arrays."""

    def __init__(self, scene: Scene) -> None:
        self.scene, moving = scene, scene.moving
        corners = [np.concatenate(body.shapes) for body in moving]
        self._owner = np.repeat(np.arange(len(moving)), [len(each) for each in corners])
        self._centres = np.array([body.centre for body in moving])
        self._arms = np.concatenate(corners) - self._centres[self._owner]
        self._mass = np.array([body.mass for body in moving])

    @cached_property
    def start(self) -> Array:
        """Poses at the start, (bodies, 3 or 7) float."""
        still = [0.0] if self.scene.dimensions == 2 else [1.0, 0.0, 0.0, 0.0]
        return np.column_stack([self._centres, np.tile(still, (len(self._centres), 1))])

    def corners(self, poses: Array) -> Array:
        """Return where all corners are, (..., corners, 2 or 3) float."""
        of = poses[..., self._owner, :]
        return of[..., : self.scene.dimensions] + turned(self._arms, of)

    def ways(self, poses: Array) -> Array:
        """Return how far each corner is from its start, (..., corners) float [m]."""
        return np.linalg.norm(self.corners(poses) - self.corners(self.start), axis=-1)

    def lifted(self, poses: Array) -> Array:
        """Return the potential energy over all weights, (frames,) float [m]."""
        scene, dimensions = self.scene, self.scene.dimensions
        weight = self._mass[:, None] * scene.gravity
        energy = -(poses[..., :dimensions] * weight).sum(axis=(-2, -1))
        names = [body.name for body in scene.moving]
        for push in scene.pushes:
            on = names.index(push.body)
            arm = push.point - self._centres[on]
            at = poses[:, on, :dimensions] + turned(arm, poses[:, on])
            energy = energy - at @ push.force
        return energy / (self._mass.sum() * np.linalg.norm(scene.gravity))

    @cached_property
    def _image(self) -> NDArray[np.int64] | None:
        """Each corner's mirror image across a vertical plane, or None without symmetry."""
        scene = self.scene
        if scene.pushes or scene.gravity[0] != 0:
            return None
        start = self.corners(self.start)
        away = np.linalg.norm(self.mirrored(start)[:, None] - start, axis=-1)
        nearest = away.argmin(axis=1)
        near = away[np.arange(len(start)), nearest] < NEARLY * scene.size
        return nearest if near.all() else None

    def mirrored(self, corners: Array) -> Array:
        """Mirror corners across the plane x = that of the common centre of mass."""
        middle = self._mass @ self._centres[:, 0] / self._mass.sum()
        flip = np.ones(self.scene.dimensions)
        flip[0] = -1
        return corners * flip + 2 * middle * (flip < 0)

    def asymmetry(self, poses: Array) -> float | None:
        """Return how far corners are from the mirror images of others at the end [m].

        None where the scene is no mirror image of itself.
        """
        if self._image is None:
            return None
        at = self.corners(poses[-1])
        return float(np.linalg.norm(self.mirrored(at) - at[self._image], axis=-1).max())
