"""Blocks in space as bodies of MuJoCo."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.engines.mujocoblocks import ORDER, Jointed
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

    def release(self, body: Any) -> None:
        """Let a body move."""
        body.add_freejoint()

    def pieces(self) -> tuple[list[tuple[int, Array]], dict[str, list[float]]]:
        """Return the parts of blocks and of supports, and where the floor is."""
        hulls = self.bodies.hulls
        known = zip(hulls.owner.tolist(), hulls.support.tolist(), hulls.corners, strict=True)
        parts = [(at, each) for at, on, each in known if at != SUPPORT or on >= 0]
        return parts, {"pos": [0.0, 0.0, self.level]}

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
