"""What contacts bore in the last step, for the points of this one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.points import JointPoints
from blocksim.engines.solid.between import sides_of
from blocksim.engines.solid.meeting import Points

SAME = 1e-6
"""Distance of points that are the same [size]."""
OPEN = 100.0
"""How much farther away a point of contact counts for its gap, over that gap."""


class Borne(NamedTuple):
    """Points of a step, and the forces there, (points, 3), along their axes."""

    points: Points
    forces: Array

    @classmethod
    def nothing(cls, points: Points) -> Borne:
        """Return no forces at points."""
        return cls(points, np.zeros((len(points.gaps), 3)))

    def at(self, points: Points, body: NDArray[np.int64]) -> Array:
        """Return the forces at the points of the next step, (points, 3).

        As a corner slides over the rim of a face its point ends, and others begin. What a
        point bore that is no more goes on to the nearest closed one of the same two bodies.

        `body`, (hulls,): Of which body each is part.
        """
        found = np.zeros((len(points.gaps), 3))
        _, was, now = np.intersect1d(self.points.keys, points.keys, return_indices=True)
        # The ways across jump where a normal is as near to one axis as to another.
        turns = np.matmul(points.axes[now], self.points.axes[was].transpose(0, 2, 1))
        found[now] = np.einsum("pij,pj->pi", turns, self.forces[was])
        lost = self.forces[:, 0] > 0
        lost[was] = False
        if not lost.any():
            return found
        left = self.points.at(lost)
        were, are = (np.stack([body[each.before], body[each.after]]) for each in (left, points))
        along, against = (
            (were[:, :, None] == each[:, None]).all(axis=0) for each in (are, are[::-1])
        )
        apart = np.linalg.norm(left.places[:, None] - points.places[None], axis=2)
        apart += OPEN * np.abs(points.gaps)
        apart[~(along | against)] = np.inf
        each = np.flatnonzero(np.isfinite(apart).any(axis=1))
        nearest = apart[each].argmin(axis=1) if len(each) else each
        pushes = np.einsum("pi,pij->pj", self.forces[lost][each], left.axes[each])
        pushes[against[each, nearest]] *= -1.0
        np.add.at(found, nearest, np.einsum("pij,pj->pi", points.axes[nearest], pushes))
        return found


def handed(
    forces: Array, contacts: JointPoints, points: Points, body: NDArray[np.int64]
) -> Borne:
    """Return the forces at points of joints, (points, 3), as those of points that are found.

    `body`, (hulls,): Of which body each is part.
    """
    assembly = contacts.problem.assembly
    places, axes = assembly.points / assembly.size, contacts.axes[contacts.joint]
    pushes = np.einsum("pi,pij->pj", forces, axes)
    joined = np.array([sides_of(each) for each in assembly.joints]).reshape(-1, 2)
    joined = joined[contacts.joint]
    sides = np.stack([body[points.before], body[points.after]], axis=1)
    ours, theirs = np.sort(sides, axis=1), np.sort(joined, axis=1)
    borne = Borne.nothing(points)
    for at, (place, push) in enumerate(zip(places, pushes, strict=True)):
        # Points of other joints may lie at the same place, of the same blocks, too.
        near = np.linalg.norm(points.places - place, axis=1) < SAME
        near &= (ours == theirs[at]).all(axis=1)
        along = np.where(near, np.abs(points.normals @ axes[at, 0]), 0.0)
        if near.any():
            best = int(along.argmax())
            sign = 1.0 if joined[at, 1] == sides[best, 1] else -1.0
            borne.forces[best] += sign * points.axes[best] @ push
    return borne
