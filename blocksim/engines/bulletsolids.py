"""Blocks in space as bodies of a Bullet space: the parts that `bulletmotion` moves.

- At each corner of a joint a box stands on one of its corners, and a thin box is the plate on
  the other block: Bullet finds that one point of contact exactly. Hulls it rounds.
- Each is a link of its block, touches its partner only, and has the joint's friction. Bullet's
  friction of links lies within the round cone.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import SPATIAL, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.later import transform
from blocksim.engines.boxes import UNTURNED, Box, Frame
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

    def linked(self, space: Space, reaches: Array | None = None) -> tuple[list[int], Joints]:
        """Create a body with links for each block, and one for all supports.

        `reaches`, (points,): How far each point reaches into its plate [size].
        """
        built, friction = [*self.states, UNMOVED], self.problem.friction
        bodies, ends = linked(space, self._links(reaches), built, self._masses, friction)
        # What is not the plate's body touches the plate.
        for touch in self.touches:
            plate = bodies[touch.plate]
            ends[touch.joint].sort(key=lambda each: each[0] != plate)
        return bodies[:-1], met(space, ends)

    def _masses(self, index: int) -> list[float] | None:
        """Return the mass of a block and its principal moments; a support has none."""
        if index == SUPPORT:
            return None
        mass, _, _, *moments = self.bodies.inertia[index].tolist()
        return [mass, *moments]

    def _links(self, reaches: Array | None) -> dict[int, list[Link]]:
        """Return what touches on each body; see `linked`."""
        found: dict[int, list[Link]] = defaultdict(list)
        for touch, ways in zip(self.touches, self.at_joints(reaches), strict=True):
            normal = touch.normal
            middle = touch.places.mean(axis=0) + (SLOP / 2 - touch.half[2]) * normal
            plate = self._box(touch.plate, touch.half, middle, touch.axes)
            found[touch.plate].append(Link(touch.joint, -touch.sign, plate))
            side, stands = CORNER * touch.spread, _standing(normal)
            for place, way in zip(touch.places, ways.tolist(), strict=True):
                centre = place + (side * math.sqrt(3.0) / 2 - SLOP / 2 - way) * normal
                box = self._box(touch.corners, [side / 2] * 3, centre, stands)
                found[touch.corners].append(Link(touch.joint, touch.sign, box))
        return found

    def _box(self, index: int, half: list[float], centre: Array, axes: Array) -> Box:
        """Return a box in the frame of a body."""
        place, turn = self.within(index, centre, axes)
        return Box(half, place, turn.tolist())

    def solid(self, space: Space, states: Sequence[State]) -> list[int]:
        """Build anew, blocks in given states as they are, what they stand on and the floor."""
        own = friction_share(self.problem.mu)
        space.clear()
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
