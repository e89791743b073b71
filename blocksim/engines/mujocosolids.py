"""Blocks in space as bodies of MuJoCo: small balls at the corners of joints, on plates.

Each ball touches its plate and nothing else: one point of contact, with a round cone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.common.later import transform
from blocksim.engines.mujocoblocks import (
    compiled,
    let_touch,
    library,
    rubble_of,
    spec_of,
    with_body,
)
from blocksim.engines.polyhedra import Polyhedra

BALL = 0.02
"""Radius of a ball, over the spread of a joint's corners."""
ORDER = [3, 0, 1, 2]
"""MuJoCo's quaternions begin with the scalar."""


class Spatial(Polyhedra):
    """The blocks of a problem in space as free bodies; see `mujocomotion`."""

    @property
    def masses(self) -> Array:
        """Inertia of each velocity: along the axes, and about a body's own."""
        return self.bodies.inertia.ravel()

    def _spec(self) -> tuple[Any, list[Any]]:
        """Return a model of free bodies, without shapes, and the bodies."""
        spec, found = spec_of(self.problem.gravity, self.masses), list[Any]()
        turns = self.quaternions[:, ORDER]
        for index, (mass, _, _, *moments) in enumerate(self.bodies.inertia.tolist()):
            centre = self.bodies.built.centres[index].tolist()
            body = with_body(spec, mass, moments, pos=centre, quat=turns[index].tolist())
            body.add_freejoint()
            found.append(body)
        return spec, found

    def joined(self, reaches: Array | None = None) -> Any:
        """Return a model of bodies that touch at the corners of joints.

        `reaches`, (points,): How far each corner reaches into its plate [size].
        """
        spec, bodies = self._spec()
        bodies.append(spec.worldbody)
        silent = {"contype": 0, "conaffinity": 0}
        for touch, ways in zip(self.touches, self.at_joints(reaches), strict=True):
            plate = touch.places.mean(axis=0) - touch.half[2] * touch.normal
            centre, turn = self.within(touch.plate, plate, touch.axes)
            bodies[touch.plate].add_geom(
                name=f"plate {touch.joint}", type=library.mjtGeom.mjGEOM_BOX,
                size=touch.half, pos=centre, quat=turn[ORDER].tolist(), **silent,
            )  # fmt: skip
            mu, ball = self.problem.friction[touch.joint], BALL * touch.spread
            for at, (place, way) in enumerate(zip(touch.places, ways.tolist(), strict=True)):
                centre, _ = self.within(
                    touch.corners, place + (ball - way) * touch.normal, np.eye(3)
                )
                name = f"corner {touch.joint} {at}"
                bodies[touch.corners].add_geom(
                    name=name, type=library.mjtGeom.mjGEOM_SPHERE,
                    size=[ball, 0.0, 0.0], pos=centre, **silent,
                )  # fmt: skip
                let_touch(spec, f"plate {touch.joint}", name, mu)
        return compiled(spec)

    def ways(self, pressures: Array) -> Array:
        """Return how far contacts give way, (points,): as their force, and what moves there."""
        inertia, place = self.bodies.inertia, self.bodies.built
        found = np.zeros_like(pressures)
        for touch, free in zip(self.touches, self.at_joints(found), strict=True):
            for index in {touch.plate, touch.corners} - {SUPPORT}:
                arms = touch.places - place.centres[index]
                about = np.cross(arms, touch.normal) @ place.turns[index]
                free[:] += 1 / inertia[index, 0] + (about**2 / inertia[index, 3:]).sum(axis=1)
        return pressures * found

    def rubble(self) -> Any:
        """Return a model of the blocks as they are, what they stand on and the floor."""
        spec, bodies = self._spec()
        hulls = self.bodies.hulls
        known = [
            (spec.worldbody if owner == SUPPORT else bodies[owner], corners)
            for owner, support, corners in zip(
                hulls.owner, hulls.support, hulls.corners, strict=True
            )
            if owner != SUPPORT or support >= 0
        ]
        return rubble_of(spec, known, {"pos": [0.0, 0.0, self.level]}, self.problem.mu)

    def poses(self, places: Array, zero: Array) -> Array:
        """Return centres and rotation vectors since they were built, (blocks, 6)."""
        now, was = places.reshape(-1, 7), zero.reshape(-1, 7)
        turned = _turns(now) * _turns(was).inv()
        return np.hstack([self.built[:, :3] + now[:, :3] - was[:, :3], turned.as_rotvec()])

    def placed(self, poses: Array) -> Array:
        """Return centres and quaternions at poses."""
        turns = transform.Rotation.from_matrix(self.place(poses).turns[:-1]).as_quat()
        return np.hstack([poses[:, :3], turns[:, ORDER]]).ravel()

    def rates(self, places: Array, moved: Array) -> Array:
        """Return velocities along and about the axes, (blocks, 6)."""
        found = moved.reshape(-1, 6).copy()
        found[:, 3:] = _turns(places.reshape(-1, 7)).apply(found[:, 3:])
        return found

    def loads(self, places: Array) -> Array | None:
        """Return loads besides gravity, moments about bodies' own axes."""
        now = places.reshape(-1, 7)
        since = _turns(now) * transform.Rotation.from_quat(self.quaternions).inv()
        found = self.along(np.hstack([now[:, :3], since.as_rotvec()]))
        if found is None:
            return None
        found[:, 3:] = _turns(now).inv().apply(found[:, 3:])
        return found.ravel()


def _turns(places: Array) -> transform.Rotation:
    """Return rotations of coordinates (blocks, 7)."""
    return transform.Rotation.from_quat(places[:, [4, 5, 6, 3]])
