"""Models of MuJoCo: blocks that touch at their joints, and blocks that may meet any other.

While joints are joints only they are contacts: pairs of boxes named beforehand, for which
alone friction has settings of its own. One face of each joint reaches beyond the other, as in
`boxes`.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import FRICTION_CAP, Library
from blocksim.engines.boxes import plate, uneven_depths
from blocksim.engines.energy import Balance
from blocksim.engines.faces import reaching, sides_of
from blocksim.engines.solids import Solids

library: Any = Library("mujoco")

TOLERANCE = 1e-14
RUBBLE_STEP, RUBBLE_PERIOD = 5e-4, 2.0
"""MuJoCo's step once blocks may meet, and the period of contacts in such steps."""
RUBBLE_SOFTNESS, RUBBLE_RATIO = 1e-3, 10.0
"""How soft they are then, and how much harder friction is than pressure."""


def spec_of(gravity: Array) -> Any:
    """Return a model without bodies, and how it is solved."""
    spec = library.MjSpec()
    option = spec.option
    option.gravity = gravity.tolist()
    option.cone = library.mjtCone.mjCONE_ELLIPTIC
    option.solver = library.mjtSolver.mjSOL_NEWTON
    option.tolerance = TOLERANCE
    # It would put all blocks back in silence where numbers overflow.
    option.disableflags |= library.mjtDisableBit.mjDSBL_AUTORESET
    return spec


def compiled(spec: Any) -> Any:
    """Return the model of joints that are contacts."""
    spec.option.enableflags |= library.mjtEnableBit.mjENBL_DIAGEXACT
    model = spec.compile()
    # A box turned by next to nothing is as its body to MuJoCo, unless it is told.
    model.geom_sameframe[:] = library.mjtSameFrame.mjSAMEFRAME_NONE
    return model


def look_of(mu: float) -> dict[str, Any]:
    """Return what bodies that may meet any other have."""
    return {
        "friction": [min(mu, FRICTION_CAP), 0.0, 0.0],
        "condim": 3,
        "solref": [RUBBLE_PERIOD * RUBBLE_STEP, 1.0],
        "solimp": [*[1 / (1 + RUBBLE_SOFTNESS)] * 2, 1.0, 0.5, 2.0],
    }


class Planar:
    """The blocks of a problem in the plane as bodies that slide along x and y, and turn.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, self._assembly = problem, problem.assembly
        self._built = self._assembly.built[:-1]
        self.masses: Array = self._assembly.masses.ravel()

    @property
    def solids(self) -> Solids:
        """Polygons, and from when on they may meet."""
        return self._solids

    @cached_property
    def _solids(self) -> Solids:
        return Solids(self._assembly)

    def joined(self, reaches: Array | None = None) -> Any:
        """Return a model of bodies that touch at joints."""
        return joined(self._problem, reaches)

    def rubble(self) -> Any:
        """Return a model of bodies that may meet."""
        return rubble(self._problem, self._solids)

    def ways(self, pressures: Array) -> Array:
        """Return how far contacts at both ends of each joint give way, (joints, 2)."""
        return ways(self._assembly, pressures)

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
        if not self._problem.is_loaded:
            return None
        return self._problem.loads(self.poses(places, np.zeros_like(places))).ravel()

    def displacement(self, moved: Array) -> float:
        """Return the largest displacement of any corner."""
        return float(displacement(moved, self._assembly))

    def balance(self, poses: Array) -> Balance:
        """Return what looks at the energy."""
        return Balance(self._problem, poses)


def _bodies(problem: Problem) -> tuple[Any, list[Any]]:
    """Return a model of bodies that move in the plane, without shapes, and the bodies."""
    assembly = problem.assembly
    size, spec = assembly.size, spec_of(problem.gravity)
    bodies: list[Any] = []
    for index, block in enumerate(assembly.blocks):
        mass, _, inertia, _, *across = assembly.spatial_masses[index].tolist()
        body = spec.worldbody.add_body(
            pos=[*(block.centre / size), 0.0],
            mass=mass,
            inertia=[*across, inertia],
            # Left out, they are not those of the body.
            ipos=[0.0, 0.0, 0.0],
            iquat=[1.0, 0.0, 0.0, 0.0],
            explicitinertial=True,
        )
        slide, hinge = library.mjtJoint.mjJNT_SLIDE, library.mjtJoint.mjJNT_HINGE
        body.add_joint(type=slide, axis=[1.0, 0.0, 0.0])
        body.add_joint(type=slide, axis=[0.0, 1.0, 0.0])
        body.add_joint(type=hinge, axis=[0.0, 0.0, 1.0])
        bodies.append(body)
    return spec, bodies


def joined(problem: Problem, reaches: Array | None = None) -> Any:
    """Return a model of bodies that touch where the assembly has joints.

    Parameters
    ----------
    problem : Problem
    reaches : (joints, 2) float, optional
        How far the sides of each joint reach into each other at its ends [size].
    """
    assembly = problem.assembly
    spec, bodies = _bodies(problem)
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
        mu = min(float(problem.friction[k]), FRICTION_CAP)
        spec.add_pair(
            geomname1=f"joint {k}, block {sides[0].body}",
            geomname2=f"joint {k}, block {sides[1].body}",
            condim=3,
            friction=[mu] * 2 + [0.0] * 3,
        )
    return compiled(spec)


def ways(assembly: Assembly, pressures: Array) -> Array:
    """Return how far contacts give way under pressures at both ends of each joint.

    A contact gives way as its force, of which it has half, and as what is free to move there.

    Returns
    -------
    (joints, 2) float
        Over what one gives way under the weight of a block that is free to move.
    """
    joints = assembly.joint_arrays
    free = np.zeros_like(pressures)
    for bodies, every in zip((joints.before, joints.after), assembly.joint_arms, strict=True):
        moves = bodies != SUPPORT
        mass, _, inertia = assembly.masses[bodies[moves]].T[:, :, None]
        arms, normal = every[moves], joints.normal[moves, None]
        levers = arms[..., 0] * normal[..., 1] - arms[..., 1] * normal[..., 0]
        free[moves] += 1 / mass + levers**2 / inertia
    carried = pressures / 2
    # A corner has one place, and all that it carries is shared by its four contacts.
    carried[joints.is_corner] = pressures[joints.is_corner].sum(axis=1, keepdims=True) / 4
    return carried * free


def rubble(problem: Problem, solids: Solids) -> Any:
    """Return a model of the blocks as they are, what they stand on and the floor."""
    spec, bodies = _bodies(problem)
    spec.option.timestep = RUBBLE_STEP
    spec.option.impratio = RUBBLE_RATIO
    look = look_of(problem.mu)
    owners = [bodies[index] for index, _ in solids.moving]
    owners += [spec.worldbody] * len(solids.fixed)
    polygons = [polygon for _, polygon in solids.moving] + solids.fixed
    for index, (body, polygon) in enumerate(zip(owners, polygons, strict=True)):
        points = [[x, y, z] for z in (-0.5, 0.5) for x, y in polygon.tolist()]
        spec.add_mesh(name=f"mesh {index}", uservert=np.array(points).ravel())
        body.add_geom(type=library.mjtGeom.mjGEOM_MESH, meshname=f"mesh {index}", **look)
    half = math.sqrt(0.5)
    spec.worldbody.add_geom(
        type=library.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], pos=[0.0, solids.level, 0.0],
        # Its normal is z, turned to y.
        quat=[half, -half, 0.0, 0.0], **look,
    )  # fmt: skip
    return spec.compile()
