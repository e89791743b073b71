"""Blocks in space as engines with shapes of their own need them.

While joints are joints, all that touches are their corners, each on a plate on the other block:
a face presses within its polygon by forces at its corners (`JointPoints`). A corner is of the
block whose rim ends there, or whose edge or corner it is, and the plate lies on a face of the
other. Each touches its plate and nothing else. Once blocks may meet others they are the
polyhedra they are, on their supports and a floor.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import FaceJoint, SpatialAssembly
from blocksim.blocks.space.polyhedron import frame
from blocksim.common.later import transform
from blocksim.engines.energy import Balance
from blocksim.engines.solid.between import as_built
from blocksim.engines.solid.bodies import Bodies, Place
from blocksim.engines.solids import LARGEST, Faces, obj_text

SQUARE = 1e-6
"""Cosine from 1 up to which a face lies along a joint."""
BEYOND, THIN = 0.5, 0.2
"""How far a plate reaches beyond the corners on it, and its thickness, over their spread."""
LEAST = 0.02
"""Least spread that is taken [size]."""
FREE = 0.05
"""Displacement up to which joints are all that touches, less where others are near [size]."""
TOUCHING = 1e-6
"""Gap up to which what has no joint touches along a rim as it was built [size]."""


class Touch(NamedTuple):
    """What touches at a joint.

    `plate`, `corners`: Blocks with the plate and with the corners, or `SUPPORT`.
    `sign`: 1 where the corners are on `after` of the joint, else -1.
    `places`, (k, 3): Of the corners, in the order of the joint's points [size].
    `axes`, (3, 3): Columns: two along the plate, and its normal towards the block with the
        corners.
    `spread`: How far the corners are from their mean.
    """

    joint: int
    plate: int
    corners: int
    sign: float
    places: Array
    axes: Array
    spread: float

    @property
    def normal(self) -> Array:
        """Of the plate, towards the block with the corners, (3,)."""
        return self.axes[:, 2]

    @property
    def half(self) -> list[float]:
        """Half extents of the plate."""
        wide = (1 + BEYOND) * self.spread
        return [wide, wide, THIN * self.spread / 2]


class Polyhedra:
    """Blocks of a problem: frames, masses, loads, energy, what touches, and when all may.

    Poses are centres [size] and rotation vectors since blocks were built, (blocks, 6).

    `loose`: Whether blocks may meet that share no joint.
    `thinnest`: Thickness of the thinnest block [size].
    `largest`: Way in a step that keeps overlaps small [size].
    """

    def __init__(self, problem: Problem[SpatialAssembly]) -> None:
        self.problem, self.assembly = problem, problem.assembly
        self.bodies = Bodies(problem)
        self.built = self.bodies.poses(self.bodies.built)
        hulls = self.bodies.hulls
        self.thinnest = float(hulls.thickness[hulls.owner != SUPPORT].min())
        self.largest = LARGEST * self.thinnest
        self.loose = False

    @property
    def solids(self) -> Self:
        """When blocks may meet others is known here."""
        return self

    @property
    def quaternions(self) -> Array:
        """How blocks are built, along their principal axes, (blocks, 4)."""
        return transform.Rotation.from_matrix(self.bodies.built.turns[:-1]).as_quat()

    def place(self, poses: Array) -> Place:
        """Return where blocks are by their poses."""
        turned = transform.Rotation.from_rotvec(poses[:, 3:]).as_matrix()
        built = self.bodies.built
        return Place(
            np.vstack([poses[:, :3], built.centres[-1:]]),
            np.concatenate([turned @ built.turns[:-1], built.turns[-1:]]),
        )

    def along(self, poses: Array) -> Array | None:
        """Return loads besides gravity along the axes, (blocks, 6); None where none acts."""
        if not self.problem.is_loaded:
            return None
        place = self.place(poses)
        found = self.bodies.pull(place, np.zeros(3))
        found[:, 3:] = np.einsum("bij,bj->bi", place.turns[:-1], found[:, 3:])
        return found

    def balance(self, poses: Array) -> Balance[Array]:
        """Return what looks at the energy, from where blocks are let go."""

        def potential(poses: Array) -> float:
            return self.bodies.potential(self.place(poses))

        def kinetic(poses: Array, velocities: Array) -> float:
            own = velocities.copy()
            own[:, 3:] = np.einsum("bji,bj->bi", self.place(poses).turns[:-1], own[:, 3:])
            return self.bodies.kinetic(own)

        return Balance(potential, kinetic, poses)

    @cached_property
    def touches(self) -> tuple[Touch, ...]:
        """What touches at each joint."""
        return tuple(self._touch(at, joint) for at, joint in enumerate(self.assembly.joints))

    def _touch(self, at: int, joint: FaceJoint) -> Touch:
        """Return the plate on the side that has a face there, and the corners on the other."""
        sign = 1.0
        if not self._has_face(joint, 1.0) and self._has_face(joint, -1.0):
            sign = -1.0
        plate, corners = joint.before, joint.after
        if sign < 0:
            plate, corners = corners, plate
        places = joint.points / self.assembly.size
        spread = float(np.linalg.norm(places - places.mean(axis=0), axis=1).max())
        normal = sign * joint.normal
        axes = np.vstack([frame(normal), normal]).T
        return Touch(at, plate, corners, sign, places, axes, max(spread, LEAST))

    def at_joints(self, values: Array | None) -> list[Array]:
        """Return values at the points of joints, (points,), for each touch; 0 where None."""
        counts = [len(each.places) for each in self.touches]
        every = np.zeros(sum(counts)) if values is None else values
        ends = np.cumsum(counts).tolist()
        return [every[end - count : end] for count, end in zip(counts, ends, strict=True)]

    def within(self, index: int, place: Array, axes: Array) -> tuple[list[float], Array]:
        """Return a place in the frame of a body, and its axes there as a quaternion, (4,)."""
        turn, origin = self.bodies.built.turns[index].T, self.bodies.built.centres[index]
        return (turn @ (place - origin)).tolist(), transform.Rotation.from_matrix(
            turn @ axes
        ).as_quat()

    def _has_face(self, joint: FaceJoint, sign: float) -> bool:
        """Tell whether the block on a side of a joint has a face along it."""
        index = joint.before if sign > 0 else joint.after
        if index != SUPPORT:
            blocks = (self.assembly.blocks[index],)
        elif joint.support is None:
            blocks = self.assembly.supports
        else:
            blocks = (self.assembly.supports[joint.support],)
        faces = [face for block in blocks for hull in block.hulls for face in hull.faces]
        return any(sign * float(face.normal @ joint.normal) > 1 - SQUARE for face in faces)

    @cached_property
    def _free(self) -> float:
        """How far blocks may move before they meet others [size]."""
        points, joined = as_built(self.bodies, FREE)
        gaps = points.gaps[~joined & (points.gaps > TOUCHING)]
        return float(gaps.min(initial=2 * FREE)) / 2

    def update(self, poses: Array) -> None:
        """Look where blocks are, and whether they may meet others."""
        moved = float(self.assembly.displacement(poses - self.built))
        self.loose = self.loose or moved > self._free

    def texts(self) -> tuple[list[str], list[str]]:
        """Return hulls as texts of .obj files: of blocks in their frames, and of supports."""
        hulls = self.bodies.hulls
        owned = [hulls.owner == index for index in range(len(self.assembly.blocks))]
        fixed = np.flatnonzero((hulls.owner == SUPPORT) & (hulls.support >= 0))
        moving = [self._text(np.flatnonzero(its).tolist()) for its in owned]
        return moving, [self._text([hull]) for hull in fixed.tolist()]

    def _text(self, which: list[int]) -> str:
        """Return hulls as the text of an .obj file."""
        hulls = self.bodies.hulls
        known = zip(hulls.corners, hulls.around.tolist(), hulls.many.tolist(), strict=True)
        every: list[tuple[Array, Faces]] = [
            (corners, [way[:count] for way, count in zip(around, many, strict=True) if count])
            for corners, around, many in known
        ]
        return obj_text(every[hull] for hull in which)

    @property
    def level(self) -> float:
        """Height of the floor [size]."""
        hulls = self.bodies.hulls
        return float(hulls.corners[-1, :, 2].max())
