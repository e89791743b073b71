"""Where the two blocks of a joint touch, wherever they have moved.

Each joint has two contacts, at its inner and its outer end. At either end the two corners
lie side by side once the joint has slipped: the one that lies over the other block's face
touches that face, whose normal it takes. A face that reaches beyond its joint goes on doing
so. That ends where the faces no longer lie over each other or have turned far apart.

A corner on a face has both its contacts in the corner. It is over when the corner leaves the
face, and when its block has turned until another of its edges lies on it.

Points and directions are complex numbers, x + iy: a product turns them, and that of one with
the conjugate of another is their scalar product and, times i, their cross product.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.corners import NEAR, turns

Complex = NDArray[np.complex128]

DEEPEST = 0.05
"""Overlap in joint lengths beyond which two faces no longer touch but have passed."""
WIDEST = 0.98
"""Cosine of the angle between two faces from which they no longer form a joint: other faces
of the blocks may then touch first."""
BEFORE = 0.03
"""Turn by which a corner is given up before another edge comes down: no step goes farther."""
INWARDS = np.array([1.0, -1.0])
"""Along a joint, from its inner and from its outer end."""


@dataclass(frozen=True, eq=False)
class Touch:
    """Contacts at one instant.

    `gap`, (joints, 2): At the inner and outer end, below 0 where blocks overlap.
    `rows`, (joints, 4, 6): Velocities of `after` relative to `before` from those of both
        blocks, along the normals of the two contacts, then along their tangents.
    `faces`, (3, pairs): With which faces polygons touch that have met, as `Polygons.touch`
        takes them.
    """

    gap: Array
    rows: Array
    faces: NDArray[np.int64] | None = None


class Geometry:
    """Corners of the joints of an assembly, carried by their blocks."""

    def __init__(self, assembly: Assembly) -> None:
        joints = assembly.joint_arrays
        self.before, self.after = joints.before, joints.after
        sides, tangent = assembly.sides, in_one(joints.tangent)
        faces, centres = in_one(faces_at_joints(assembly)), in_one(assembly.built)
        # Both corners of each face, then its direction, all of which a block turns alike.
        turned = np.empty((*sides.shape, 3), dtype=np.complex128)
        turned[..., :2] = faces.swapaxes(0, 1) - centres[sides, None]
        turned[..., 2] = tangent
        self._sides, self._turned = sides.ravel(), turned.reshape(-1, 3)
        lengths = ((faces[..., 1] - faces[..., 0]) * tangent[:, None].conj()).real
        self._length = lengths[:, 0]
        shorter, longer = np.minimum(*lengths.T), np.maximum(*lengths.T)
        self._deepest: Array = DEEPEST * np.where(joints.is_corner, longer, shorter)
        # Of `before` less, of `after` more, of the ground nothing.
        self._moves = np.where(sides == SUPPORT, 0.0, [[-1.0], [1.0]]).T
        self._corners = np.flatnonzero(joints.is_corner)
        self._carried_by_after = joints.carrier[self._corners, None] == 1
        turns = np.array([turns_of(assembly, int(index)) for index in self._corners]).reshape(
            -1, 2
        )
        self._turns: Array = turns - np.minimum(turns / 2, BEFORE)

    def touch(self, poses: Array) -> tuple[Touch, NDArray[np.bool_]]:
        """Find the contacts, and which joints still are joints.

        `poses`, (blocks, 3): Centres of mass x, y and rotations, scaled.
        Returns `holds`, (joints,).
        """
        count = len(self._length)
        placed = np.concatenate([poses, np.zeros((1, 3))])[self._sides]
        centres = in_one(placed)[:, None]
        turned = self._turned * np.exp(1j * placed[:, 2:])
        one, two = turned[:count, 2:], turned[count:, 2:]
        points = turned[:, :2] + centres
        before, after = points[:count], points[count:]
        apart = after - before
        along = (apart * one.conj()).real
        overlapping = self._length - np.maximum(along[:, 0], 0) + np.minimum(along[:, 1], 0)
        # Over the face of `before` lies the corner of `after` that is nearer to its middle.
        after_over = along * INWARDS >= 0
        holds = (overlapping > 0) & ((one * two.conj()).real[:, 0] > WIDEST)
        if len(self._corners):
            holds[self._corners] = self._on_face(one, two, apart)
            after_over[self._corners] = ~self._carried_by_after
        tangents: Complex = np.where(after_over, one, two)
        gap = (apart.conj() * tangents).imag
        holds &= gap.min(axis=1) > -self._deepest
        at: Complex = np.where(after_over, after, before)
        rows = rows_at(at, tangents, centres.reshape(2, count).T, self._moves)
        return Touch(gap=gap, rows=rows), holds

    def _on_face(self, one: Complex, two: Complex, apart: Complex) -> NDArray[np.bool_]:
        """Tell which corners are on their faces still, and touch them with nothing else.

        `one`, `two`, (joints, 1) complex: Directions of the faces of `before` and `after`.
        `apart`, (joints, 2) complex: From the corners of `before` to those of `after`.
        """
        one, two, apart = one[self._corners], two[self._corners], apart[self._corners]
        after = self._carried_by_after
        along = (apart * np.where(after, two, one).conj()).real
        inwards = np.where(after, -1.0, 1.0) * INWARDS
        turn = (one.conj() * two)[:, 0]
        return (
            (along * inwards >= 0).all(axis=1)
            & (turn.real > WIDEST)
            & (turn.imag > -self._turns[:, 0])
            & (turn.imag < self._turns[:, 1])
        )


def rows_at(points: Complex, tangents: Complex, centres: Complex, moves: Array) -> Array:
    """Return velocities at two contacts of each pair from those of both blocks, as in `Touch`.

    `points`, `tangents`, (pairs, 2) complex: Of the two contacts.
    `centres`, (pairs, 2) complex: Centres of mass of both blocks.
    `moves`, (pairs, 2): -1 for the first block, 1 for the second, 0 for what stays.
    """
    axes = np.concatenate([-1j * tangents, tangents], axis=1)[..., None]
    arms = np.concatenate([points, points], axis=1)[..., None] - centres[:, None]
    rows = np.empty((len(points), 4, 2, 3))
    rows[..., 0], rows[..., 1] = axes.real, axes.imag
    rows[..., 2] = (arms.conj() * axes).imag
    rows *= moves[:, None, :, None]
    return rows.reshape(len(points), 4, 6)


def in_one(points: Array) -> Complex:
    """Return x + iy, shape (...), of points of shape (..., 2 or more)."""
    return points[..., 0] + 1j * points[..., 1]


def faces_at_joints(assembly: Assembly) -> Array:
    """Return ends of the faces of both blocks of each joint, (joints, 2, 2, 2), scaled.

    They lie on the line of the joint. Where it ends though neither face does, as of a joint
    that is given and not found, both faces end with it.
    """
    joints = assembly.joint_arrays
    if (joints.faces == joints.ends[:, None]).all() and not joints.is_corner.any():
        return joints.faces
    start, along = joints.ends[:, None, :1], joints.tangent[:, None, None]
    as_built = np.stack([np.zeros_like(joints.length), joints.length], axis=1)[:, None]
    where = ((joints.faces - start) * along).sum(axis=-1)
    corner = joints.is_corner
    bounds = np.stack([where[:, :, 0].max(axis=1), where[:, :, 1].min(axis=1)], axis=1)
    ends = np.abs(bounds[:, None] - as_built) <= NEAR
    kept = np.where(np.abs(where - as_built) <= NEAR, as_built, where)
    found = np.where(ends, kept, as_built)
    # A corner's face may end in it, and does not end before.
    both = np.stack([np.minimum(where[:, :, 0], 0), np.maximum(where[:, :, 1], 0)], axis=-1)
    carries = np.arange(2) == joints.carrier[:, None]
    of_corner = np.where(carries[:, :, None], both, 0.0)
    found = np.where(corner[:, None, None], of_corner, found)
    points = start + found[..., None] * along
    # As they are given, to the last digit, where the joint is all there is.
    exact = np.broadcast_to(joints.ends[:, None], points.shape)
    return np.where((found == as_built)[..., None], exact, points)


def turns_of(assembly: Assembly, joint: int) -> tuple[float, float]:
    """Sines of the turns of `after` against `before` that a corner allows, either way."""
    made, joints = assembly.joints[joint], assembly.joint_arrays
    sign = 1.0 if joints.carrier[joint] == 0 else -1.0
    polygons = assembly.polygons_at(made, 1 if sign > 0 else 0)
    normal, tangent = sign * made.normal, sign * made.tangent
    down, up = turns(made.inner, normal, tangent, polygons, assembly.size)
    found = (down, up) if sign > 0 else (up, down)
    return math.sin(min(found[0], math.pi / 2)), math.sin(min(found[1], math.pi / 2))
