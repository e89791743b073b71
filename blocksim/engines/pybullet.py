"""Bullet through pybullet: three dimensions, off-screen, sequential impulses, Coulomb friction.

How a near-critical arch has to be put into it (each point measured, see
`analysis/pybullet_settings.py`):

- Hulls are unfit: they get one contact point a step, or rounded corners. A block has a
  thin box on each side of a joint, which Bullet collides exactly.
- Each box is a link of its block, fixed to it. So the two boxes of a joint touch each other
  and nothing else, and have the joint's friction. Bullet bounds friction of such bodies anew
  in each sweep; that of bodies without links it leaves where pressure is lost.
- Corners that coincide make contact points jump. One face of each joint reaches beyond
  the other by a `LEDGE`, along the joint and in depth: the contacts are those of the
  smaller face, whose corners are true.
- Bodies sink until they overlap by the slop, so they start with just that overlap.
- Points of contact closer than Bullet's breaking threshold replace each other. It is a
  share of a box's size.
- Impulses are forgotten after every step, so that each step is solved from nothing. The
  sweeps this takes hardly depend on the step: long steps, each solved until a sweep changes
  next to nothing.
- Where gravity lies in the plane so does all motion, by symmetry. Sweeps break it, though:
  of two contacts across the plane the first takes more, and walls rock out of the plane
  for as long as they are solved. There inertias out of the plane are beyond reach (`LOCK`),
  and a joint is so narrow that Bullet makes one contact of two. A lock a million times
  softer is no lock: it leaves 3e-5 g that no sweeps remove.
- Once blocks may meet others (`solids`) all are built anew, as hulls that know their faces,
  with what they stand on and a floor. A space that is reset forgets who may not touch whom;
  bodies removed one by one leave that to those that take their numbers.
- Where gravity leans out of the plane inertias are the true ones. Bullet takes notice of an
  inertia only when a step ends: one without gravity comes first.
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
from dataclasses import replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import Engine, Library, Quality, Settings
from blocksim.engines.boxes import EDGE, Box, Frame, edge, plate
from blocksim.engines.energy import Balance
from blocksim.engines.faces import LEDGE, LEDGE_SHARE, Side, sides_of
from blocksim.engines.solids import Solids, prisms

bullet: Any = Library("pybullet", quiet=True)
UNTURNED = Frame()

MOST_FRICTION = 10.0
"""Bullet's own bound of a pair's friction."""
OVERLAP = 1e-6
"""Overlap of two closed faces, and slop [size]."""
DEEPEST = 1.5e-6
"""Overlap of blocks as built from which they are not trusted [size]."""
LOCK = 1e12
"""Inertias out of the plane where gravity lies in it [mean mass, size squared]."""
NARROW, MERGED = 0.04, 0.1
"""Depth of a joint there, in units of its length, and Bullet's breaking threshold, in units
of half a box's diagonal: contacts across the plane are one, those along it are two."""
PRESSED, SOFT = 1e-7, 10.0
"""How far the joint with most pressure reaches into itself where pressures are given [size],
and stiffness of joints times the square of the step in which they are solved [mean mass]."""
SETTLED = 1e-3
"""Acceleration from which on blocks that are pressed stay where they have given way to [g]."""
TIE = 1e-11
"""Angle between the boxes of a joint: Bullet takes the normal of the longer one, always."""
BREAKING = 0.1
"""Distance at which contact points count as one else, in units of the shortest joint."""
MOST_BREAKING = 0.02
"""Bullet's own such distance, in units of a block's size."""
STEP = 0.1
SHORT, SHORTEST = 0.1, 1e-3
"""Length of a joint below which errors shrink more slowly, and shortest measured [size]."""
SWEEPS = 100
"""Most sweeps of a step, for each pair of blocks."""
HOLD_SWEEPS = 600
"""Most sweeps of the onset test, for each pair of blocks."""
LEAST_HOLD = 600_000
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


def _share(mu: float) -> float:
    """Return what two sides have of a friction, each: a pair's is their product."""
    return math.sqrt(min(float(mu), MOST_FRICTION))


def _layers(assembly: Assembly) -> Array:
    """Return where across the plane joints are, so that no two of a block meet, (joints,)."""
    taken: dict[int, set[int]] = defaultdict(set)
    layers = np.zeros(len(assembly.joints))
    for index, joint in enumerate(assembly.joints):
        its = [taken[body] for body in (joint.before, joint.after) if body != SUPPORT]
        layer = next(k for k in itertools.count() if not any(k in each for each in its))
        for each in its:
            each.add(layer)
        layers[index] = layer
    return layers * 2 * NARROW * max(assembly.joint_arrays.length.max(), EDGE)


def _breaking(assembly: Assembly, across: float = 0.0) -> float:
    """Return a breaking threshold that the shortest joint is longer than."""
    reach = float(assembly.reach.max()) / assembly.size + across
    reach += float(assembly.depths.max()) / 2
    return min(MOST_BREAKING, BREAKING * assembly.shortest / reach)


def _pressed(sides: tuple[Side, Side], ends: Array, ways: Array) -> tuple[Side, Side]:
    """Let the shorter side of a joint reach into the other, by a way at each end.

    The other is the one Bullet takes the normal from.
    """
    shorter = int(sides[1].length < sides[0].length)
    side, along = sides[shorter], ends[1] - ends[0]
    shares = (side.ends - ends[0]) @ along / (along @ along) if along.any() else np.zeros(2)
    reach = ways[0] + shares * (ways[1] - ways[0])
    moved = replace(side, ends=side.ends - np.outer(reach, side.inward))
    return (sides[0], moved) if shorter else (moved, sides[1])


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
        self._breaking = MERGED if problem.is_planar else _breaking(assembly)
        self._begin()
        self._loaded = problem.is_loaded
        self._places = [frame.place(block.centre / assembly.size) for block in assembly.blocks]
        self._joints: dict[tuple[int, ...], list[tuple[int, float]]] = defaultdict(list)
        self._is_free = self._is_rubble = False
        self._short, self._held = settings.step, 0
        self._bodies = self._build()
        bullet.performCollisionDetection(physicsClientId=self._client)
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

    def _build(self, pressures: Array | None = None) -> list[int]:
        """Create a body for each block, and one for the support; see `begin`."""
        boxes, bodies = self._boxes(pressures), list[int]()
        ends: dict[int, list[tuple[int, int, float]]] = defaultdict(list)
        for index in [*range(len(self._places)), SUPPORT]:
            body = self._jointed([box for *_, box in boxes[index]], index)
            for link, (joint, sense, _) in enumerate(boxes[index]):
                self._rub(body, _share(self._problem.friction[joint]), link)
                ends[joint].append((body, link, sense))
            bodies.append(body)
        self._meet(ends)
        return bodies[:-1]

    def _boxes(self, pressures: Array | None = None) -> dict[int, list[tuple[int, float, Box]]]:
        """Return what touches on each body: a joint, 1 if on `after` and else -1, a box."""
        boxes: dict[int, list[tuple[int, float, Box]]] = defaultdict(list)
        size, ends = self._assembly.size, self._assembly.joint_arrays.ends
        for joint, sides in enumerate(sides_of(self._assembly)):
            deep = self._depths(sides)
            pair = (
                sides if pressures is None else _pressed(sides, ends[joint], pressures[joint])
            )
            for side, depth, sense in zip(pair, deep, (-1.0, 1.0), strict=True):
                at_rest = side.body == SUPPORT
                origin = np.zeros(2) if at_rest else self._assembly.centres[side.body] / size
                box = (edge if side.is_corner else plate)(side, depth, origin, OVERLAP)
                turned = box.turned(math.pi + TIE * (sense > 0))
                boxes[side.body].append((joint, sense, turned))
        return boxes

    def _meet(self, ends: dict[int, list[tuple[int, int, float]]]) -> None:
        """Let the two sides of each joint touch each other, by body and link."""
        for joint, ((one, first, sense), (other, second, against)) in ends.items():
            self._joints[one, other, first, second].append((joint, sense))
            self._joints[other, one, second, first].append((joint, against))
            bullet.setCollisionFilterPair(
                one, other, first, second, 1, physicsClientId=self._client
            )

    def _let_go(self) -> None:
        """Build anew for motion, of bodies without links: Bullet keeps their pressures.

        Such a body has one friction, and its boxes cannot be told whom to touch. So they lie
        in layers: in the plane it does not matter where across it a joint is.
        """
        assembly, problem = self._assembly, self._problem
        self._is_free = True
        joints, mu = assembly.joint_arrays, _share(problem.mu)
        between = (joints.before != SUPPORT) & (joints.after != SUPPORT)
        if not problem.is_planar or (problem.friction[between] != problem.mu).any() or not mu:
            return
        bullet.resetSimulation(physicsClientId=self._client)
        self._joints.clear()
        layers = _layers(assembly)
        self._breaking = _breaking(assembly, layers.max())
        self._begin()
        boxes, bodies = self._boxes(), list[int]()
        ends: dict[int, list[tuple[int, int, float]]] = defaultdict(list)
        blocks = [(index, boxes[index]) for index in range(len(self._places))]
        for index, its in [*blocks, *((SUPPORT, [each]) for each in boxes[SUPPORT])]:
            shape = bullet.createCollisionShapeArray(
                shapeTypes=[bullet.GEOM_BOX] * len(its),
                halfExtents=[box.half for *_, box in its],
                collisionFramePositions=[
                    [*box.centre[:2], float(layers[joint])] for joint, _, box in its
                ],
                collisionFrameOrientations=[box.quaternion for *_, box in its],
                physicsClientId=self._client,
            )
            body = self._solid(shape, self._place(index), index)
            for joint, sense, _ in its:
                ends[joint].append((body, -1, sense))
                if index == SUPPORT:
                    self._rub(body, _share(problem.friction[joint]) ** 2 / mu)
            bullet.setCollisionFilterGroupMask(body, -1, 0, 0, physicsClientId=self._client)
            bodies.append(body)
        self._meet(ends)
        self._bodies = bodies[: len(self._places)]
        bullet.stepSimulation(physicsClientId=self._client)
        self._pull()
        self._short, sweeps, self._held = self._settings.step, self._held, 0
        self.hold(sweeps)

    def _place(self, index: int) -> list[float]:
        """Return where a body is built."""
        return self._frame.place(np.zeros(2)) if index == SUPPORT else self._places[index]

    def _depths(self, sides: tuple[Side, Side]) -> tuple[float, float]:
        """Tell how deep both boxes of a joint are, of which the longer is deeper, too."""
        lengths = [side.length for side in sides]
        if self._problem.is_planar:
            depth = NARROW * (min(lengths) or EDGE)
            more = depth * LEDGE_SHARE
        else:
            depths = self._assembly.depths
            depth = min(float(depths[each.body]) for each in sides if each.body != SUPPORT)
            more = 2 * LEDGE
        return (depth, depth + more) if lengths[1] > lengths[0] else (depth + more, depth)

    def _jointed(self, boxes: list[Box], index: int) -> int:
        """Create a body with a link for each of its boxes, which touch nothing yet."""
        shapes = [
            bullet.createCollisionShape(
                bullet.GEOM_BOX, halfExtents=box.half, physicsClientId=self._client
            )
            for box in boxes
        ]
        count = len(boxes)
        body: int = bullet.createMultiBody(
            0.0 if index == SUPPORT else float(self._assembly.masses[index, 0]),
            basePosition=self._place(index),
            baseOrientation=self._frame.quaternion,
            linkMasses=[0.0] * count,
            linkCollisionShapeIndices=shapes,
            linkVisualShapeIndices=[-1] * count,
            linkPositions=[box.centre for box in boxes],
            linkOrientations=[box.quaternion for box in boxes],
            linkInertialFramePositions=[[0.0, 0.0, 0.0]] * count,
            linkInertialFrameOrientations=[[0.0, 0.0, 0.0, 1.0]] * count,
            linkParentIndices=[0] * count,
            linkJointTypes=[bullet.JOINT_FIXED] * count,
            linkJointAxis=[[0.0, 0.0, 1.0]] * count,
            physicsClientId=self._client,
        )
        self._weigh(body, index)
        for link in range(count):
            bullet.setCollisionFilterGroupMask(body, link, 0, 0, physicsClientId=self._client)
        return body

    def _weigh(self, body: int, index: int) -> None:
        """Give a body the mass and the inertias of a block, and no damping."""
        bullet.changeDynamics(
            body, -1, linearDamping=0, angularDamping=0, physicsClientId=self._client
        )
        if index == SUPPORT:
            return
        mass, _, inertia, _, *across = self._assembly.spatial_masses[index].tolist()
        if self._problem.is_planar:
            across = [LOCK, LOCK]
        bullet.changeDynamics(
            body,
            -1,
            mass=mass,
            localInertiaDiagonal=[*across, inertia],
            physicsClientId=self._client,
        )

    def _rub(self, body: int, share: float, link: int = -1) -> None:
        """Give a body, or a link of it, its share of a friction, and no rebound."""
        bullet.changeDynamics(
            body,
            link,
            lateralFriction=share,
            restitution=0,
            physicsClientId=self._client,
        )

    def _solid(self, shape: int, place: list[float], index: int = SUPPORT) -> int:
        """Create a body of one shape; that of no block stays where it is."""
        # Without maximal coordinates Bullet would push blocks that overlap apart.
        body: int = bullet.createMultiBody(
            0.0 if index == SUPPORT else float(self._assembly.masses[index, 0]),
            shape,
            basePosition=place,
            baseOrientation=self._frame.quaternion,
            useMaximalCoordinates=1,
            physicsClientId=self._client,
        )
        self._rub(body, _share(self._problem.mu))
        self._weigh(body, index)
        return body

    def begin(self, forces: Array) -> None:
        """Build anew, of joints that press by themselves as the forces given do.

        Bullet keeps no impulses. So joints are springs whose faces reach into each other by
        what it takes; they are so soft, for the step in which they are solved, that pressures
        stay near what is given. Friction is left to Bullet.
        """
        pressures = np.maximum(forces[:, :, 0], 0.0)
        corner = self._assembly.joint_arrays.is_corner
        pressures[corner] = pressures[corner].sum(axis=1, keepdims=True)
        stiffness = max(1.0, float(pressures.max())) / PRESSED
        self._short, self._held = math.sqrt(SOFT / stiffness), 0
        bullet.resetSimulation(physicsClientId=self._client)
        self._begin()
        self._pull()
        self._joints.clear()
        self._bodies = self._build(pressures / stiffness)
        for body, _, link, _ in self._joints:
            bullet.changeDynamics(
                body,
                link,
                # A pair's stiffness is half of either's.
                contactStiffness=2 * stiffness,
                contactDamping=0,
                physicsClientId=self._client,
            )

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back.

        Impulses are not kept: the sweeps made so far are made again.
        """
        self._held += sweeps
        step = self._short
        self._set(fixedTimeStep=step, numSolverIterations=self._held, solverResidualThreshold=0)
        self._step()
        accelerations = self._velocities() / step
        nothing = [0.0, 0.0, 0.0]
        # Springs that give way by next to nothing make up for what forces given are off.
        gives = step != self._settings.step and np.abs(accelerations).max() < SETTLED
        for body, place in zip(self._bodies, self._places, strict=True):
            if not gives:
                bullet.resetBasePositionAndOrientation(
                    body, place, self._frame.quaternion, physicsClientId=self._client
                )
            bullet.resetBaseVelocity(body, nothing, nothing, physicsClientId=self._client)
        return accelerations

    def advance(self, steps: int) -> None:
        """Let the blocks move, in parts of a step where they move far."""
        if not self._is_free:
            self._let_go()
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
        assembly = self._assembly
        self._breaking = _breaking(assembly)
        self._begin()
        polygons: dict[int, list[Array]] = defaultdict(list)
        for index, polygon in self._solids.moving:
            polygons[index].append(polygon)
        with TemporaryDirectory() as folder:
            for index, ((place, _), _) in enumerate(states):
                shape = self._prism(folder, polygons[index], float(assembly.depths[index]))
                self._bodies[index] = self._solid(shape, list(place), index)
            # As deep as it is drawn.
            deep = float(assembly.depths.max())
            for polygon in self._solids.fixed:
                middle = polygon.mean(axis=0)
                shape = self._prism(folder, [polygon - middle], deep)
                self._solid(shape, self._frame.place(middle))
        floor = bullet.createCollisionShape(
            bullet.GEOM_PLANE, planeNormal=[0.0, 1.0, 0.0], physicsClientId=self._client
        )
        self._solid(floor, self._frame.place(np.array([0.0, self._solids.level])))
        bullet.stepSimulation(physicsClientId=self._client)
        for body, ((place, turn), (shift, spin)) in zip(self._bodies, states, strict=True):
            bullet.resetBasePositionAndOrientation(
                body, place, turn, physicsClientId=self._client
            )
            bullet.resetBaseVelocity(body, shift, spin, physicsClientId=self._client)
        self._pull()

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
            push, friction, along, across, beyond = contact[9:14]
            force = push * np.array(contact[7]) + friction * np.array(along)
            force += across * np.array(beyond)
            # The boxes overlap: the joint is midway.
            place = (np.array(contact[5]) + contact[6]) / 2
            joint, sense = self._nearest(self._joints[contact[1:5]], place)
            # It acts on the first body.
            found[joint] += sense * self._frame.wrench(place, force)
        return found

    def _nearest(self, joints: list[tuple[int, float]], place: Array) -> tuple[int, float]:
        """Tell which joint of two blocks a contact belongs to."""
        point, ends = self._frame.point(place), self._assembly.joint_arrays.ends
        return min(joints, key=lambda each: np.hypot(*(ends[each[0]] - point).T).min())

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
    most_friction=MOST_FRICTION,
    takes_forces=True,
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
