"""Chipmunk through pymunk: planar, sequential impulses, Coulomb friction.

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
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import FRICTION_CAP, Engine, Library, Quality, Settings
from blocksim.engines.energy import Balance
from blocksim.engines.faces import Side, sides_of
from blocksim.engines.solids import Solids, smaller, width

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
LONGEST_STEP = 1 / 100
THICK = 0.8
"""Joint length from which the longest step will do [size]."""
SWEEPS = 100
"""Sweeps of a moving run per unit of time, for each block."""
LEAST_SWEEPS = 5
RUBBLE_SWEEPS, MOST_PARTS = 100, 100
"""Least sweeps, and most parts of a step, once blocks may meet."""
ROUND = 1e-4
"""Radius of the corners of blocks that meet, in units of their least width."""
LEAST_AGAIN, MOST_AGAIN = 100, 400
"""Sweeps of a step on ground that shakes: at least, and at most for each pair of blocks."""
CHANGE = 1e-2
"""Change of velocities, as a share of them, at which a step on such ground counts as solved."""
SHAKEN_PARTS, MOVES = 8, 1e-4
"""Parts of a step there, in each of which an impact may be, and velocity from which it is
divided [sqrt(size g)]."""
FAST, FEWER = 1e-2, 50
"""Velocity from which on so many times fewer will do [sqrt(size g)]."""
IMPACT = 10.0
"""Acceleration from which a block has met something [g]."""
MOST_UNSEEN, LEAST_WAY = 16, 1e-12
"""Most steps between two looks where blocks are, and the least way in one [size]."""
HOLD_SWEEPS, LEAST_HOLD = 4000, 50_000
"""Most sweeps of the onset test for each pair of blocks, and at least."""
SLENDER, SLENDEREST = 80, 2.5e-4
"""The same over the length of the shortest joint, and the shortest that was measured [size]."""
LONGEST_HOLD = 5e9
"""Most of these sweeps times blocks, about four minutes."""
UNAIDED = 2e6
"""These sweeps times blocks before the search for impulses is helped, 0.1 s."""


def rule(assembly: Assembly) -> Settings:
    """Choose steps as long as the thickness allows, for the most sweeps in each.

    A hinge that turns for a step overlaps by about 100 step^2 / thickness of its
    motion (measured), which asks for short steps. Sliding asks for many sweeps in a
    step: released from converged impulses, at equal work long steps keep friction
    converged where short ones do not. (Released from nothing it is the other way round.)

    The onset test needs about 40 sweeps for each pair of blocks, and in thin arches 10 to
    20 over the length of a joint: a small moment at it is a large change of its
    pressures. It is allowed four times that, and more where modes die away slowly. What
    takes longer than `UNAIDED` goes on from forces of limit analysis: in a few thousand sweeps,
    however thin or many the voussoirs.
    """
    count = len(assembly.blocks)
    step = LONGEST_STEP * min(1.0, math.sqrt(assembly.shortest / THICK))
    slender = SLENDER / max(assembly.shortest, SLENDEREST) * count**2
    return Settings(
        step=step,
        sweeps=max(LEAST_SWEEPS, round(SWEEPS * count * step)),
        hold_sweeps=max(
            LEAST_HOLD, HOLD_SWEEPS * count**2, round(min(slender, LONGEST_HOLD / count))
        ),
        unaided=round(UNAIDED / count),
    )


def _choose(arbiter: pymunk.Arbiter, _space: pymunk.Space, world: _Space) -> None:
    """Let touch what its world lets touch."""
    if not world.chooses(*arbiter.shapes):
        arbiter.process_collision = False


def _let_go(space: Any) -> None:
    """Let a space go at once.

    What chooses holds the space that holds it, so that all that Chipmunk has taken for its
    contacts, 0.2 MB, would wait for Python's collector of cycles.
    """
    for handler in space._handlers.values():
        handler._space = None


class _Space:
    """A pymunk space with one body for each block, and one shape for each side of a joint."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        assembly = problem.assembly
        self._problem, self._assembly, self._settings = problem, assembly, settings
        self._inset = min(INSET, INSET_SHARE * assembly.shortest)
        self._loaded = problem.is_loaded
        self._shapes: dict[pymunk.Shape, tuple[int, float, pymunk.Body]] = {}
        self._polygons: dict[pymunk.Shape, int] = {}
        self._penetration = 0.0
        self._space, self._bodies = self._build()
        self._balance = Balance(problem, self.poses())
        self._time = 0.0
        self._last, self._rate = settings.step, np.zeros((len(self._bodies), 3))
        self._unseen, self._ahead = 1, 0

    def _build(self) -> tuple[pymunk.Space, list[pymunk.Body]]:
        """Put the blocks into a new space, without impulses."""
        assembly, size = self._assembly, self._assembly.size
        space = pymunk.Space()
        space.gravity = (float(self._problem.gravity[0]), float(self._problem.gravity[1]))
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
            return self._solids.may_meet(self._polygons[one], self._polygons[other])
        return self._shapes[one][0] == self._shapes[other][0]

    @cached_property
    def _solids(self) -> Solids:
        return Solids(self._assembly)

    def _make_solid(self) -> None:
        """Add the polygons of blocks, what they stand on and the floor."""
        friction = math.sqrt(min(self._problem.mu, FRICTION_CAP))
        bodies = [self._bodies[index] for index, _ in self._solids.moving]
        fixed = [*self._solids.fixed, self._solids.floor]
        bodies += [self._space.static_body] * len(fixed)
        corners = [polygon for _, polygon in self._solids.moving] + fixed
        for index, (body, polygon) in enumerate(zip(bodies, corners, strict=True)):
            radius = ROUND * width(polygon)
            # Corners that coincide are collided wrongly: rounded ones do not.
            shape = pymunk.Poly(body, smaller(polygon, radius).tolist(), radius=radius)
            shape.friction = friction
            shape.filter = pymunk.ShapeFilter(categories=2, mask=2)
            self._space.add(shape)
            self._polygons[shape] = index

    def _part(self) -> None:
        """Give up joints that have come apart: their blocks are solid to each other."""
        self._solids.update(self.poses())
        holds = self._solids.holds
        over = [shape for shape, (joint, *_) in self._shapes.items() if not holds[joint]]
        if not over:
            return
        ended = {self._shapes[shape][0] for shape in over}
        self._space.remove(*over)
        for shape in over:
            del self._shapes[shape]
        parted = set[int]().union(*(self._solids.sides[joint] for joint in ended))
        again = [shape for shape, index in self._polygons.items() if index in parted]
        # What has been turned down while it touched is asked again.
        self._space.remove(*again)
        self._space.add(*again)

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back."""
        # Positions are integrated first and at rest, so they never change here.
        self._space.iterations = sweeps
        self._step(self._settings.step)
        rates = self._velocities() / self._settings.step
        for body in self._bodies:
            body.velocity = (0.0, 0.0)
            body.angular_velocity = 0.0
        return rates

    def begin(self, forces: Array) -> None:
        """Write the impulses of given forces into the contacts."""
        self.hold(1)
        joints = self._assembly.joint_arrays
        along = np.stack([joints.normal, joints.tangent], axis=1)
        impulses = self._settings.step * np.einsum("jek,jkd->jed", forces, along)
        for joint, place, axes, contact in self._contacts():
            end = int(np.hypot(*(joints.ends[joint] - place).T).argmin())
            corner = joints.is_corner[joint]
            given = impulses[joint].sum(axis=0) if corner else impulses[joint, end]
            contact.jnAcc, contact.jtAcc = (axes @ given).tolist()

    def advance(self, steps: int) -> None:
        """Let the blocks move, in parts of a step once they may meet."""
        for _ in range(steps):
            if self._polygons:
                self._part()
                self._tumble()
                continue
            self._space.iterations = self._settings.sweeps
            self._watch()
            before = self._velocities() if self._solids.loose else None
            parts = self._parts()
            for _ in range(parts):
                self._go(self._settings.step / parts)
            if before is not None:
                self._rate = (self._velocities() - before) / self._settings.step
                self._make_solid()

    def _parts(self) -> int:
        """Tell in how many parts a step is taken before blocks may meet."""
        if self._problem.shaking is None:
            return 1
        moves = float(displacement(self._velocities(), self._assembly)) > MOVES
        return SHAKEN_PARTS if moves else 1

    def _watch(self) -> None:
        """Look where blocks are, as soon as they may have moved far enough to meet others."""
        self._ahead -= 1
        if self._ahead > 0:
            return
        solids, before = self._solids, self._solids.left
        solids.update(self.poses())
        fast = max((before - solids.left) / self._unseen, LEAST_WAY)
        self._unseen = min(max(1, int(solids.left / (2 * fast))), MOST_UNSEEN)
        self._ahead = self._unseen

    def _tumble(self) -> None:
        """Take a step of blocks that may meet, in parts."""
        step, velocities = self._settings.step, self._velocities()
        speed = float(displacement(velocities, self._assembly)) + step
        parts = min(math.ceil(speed * step / self._solids.largest), MOST_PARTS)
        if self._problem.shaking is not None:
            parts = max(parts, SHAKEN_PARTS)
        part = step / parts
        # Velocities are those half a step ahead: what has been gained by then is less now.
        sudden = np.abs(self._rate).max(axis=1, keepdims=True) > IMPACT
        velocities += np.where(sudden, 0.0, self._rate) * (part - self._last) / 2
        for body, (x, y, turn) in zip(self._bodies, velocities.tolist(), strict=True):
            body.velocity, body.angular_velocity = (x, y), turn
        self._space.iterations = max(RUBBLE_SWEEPS, self._settings.sweeps // parts)
        for _ in range(parts - 1):
            self._forget()
            self._go(part)
        before = self._velocities()
        self._forget()
        self._go(part)
        after = self._velocities()
        self._balance.look(self.poses(), before, after)
        self._last, self._rate = part, (after - before) / part
        self._penetration = max(self._penetration, self._deepest())

    def _velocities(self) -> Array:
        return np.array([(*body.velocity, body.angular_velocity) for body in self._bodies])

    def _go(self, step: float) -> None:
        """Take a step in time, in which the ground may shake."""
        if self._problem.shaking is None:
            self._step(step)
            return
        x, y, _ = self._problem.shaken(self._time, self._time + step).tolist()
        self._space.gravity = x, y
        self._time += step
        self._converge(step)

    def _converge(self, step: float) -> None:
        """Take a step again and again, with more sweeps, until its velocities stay the same.

        The forces of before do not balance what the ground pushes with now: a few sweeps
        leave joints that give way, and arches fall at two thirds of what they bear.
        """
        states = [
            (each.position, each.angle, each.velocity, each.angular_velocity)
            for each in self._bodies
        ]
        sweeps = spent = max(self._space.iterations, LEAST_AGAIN)
        self._space.iterations = sweeps
        self._step(step)
        found, most = self._velocities(), MOST_AGAIN * len(states) ** 2 + LEAST_HOLD
        if float(displacement(found, self._assembly)) > FAST:
            most //= FEWER
        while spent < most:
            for body, (place, angle, velocity, turn) in zip(self._bodies, states, strict=True):
                body.position, body.angle = place, angle
                body.velocity, body.angular_velocity = velocity, turn
            self._space.iterations = spent
            spent *= 2
            self._step(step)
            before, found = found, self._velocities()
            change = float(displacement(found - before, self._assembly))
            speed = float(displacement(found, self._assembly))
            if change < max(self._settings.still * step, CHANGE * speed):
                break
        self._space.iterations = sweeps

    def _step(self, step: float) -> None:
        """Take a step under gravity and loads, which pymunk forgets after each."""
        if self._loaded:
            loads = self._problem.loads(self.poses())
            for body, (x, y, moment) in zip(self._bodies, loads.tolist(), strict=True):
                body.force, body.torque = (x, y), moment
        self._space.step(step)

    def poses(self) -> Array:
        """Return centres of mass and rotations."""
        return np.array([(*body.position, body.angle) for body in self._bodies])

    def resultants(self) -> Array:
        """Add up the impulses of contacts."""
        found = np.zeros((len(self._assembly.joints), 3))
        for joint, place, axes, contact in self._contacts():
            x, y = np.array([contact.jnAcc, contact.jtAcc]) @ axes
            found[joint] += x, y, place[0] * y - place[1] * x
        return found / self._settings.step

    def _contacts(self) -> Iterator[tuple[int, Array, Array, Any]]:
        """Go through the contacts, which pymunk shows only to those who pickle a space.

        Yields
        ------
        joint : int
        place : (2,) float
        axes : (2, 2) float
            Normal and tangent of its impulses, as they act on the block after the joint.
        contact : Any
            Chipmunk's own: `jnAcc` and `jtAcc` are its impulses.
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

    def _forget(self) -> None:
        """Forget impulses: those of an impact, taken for those of rest, would throw blocks."""
        if self._problem.shaking is not None:
            return  # They are found anew all the same.
        space: Any = self._space
        for pair in space._get_arbiters():
            for contact in pair.contacts[0 : pair.count]:
                contact.jnAcc = contact.jtAcc = 0.0

    def _deepest(self) -> float:
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

    def quality(self) -> Quality:
        """Tell how deep blocks that meet have overlapped; Chipmunk does not tell more."""
        if not self._polygons:
            return Quality()
        return Quality(penetration=self._penetration, gain=self._balance.gain)


ENGINE = Engine(
    name="pymunk",
    sees="motion in the plane: onset and collapse with Coulomb friction",
    library="pymunk",
    remedy="pip install 'pymunk>=7.3'",
    version_of=lambda: version("pymunk"),
    rule=rule,
    build=_Space,
    adjustable=("step", "sweeps", "hold_sweeps", "still", "rest"),
    finest=1e-4,
    shakes=True,
    takes_forces=True,
    tells_forces=True,
    keeps_impulses=True,
    reduces=True,
    merges=True,
    usual_sweeps=10,
    validates=("arches", "structures"),
    validated_to=0.001,
    chart={
        "tolerance": (1e-2, 1e-3, 1e-4),
        "step": (1 / 15, 1 / 60, 1 / 240, 1 / 960, 1 / 3840),
        "sweeps": (10, 40, 160, 640, 2560),
        "hold_sweeps": (1e3, 3e3, 1e4, 3e4, 1e5),
        "voussoirs": (7, 13, 27, 53),
    },
    colour="#D55E00",
    tint="#f8dcc9",
    marker="s",
)
