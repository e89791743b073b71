"""One of Chipmunk's spaces, through pymunk: bodies, who meets whom, steps, contacts.

How a near-critical arch has to be put into it (measured; see docs/methods/engines.md):

- Faces that touch exactly have round-off gaps and lose contacts. Each joint face is
  set back by `INSET` and the shape given a radius that closes the joint again with an
  overlap of an eighth of it, less than the slop: contacts exist from the start, their
  levers are those of the true corners, and no position correction acts.
- Corners that coincide make the collision routine return a wrong normal now and then,
  and corners that pass each other as a joint slips make it forget the impulses of a
  contact, from which a moving arch does not recover. One face of each joint reaches beyond
  the other by a `LEDGE`: the contacts are those of the shorter face, whose corners are
  true, until the joint has slipped that far.
- A pair's friction is the product of its two shapes' values: each takes sqrt(mu).
- A contact that was open for a moment would come back with its old impulse:
  collision_persistence is 1.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.outlines import width
from blocksim.blocks.problem import Problem
from blocksim.engines.base import FRICTION_CAP, Library
from blocksim.engines.faces import Side, sides_of
from blocksim.engines.solids import Solids, smaller

if TYPE_CHECKING:
    import pymunk
else:
    pymunk = Library("pymunk")

INSET = 1e-6
"""Most a face is set back; no more than `INSET_SHARE` of the shortest joint."""
INSET_SHARE = 1e-4
OVERLAP = 0.25
"""Overlap of two closed shapes, in units of the inset."""
PLATE, THINNEST = 0.15, 100.0
"""Thickness of what touches in units of the block's extent, and at least of the inset."""
ROUND = 1e-4
"""Radius of the corners of blocks that meet, in units of their least width."""


def _choose(arbiter: pymunk.Arbiter, _space: pymunk.Space, space: Space) -> None:
    """Let touch what the space lets touch."""
    if not space.chooses(*arbiter.shapes):
        arbiter.process_collision = False


def _let_go(space: Any) -> None:
    """Let a space go at once.

    What chooses holds the space that holds it, so that all that Chipmunk has taken for its
    contacts, 0.2 MB, would wait for Python's collector of cycles.
    """
    for handler in space._handlers.values():
        handler._space = None


class Space:
    """A pymunk space with one body for each block, and one shape for each side of a joint."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._assembly = problem, problem.assembly
        self._inset = min(INSET, INSET_SHARE * problem.assembly.shortest)
        self._loaded = problem.is_loaded
        self._shapes: dict[pymunk.Shape, tuple[int, float, pymunk.Body]] = {}
        self._polygons: dict[pymunk.Shape, int] = {}
        self._space, self._bodies = self._build()
        self.set_gravity(problem.gravity)

    def _build(self) -> tuple[pymunk.Space, list[pymunk.Body]]:
        """Put the blocks into a new space, without impulses."""
        assembly, size = self._assembly, self._assembly.size
        space = pymunk.Space()
        space.collision_slop = self._inset
        space.collision_persistence = 1
        space.on_collision(begin=_choose, data=weakref.proxy(self))
        weakref.finalize(self, _let_go, space)
        bodies: list[pymunk.Body] = []
        for block, (mass, _, inertia) in zip(assembly.blocks, assembly.masses, strict=True):
            body = pymunk.Body(float(mass), float(inertia))
            centre = block.centre / size
            body.position = (float(centre[0]), float(centre[1]))
            space.add(body)
            bodies.append(body)
        for sides, mu in zip(sides_of(assembly), self._problem.friction, strict=True):
            for side, sense in zip(sides, (1.0, -1.0), strict=True):
                body = space.static_body if side.body == SUPPORT else bodies[side.body]
                shape = self._shape(body, side)
                shape.friction = math.sqrt(min(float(mu), FRICTION_CAP))
                shape.filter = pymunk.ShapeFilter(categories=1, mask=1)
                space.add(shape)
                self._shapes[shape] = side.joint, sense, body
        return space, bodies

    def _shape(self, body: pymunk.Body, side: Side) -> pymunk.Shape:
        """Return a plate on a face, or a dot for a corner, set back and made round."""
        radius = self._inset * (1 + OVERLAP / 2)
        ends = side.ends + side.inward * self._inset - np.array(body.position)
        if side.is_corner:
            return pymunk.Circle(body, radius, (float(ends[0, 0]), float(ends[0, 1])))
        back = side.inward * max(PLATE * side.room, THINNEST * self._inset)
        corners = [*ends.tolist(), *(ends[::-1] + back).tolist()]
        return pymunk.Poly(body, corners, radius=radius)

    def chooses(self, one: pymunk.Shape, other: pymunk.Shape) -> bool:
        """Tell whether two may touch: sides of a joint, or polygons that no joint holds."""
        if one in self._polygons:
            return self.solids.may_meet(self._polygons[one], self._polygons[other])
        return self._shapes[one][0] == self._shapes[other][0]

    @cached_property
    def solids(self) -> Solids:
        """Blocks as they are to those that no joint holds to them."""
        return Solids(self._assembly)

    @property
    def is_solid(self) -> bool:
        """Whether blocks may meet without a joint."""
        return bool(self._polygons)

    def make_solid(self) -> None:
        """Add the polygons of blocks, what they stand on and the floor."""
        friction = math.sqrt(min(self._problem.mu, FRICTION_CAP))
        bodies = [self._bodies[index] for index, _ in self.solids.moving]
        fixed = [*self.solids.fixed, self.solids.floor]
        bodies += [self._space.static_body] * len(fixed)
        corners = [polygon for _, polygon in self.solids.moving] + fixed
        for index, (body, polygon) in enumerate(zip(bodies, corners, strict=True)):
            radius = ROUND * width(polygon)
            # Corners that coincide are collided wrongly: rounded ones do not.
            shape = pymunk.Poly(body, smaller(polygon, radius).tolist(), radius=radius)
            shape.friction = friction
            shape.filter = pymunk.ShapeFilter(categories=2, mask=2)
            self._space.add(shape)
            self._polygons[shape] = index

    def part(self) -> None:
        """Give up joints that have come apart: their blocks are solid to each other."""
        self.solids.update(self.poses())
        holds = self.solids.holds
        over = [shape for shape, (joint, *_) in self._shapes.items() if not holds[joint]]
        if not over:
            return
        ended = {self._shapes[shape][0] for shape in over}
        self._space.remove(*over)
        for shape in over:
            del self._shapes[shape]
        parted = set[int]().union(*(self.solids.sides[joint] for joint in ended))
        again = [shape for shape, index in self._polygons.items() if index in parted]
        # What has been turned down while it touched is asked again.
        self._space.remove(*again)
        self._space.add(*again)

    def set_gravity(self, gravity: Array) -> None:
        """Let it pull along x and y as given."""
        self._space.gravity = float(gravity[0]), float(gravity[1])

    def step(self, step: float, sweeps: int) -> None:
        """Take a step under gravity and loads, which pymunk forgets after each."""
        self._space.iterations = sweeps
        if self._loaded:
            loads = self._problem.loads(self.poses())
            for body, (x, y, moment) in zip(self._bodies, loads.tolist(), strict=True):
                body.force, body.torque = (x, y), moment
        self._space.step(step)

    def poses(self) -> Array:
        """Return centres of mass and rotations."""
        return np.array([(*body.position, body.angle) for body in self._bodies])

    def put(self, poses: Array) -> None:
        """Put every block somewhere."""
        for body, (x, y, angle) in zip(self._bodies, poses.tolist(), strict=True):
            body.position, body.angle = (x, y), angle

    def velocities(self) -> Array:
        """Return those of centres of mass, and of rotations."""
        return np.array([(*body.velocity, body.angular_velocity) for body in self._bodies])

    def set_velocities(self, velocities: Array) -> None:
        """Give every block a velocity and a rate of rotation."""
        for body, (x, y, turn) in zip(self._bodies, velocities.tolist(), strict=True):
            body.velocity, body.angular_velocity = (x, y), turn

    def contacts(self) -> Iterator[tuple[int, Array, Array, Any]]:
        """Go through the joints' contacts, which pymunk shows only to those who pickle a space.

        Yields `place`, (2,).
        Yields `axes`, (2, 2): Normal and tangent of its impulses, as they act on the block
            after the joint.
        Yields `contact`: Chipmunk's own: `jnAcc` and `jtAcc` are its impulses.
        """
        for one, other, pair in self._pairs():
            if one in self._polygons:
                continue
            joint, sense, body = self._shapes[one]
            first, second = body.position, self._shapes[other][2].position
            normal = pymunk.Vec2d(pair.n.x, pair.n.y)
            # It leads from the first shape to the second.
            axes = sense * np.array([normal, normal.perpendicular()])
            for contact in pair.contacts[0 : pair.count]:
                # The two shapes overlap: the contact is midway.
                x = first.x + contact.r1.x + second.x + contact.r2.x
                y = first.y + contact.r1.y + second.y + contact.r2.y
                yield joint, np.array([x, y]) / 2, axes, contact

    def _pairs(self) -> Iterator[tuple[pymunk.Shape, pymunk.Shape, Any]]:
        """Go through the pairs of shapes that touch."""
        space: Any = self._space
        shapes: dict[Any, pymunk.Shape] = {}
        for shape in (*self._shapes, *self._polygons):
            its: Any = shape
            shapes[its._shape] = shape
        for pair in space._get_arbiters():
            yield shapes[pair.a], shapes[pair.b], pair

    def forget(self) -> None:
        """Forget impulses: those of an impact, taken for those of rest, would throw blocks."""
        space: Any = self._space
        for pair in space._get_arbiters():
            for contact in pair.contacts[0 : pair.count]:
                contact.jnAcc = contact.jtAcc = 0.0

    def deepest(self) -> float:
        """Return the deepest overlap of any two blocks."""
        found = 0.0
        for one, other, pair in self._pairs():
            first, second = one.body, other.body
            if first is None or second is None:
                continue
            (x1, y1), (x2, y2) = first.position, second.position
            for contact in pair.contacts[0 : pair.count]:
                x = x2 + contact.r2.x - x1 - contact.r1.x
                y = y2 + contact.r2.y - y1 - contact.r1.y
                found = max(found, -(x * pair.n.x + y * pair.n.y))
        return found
