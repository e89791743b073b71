"""Chipmunk through pymunk: planar, sequential impulses, Coulomb friction.

How a near-critical arch has to be put into it (each point measured, see ARCHITECTURE.md):

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

import itertools
import math
from collections.abc import Iterator
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Joint
from blocksim.blocks.problem import Problem
from blocksim.engines.base import FRICTION_CAP, Engine, Library, Quality, Settings
from blocksim.engines.faces import crowding, faces_of, ledge, side

if TYPE_CHECKING:
    import pymunk
else:
    pymunk = Library("pymunk")

INSET = 1e-6
"""Most a face is set back; no more than `INSET_SHARE` of the shortest joint."""
INSET_SHARE = 1e-4
OVERLAP = 0.25
"""Overlap of two closed shapes, in units of the inset."""
CLEARANCE = 6.0
"""Least width of a block between two faces, in units of the inset."""
LONGEST_STEP = 1 / 100
THICK = 0.8
"""Joint length from which the longest step will do [size]."""
SWEEPS = 100
"""Sweeps of a moving run per unit of time, for each block."""
LEAST_SWEEPS = 5
HOLD_SWEEPS, LEAST_HOLD = 4000, 50_000
"""Most sweeps of the onset test for each pair of blocks, and at least."""
SLENDER, SLENDEREST = 80, 2.5e-4
"""The same over the length of the shortest joint, and the shortest that was measured [size]."""
LONGEST_HOLD = 5e9
"""Most of these sweeps times blocks, about four minutes."""
SUPPORT_BIT = 1 << 31


def rule(assembly: Assembly) -> Settings:
    """Choose steps as long as the thickness allows, for the most sweeps in each.

    A hinge that turns for a step overlaps by about 100 step^2 / thickness of its
    motion (measured), which asks for short steps. Sliding asks for many sweeps in a
    step: released from converged impulses, at equal work long steps keep friction
    converged where short ones do not. (Released from nothing it is the other way round.)

    The onset test needs about 40 sweeps for each pair of blocks, and in thin arches 10 to
    20 over the length of a joint: a small moment at it is a large change of its
    pressures. It is allowed four times that, and more where modes die away slowly.
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
    )


class _Space:
    """A pymunk space with one body for each block."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        assembly, mu = problem.assembly, problem.mu
        self._assembly, self._settings = assembly, settings
        self._gravity = (float(problem.gravity[0]), float(problem.gravity[1]))
        self._inset = min(INSET, INSET_SHARE * assembly.shortest)
        self._friction = math.sqrt(min(mu, FRICTION_CAP))
        # Footings come after the blocks, in the order of their joints.
        names = itertools.count(len(assembly.blocks))
        self._sides = [
            tuple(next(names) if side == SUPPORT else side for side in (j.before, j.after))
            for j in assembly.joints
        ]
        self._space, self._bodies, self._shapes = self._build()

    def _build(self) -> tuple[pymunk.Space, list[pymunk.Body], list[pymunk.Shape]]:
        """Put the blocks into a new space, without impulses."""
        assembly, size = self._assembly, self._assembly.size
        space = pymunk.Space()
        space.gravity = self._gravity
        space.collision_slop = self._inset
        space.collision_persistence = 1
        faces = faces_of(assembly)
        bodies: list[pymunk.Body] = []
        shapes: list[pymunk.Shape] = []
        for index, block in enumerate(assembly.blocks):
            mass, _, inertia = assembly.masses[index].tolist()
            body = pymunk.Body(mass, inertia)
            centre = block.centre / size
            body.position = (float(centre[0]), float(centre[1]))
            outline = _outline(block.vertices, index, faces[index], size, self._inset)
            shape = self._shape(body, outline - centre)
            bits = [k for k, joint in enumerate(assembly.springings) if index == joint.bears]
            shape.filter = pymunk.ShapeFilter(categories=1 | sum(2 << k for k in bits))
            space.add(body, shape)
            bodies.append(body)
            shapes.append(shape)
        for k, joint in enumerate(assembly.springings):
            shape = self._shape(space.static_body, _footing(joint, size, self._inset))
            # A support touches only the block that stands on it.
            shape.filter = pymunk.ShapeFilter(categories=SUPPORT_BIT, mask=2 << k)
            if joint.friction == 0:
                shape.friction = 0.0
            space.add(shape)
            shapes.append(shape)
        return space, bodies, shapes

    def _shape(self, body: pymunk.Body, outline: Array) -> pymunk.Poly:
        corners = [(float(x), float(y)) for x, y in outline]
        shape = pymunk.Poly(body, corners, radius=self._inset * (1 + OVERLAP / 2))
        shape.friction = self._friction
        return shape

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back."""
        # Positions are integrated first and at rest, so they never change here.
        self._space.iterations = sweeps
        self._space.step(self._settings.step)
        rates = [(*body.velocity, body.angular_velocity) for body in self._bodies]
        for body in self._bodies:
            body.velocity = (0.0, 0.0)
            body.angular_velocity = 0.0
        return np.array(rates) / self._settings.step

    def begin(self, forces: Array) -> None:
        """Write the impulses of given forces into the contacts."""
        self.hold(1)
        joints = self._assembly.joint_arrays
        along = np.stack([joints.normal, joints.tangent], axis=1)
        impulses = self._settings.step * np.einsum("jek,jkd->jed", forces, along)
        for joint, place, axes, contact in self._contacts():
            end = np.hypot(*(joints.ends[joint] - place).T).argmin()
            contact.jnAcc, contact.jtAcc = (axes @ impulses[joint, end]).tolist()

    def advance(self, steps: int) -> None:
        """Let the blocks move."""
        self._space.iterations = self._settings.sweeps
        for _ in range(steps):
            self._space.step(self._settings.step)

    def poses(self) -> Array:
        """Return centres of mass and rotations."""
        return np.array([(*body.position, body.angle) for body in self._bodies])

    def resultants(self) -> Array:
        """Add up the impulses of contacts."""
        found = np.zeros((len(self._sides), 3))
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
        space: Any = self._space
        shapes: list[Any] = self._shapes
        names = {shape._shape: index for index, shape in enumerate(shapes)}
        joints = {sides: index for index, sides in enumerate(self._sides)}
        for pair in space._get_arbiters():
            sides = names[pair.a], names[pair.b]
            forth, back = joints.get(sides), joints.get(sides[::-1])
            first, second = (shapes[side].body.position for side in sides)
            normal = pymunk.Vec2d(pair.n.x, pair.n.y)
            axes = np.array([normal, normal.perpendicular()])
            for contact in pair.contacts[0 : pair.count]:
                # The two shapes overlap: the contact is midway.
                x = first.x + contact.r1.x + second.x + contact.r2.x
                y = first.y + contact.r1.y + second.y + contact.r2.y
                place = np.array([x, y]) / 2
                if forth is not None:
                    yield forth, place, axes, contact
                elif back is not None:
                    yield back, place, -axes, contact

    def quality(self) -> Quality:
        """Chipmunk does not tell."""
        return Quality()


def _outline(
    vertices: Array, index: int, faces: list[Joint], size: float, inset: float
) -> Array:
    """Corners of a block with its joint faces set back, scaled, shape (k, 2)."""
    corners: list[Array] = [v / size for v in vertices if not _on_a_face(v, faces)]
    for joint in faces:
        inward = side(joint, index) * joint.normal * inset
        beyond = ledge(joint, index, size)
        for end, along in ((joint.inner, joint.tangent), (joint.outer, -joint.tangent)):
            cut = max(-beyond, crowding(end, along, faces, size, CLEARANCE * inset))
            corners.append(end / size + inward + along * cut)
    return np.array(corners)


def _on_a_face(vertex: Array, faces: list[Joint]) -> bool:
    return any(np.array_equal(vertex, end) for j in faces for end in (j.inner, j.outer))


def _footing(joint: Joint, size: float, inset: float) -> Array:
    """Return a slab under a springing, wider than the joint by its length on both sides."""
    into = side(joint, joint.bears) * joint.normal
    span = joint.tangent * joint.length / size
    ends = np.array([joint.inner / size - span, joint.outer / size + span]) - into * inset
    return np.concatenate([ends, ends[::-1] - into * joint.length / size])


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
    takes_forces=True,
    tells_forces=True,
    usual_sweeps=10,
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
