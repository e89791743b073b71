"""Blocks in space as bodies of a Bullet space: the parts that `bulletmotion` moves.

- At each corner of a joint a box stands on one of its corners, and a thin box is its plate on
  the other block: Bullet finds that one point of contact exactly. Hulls it rounds.
- Each is a link of its block, touches its partner only, and has the joint's friction. Bullet's
  friction of links lies within the round cone; with forces given within rectangles in it.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import SPATIAL, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.points import JointPoints
from blocksim.common.later import sparse_linalg, transform
from blocksim.engines.boxes import UNTURNED, Box, Frame
from blocksim.engines.bulletfriction import across, rectangle
from blocksim.engines.bulletparts import Joints, Link, let_go, linked, met
from blocksim.engines.bulletspace import NOTHING, SLOP, Space, State, friction_share
from blocksim.engines.polyhedra import Polyhedra

CORNER = 0.05
"""Side of the box in a corner, over the spread of a joint's corners."""
PRESSED = 1e-4
"""How far the joint with most pressure reaches into itself where pressures are given [size].
Let go, blocks go on in steps that suit such springs: softer ones ask for fewer."""
BREAKING = 0.1
"""Bullet's breaking threshold, in units of a box."""
MERGED = 0.02
"""Distance at which points of hulls replace each other, over the thickness of the thinnest
block. With more the deepest of them are lost: thin blocks went into each other."""
DIAGONAL = np.ones(3) / math.sqrt(3.0)
UNMOVED = State(NOTHING, UNTURNED)
"""How supports are built."""


class Spatial(Polyhedra):
    """The blocks of a problem in space as bodies; see `bulletmotion`."""

    breaking = BREAKING
    turns = (3, 4, 5)
    can_be_layered = False
    pressed = PRESSED

    def __init__(self, problem: Problem[SpatialAssembly]) -> None:
        super().__init__(problem)
        self._points = JointPoints(problem)
        self.frame = Frame(range(SPATIAL), self.quaternions)
        self.reach: Array = self.bodies.reach
        centres = self.bodies.built.centres.tolist()
        self.states = [
            State(place, turn)
            for place, turn in zip(centres, self.quaternions.tolist(), strict=False)
        ]

    def loads(self, poses: Array) -> Array | None:
        """Return loads besides gravity, (blocks, 6), or None."""
        return self.along(poses)

    def pressures(self, forces: Array) -> Array:
        """Return pressures of forces at the points of joints, (points, 3)."""
        return np.maximum(forces[:, 0], 0.0)

    def flatten(self, space: Space, bodies: list[int]) -> None:
        """Leave blocks where they are: there is no plane."""

    def layered(self, space: Space) -> tuple[list[int], Joints]:
        """Refuse: friction of bodies without links lies within pyramids."""
        raise NotImplementedError

    def linked(
        self, space: Space, forces: Array | None = None, stiffness: float = 1.0
    ) -> tuple[list[int], Joints]:
        """Create a body with links for each block, and one for all supports.

        `forces`, (points, 3): Whose pressures points have that reach into their plates, with a
            stiffness, and that are within the rectangles in which friction is held.
        """
        built, friction = [*self.states, UNMOVED], self._points.friction
        links = self._links(forces, stiffness)
        bodies, ends = linked(space, links, built, self._masses, friction)
        return bodies[:-1], met(space, ends)

    def _masses(self, index: int) -> list[float] | None:
        """Return the mass of a block and its principal moments; a support has none."""
        if index == SUPPORT:
            return None
        mass, _, _, *moments = self.bodies.inertia[index].tolist()
        return [mass, *moments]

    def _links(self, forces: Array | None, stiffness: float) -> dict[int, list[Link]]:
        """Return what touches on each body, by points of joints; see `linked`."""
        found: dict[int, list[Link]] = defaultdict(list)
        known = np.zeros((len(self._points.joint), 3))
        if forces is not None:
            known = self._balanced(forces, stiffness)
        ways, rubbing = (self.pressures(known) / stiffness).tolist(), self._rubbing(known)
        point = 0
        for touch in self.touches:
            normal = touch.normal
            middle = touch.places.mean(axis=0) + (SLOP / 2 - touch.half[2]) * normal
            side, stands = CORNER * touch.spread, _standing(normal)
            seen = across(normal)
            axes = np.vstack([seen, normal]).T
            plate = self._box(touch.plate, touch.half, middle, axes)
            for place in touch.places:
                rubs = None if forces is None else rectangle(seen @ rubbing[point])
                deep = side * math.sqrt(3.0) / 2 - SLOP / 2 - ways[point]
                box = self._box(touch.corners, [side / 2] * 3, place + deep * normal, stands)
                found[touch.plate].append(Link(point, -touch.sign, plate, rubs))
                found[touch.corners].append(Link(point, touch.sign, box))
                point += 1
        return found

    def _rubbing(self, forces: Array) -> Array:
        """Return the part of forces at points that is across their normals, (points, 3)."""
        axes = self._points.axes[self._points.joint]
        return np.einsum("pk,pkx->px", forces[:, 1:], axes[:, 1:])

    def _balanced(self, forces: Array, stiffness: float) -> Array:
        """Return forces (points, 3) that balance as Bullet lets them act.

        Where a corner reaches into its plate, friction acts on its block at the corner, and on
        the other where the plate is. What moment is left is taken up by small changes, each in
        proportion to its point's pressure.
        """
        pressures = self.pressures(forces)
        owners = np.concatenate([np.full(len(t.places), t.corners) for t in self.touches])
        normals = np.concatenate([np.tile(t.normal, (len(t.places), 1)) for t in self.touches])
        signs = np.concatenate([np.full(len(t.places), t.sign) for t in self.touches])
        arms = normals * (-signs * pressures / stiffness)[:, None]
        moments = np.cross(arms, self._rubbing(forces))
        left = np.zeros((len(self.states), 6))
        moves = owners != SUPPORT
        np.add.at(left[:, 3:], owners[moves], moments[moves])
        weights = np.repeat(pressures, 3)
        scaled = self._points.matrix.multiply(weights).tocsr()
        found = sparse_linalg.lsqr(scaled, -left.ravel(), atol=1e-12, btol=1e-12)[0]
        return forces + (weights * found).reshape(-1, 3)

    def _box(self, index: int, half: list[float], centre: Array, axes: Array) -> Box:
        """Return a box in the frame of a body."""
        place, turn = self.within(index, centre, axes)
        return Box(half, place, turn.tolist())

    def solid(self, space: Space, states: Sequence[State]) -> list[int]:
        """Build anew, blocks in given states as they are, what they stand on and the floor."""
        own = friction_share(self.problem.mu)
        space.clear(MERGED * self.thinnest / float(self.reach.max()))
        moving, fixed = self.texts()
        bodies = [
            space.hulls(text, own, State(state.place, state.turn), self._masses(index))
            for index, (text, state) in enumerate(zip(moving, states, strict=True))
        ]
        for text in fixed:
            space.hulls(text, own, UNMOVED)
        space.floor(own, UNMOVED._replace(place=[0.0, 0.0, self.level]), [0.0, 0.0, 1.0])
        return let_go(space, bodies, states, self.problem.gravity)


def _standing(normal: Array) -> Array:
    """Return axes of a box of which one corner looks against a normal, (3, 3)."""
    turn, _ = transform.Rotation.align_vectors([normal], [DIAGONAL])
    return turn.as_matrix()
