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
from scipy.spatial.transform import Rotation

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


class Jointed(Touching, ABC):
    """Bodies of a model that touch at the corners of joints.

    `problem`.
    `inertia`, (blocks, 6): Mass along each axis, and moments about a body's own.
    """

    problem: Problem[Any]
    inertia: Array

    @abstractmethod
    def release(self, body: Any) -> None:
        """Let a body of a model move."""

    @abstractmethod
    def pieces(self) -> tuple[list[tuple[int, Array]], dict[str, list[float]]]:
        """Return convex parts, each of a block or of `SUPPORT`, and where the floor is."""

    def _bodies(self) -> tuple[Any, list[Any]]:
        """Return a model of bodies without shapes, and how it is solved; then the bodies.

        The last of them is what is fixed.
        """
        least, lightest = library.mjMINVAL, float(self.inertia.min())
        allowed = f"above {least:g} of the mean block's: MuJoCo takes no less"
        require(
            lightest > least, "lightest block", f"mass or inertia of {lightest:.3g}", allowed
        )
        spec, bodies = library.MjSpec(), list[Any]()
        option = spec.option
        option.gravity = self.problem.gravity.tolist()
        option.cone = library.mjtCone.mjCONE_ELLIPTIC
        option.solver = library.mjtSolver.mjSOL_NEWTON
        option.tolerance = TOLERANCE
        # It would put all blocks back in silence where numbers overflow.
        option.disableflags |= library.mjtDisableBit.mjDSBL_AUTORESET
        turns = Rotation.from_matrix(self.frames.turns[:-1]).as_quat()[:, ORDER]
        for (mass, _, _, *moments), centre, turn in zip(
            self.inertia.tolist(), self.frames.centres.tolist(), turns.tolist(), strict=False
        ):
            # Left out, its own place and axes are not those of the body.
            body = spec.worldbody.add_body(
                pos=centre, quat=turn, mass=mass, inertia=moments, ipos=[0.0, 0.0, 0.0],
                iquat=[1.0, 0.0, 0.0, 0.0], explicitinertial=True,
            )  # fmt: skip
            self.release(body)
            bodies.append(body)
        return spec, [*bodies, spec.worldbody]

    def joined(self, reaches: Array | None = None) -> Any:
        """Return a model of bodies that touch at the corners of joints.

        `reaches`, (points,): How far each corner reaches into its plate [size].
        """
        spec, bodies = self._bodies()
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

    def rubble(self) -> Any:
        """Return a model of the blocks as they are, what they stand on and the floor."""
        (spec, bodies), (hulls, floor) = self._bodies(), self.pieces()
        spec.option.timestep, spec.option.impratio = RUBBLE_STEP, RUBBLE_RATIO
        look: dict[str, Any] = {
            "friction": [min(self.problem.mu, FRICTION_CAP), 0.0, 0.0],
            "condim": 3,
            "solref": [RUBBLE_PERIOD * RUBBLE_STEP, 1.0],
            "solimp": [*[1 / (1 + RUBBLE_SOFTNESS)] * 2, 1.0, 0.5, 2.0],
        }
        for index, (owner, corners) in enumerate(hulls):
            spec.add_mesh(name=f"mesh {index}", uservert=corners.ravel())
            # A mesh is moved to its centre of mass unless it is told where it lies.
            bodies[owner].add_geom(
                type=library.mjtGeom.mjGEOM_MESH, meshname=f"mesh {index}", **look
            )
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
        self.inertia = self.assembly.spatial_masses[:, [0, 1, 3, 4, 5, 2]]

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

    def release(self, body: Any) -> None:
        """Let a body slide along x and y, and turn."""
        slide, hinge = library.mjtJoint.mjJNT_SLIDE, library.mjtJoint.mjJNT_HINGE
        body.add_joint(type=slide, axis=[1.0, 0.0, 0.0])
        body.add_joint(type=slide, axis=[0.0, 1.0, 0.0])
        body.add_joint(type=hinge, axis=[0.0, 0.0, 1.0])

    def pieces(self) -> tuple[list[tuple[int, Array]], dict[str, list[float]]]:
        """Return polygons as prisms, and a floor whose normal is z, turned to y."""
        solids, half = self.solids, math.sqrt(0.5)
        polygons = [*solids.moving, *((SUPPORT, each) for each in solids.fixed)]
        floor = {"pos": [0.0, solids.level, 0.0], "quat": [half, -half, 0.0, 0.0]}
        return [(owner, prism(each, 1.0)[0]) for owner, each in polygons], floor

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
