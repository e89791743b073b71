"""Blocks in space as bodies of MuJoCo."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.engines.mujocoblocks import (
    ORDER,
    Jointed,
    rubble_of,
    spec_of,
    with_body,
)
from blocksim.engines.polyhedra import Polyhedra


class Spatial(Polyhedra, Jointed):
    """The blocks of a problem in space as free bodies; see `mujocomotion`."""

    @property
    def inertia(self) -> Array:  # type: ignore[override]
        """Mass along each axis, and moments about a body's own, (blocks, 6)."""
        return self.bodies.inertia

    @property
    def masses(self) -> Array:
        """The same of each velocity."""
        return self.inertia.ravel()

    def free(self) -> tuple[Any, list[Any]]:
        """Return a model of free bodies, without shapes, and the bodies."""
        spec, found = spec_of(self.problem.gravity, self.masses), list[Any]()
        turns = self.quaternions[:, ORDER]
        for index, (mass, _, _, *moments) in enumerate(self.bodies.inertia.tolist()):
            centre = self.bodies.built.centres[index].tolist()
            body = with_body(spec, mass, moments, pos=centre, quat=turns[index].tolist())
            body.add_freejoint()
            found.append(body)
        return spec, found

    def rubble(self) -> Any:
        """Return a model of the blocks as they are, what they stand on and the floor."""
        spec, bodies = self.free()
        hulls = self.bodies.hulls
        known = [
            (spec.worldbody if owner == SUPPORT else bodies[owner], corners)
            for owner, support, corners in zip(
                hulls.owner, hulls.support, hulls.corners, strict=True
            )
            if owner != SUPPORT or support >= 0
        ]
        return rubble_of(spec, known, {"pos": [0.0, 0.0, self.level]}, self.problem.mu)

    def poses(self, places: Array, zero: Array) -> Array:
        """Return centres and rotation vectors since they were built, (blocks, 6)."""
        now, was = places.reshape(-1, 7), zero.reshape(-1, 7)
        turned = _turns(now) * _turns(was).inv()
        return np.hstack([self.built[:, :3] + now[:, :3] - was[:, :3], turned.as_rotvec()])

    def placed(self, poses: Array) -> Array:
        """Return centres and quaternions at poses."""
        turns = Rotation.from_matrix(self.place(poses).turns[:-1]).as_quat()
        return np.hstack([poses[:, :3], turns[:, ORDER]]).ravel()

    def rates(self, places: Array, moved: Array) -> Array:
        """Return velocities along and about the axes, (blocks, 6)."""
        found = moved.reshape(-1, 6).copy()
        found[:, 3:] = _turns(places.reshape(-1, 7)).apply(found[:, 3:])
        return found

    def loads(self, places: Array) -> Array | None:
        """Return loads besides gravity, moments about bodies' own axes."""
        now = places.reshape(-1, 7)
        since = _turns(now) * Rotation.from_quat(self.quaternions).inv()
        found = self.along(np.hstack([now[:, :3], since.as_rotvec()]))
        if found is None:
            return None
        found[:, 3:] = _turns(now).inv().apply(found[:, 3:])
        return found.ravel()


def _turns(places: Array) -> Rotation:
    """Return rotations of coordinates (blocks, 7)."""
    return Rotation.from_quat(places[:, [4, 5, 6, 3]])
