"""Models of MuJoCo: blocks that touch at their joints, and blocks that may meet any other.

While joints are joints only they are contacts: pairs of boxes named beforehand, for which
alone friction has settings of its own. One face of each joint reaches beyond the other, as in
`boxes`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.engines.base import FRICTION_CAP, Library
from blocksim.engines.boxes import plate, uneven_depths
from blocksim.engines.faces import reaching, sides_of
from blocksim.engines.solids import Polygons, prism

library: Any = Library("mujoco")

TOLERANCE = 1e-14
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


def let_touch(spec: Any, one: str, other: str, mu: float) -> None:
    """Let two shapes touch, with a friction."""
    friction = [min(float(mu), FRICTION_CAP)] * 2 + [0.0] * 3
    spec.add_pair(geomname1=one, geomname2=other, condim=3, friction=friction)


def compiled(spec: Any) -> Any:
    """Return the model of joints that are contacts."""
    spec.option.enableflags |= library.mjtEnableBit.mjENBL_DIAGEXACT
    model = spec.compile()
    # A box turned by next to nothing is as its body to MuJoCo, unless it is told.
    model.geom_sameframe[:] = library.mjtSameFrame.mjSAMEFRAME_NONE
    return model


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


class Planar(Polygons):
    """The blocks of a problem in the plane as bodies that slide along x and y, and turn."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self._built = self.assembly.built[:-1]
        self.masses: Array = self.assembly.masses.ravel()

    def _bodies(self) -> tuple[Any, list[Any]]:
        """Return a model of bodies that move in the plane, without shapes, and the bodies."""
        assembly = self.assembly
        size, spec = assembly.size, spec_of(self.problem.gravity, assembly.masses)
        bodies: list[Any] = []
        for index, block in enumerate(assembly.blocks):
            mass, _, inertia = assembly.masses[index].tolist()
            # It turns about z alone, but moments have to be those of a body.
            across = inertia / 2 + mass * float(assembly.depths[index]) ** 2 / 12
            body = with_body(
                spec, mass, [across, across, inertia], pos=[*(block.centre / size), 0.0]
            )
            slide, hinge = library.mjtJoint.mjJNT_SLIDE, library.mjtJoint.mjJNT_HINGE
            body.add_joint(type=slide, axis=[1.0, 0.0, 0.0])
            body.add_joint(type=slide, axis=[0.0, 1.0, 0.0])
            body.add_joint(type=hinge, axis=[0.0, 0.0, 1.0])
            bodies.append(body)
        return spec, bodies

    def joined(self, reaches: Array | None = None) -> Any:
        """Return a model of bodies that touch where the assembly has joints.

        `reaches`, (joints, 2): How far the sides of each joint reach into each other at its
            ends [size].
        """
        assembly = self.assembly
        spec, bodies = self._bodies()
        centres = assembly.built[:, :2]
        depth = np.append(uneven_depths(assembly), 2 * assembly.depths.max())
        for k, pair in enumerate(sides_of(assembly)):
            ends = assembly.joint_arrays.ends[k]
            sides = pair if reaches is None else reaching(pair, ends, reaches[k])
            for side in sides:
                body = spec.worldbody if side.body == SUPPORT else bodies[side.body]
                box = plate(side, float(depth[side.body]), centres[side.body], overlap=0.0)
                x, y, z, w = box.quaternion
                body.add_geom(
                    name=f"joint {k}, block {side.body}",
                    type=library.mjtGeom.mjGEOM_BOX,
                    size=box.half,
                    pos=box.centre,
                    quat=[w, x, y, z],
                    contype=0,
                    conaffinity=0,
                )
            one, other = (f"joint {k}, block {side.body}" for side in sides)
            let_touch(spec, one, other, self.problem.friction[k])
        return compiled(spec)

    def ways(self, pressures: Array) -> Array:
        """Return how far contacts give way under pressures at both ends of each joint.

        A contact gives way as its force, of which it has half, and as what is free to move.

        Returns (joints, 2): Over what one gives way under the weight of a block that is free to
            move.
        """
        assembly, joints = self.assembly, self.assembly.joint_arrays
        free = np.zeros_like(pressures)
        for bodies, every in zip(
            (joints.before, joints.after), assembly.joint_arms, strict=True
        ):
            moves = bodies != SUPPORT
            mass, _, inertia = assembly.masses[bodies[moves]].T[:, :, None]
            arms, normal = every[moves], joints.normal[moves, None]
            levers = arms[..., 0] * normal[..., 1] - arms[..., 1] * normal[..., 0]
            free[moves] += 1 / mass + levers**2 / inertia
        carried = pressures / 2
        # A corner has one place, and all that it carries is shared by its four contacts.
        carried[joints.is_corner] = pressures[joints.is_corner].sum(axis=1, keepdims=True) / 4
        return carried * free

    def rubble(self) -> Any:
        """Return a model of the blocks as they are, what they stand on and the floor."""
        spec, bodies = self._bodies()
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
