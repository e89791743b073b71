"""What is known of pairs of bodies in space: their friction, and gaps as they were drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import FaceJoint, SpatialAssembly
from blocksim.engines.solid import MOST_FRICTION
from blocksim.engines.solid.bodies import Bodies
from blocksim.engines.solid.hulls import Hulls
from blocksim.engines.solid.meeting import Points, apart, meet, near

ALONG = 0.99
"""Cosine from which on a point of contact is one of a joint."""
ROUNDED = 9e-3
"""How deep edges that share no joint come into each other, over the thinner of two hulls."""


class FrictionBetween:
    """Friction between hulls: of their joint where they have one, else that of all."""

    def __init__(self, problem: Problem[SpatialAssembly], hulls: Hulls) -> None:
        self._all, self._bodies = min(problem.mu, MOST_FRICTION), body_of(hulls)
        self._own: dict[tuple[int, int], float] = {}
        for joint, mu in zip(problem.assembly.joints, problem.friction.tolist(), strict=True):
            if joint.friction is not None:
                self._own[min(sides := sides_of(joint)), max(sides)] = min(mu, MOST_FRICTION)

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


def as_built(bodies: Bodies, reach: float | Array) -> tuple[Points, NDArray[np.bool_]]:
    """Return points at which hulls are within reach as built, and which are of a joint."""
    hulls = bodies.hulls.placed(*bodies.built)
    ways = np.broadcast_to(reach, len(hulls.owner))
    pairs = near(hulls, ways)
    points = meet(hulls, pairs, ways[pairs].sum(axis=1))
    normals: dict[tuple[int, ...], list[Array]] = {}
    for each in bodies.problem.assembly.joints:
        normals.setdefault(tuple(sorted(sides_of(each))), []).append(each.normal)
    body = body_of(hulls)
    sides = np.sort(np.stack([body[points.before], body[points.after]]), axis=0).T.tolist()
    along = [
        np.abs(normals.get(tuple(side), np.zeros((1, 3))) @ normal).max() > ALONG
        for side, normal in zip(sides, points.normals, strict=True)
    ]
    return points, np.array(along, dtype=bool)


class DrawnApart:
    """Gaps of joints as they are drawn, which count as none, and edges, which are rounded.

    Hulls that touch as they are drawn and have no joint there, along an edge or at a corner,
    bear nothing. Sharp as they are drawn, they would wedge as soon as both slide by a hair:
    one along the other's face, the other across it.
    """

    def __init__(self, bodies: Bodies) -> None:
        self._count, assembly = len(bodies.hulls.owner), bodies.problem.assembly
        widest = max((abs(each.gap) for each in assembly.joints), default=0.0) / assembly.size
        hulls, reach = bodies.hulls.placed(*bodies.built), widest + 1e-6
        pairs = near(hulls, np.full(self._count, reach))
        pairs = pairs[apart(hulls, pairs) <= 2 * reach]
        self._keys = self._pairs(*pairs.T)
        self._gaps = np.full(len(self._keys), -np.inf)
        points, joined = as_built(bodies, reach)
        points = points.at(joined)
        place = np.searchsorted(self._keys, self._pairs(points.before, points.after))
        np.maximum.at(self._gaps, place, points.gaps)
        edges = np.isinf(self._gaps)
        self._gaps[edges] = 0.0
        self._rounded = np.where(edges, ROUNDED * hulls.thickness[pairs].min(axis=1), 0.0)

    def _pairs(self, one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.int64]:
        return np.minimum(one, other) * self._count + np.maximum(one, other)

    def at(self, points: Points) -> tuple[Array, Array]:
        """Return the gap of each point as drawn, and how deep its edge is rounded."""
        if not len(self._keys):
            return np.zeros(len(points.gaps)), np.zeros(len(points.gaps))
        keys = self._pairs(points.before, points.after)
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        known = self._keys[at] == keys
        return np.where(known, self._gaps[at], 0.0), np.where(known, self._rounded[at], 0.0)
