"""Bullet through pybullet: three dimensions, off-screen, sequential impulses, Coulomb friction.

How a near-critical arch has to be put into it (each point measured, see
`analysis/pybullet_settings.py`):

- Hulls are unfit: they get one contact point a step, or rounded corners. A block is a
  thin box on each of its joint faces, which Bullet collides exactly.
- Corners that coincide make contact points jump. One face of each joint reaches beyond
  the other by a `LEDGE`, along the joint and in depth: the contacts are those of the
  smaller face, whose corners are true.
- Bodies sink until they overlap by the slop, so they start with just that overlap.
- Points of contact closer than Bullet's breaking threshold replace each other. It is a
  share of the block's size, which for thin arches is more than the joint's length.
- Friction impulses are forgotten after every step, so that each step is solved from
  nothing. The sweeps this takes hardly depend on the step: long steps, each solved until
  a sweep changes next to nothing.
- Inertias are the true ones. Large ones out of the plane, meant to lock the arch in it,
  keep the solver from converging. Bullet takes notice of an inertia only when a step ends:
  one without gravity comes first.
- A pair's friction is the product of its two shapes' values: each takes sqrt(mu). Bullet
  cuts that product off at 10.

Bullet's x and y are those of the assembly's plane, z is out of it. In that frame the two
directions of friction Bullet chooses at rest lie in the plane and across it.
"""

from __future__ import annotations

import math
import weakref
from importlib.metadata import version
from typing import Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Joint, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import Engine, Library, Quality, Settings
from blocksim.engines.boxes import Frame, footing, plate
from blocksim.engines.faces import faces_of

bullet: Any = Library("pybullet", quiet=True)
UNTURNED = Frame()

MOST_FRICTION = 10.0
"""Bullet's own bound of a pair's friction."""
OVERLAP = 2e-5
"""Overlap of two closed faces, and slop [size]."""
BREAKING = 0.1
"""Distance at which contact points count as one, in units of the shortest joint."""
MOST_BREAKING = 0.02
"""Bullet's own such distance, in units of a block's size."""
STEP = 0.1
SHORT, SHORTEST = 0.1, 1e-3
"""Length of a joint below which errors shrink more slowly, and shortest measured [size]."""
SWEEPS = 100
"""Most sweeps of a step, for each pair of blocks."""
HOLD_SWEEPS = 300
"""Most sweeps of the onset test, for each pair of blocks."""
STILL = 1e-5
NOISE = 1e-6
"""Way of an arch at rest by the last of each step's errors, in hundreds of units of time."""
ACCURACY = 1e-5
"""Error of the accelerations at which a step counts as solved [g]."""
SHARE = 1e-4
"""The same as a share of the velocities, once blocks move fast."""
RELAXATION = 3.0
"""Sweeps in which an error shrinks e-fold, for each pair of blocks (measured)."""
TRAVEL = 5e-3
"""Way of a corner in a step above which the step is divided [size]."""
FINEST = 20
"""Most parts of a step."""


def rule(assembly: Assembly) -> Settings:
    """Choose sweeps that suffice for impulses to cross the assembly.

    What has to cross n blocks and a support takes (n + 1)^2 sweeps; more where joints
    are short, and a small moment at one of them is a large change of its pressures.
    """
    pairs = _pairs(assembly)
    return Settings(
        step=STEP,
        sweeps=round(SWEEPS * pairs),
        hold_sweeps=round(HOLD_SWEEPS * pairs),
        still=STILL,
        noise=NOISE,
    )


def _pairs(assembly: Assembly) -> float:
    """Pairs of bodies, as many more as short joints count for."""
    return (len(assembly.blocks) + 1) ** 2 * max(1.0, SHORT / max(assembly.shortest, SHORTEST))


class Bodies:
    """Bullet's space with one body for each block.

    Parameters
    ----------
    problem : Problem
    settings : Settings
    frame : Frame, optional
        Where in Bullet's frame the assembly lies, turned about the vertical. It should not
        matter, and this is how to see whether it does.
    """

    def __init__(self, problem: Problem, settings: Settings, frame: Frame = UNTURNED) -> None:
        assembly, mu = problem.assembly, problem.mu
        self._assembly, self._settings, self._frame = assembly, settings, frame
        self._pairs = settings.sweeps / SWEEPS
        self._client = bullet.connect(bullet.DIRECT)
        # Bullet keeps at most a thousand spaces open.
        weakref.finalize(self, bullet.disconnect, self._client)
        reach = float(assembly.reach.max()) / assembly.size + float(assembly.depths.max()) / 2
        self._breaking = min(MOST_BREAKING, BREAKING * assembly.shortest / reach)
        self._set(
            numSubSteps=0,
            contactSlop=OVERLAP,
            useSplitImpulse=1,
            splitImpulsePenetrationThreshold=0,
            warmStartingFactor=1,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
        )
        self._friction = math.sqrt(min(mu, MOST_FRICTION))
        self._places = [frame.place(block.centre / assembly.size) for block in assembly.blocks]
        faces = faces_of(assembly)
        self._bodies = [self._block(index, faces[index]) for index in range(len(faces))]
        self._footings: list[int] = []
        for joint in assembly.springings:
            footing = self._footing(joint)
            self._footings.append(footing)
            # A support touches only the block that stands on it.
            for index, body in enumerate(self._bodies):
                if index != joint.bears:
                    bullet.setCollisionFilterPair(
                        footing, body, -1, -1, 0, physicsClientId=self._client
                    )
        bullet.stepSimulation(physicsClientId=self._client)
        bullet.setGravity(
            *frame.vector(*problem.gravity.tolist()),
            physicsClientId=self._client,
        )

    def _set(self, **parameters: float) -> None:
        # All spaces share one breaking threshold: each sets its own before it steps.
        bullet.setPhysicsEngineParameter(
            **parameters,
            contactBreakingThreshold=self._breaking,
            physicsClientId=self._client,
        )

    def _block(self, index: int, faces: list[Joint]) -> int:
        """Create a body that is a thin box on each of its block's faces."""
        block, size = self._assembly.blocks[index], self._assembly.size
        boxes = [plate(block, index, joint, faces, size, OVERLAP) for joint in faces]
        shape = bullet.createCollisionShapeArray(
            shapeTypes=[bullet.GEOM_BOX] * len(boxes),
            halfExtents=[box.half for box in boxes],
            collisionFramePositions=[box.centre for box in boxes],
            collisionFrameOrientations=[box.quaternion for box in boxes],
            physicsClientId=self._client,
        )
        mass, _, inertia, _, *across = self._assembly.spatial_masses[index].tolist()
        body = self._body(mass, shape, self._places[index])
        bullet.changeDynamics(
            body,
            -1,
            mass=mass,
            localInertiaDiagonal=[*across, inertia],
            physicsClientId=self._client,
        )
        return body

    def _footing(self, joint: Joint) -> int:
        """Create a slab under a springing, wider than the joint on all sides."""
        block = self._assembly.blocks[joint.bears]
        box, centre = footing(block, joint, self._assembly.size, OVERLAP)
        shape = bullet.createCollisionShapeArray(
            shapeTypes=[bullet.GEOM_BOX],
            halfExtents=[box.half],
            collisionFramePositions=[[0.0, 0.0, 0.0]],
            collisionFrameOrientations=[box.quaternion],
            physicsClientId=self._client,
        )
        body = self._body(0.0, shape, self._frame.place(centre))
        if joint.friction == 0:
            bullet.changeDynamics(body, -1, lateralFriction=0, physicsClientId=self._client)
        return body

    def _body(self, mass: float, shape: int, place: list[float]) -> int:
        # Without maximal coordinates Bullet forgets all impulses and damps every motion.
        body: int = bullet.createMultiBody(
            mass,
            shape,
            basePosition=place,
            baseOrientation=self._frame.quaternion,
            useMaximalCoordinates=1,
            physicsClientId=self._client,
        )
        bullet.changeDynamics(
            body,
            -1,
            lateralFriction=self._friction,
            linearDamping=0,
            angularDamping=0,
            restitution=0,
            physicsClientId=self._client,
        )
        return body

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back.

        Normal impulses are kept, which helps; those of friction start again.
        """
        step = self._settings.step
        self._set(fixedTimeStep=step, numSolverIterations=sweeps, solverResidualThreshold=0)
        bullet.stepSimulation(physicsClientId=self._client)
        accelerations = self._velocities() / step
        nothing = [0.0, 0.0, 0.0]
        for body, place in zip(self._bodies, self._places, strict=True):
            bullet.resetBasePositionAndOrientation(
                body, place, self._frame.quaternion, physicsClientId=self._client
            )
            bullet.resetBaseVelocity(body, nothing, nothing, physicsClientId=self._client)
        return accelerations

    def advance(self, steps: int) -> None:
        """Let the blocks move, in parts of a step where they move far."""
        for _ in range(steps):
            speed = float(displacement(self._velocities(), self._assembly))
            parts = min(max(1, math.ceil(speed * self._settings.step / TRAVEL)), FINEST)
            step = self._settings.step / parts
            change = max(ACCURACY * step, SHARE * speed) / (RELAXATION * self._pairs)
            self._set(
                fixedTimeStep=step,
                numSolverIterations=self._settings.sweeps,
                solverResidualThreshold=change**2,
            )
            for _ in range(parts):
                bullet.stepSimulation(physicsClientId=self._client)

    def poses(self) -> Array:
        """Return places and rotations, shape (blocks, 6)."""
        read = [
            bullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
            for body in self._bodies
        ]
        places, quaternions = zip(*read, strict=True)
        return self._frame.poses(np.array(places), np.array(quaternions))

    def resultants(self) -> Array:
        """Add up the forces of contacts in the plane."""
        footings = iter(self._footings)
        joints = {
            tuple(
                next(footings) if side == SUPPORT else self._bodies[side]
                for side in (joint.before, joint.after)
            ): index
            for index, joint in enumerate(self._assembly.joints)
        }
        found = np.zeros((len(joints), 3))
        # Asked for one pair, Bullet may turn the normal round, and not the friction.
        for contact in bullet.getContactPoints(physicsClientId=self._client):
            sides = contact[1:3]
            push, friction, along, across, beyond = contact[9:14]
            force = push * np.array(contact[7]) + friction * np.array(along)
            force += across * np.array(beyond)
            # The boxes overlap: the joint is midway.
            place = (np.array(contact[5]) + contact[6]) / 2
            wrench = self._frame.wrench(place, force)
            # It acts on the first body.
            if sides in joints:
                found[joints[sides]] -= wrench
            else:
                found[joints[sides[::-1]]] += wrench
        return found

    def quality(self) -> Quality:
        """Bullet does not tell."""
        return Quality()

    def _velocities(self) -> Array:
        read = [
            bullet.getBaseVelocity(body, physicsClientId=self._client) for body in self._bodies
        ]
        linear, angular = zip(*read, strict=True)
        return self._frame.motions(np.array(linear), np.array(angular))


ENGINE = Engine(
    name="pybullet",
    sees="motion in space: the same, and out of the plane",
    library="pybullet",
    remedy="pip install pybullet with Python 3.11 or older, for which it has wheels",
    version_of=lambda: version("pybullet"),
    rule=rule,
    build=Bodies,
    adjustable=("step", "sweeps", "hold_sweeps", "still", "rest"),
    finest=1e-3,
    is_spatial=True,
    most_friction=MOST_FRICTION,
    tells_forces=True,
    contacts=4,
    usual_sweeps=10,
    chart={
        "tolerance": (1e-2, 1e-3),
        "step": (1 / 15, 1 / 60, 1 / 240, 1 / 960),
        "sweeps": (10, 40, 160, 640, 2560),
        "hold_sweeps": (1e3, 3e3, 1e4, 3e4, 1e5),
        "voussoirs": (7, 13, 27),
    },
    colour="#009E73",
    tint="#cdebe2",
    marker="^",
)
