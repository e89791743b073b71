"""Blocks in space as bodies of MuJoCo: small balls at the corners of joints, on plates.

Each ball touches its plate and nothing else: one point of contact, with a round cone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.engines.base import FRICTION_CAP
from blocksim.engines.mujocoblocks import (
    RUBBLE_RATIO,
    RUBBLE_STEP,
    compiled,
    library,
    look_of,
    spec_of,
)
from blocksim.engines.polyhedra import Polyhedra

BALL = 0.02
"""Radius of a ball, over the spread of a joint's corners."""
ORDER = [3, 0, 1, 2]
"""MuJoCo's quaternions begin with the scalar."""


class Spatial(Polyhedra):
    """The blocks of a problem in space as free bodies; see `mujoco.Parts`."""

    @property
    def masses(self) -> Array:
        """Inertia of each velocity: along the axes, and about a body's own."""
        return self.bodies.inertia.ravel()

    @property
    def solids(self) -> Spatial:
        """When blocks may meet others is known here."""
        return self

    def _spec(self) -> tuple[Any, list[Any]]:
        """Return a model of free bodies, without shapes, and the bodies."""
        spec, found = spec_of(self.problem.gravity), list[Any]()
        turns = self.quaternions[:, ORDER]
        for index, (mass, _, _, *moments) in enumerate(self.bodies.inertia.tolist()):
            body = spec.worldbody.add_body(
                pos=self.bodies.built.centres[index].tolist(),
                quat=turns[index].tolist(),
                mass=mass,
                inertia=moments,
                ipos=[0.0, 0.0, 0.0],
                iquat=[1.0, 0.0, 0.0, 0.0],
                explicitinertial=True,
            )
            body.add_freejoint()
            found.append(body)
        return spec, found

    def joined(self, reaches: Array | None = None) -> Any:
        """Return a model of bodies that touch at the corners of joints.

        Parameters
        ----------
        reaches : (points,) float, optional
            How far each corner reaches into its plate [size].
        """
        spec, bodies = self._spec()
        bodies.append(spec.worldbody)
        ways = np.zeros(sum(len(each.places) for each in self.touches))
        ways = ways if reaches is None else reaches
        silent = {"contype": 0, "conaffinity": 0}
        first = 0
        for touch in self.touches:
            own = ways[first : first + len(touch.places)]
            first += len(touch.places)
            normal = touch.axes[:, 2]
            plate = touch.places.mean(axis=0) - touch.half[2] * normal
            centre, turn = self._within(touch.plate, plate, touch.axes)
            bodies[touch.plate].add_geom(
                name=f"plate {touch.joint}", type=library.mjtGeom.mjGEOM_BOX,
                size=touch.half, pos=centre, quat=turn, **silent,
            )  # fmt: skip
            mu = min(float(self.problem.friction[touch.joint]), FRICTION_CAP)
            ball = BALL * touch.spread
            for at, (place, way) in enumerate(zip(touch.places, own.tolist(), strict=True)):
                centre, _ = self._within(
                    touch.corners, place + (ball - way) * normal, np.eye(3)
                )
                name = f"corner {touch.joint} {at}"
                bodies[touch.corners].add_geom(
                    name=name, type=library.mjtGeom.mjGEOM_SPHERE,
                    size=[ball, 0.0, 0.0], pos=centre, **silent,
                )  # fmt: skip
                spec.add_pair(
                    geomname1=f"plate {touch.joint}",
                    geomname2=name,
                    condim=3,
                    friction=[mu] * 2 + [0.0] * 3,
                )
        return compiled(spec)

    def _within(
        self, index: int, centre: Array, axes: Array
    ) -> tuple[list[float], list[float]]:
        """Return a place and axes in the frame of a body, the axes as a quaternion."""
        if index == SUPPORT:
            own, place = axes, centre
        else:
            turn = self.bodies.built.turns[index].T
            own, place = turn @ axes, turn @ (centre - self.bodies.built.centres[index])
        turned = Rotation.from_matrix(own).as_quat()[ORDER]
        return place.tolist(), turned.tolist()

    def ways(self, pressures: Array) -> Array:
        """Return how far contacts give way, (points,): as their force, and what moves there."""
        inertia, place = self.bodies.inertia, self.bodies.built
        found, first = np.zeros_like(pressures), 0
        for touch in self.touches:
            at = slice(first, first + len(touch.places))
            first += len(touch.places)
            for index in {touch.plate, touch.corners} - {SUPPORT}:
                arms = touch.places - place.centres[index]
                about = np.cross(arms, touch.axes[:, 2]) @ place.turns[index]
                found[at] += 1 / inertia[index, 0] + (about**2 / inertia[index, 3:]).sum(axis=1)
        return pressures * found

    def rubble(self) -> Any:
        """Return a model of the blocks as they are, what they stand on and the floor."""
        spec, bodies = self._spec()
        spec.option.timestep, spec.option.impratio = RUBBLE_STEP, RUBBLE_RATIO
        look, hulls = look_of(self.problem.mu), self.bodies.hulls
        for index, (owner, corners) in enumerate(zip(hulls.owner, hulls.corners, strict=True)):
            if owner == SUPPORT and hulls.support[index] < 0:
                continue
            spec.add_mesh(name=f"mesh {index}", uservert=corners.ravel())
            body = spec.worldbody if owner == SUPPORT else bodies[owner]
            # A mesh is moved to its centre of mass unless it is told where it lies.
            body.add_geom(type=library.mjtGeom.mjGEOM_MESH, meshname=f"mesh {index}", **look)
        spec.worldbody.add_geom(
            type=library.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0],
            pos=[0.0, 0.0, self.level], **look,
        )  # fmt: skip
        return spec.compile()

    def poses(self, places: Array, zero: Array) -> Array:
        """Return centres and rotation vectors since they were built, (blocks, 6)."""
        now, was = places.reshape(-1, 7), zero.reshape(-1, 7)
        turned = _turns(now) * _turns(was).inv()
        return np.hstack([self.built[:, :3] + now[:, :3] - was[:, :3], turned.as_rotvec()])

    def placed(self, poses: Array) -> Array:
        """Return centres and quaternions at poses."""
        turns = Rotation.from_matrix(self.place(poses).turns[:-1]).as_quat()
        return np.hstack([poses[:, :3], turns[:, ORDER]]).ravel()

    def rates(self, places: Array, moved: Array) -> Array:
        """Return velocities along and about the axes, (blocks, 6)."""
        found = moved.reshape(-1, 6).copy()
        found[:, 3:] = _turns(places.reshape(-1, 7)).apply(found[:, 3:])
        return found

    def loads(self, places: Array) -> Array | None:
        """Return loads besides gravity, moments about bodies' own axes."""
        now = places.reshape(-1, 7)
        since = _turns(now) * Rotation.from_quat(self.quaternions).inv()
        found = self.along(np.hstack([now[:, :3], since.as_rotvec()]))
        if found is None:
            return None
        found[:, 3:] = _turns(now).inv().apply(found[:, 3:])
        return found.ravel()


def _turns(places: Array) -> Rotation:
    """Return rotations of coordinates (blocks, 7)."""
    return Rotation.from_quat(places[:, [4, 5, 6, 3]])
