"""What is known of pairs of bodies in space: their friction, and gaps as they were drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.space.assembly import FaceJoint
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.engines.solid.bodies import Bodies
from blocksim.engines.solid.hulls import Hulls
from blocksim.engines.solid.meeting import Points, meet, near

ROUGH = 1e3
"""Friction without a bound is taken as this."""


class FrictionBetween:
    """Friction between hulls: of their joint where they have one, else that of all.

    Parameters
    ----------
    problem : SpatialProblem
    hulls : Hulls
    """

    def __init__(self, problem: SpatialProblem, hulls: Hulls) -> None:
        self._all, self._bodies = min(problem.mu, ROUGH), body_of(hulls)
        self._own: dict[tuple[int, int], float] = {}
        for joint, mu in zip(problem.assembly.joints, problem.friction.tolist(), strict=True):
            if joint.friction is not None:
                self._own[min(sides := sides_of(joint)), max(sides)] = min(mu, ROUGH)

    def at(self, points: Points) -> Array:
        """Return the friction coefficient at each point."""
        found = np.full(len(points.gaps), self._all)
        if self._own:
            bodies = self._bodies
            pairs = np.sort(np.stack([bodies[points.before], bodies[points.after]]), axis=0)
            found[:] = [self._own.get((a, b), self._all) for a, b in pairs.T.tolist()]
        return found


def body_of(hulls: Hulls) -> NDArray[np.int64]:
    """Return a number for the body of each hull: of blocks, then below -1 of supports."""
    return np.where(hulls.owner == SUPPORT, -2 - hulls.support, hulls.owner)


def sides_of(joint: FaceJoint) -> tuple[int, int]:
    """Return the same numbers of the two sides of a joint."""
    fixed = -1 if joint.support is None else -2 - joint.support
    first, second = (fixed if each == SUPPORT else each for each in (joint.before, joint.after))
    return first, second


class DrawnApart:
    """Gaps of joints as they are drawn, which count as none.

    Parameters
    ----------
    problem : SpatialProblem
    bodies : Bodies
    """

    def __init__(self, problem: SpatialProblem, bodies: Bodies) -> None:
        hulls = bodies.hulls.placed(*bodies.built)
        self._count = len(hulls.owner)
        joints = problem.assembly.joints
        widest = max((abs(each.gap) for each in joints), default=0.0) / problem.assembly.size
        reach = np.full(self._count, widest + 1e-6)
        pairs = near(hulls, reach)
        points = meet(hulls, pairs, reach[pairs].sum(axis=1))
        keys = self._pairs(points)
        self._keys, place = np.unique(keys, return_inverse=True)
        self._gaps = np.full(len(self._keys), -np.inf)
        np.maximum.at(self._gaps, place, points.gaps)
        # What touches nothing as it is drawn has its gap.
        joined = {tuple(sorted(sides_of(each))) for each in joints}
        bodies_of = body_of(hulls)
        sides = np.sort(
            np.stack(
                [bodies_of[self._keys // self._count], bodies_of[self._keys % self._count]]
            ),
            axis=0,
        ).T.tolist()
        self._gaps[[tuple(each) not in joined for each in sides]] = 0.0

    def _pairs(self, points: Points) -> NDArray[np.int64]:
        first, second = (f(points.before, points.after) for f in (np.minimum, np.maximum))
        return first * self._count + second

    def at(self, points: Points) -> Array:
        """Return the gap as drawn between the hulls of each point."""
        if not len(self._keys):
            return np.zeros(len(points.gaps))
        keys = self._pairs(points)
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return np.where(self._keys[at] == keys, self._gaps[at], 0.0)
