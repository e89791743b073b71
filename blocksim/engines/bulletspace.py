"""One of Bullet's spaces, through pybullet: bodies, who meets whom, steps, contacts.

- A pair's friction is the product of its two shapes' values: each takes sqrt(mu). Bullet
  cuts that product off at 10.
- Bullet takes notice of an inertia only when a step ends: after bodies are created, one
  without gravity comes first.
- A space that is reset forgets who may not touch whom; bodies removed one by one leave that
  to those that take their numbers.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.base import Library
from blocksim.engines.boxes import Box, Frame
from blocksim.engines.bulletfriction import Rectangles

bullet: Any = Library("pybullet", quiet=True)

MOST_FRICTION = 10.0
"""Bullet's own bound of a pair's friction."""
SLOP = 1e-6
"""Overlap of two bodies down to which Bullet lets them sink [size]."""
KNOW_FACES = 4096
"""Bullet's flag by which hulls meet by their faces, with all points of contact at once and
without the margin that else rounds their corners; pybullet gives it no name."""
ABOVE_PLANE = 1e-3
"""How far above a plane Bullet keeps hulls: the margin that pybullet gives them."""
OFF = 1e-4
"""By what share of a hull's extent its corners may be off, at most: Bullet rounds them to
1 / 10216 of it."""
NOTHING = (0.0, 0.0, 0.0)


def friction_share(mu: float) -> float:
    """Return what two sides have of a friction, each: a pair's is their product."""
    return math.sqrt(min(float(mu), MOST_FRICTION))


class Contact(NamedTuple):
    """A point of contact in Bullet's frame.

    `pair`, (int, int, int, int): Two bodies, and the link of each.
    `place`, `force`, (3,): The force acts on the first body.
    """

    pair: tuple[int, int, int, int]
    place: Array
    force: Array


class State(NamedTuple):
    """Place, quaternion, velocity and spin of a body in Bullet's frame."""

    place: Sequence[float]
    turn: Sequence[float]
    shift: Sequence[float] = NOTHING
    spin: Sequence[float] = NOTHING


class _Client:
    """Bullet's functions, told in which space to act."""

    def __init__(self) -> None:
        self._number = bullet.connect(bullet.DIRECT)
        # Bullet keeps at most a thousand spaces open.
        weakref.finalize(self, bullet.disconnect, self._number)

    def __getattr__(self, name: str) -> Any:
        return partial(getattr(bullet, name), physicsClientId=self._number)


class Space:
    """One of Bullet's spaces. Bodies and their links are known by their numbers.

    A body has its share of a friction (`friction_share`). Its masses are its mass and its
    moments of inertia about x, y and z; one without them stays where it is.

    `frame`: How motions of bodies are written.
    `breaking`: Breaking threshold: points of contact closer than that replace each other.
    """

    def __init__(self, frame: Frame, breaking: float) -> None:
        self.frame, self._client = frame, _Client()
        self.rectangles = Rectangles(self._client)
        self._begin(breaking)

    def _begin(self, breaking: float) -> None:
        """Set what holds for all steps."""
        self._breaking = breaking
        self._set(
            numSubSteps=0,
            contactSlop=SLOP,
            useSplitImpulse=1,
            splitImpulsePenetrationThreshold=0,
            warmStartingFactor=1,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
        )
        self.rectangles.forget()

    def _set(self, **parameters: float) -> None:
        # All spaces share one breaking threshold: each sets its own before it steps.
        self._client.setPhysicsEngineParameter(
            **parameters, contactBreakingThreshold=self._breaking
        )

    def clear(self, breaking: float | None = None) -> None:
        """Remove all bodies and gravity; take another breaking threshold if one is given."""
        self._client.resetSimulation()
        self._begin(self._breaking if breaking is None else breaking)

    def solve_by(
        self, step: float, sweeps: int, *, change: float = 0.0, warm: float = 1.0
    ) -> None:
        """Set how steps are solved.

        `step`: Time step.
        `sweeps`: Most sweeps.
        `change`: Change of a velocity in a sweep at which no more are made.
        `warm`: Share of their impulses with which contacts begin a step.
        """
        self._set(
            fixedTimeStep=step,
            numSolverIterations=sweeps,
            solverResidualThreshold=change**2,
            warmStartingFactor=warm,
        )

    def pull(self, gravity: Array) -> None:
        """Let gravity act, (3,)."""
        self._client.setGravity(*gravity.tolist())

    def push(self, body: int, load: Array) -> None:
        """Load a body in the next step, in columns of poses; Bullet forgets it after."""
        place, _ = self._client.getBasePositionAndOrientation(body)
        force, torque = self.frame.told(load)
        self._client.applyExternalForce(body, -1, force, place, bullet.WORLD_FRAME)
        self._client.applyExternalTorque(body, -1, torque, bullet.WORLD_FRAME)

    def step(self) -> None:
        """Take a step."""
        self._client.stepSimulation()

    def linked(
        self,
        boxes: Sequence[Box],
        shares: Sequence[float],
        built: State,
        masses: list[float] | None,
    ) -> int:
        """Create a body with a link for each box, of its share of a friction.

        The links touch nothing yet; see `meet`.
        """
        shapes = [
            self._client.createCollisionShape(bullet.GEOM_BOX, halfExtents=box.half)
            for box in boxes
        ]
        count = len(boxes)
        body: int = self._client.createMultiBody(
            masses[0] if masses else 0.0,
            basePosition=built.place,
            baseOrientation=built.turn,
            linkMasses=[0.0] * count,
            linkCollisionShapeIndices=shapes,
            linkVisualShapeIndices=[-1] * count,
            linkPositions=[box.centre for box in boxes],
            linkOrientations=[box.quaternion for box in boxes],
            linkInertialFramePositions=[NOTHING] * count,
            linkInertialFrameOrientations=[[0.0, 0.0, 0.0, 1.0]] * count,
            linkParentIndices=[0] * count,
            linkJointTypes=[bullet.JOINT_FIXED] * count,
            linkJointAxis=[[0.0, 0.0, 1.0]] * count,
        )
        self._weigh(body, masses)
        for link, share in enumerate(shares):
            self._avoid(body, link)
            self._rub(body, share, link)
        return body

    def layered(
        self,
        boxes: Sequence[Box],
        share: float,
        built: State,
        masses: list[float] | None,
    ) -> int:
        """Create a body of boxes, all with the same share of a friction.

        It touches nothing yet; see `meet`.
        """
        shape: int = self._client.createCollisionShapeArray(
            shapeTypes=[bullet.GEOM_BOX] * len(boxes),
            halfExtents=[box.half for box in boxes],
            collisionFramePositions=[box.centre for box in boxes],
            collisionFrameOrientations=[box.quaternion for box in boxes],
        )
        body = self._solid(shape, share, built, masses)
        self._avoid(body, -1)
        return body

    def hulls(
        self, text: str, share: float, built: State, masses: list[float] | None = None
    ) -> int:
        """Create a body of convex hulls from the text of an .obj file, and its friction share.

        Of hulls only those from files know their faces.
        """
        with TemporaryDirectory() as folder:
            path = Path(folder) / "block.obj"
            path.write_text(text, encoding="ascii")
            shape: int = self._client.createCollisionShape(
                bullet.GEOM_MESH, fileName=str(path), flags=KNOW_FACES
            )
            # The body's creation reads the file once more.
            return self._solid(shape, share, built, masses)

    def floor(self, share: float, built: State, upwards: list[float]) -> int:
        """Create a level floor through a place, with its share of a friction."""
        shape: int = self._client.createCollisionShape(bullet.GEOM_PLANE, planeNormal=upwards)
        low = np.array(built.place) - ABOVE_PLANE * np.array(upwards)
        return self._solid(shape, share, built._replace(place=low.tolist()), None)

    def _solid(self, shape: int, share: float, built: State, masses: list[float] | None) -> int:
        # Without maximal coordinates Bullet would push blocks that overlap apart.
        body: int = self._client.createMultiBody(
            masses[0] if masses else 0.0,
            shape,
            basePosition=built.place,
            baseOrientation=built.turn,
            useMaximalCoordinates=1,
        )
        self._rub(body, share)
        self._weigh(body, masses)
        return body

    def _weigh(self, body: int, masses: list[float] | None) -> None:
        """Give a body its masses, and no damping."""
        self._client.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
        if masses:
            mass, *inertia = masses
            self._client.changeDynamics(body, -1, mass=mass, localInertiaDiagonal=inertia)

    def _rub(self, body: int, share: float, link: int = -1) -> None:
        """Give a body, or a link of it, its share of a friction, and no rebound."""
        self._client.changeDynamics(body, link, lateralFriction=share, restitution=0)

    def soften(self, body: int, link: int, stiffness: float) -> None:
        """Make contacts of a link springs; a pair's stiffness is half of either's."""
        self._client.changeDynamics(body, link, contactStiffness=stiffness, contactDamping=0)

    def _avoid(self, body: int, link: int) -> None:
        """Let a link touch nothing."""
        self._client.setCollisionFilterGroupMask(body, link, 0, 0)

    def meet(self, one: int, other: int, first: int, second: int) -> None:
        """Let links of two bodies touch each other."""
        self._client.setCollisionFilterPair(one, other, first, second, 1)

    def state(self, body: int) -> State:
        """Return how a body lies and moves."""
        return State(
            *self._client.getBasePositionAndOrientation(body),
            *self._client.getBaseVelocity(body),
        )

    def put(self, body: int, state: State) -> None:
        """Let a body lie and move so."""
        self._client.resetBasePositionAndOrientation(body, state.place, state.turn)
        self._client.resetBaseVelocity(body, state.shift, state.spin)

    def stop(self, body: int) -> None:
        """Let a body rest where it is."""
        self._client.resetBaseVelocity(body, NOTHING, NOTHING)

    def hasten(self, body: int, velocity: Array) -> None:
        """Let a body go on with a velocity, in the columns of `poses`."""
        shift, spin = self.frame.told(velocity)
        self._client.resetBaseVelocity(body, shift, spin)

    def poses(self, bodies: Sequence[int]) -> Array:
        """Return places and rotations, (bodies, 3) in the plane, (bodies, 6) in space."""
        read = [self._client.getBasePositionAndOrientation(body) for body in bodies]
        places, quaternions = zip(*read, strict=True)
        return self.frame.poses(np.array(places), np.array(quaternions))

    def velocities(self, bodies: Sequence[int]) -> Array:
        """Return velocities in the columns of `poses`."""
        read = [self._client.getBaseVelocity(body) for body in bodies]
        linear, angular = zip(*read, strict=True)
        return self.frame.motions(np.array(linear), np.array(angular))

    def contacts(self) -> Iterator[Contact]:
        """Go through the points of contact of the last step."""
        # Asked for one pair, Bullet may turn the normal round, and not the friction.
        for contact in self._client.getContactPoints():
            push, friction, along, across, beyond = contact[9:14]
            force = push * np.array(contact[7]) + friction * np.array(along)
            force += across * np.array(beyond)
            # Bodies overlap: they meet midway.
            yield Contact(contact[1:5], (np.array(contact[5]) + contact[6]) / 2, force)

    def find_contacts(self) -> None:
        """Find contacts without a step."""
        self._client.performCollisionDetection()

    def overlap(self) -> float:
        """Return the deepest overlap of any two bodies."""
        contacts = self._client.getContactPoints()
        return max((-contact[8] for contact in contacts), default=0.0)
