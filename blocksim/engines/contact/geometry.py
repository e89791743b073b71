"""Where the two blocks of a joint touch, wherever they have moved.

Each joint has two contacts, at its inner and its outer end. At either end the two corners
lie side by side once the joint has slipped: the one that lies over the other block's face
touches that face, whose normal it takes. A face that reaches beyond its joint goes on doing
so. That ends where the faces no longer lie over each other or have turned far apart.

A corner on a face has both its contacts in the corner. It is over when the corner leaves the
face, and when its block has turned until another of its edges lies on it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.corners import NEAR, turns

DEEPEST = 0.05
"""Overlap in joint lengths beyond which two faces no longer touch but have passed."""
WIDEST = 0.98
"""Cosine of the angle between two faces from which they no longer form a joint: other faces
of the blocks may then touch first."""


@dataclass(frozen=True, eq=False)
class Touch:
    """Contacts at one instant.

    Parameters
    ----------
    gap : (joints, 2) float
        At the inner and outer end, below 0 where blocks overlap.
    rows : (joints, 4, 6) float
        Velocities of `after` relative to `before` from those of both blocks, along the
        normals of the two contacts, then along their tangents.
    """

    gap: Array
    rows: Array


class Geometry:
    """Corners of the joints of an assembly, carried by their blocks."""

    def __init__(self, assembly: Assembly) -> None:
        size, count = assembly.size, len(assembly.joints)
        joints = assembly.joint_arrays
        self.before, self.after = joints.before, joints.after
        # The ground is a block at the origin that stays, index -1.
        centres = np.vstack([assembly.centres / size, np.zeros(2)])
        self._sides = np.concatenate([self.before, self.after])
        faces = faces_at_joints(assembly)
        self._arms = np.concatenate([faces[:, 0], faces[:, 1]]) - centres[self._sides][:, None]
        self._axes = np.concatenate([joints.tangent, joints.tangent])
        lengths = ((faces[:, :, 1] - faces[:, :, 0]) * joints.tangent[:, None]).sum(axis=-1)
        self._length = lengths[:, 0]
        shorter, longer = lengths.min(axis=1), lengths.max(axis=1)
        self._deepest: Array = DEEPEST * np.where(joints.is_corner, longer, shorter)
        self._moves = (self._sides != SUPPORT).astype(np.float64)[:, None, None]
        self._signs = np.repeat([-1.0, 1.0], count)[:, None, None]
        self._corners = np.flatnonzero(joints.is_corner)
        self._carried_by_after = joints.carrier[self._corners, None] == 1
        self._turns = np.array(
            [turns_of(assembly, int(index)) for index in self._corners]
        ).reshape(-1, 2)

    def touch(self, poses: Array) -> tuple[Touch, NDArray[np.bool_]]:
        """Find the contacts, and which joints still are joints.

        Parameters
        ----------
        poses : (blocks, 3) float
            Centres of mass x, y and rotations, scaled.

        Returns
        -------
        touch : Touch
        holds : (joints,) bool
        """
        count = len(self._length)
        placed = np.vstack([poses, np.zeros(3)])[self._sides]
        cos, sin = np.cos(placed[:, 2])[:, None], np.sin(placed[:, 2])[:, None]
        corners = np.empty((2 * count, 2, 2))
        corners[:, :, 0] = cos * self._arms[:, :, 0] - sin * self._arms[:, :, 1]
        corners[:, :, 1] = sin * self._arms[:, :, 0] + cos * self._arms[:, :, 1]
        corners += placed[:, None, :2]
        x, y = self._axes.T
        tangents = np.stack(
            [cos[:, 0] * x - sin[:, 0] * y, sin[:, 0] * x + cos[:, 0] * y], axis=-1
        )
        first, second = corners[:count], corners[count:]
        apart = second - first
        along = np.matmul(apart, tangents[:count, :, None])[:, :, 0]
        overlapping = self._length - np.maximum(along[:, 0], 0) + np.minimum(along[:, 1], 0)
        holds = overlapping > 0
        # Over the face of `before` lies the corner of `after` that is nearer to its middle.
        after_over = along * np.array([1.0, -1.0]) >= 0
        holds &= (tangents[:count] * tangents[count:]).sum(axis=-1) > WIDEST
        if len(self._corners):
            holds[self._corners] = self._on_face(tangents, apart)
            after_over[self._corners] = ~self._carried_by_after
        tangent = np.where(
            after_over[:, :, None], tangents[:count, None], tangents[count:, None]
        )
        normal = np.stack([tangent[:, :, 1], -tangent[:, :, 0]], axis=-1)
        gap = (apart * normal).sum(axis=-1)
        holds &= gap.min(axis=1) > -self._deepest
        point = np.where(after_over[:, :, None], second, first)
        arm = np.concatenate([point, point]) - placed[:, None, :2]

        def rates(axis: Array) -> Array:
            both = np.concatenate([axis, axis])
            turn = arm[:, :, :1] * both[:, :, 1:] - arm[:, :, 1:] * both[:, :, :1]
            parts = np.concatenate([both, turn], axis=-1) * self._signs * self._moves
            return np.concatenate([parts[:count], parts[count:]], axis=-1)

        rows = np.concatenate([rates(normal), rates(tangent)], axis=1)
        return Touch(gap=gap, rows=rows), holds

    def _on_face(self, tangents: Array, apart: Array) -> NDArray[np.bool_]:
        """Tell which corners are on their faces still, and touch them with nothing else."""
        count, chosen = len(self._length), self._corners
        one, two = tangents[chosen], tangents[count + chosen]
        face = np.where(self._carried_by_after, two, one)
        along = np.matmul(apart[chosen], face[:, :, None])[:, :, 0]
        inwards = np.where(self._carried_by_after, -1.0, 1.0) * np.array([1.0, -1.0])
        turned = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        return (
            (along * inwards >= 0).all(axis=1)
            & ((one * two).sum(axis=1) > WIDEST)
            & (turned > -self._turns[:, 0])
            & (turned < self._turns[:, 1])
        )


def faces_at_joints(assembly: Assembly) -> Array:
    """Return ends of the faces of both blocks of each joint, (joints, 2, 2, 2), scaled.

    They lie on the line of the joint. Where it ends though neither face does, as of a joint
    that is given and not found, both faces end with it.
    """
    joints = assembly.joint_arrays
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
