"""Blocks as bodies of a Bullet space: at rest, in motion, and once they may meet others.

How a near-critical arch has to be put into it, each point measured:

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
- Gravity lies in the plane, and so does all motion, by symmetry. Sweeps break it, though:
  of two contacts across the plane the first takes more, and walls rock out of the plane
  for as long as they are solved. So inertias out of the plane are beyond reach (`LOCK`),
  and a joint is so narrow that Bullet makes one contact of two. A million times the true
  ones, as others take, leave a hundred times more that no sweeps remove (1e-6 g).

Bullet's x and y are those of the assembly's plane, z is out of it. So the two
directions of friction Bullet chooses at rest lie in the plane and across it.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.engines.boxes import EDGE, IN_PLANE, UNTURNED, Frame, edge, plate
from blocksim.engines.bulletparts import Ends, Joints, Link, let_go, linked, met
from blocksim.engines.bulletspace import SLOP, Space, State, friction_share
from blocksim.engines.faces import LEDGE_SHARE, Side, reaching, sides_of
from blocksim.engines.solids import Polygons, obj_text, prism

OVERLAP = SLOP
"""Of two closed faces: they would sink until they overlap by it [size]."""
LOCK = 1e12
"""Inertias out of the plane [mean mass, size squared]."""
NARROW, MERGED = 0.04, 0.1
"""Depth of a joint there, in units of its length, and Bullet's breaking threshold, in units
of half a box's diagonal: contacts across the plane are one, those along it are two."""
TIE = 1e-11
"""Angle between the boxes of a joint: Bullet takes the normal of the longer one, always."""
BREAKING = 0.1
"""Distance at which contact points count as one else, in units of the shortest joint."""
MOST_BREAKING = 0.02
"""Bullet's own such distance, in units of a block's size."""
PRESSED = 1e-7
"""How far the joint with most pressure reaches into itself where pressures are given [size]."""
BESIDE = 1e-7
"""Distance from the plane from which blocks that meet are put back into it [size]."""


class Planar(Polygons):
    """The blocks of a problem in the plane as bodies: the parts that `bulletmotion` moves."""

    turns = (2,)
    pressed = PRESSED

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self.frame = Frame(IN_PLANE)
        self.reach: Array = self.assembly.reach / self.assembly.size
        self.states = [self._at(index) for index in range(len(self.assembly.blocks))]
        self.breaking = MERGED

    def loads(self, poses: Array) -> Array | None:
        """Return loads besides gravity, (blocks, 3); None where there are none."""
        return self.problem.loads(poses) if self.problem.is_loaded else None

    def pressures(self, forces: Array) -> Array:
        """Return pressures at both ends of each joint, of forces (joints, 2, 2)."""
        pressures = np.maximum(forces[:, :, 0], 0.0)
        corner = self.assembly.joint_arrays.is_corner
        pressures[corner] = pressures[corner].sum(axis=1, keepdims=True)
        return pressures

    def flatten(self, space: Space, bodies: list[int]) -> None:
        """Put centres that have left the plane back into it, with no velocity out of it.

        Impacts kick blocks out of the plane, by 1e-3 of their velocity. What is put back loses
        its contacts, and sinks: so only what is off is.
        """
        for body in bodies:
            (x, y, z), turn, (right, up, _), spin = space.state(body)
            if abs(z) > BESIDE:
                space.put(body, State((x, y, 0.0), turn, (right, up, 0.0), spin))

    def linked(
        self, space: Space, forces: Array | None = None, stiffness: float = 1.0
    ) -> tuple[list[int], Joints]:
        """Create a body with links for each block, and one for the support.

        `forces`, (joints, 2, 2): Whose pressures sides of joints that reach into each other
            have at their ends, with a stiffness.
        """
        reaches = None if forces is None else self.pressures(forces) / stiffness
        built, masses = [*self.states, self._at(SUPPORT)], partial(_masses, self.problem)
        links = _boxes(self.problem, reaches)
        bodies, ends = linked(space, links, built, masses, self.problem.friction)
        return bodies[:-1], met(space, ends)

    @property
    def can_be_layered(self) -> bool:
        """Whether blocks can be bodies without links.

        Such a body has one friction, and its boxes cannot be told whom to touch. So they lie
        in layers: in the plane it does not matter where across it a joint is. Each has one.
        """
        problem, joints = self.problem, self.assembly.joint_arrays
        free = set(range(len(self.assembly.blocks))) - {*joints.before, *joints.after}
        between = (joints.before != SUPPORT) & (joints.after != SUPPORT)
        is_one = not (problem.friction[between] != problem.mu).any()
        return is_one and problem.mu > 0 and not free

    def layered(self, space: Space) -> tuple[list[int], Joints]:
        """Build anew, of bodies without links, and those of the support one for each joint."""
        problem, mu = self.problem, friction_share(self.problem.mu)
        layers = _layers(self.assembly)
        space.clear(_breaking(self.assembly, layers.max()))
        boxes, bodies = _boxes(problem), list[int]()
        ends: Ends = defaultdict(list)
        blocks = [(index, boxes[index]) for index in range(len(self.assembly.blocks))]
        for index, its in [*blocks, *((SUPPORT, [each]) for each in boxes[SUPPORT])]:
            # What a block has of a pair's friction is the same everywhere.
            own = mu
            if index == SUPPORT:
                own = friction_share(problem.friction[its[0].joint]) ** 2 / mu
            placed = [
                replace(box, centre=[*box.centre[:2], float(layers[joint])])
                for joint, _, box, _ in its
            ]
            body = space.layered(placed, own, self._at(index), _masses(problem, index))
            for each in its:
                ends[each.joint].append((body, -1, each.sense))
            bodies.append(body)
        joints = met(space, ends)
        space.step()
        space.pull(problem.gravity)
        return bodies[: len(blocks)], joints

    def solid(self, space: Space, states: Sequence[State]) -> list[int]:
        """Build anew, blocks in given states as they are, what they stand on and the floor."""
        assembly, own = self.assembly, friction_share(self.problem.mu)
        space.clear(_breaking(assembly))
        polygons: dict[int, list[Array]] = defaultdict(list)
        for index, polygon in self.solids.moving:
            polygons[index].append(polygon)
        bodies = list[int]()
        for index, state in enumerate(states):
            deep = float(assembly.depths[index])
            text = obj_text(prism(each, deep) for each in polygons[index])
            built = State(state.place, UNTURNED)
            bodies.append(space.hulls(text, own, built, _masses(self.problem, index)))
        # As deep as it is drawn.
        deep = float(assembly.depths.max())
        for polygon in self.solids.fixed:
            middle = polygon.mean(axis=0)
            text = obj_text([prism(polygon - middle, deep)])
            space.hulls(text, own, _at_rest(middle))
        space.floor(own, _at_rest(np.array([0.0, self.solids.level])), [0.0, 1.0, 0.0])
        return let_go(space, bodies, states, self.problem.gravity)

    def _at(self, index: int) -> State:
        """Return how the body of a block, or of the support, is built."""
        if index == SUPPORT:
            return _at_rest(np.zeros(2))
        return _at_rest(self.assembly.blocks[index].centre / self.assembly.size)


def _at_rest(place: Array) -> State:
    """Return how a body is built at a place in the plane, (2,)."""
    return State([*place.tolist(), 0.0], UNTURNED)


def _masses(problem: Problem, index: int) -> list[float] | None:
    """Return the mass of a block and its inertias about x, y and z; a support has none."""
    if index == SUPPORT:
        return None
    mass, _, inertia = problem.assembly.masses[index].tolist()
    return [mass, LOCK, LOCK, inertia]


def _boxes(problem: Problem, reaches: Array | None = None) -> dict[int, list[Link]]:
    """Return what touches on each body.

    `reaches`, (joints, 2): How far the sides of each joint reach into each other at its ends
        [size].
    """
    assembly = problem.assembly
    found: dict[int, list[Link]] = defaultdict(list)
    for joint, sides in enumerate(sides_of(assembly)):
        deep, pair = _depths(sides), sides
        if reaches is not None:
            pair = reaching(sides, assembly.joint_arrays.ends[joint], reaches[joint])
        for side, depth, sense in zip(pair, deep, (-1.0, 1.0), strict=True):
            at_rest = side.body == SUPPORT
            origin = np.zeros(2) if at_rest else assembly.centres[side.body] / assembly.size
            turn = math.pi + TIE * (sense > 0)
            box = (edge if side.is_corner else plate)(side, depth, origin, OVERLAP, turn)
            found[side.body].append(Link(joint, sense, box))
    return found


def _depths(sides: tuple[Side, Side]) -> tuple[float, float]:
    """Tell how deep both boxes of a joint are, of which the longer is deeper, too."""
    lengths = [side.length for side in sides]
    depth = NARROW * (min(lengths) or EDGE)
    more = depth * LEDGE_SHARE
    return (depth, depth + more) if lengths[1] > lengths[0] else (depth + more, depth)


def _layers(assembly: Assembly) -> Array:
    """Return where across the plane joints are, (joints,).

    Of two blocks that meet all sides may touch, not those of their joint alone. So each
    joint of either is in a layer of its own: sides of others reach into each other where
    a voussoir is narrow (at eta = 2 the intrados is a point).
    """
    joints_of: dict[int, set[int]] = defaultdict(set)
    meets: dict[int, set[int]] = defaultdict(set)
    blocks = [{joint.before, joint.after} - {SUPPORT} for joint in assembly.joints]
    for index, its in enumerate(blocks):
        for block in its:
            joints_of[block].add(index)
            meets[block] |= its
    found: list[int] = []
    for its in blocks:
        near = {joint for one in its for other in meets[one] for joint in joints_of[other]}
        taken = {found[joint] for joint in near if joint < len(found)}
        found.append(next(k for k in itertools.count() if k not in taken))
    spacing = 2 * NARROW * max(assembly.joint_arrays.length.max(), EDGE)
    return np.array(found) * spacing


def _breaking(assembly: Assembly, across: float = 0.0) -> float:
    """Return a breaking threshold that the shortest joint is longer than."""
    reach = float(assembly.reach.max()) / assembly.size + across
    reach += float(assembly.depths.max()) / 2
    return min(MOST_BREAKING, BREAKING * assembly.shortest / reach)
