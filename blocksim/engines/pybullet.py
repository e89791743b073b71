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
- Once blocks may meet others (`solids`) all are built anew, as hulls that know their faces,
  with what they stand on and a floor. A space that is reset forgets who may not touch whom;
  bodies removed one by one leave that to those that take their numbers.
- Inertias are the true ones. Large ones out of the plane, meant to lock the arch in it,
  keep the solver from converging. Bullet takes notice of an inertia only when a step ends:
  one without gravity comes first.
- A pair's friction is the product of its two shapes' values: each takes sqrt(mu). Bullet
  cuts that product off at 10.

Bullet's x and y are those of the assembly's plane, z is out of it. In that frame the two
directions of friction Bullet chooses at rest lie in the plane and across it.
"""

from __future__ import annotations

import itertools
import math
import weakref
from collections import defaultdict
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import Engine, Library, Quality, Settings
from blocksim.engines.boxes import Box, Frame, plate, snug, support_of
from blocksim.engines.energy import Balance
from blocksim.engines.solids import Solids, prisms

bullet: Any = Library("pybullet", quiet=True)
UNTURNED = Frame()

MOST_FRICTION = 10.0
"""Bullet's own bound of a pair's friction."""
OVERLAP = 2e-5
"""Overlap of two closed faces, and slop [size]."""
DEEPEST = 3e-5
"""Overlap of blocks as built from which they are not trusted, drawn into each other [size]."""
BREAKING = 0.1
"""Distance at which contact points count as one, in units of the shortest joint."""
MOST_BREAKING = 0.02
"""Bullet's own such distance, in units of a block's size."""
STEP = 0.1
SHORT, SHORTEST = 0.1, 1e-3
"""Length of a joint below which errors shrink more slowly, and shortest measured [size]."""
SWEEPS = 100
"""Most sweeps of a step, for each pair of blocks."""
HOLD_SWEEPS = 600
"""Most sweeps of the onset test, for each pair of blocks."""
LEAST_HOLD = 300_000
"""The same at least: friction begins from nothing each time."""
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
LONGEST_TUMBLE, MOST_PARTS = 0.005, 400
"""Longest part of a step, and most of them, once blocks may meet."""
TUMBLE_SWEEPS = 100
KNOW_FACES = 4096
"""Bullet's flag by which hulls meet by their faces, with all points of contact at once and
without the margin that else rounds their corners; pybullet gives it no name."""


def rule(assembly: Assembly) -> Settings:
    """Choose sweeps that suffice for impulses to cross the assembly.

    What has to cross n blocks and a support takes (n + 1)^2 sweeps; more where joints
    are short, and a small moment at one of them is a large change of its pressures.
    """
    pairs = _pairs(assembly)
    return Settings(
        step=STEP,
        sweeps=round(SWEEPS * pairs),
        hold_sweeps=max(LEAST_HOLD, round(HOLD_SWEEPS * pairs)),
        still=STILL,
        noise=NOISE,
        penetration=DEEPEST,
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
        assembly = problem.assembly
        self._problem = problem
        self._assembly, self._settings, self._frame = assembly, settings, frame
        self._pairs = settings.sweeps / SWEEPS
        self._client = bullet.connect(bullet.DIRECT)
        # Bullet keeps at most a thousand spaces open.
        weakref.finalize(self, bullet.disconnect, self._client)
        reach = float(assembly.reach.max()) / assembly.size + float(assembly.depths.max()) / 2
        self._breaking = min(MOST_BREAKING, BREAKING * assembly.shortest / reach)
        self._begin()
        self._loaded = problem.is_loaded
        self._places = [frame.place(block.centre / assembly.size) for block in assembly.blocks]
        self._sides: dict[tuple[int, int], list[int]] = defaultdict(list)
        self._is_rubble = False
        self._bodies = self._build()
        bullet.stepSimulation(physicsClientId=self._client)
        self._deepest = self._overlap()
        self._pull()
        self._balance = Balance(problem, self.poses())

    def _begin(self) -> None:
        """Set what holds for all steps."""
        self._set(
            numSubSteps=0,
            contactSlop=OVERLAP,
            useSplitImpulse=1,
            splitImpulsePenetrationThreshold=0,
            warmStartingFactor=1,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
        )

    def _pull(self) -> None:
        """Let gravity act."""
        gravity = self._frame.vector(*self._problem.gravity.tolist())
        bullet.setGravity(*gravity, physicsClientId=self._client)

    def _set(self, **parameters: float) -> None:
        # All spaces share one breaking threshold: each sets its own before it steps.
        bullet.setPhysicsEngineParameter(
            **parameters,
            contactBreakingThreshold=self._breaking,
            physicsClientId=self._client,
        )

    def _build(self) -> list[int]:
        """Create a body for each block, and one for each joint with the support."""
        assembly, problem = self._assembly, self._problem
        plates, centres = snug(assembly), assembly.centres / assembly.size
        friction = math.sqrt(min(problem.mu, MOST_FRICTION))
        bodies: dict[int, int] = {}
        for index, place in enumerate(self._places):
            boxes = [
                plate(side, deep, centres[index], OVERLAP, thickness)
                for side, thickness, deep in plates[index]
            ]
            bodies[index] = self._body(boxes, place, friction, index)
        for index, joint in enumerate(assembly.joints):
            pair = [joint.before, joint.after]
            if SUPPORT in pair:
                name = support_of(index)
                ((side, thickness, deep),) = plates[name]
                middle = side.ends.mean(axis=0)
                box = plate(side, deep, middle, OVERLAP, thickness)
                place, mu = self._frame.place(middle), self._friction_of_support(index)
                bodies[name] = self._body([box], place, mu)
                pair[pair.index(SUPPORT)] = name
            one, other = (bodies[name] for name in pair)
            self._sides[one, other].append(index)
        self._keep_apart(list(bodies.values()))
        return [bodies[index] for index in range(len(assembly.blocks))]

    def _keep_apart(self, bodies: list[int]) -> None:
        """Let nothing touch but what shares a joint."""
        touching = {frozenset(pair) for pair in self._sides}
        for pair in itertools.combinations(bodies, 2):
            if frozenset(pair) not in touching:
                bullet.setCollisionFilterPair(*pair, -1, -1, 0, physicsClientId=self._client)

    def _friction_of_support(self, joint: int) -> float:
        """Return what with the friction of blocks makes that of a joint with the support."""
        own = min(float(self._problem.friction[joint]), MOST_FRICTION)
        mu = min(self._problem.mu, MOST_FRICTION)
        return own / math.sqrt(mu) if mu > 0 else 0.0

    def _body(
        self, boxes: list[Box], place: list[float], friction: float, index: int | None = None
    ) -> int:
        """Create a body of boxes; that of no block stays where it is."""
        shape = bullet.createCollisionShapeArray(
            shapeTypes=[bullet.GEOM_BOX] * len(boxes),
            halfExtents=[box.half for box in boxes],
            collisionFramePositions=[box.centre for box in boxes],
            collisionFrameOrientations=[box.quaternion for box in boxes],
            physicsClientId=self._client,
        )
        return self._add(shape, place, friction, index)

    def _add(
        self, shape: int, place: list[float], friction: float, index: int | None = None
    ) -> int:
        """Create a body of a shape; that of a block has its masses and moments of inertia."""
        masses = None if index is None else self._assembly.spatial_masses[index]
        # Without maximal coordinates Bullet forgets all impulses and damps every motion.
        body: int = bullet.createMultiBody(
            0.0 if masses is None else float(masses[0]),
            shape,
            basePosition=place,
            baseOrientation=self._frame.quaternion,
            useMaximalCoordinates=1,
            physicsClientId=self._client,
        )
        bullet.changeDynamics(
            body,
            -1,
            lateralFriction=friction,
            linearDamping=0,
            angularDamping=0,
            restitution=0,
            physicsClientId=self._client,
        )
        if masses is not None:
            mass, _, inertia, _, *across = masses.tolist()
            bullet.changeDynamics(
                body,
                -1,
                mass=mass,
                localInertiaDiagonal=[*across, inertia],
                physicsClientId=self._client,
            )
        return body

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back.

        Normal impulses are kept, which helps; those of friction start again.
        """
        step = self._settings.step
        self._set(fixedTimeStep=step, numSolverIterations=sweeps, solverResidualThreshold=0)
        self._step()
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
            if not self._is_rubble:
                self._solids.update(self.poses())
                if self._solids.loose:
                    self._make_solid()
            if self._is_rubble:
                self._tumble(speed)
                continue
            parts = min(max(1, math.ceil(speed * self._settings.step / TRAVEL)), FINEST)
            step = self._settings.step / parts
            change = max(ACCURACY * step, SHARE * speed) / (RELAXATION * self._pairs)
            self._set(
                fixedTimeStep=step,
                numSolverIterations=self._settings.sweeps,
                solverResidualThreshold=change**2,
            )
            for _ in range(parts):
                self._step()

    @cached_property
    def _solids(self) -> Solids:
        return Solids(self._assembly)

    def _make_solid(self) -> None:
        """Make blocks the bodies they are, with what they stand on and the floor."""
        self._is_rubble = True
        states = [
            (
                bullet.getBasePositionAndOrientation(body, physicsClientId=self._client),
                bullet.getBaseVelocity(body, physicsClientId=self._client),
            )
            for body in self._bodies
        ]
        # Bodies removed would leave to others, by their numbers, what they may not touch.
        bullet.resetSimulation(physicsClientId=self._client)
        self._begin()
        self._pull()
        self._sides.clear()
        assembly, friction = self._assembly, math.sqrt(min(self._problem.mu, MOST_FRICTION))
        polygons: dict[int, list[Array]] = defaultdict(list)
        for index, polygon in self._solids.moving:
            polygons[index].append(polygon)
        with TemporaryDirectory() as folder:
            for index, ((place, turn), (shift, spin)) in enumerate(states):
                shape = self._prism(folder, polygons[index], float(assembly.depths[index]))
                body = self._add(shape, list(place), friction, index)
                bullet.resetBasePositionAndOrientation(
                    body, place, turn, physicsClientId=self._client
                )
                bullet.resetBaseVelocity(body, shift, spin, physicsClientId=self._client)
                self._bodies[index] = body
            # As deep as it is drawn.
            deep = float(assembly.depths.max())
            for polygon in self._solids.fixed:
                middle = polygon.mean(axis=0)
                shape = self._prism(folder, [polygon - middle], deep)
                self._add(shape, self._frame.place(middle), friction)
        floor = bullet.createCollisionShape(
            bullet.GEOM_PLANE, planeNormal=[0.0, 1.0, 0.0], physicsClientId=self._client
        )
        self._add(floor, self._frame.place(np.array([0.0, self._solids.level])), friction)

    def _prism(self, folder: str, polygons: list[Array], depth: float) -> int:
        """Return the shape of a block: of hulls only those from files know their faces."""
        path = Path(folder) / "block.obj"
        path.write_text(prisms(polygons, depth), encoding="ascii")
        shape: int = bullet.createCollisionShape(
            bullet.GEOM_MESH,
            fileName=str(path),
            flags=KNOW_FACES,
            physicsClientId=self._client,
        )
        return shape

    def _tumble(self, speed: float) -> None:
        """Take a step of blocks that meet."""
        way = self._settings.step * (speed + self._settings.step)
        finest = self._settings.step / LONGEST_TUMBLE
        parts = min(math.ceil(max(way / self._solids.largest, finest)), MOST_PARTS)
        self._set(
            fixedTimeStep=self._settings.step / parts,
            numSolverIterations=TUMBLE_SWEEPS,
            solverResidualThreshold=0,
            # Impulses of an impact, taken for those of rest, would throw blocks.
            warmStartingFactor=0,
        )
        for _ in range(parts - 1):
            self._step()
        poses, before = self.poses(), self._velocities()
        self._step()
        self._balance.look(poses, before, self._velocities())
        self._deepest = max(self._deepest, self._overlap())

    def _overlap(self) -> float:
        """Return the deepest overlap of any two bodies."""
        contacts = bullet.getContactPoints(physicsClientId=self._client)
        return max((-contact[8] for contact in contacts), default=0.0)

    def _step(self) -> None:
        """Take a step under gravity and loads, which Bullet forgets after each."""
        if self._loaded:
            loads = self._problem.loads(self.poses()[:, :PLANAR])
            for body, (x, y, moment) in zip(self._bodies, loads.tolist(), strict=True):
                place, _ = bullet.getBasePositionAndOrientation(
                    body, physicsClientId=self._client
                )
                bullet.applyExternalForce(
                    body,
                    -1,
                    self._frame.vector(x, y, 0.0),
                    place,
                    bullet.WORLD_FRAME,
                    physicsClientId=self._client,
                )
                bullet.applyExternalTorque(
                    body,
                    -1,
                    self._frame.vector(0.0, 0.0, moment),
                    bullet.WORLD_FRAME,
                    physicsClientId=self._client,
                )
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
        found = np.zeros((len(self._assembly.joints), 3))
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
            forth = sides in self._sides
            joints = self._sides[sides if forth else sides[::-1]]
            found[self._nearest(joints, place)] += -wrench if forth else wrench
        return found

    def _nearest(self, joints: list[int], place: Array) -> int:
        """Tell which joint of two blocks a contact belongs to."""
        if len(joints) == 1:
            return joints[0]
        ends = self._assembly.joint_arrays.ends[joints]
        off = np.moveaxis(ends - self._frame.point(place), -1, 0)
        return joints[int(np.hypot(*off).min(axis=1).argmin())]

    def quality(self) -> Quality:
        """Tell how deep blocks have overlapped, as built and once they meet others."""
        gain = self._balance.gain if self._is_rubble else None
        return Quality(penetration=self._deepest, gain=gain)

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
    has_joint_friction=False,
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
