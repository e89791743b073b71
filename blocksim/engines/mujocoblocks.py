"""Models of MuJoCo: blocks that touch at their joints, and blocks that may meet any other.

While joints are joints only they are contacts: small balls at their corners, in the plane at
both ends, each on a plate on the other block. A ball touches its plate and nothing else, by a
pair that is named beforehand, for which alone friction has settings of its own: one point of
contact, with a round cone.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.engines.base import FRICTION_CAP, Library
from blocksim.engines.polyhedra import Touch, Touching
from blocksim.engines.solid.bodies import Place
from blocksim.engines.solids import Polygons, prism

library: Any = Library("mujoco")

TOLERANCE = 1e-14
BALL = 0.02
"""Radius of a ball, over the spread of a joint's corners."""
ORDER = [3, 0, 1, 2]
"""MuJoCo's quaternions begin with the scalar."""
RUBBLE_STEP, RUBBLE_PERIOD = 5e-4, 2.0
"""MuJoCo's step once blocks may meet, and the period of contacts in such steps."""
RUBBLE_SOFTNESS, RUBBLE_RATIO = 1e-3, 10.0
"""How soft they are then, and how much harder friction is than pressure."""


def spec_of(gravity: Array, masses: Array) -> Any:
    """Return a model without bodies, and how it is solved."""
    least, lightest = library.mjMINVAL, float(masses.min())
    allowed = f"above {least:g} of the mean block's: MuJoCo takes no less"
    require(lightest > least, "lightest block", f"mass or inertia of {lightest:.3g}", allowed)
    spec = library.MjSpec()
    option = spec.option
    option.gravity = gravity.tolist()
    option.cone = library.mjtCone.mjCONE_ELLIPTIC
    option.solver = library.mjtSolver.mjSOL_NEWTON
    option.tolerance = TOLERANCE
    # It would put all blocks back in silence where numbers overflow.
    option.disableflags |= library.mjtDisableBit.mjDSBL_AUTORESET
    return spec


def with_body(spec: Any, mass: float, inertia: list[float], **where: list[float]) -> Any:
    """Add a body of some mass and principal moments to a model, and return it."""
    # Left out, its own place and axes are not those of the body.
    return spec.worldbody.add_body(
        mass=mass,
        inertia=inertia,
        ipos=[0.0, 0.0, 0.0],
        iquat=[1.0, 0.0, 0.0, 0.0],
        explicitinertial=True,
        **where,
    )


class Jointed(Touching, ABC):
    """Bodies of a model that touch at the corners of joints.

    `problem`.
    `inertia`, (blocks, 6): Mass along each axis, and moments about a body's own.
    """

    problem: Problem[Any]
    inertia: Array

    @abstractmethod
    def free(self) -> tuple[Any, list[Any]]:
        """Return a model of bodies without shapes, and the bodies."""

    def joined(self, reaches: Array | None = None) -> Any:
        """Return a model of bodies that touch at the corners of joints.

        `reaches`, (points,): How far each corner reaches into its plate [size].
        """
        spec, bodies = self.free()
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
            friction = [min(float(mu), FRICTION_CAP)] * 2 + [0.0] * 3
            for at, (place, way) in enumerate(zip(touch.places, ways.tolist(), strict=True)):
                centre, _ = self.within(
                    touch.corners, place + (ball - way) * touch.normal, np.eye(3)
                )
                name = f"corner {touch.joint} {at}"
                bodies[touch.corners].add_geom(
                    name=name, type=library.mjtGeom.mjGEOM_SPHERE,
                    size=[ball, 0.0, 0.0], pos=centre, **silent,
                )  # fmt: skip
                spec.add_pair(
                    geomname1=f"plate {touch.joint}", geomname2=name,
                    condim=3, friction=friction,
                )  # fmt: skip
        spec.option.enableflags |= library.mjtEnableBit.mjENBL_DIAGEXACT
        model = spec.compile()
        # A box turned by next to nothing is as its body to MuJoCo, unless it is told.
        model.geom_sameframe[:] = library.mjtSameFrame.mjSAMEFRAME_NONE
        return model

    def ways(self, pressures: Array) -> Array:
        """Return how far contacts give way, (points,): as their force, and what moves there.

        `pressures`, (points,).
        """
        found, (centres, turns) = np.zeros_like(pressures), self.frames
        for touch, free in zip(self.touches, self.at_joints(found), strict=True):
            for index in {touch.plate, touch.corners} - {SUPPORT}:
                arms = touch.places - centres[index]
                about = np.cross(arms, touch.normal) @ turns[index]
                inertia = self.inertia[index]
                free[:] += 1 / inertia[0] + (about**2 / inertia[3:]).sum(axis=1)
        return pressures * found


def rubble_of(
    spec: Any, hulls: list[tuple[Any, Array]], floor: dict[str, list[float]], mu: float
) -> Any:
    """Return the model of hulls on bodies that may meet any other, and of a floor."""
    spec.option.timestep, spec.option.impratio = RUBBLE_STEP, RUBBLE_RATIO
    look: dict[str, Any] = {
        "friction": [min(mu, FRICTION_CAP), 0.0, 0.0],
        "condim": 3,
        "solref": [RUBBLE_PERIOD * RUBBLE_STEP, 1.0],
        "solimp": [*[1 / (1 + RUBBLE_SOFTNESS)] * 2, 1.0, 0.5, 2.0],
    }
    for index, (body, corners) in enumerate(hulls):
        spec.add_mesh(name=f"mesh {index}", uservert=corners.ravel())
        # A mesh is moved to its centre of mass unless it is told where it lies.
        body.add_geom(type=library.mjtGeom.mjGEOM_MESH, meshname=f"mesh {index}", **look)
    plane = library.mjtGeom.mjGEOM_PLANE
    spec.worldbody.add_geom(type=plane, size=[0.0, 0.0, 1.0], **floor, **look)
    return spec.compile()


class Planar(Polygons, Jointed):
    """The blocks of a problem in the plane as bodies that slide along x and y, and turn."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self._built = self.assembly.built[:-1]
        self.masses: Array = self.assembly.masses.ravel()
        centres = np.pad(self.assembly.built[:, :2], ((0, 0), (0, 1)))
        self.frames = Place(centres, np.broadcast_to(np.eye(3), (len(centres), 3, 3)))
        self.inertia = np.full((len(self._built), 6), np.inf)
        self.inertia[:, [0, 1, 5]] = self.assembly.masses

    @cached_property
    def touches(self) -> tuple[Touch, ...]:
        """Both ends of each joint, which are one of a corner that rests on a face."""
        joints, flat = self.assembly.joint_arrays, ((0, 0), (0, 1))
        ends, normals = np.pad(joints.ends, ((0, 0), *flat)), np.pad(joints.normal, flat)
        known = zip(self.assembly.sides.T.tolist(), joints.carrier, ends, normals, strict=True)
        return tuple(
            Touch.of(at, sides, -1.0 if carrier else 1.0, places, normal)
            for at, (sides, carrier, places, normal) in enumerate(known)
        )

    def ways(self, pressures: Array) -> Array:
        """Return how far contacts give way under pressures at both ends of each joint."""
        corner = self.assembly.joint_arrays.is_corner[:, None]
        even = np.where(corner, pressures.mean(axis=1, keepdims=True), pressures)
        return super().ways(even.ravel())

    def free(self) -> tuple[Any, list[Any]]:
        """Return a model of bodies that move in the plane, without shapes, and the bodies."""
        assembly = self.assembly
        size, spec = assembly.size, spec_of(self.problem.gravity, assembly.spatial_masses)
        bodies: list[Any] = []
        for index, block in enumerate(assembly.blocks):
            mass, _, inertia, _, *across = assembly.spatial_masses[index].tolist()
            body = with_body(spec, mass, [*across, inertia], pos=[*(block.centre / size), 0.0])
            slide, hinge = library.mjtJoint.mjJNT_SLIDE, library.mjtJoint.mjJNT_HINGE
            body.add_joint(type=slide, axis=[1.0, 0.0, 0.0])
            body.add_joint(type=slide, axis=[0.0, 1.0, 0.0])
            body.add_joint(type=hinge, axis=[0.0, 0.0, 1.0])
            bodies.append(body)
        return spec, bodies

    def rubble(self) -> Any:
        """Return a model of the blocks as they are, what they stand on and the floor."""
        spec, bodies = self.free()
        solids, half = self.solids, math.sqrt(0.5)
        polygons = [(bodies[index], polygon) for index, polygon in solids.moving]
        polygons += [(spec.worldbody, polygon) for polygon in solids.fixed]
        hulls = [(body, prism(polygon, 1.0)[0]) for body, polygon in polygons]
        # The floor's normal is z, turned to y.
        floor = {"pos": [0.0, solids.level, 0.0], "quat": [half, -half, 0.0, 0.0]}
        return rubble_of(spec, hulls, floor, self.problem.mu)

    def poses(self, places: Array, zero: Array) -> Array:
        """Return centres and rotations, (blocks, 3)."""
        return self._built + (places - zero).reshape(-1, PLANAR)

    def placed(self, poses: Array) -> Array:
        """Return what blocks have moved."""
        return (poses - self._built).ravel()

    def rates(self, places: Array, moved: Array) -> Array:  # noqa: ARG002 - of both
        """Return velocities, (blocks, 3)."""
        return moved.reshape(-1, PLANAR).copy()

    def loads(self, places: Array) -> Array | None:
        """Return loads besides gravity."""
        if not self.problem.is_loaded:
            return None
        return self.problem.loads(self.poses(places, np.zeros_like(places))).ravel()
