"""Poses of bodies: where their corners are, what they weigh there, and their mirror image."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.suite.scene import Scene

PLANAR, SPATIAL = 3, 7
"""Numbers of a pose: x, y and angle; x, y, z and a quaternion w, x, y, z."""
NEARLY = 1e-6
"""How far corners may be from their mirror images, in sizes of the mean body."""


def turned(arms: Array, poses: Array) -> Array:
    """Turn arms as poses say, (..., d) float for poses (..., 3 or 7)."""
    if poses.shape[-1] == PLANAR:
        cos, sin = np.cos(poses[..., 2]), np.sin(poses[..., 2])
        x, y = arms[..., 0], arms[..., 1]
        return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
    quaternion = poses[..., 3:]
    length = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    unit = quaternion / np.where(length > 0, length, 1.0)
    real, axis = unit[..., :1], unit[..., 1:]
    once = 2 * np.cross(axis, arms)
    return arms + real * once + np.cross(axis, once)


class Bodies:
    """What moves in a scene, its corners as arrays.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, moving = scene, scene.moving
        corners = [np.concatenate(body.shapes) for body in moving]
        self._owner = np.repeat(np.arange(len(moving)), [len(each) for each in corners])
        self._centres = np.array([body.centre for body in moving])
        self._arms = np.concatenate(corners) - self._centres[self._owner]
        self._mass = np.array([body.mass for body in moving])

    @cached_property
    def start(self) -> Array:
        """Poses at the start, (bodies, 3 or 7) float."""
        still = [0.0] if self.scene.dimensions == 2 else [1.0, 0.0, 0.0, 0.0]
        return np.column_stack([self._centres, np.tile(still, (len(self._centres), 1))])

    def corners(self, poses: Array) -> Array:
        """Return where all corners are, (..., corners, 2 or 3) float."""
        of = poses[..., self._owner, :]
        return of[..., : self.scene.dimensions] + turned(self._arms, of)

    def ways(self, poses: Array) -> Array:
        """Return how far each corner is from its start, (..., corners) float [m]."""
        return np.linalg.norm(self.corners(poses) - self.corners(self.start), axis=-1)

    def lifted(self, poses: Array) -> Array:
        """Return the potential energy over all weights, (frames,) float [m]."""
        scene, dimensions = self.scene, self.scene.dimensions
        weight = self._mass[:, None] * scene.gravity
        energy = -(poses[..., :dimensions] * weight).sum(axis=(-2, -1))
        names = [body.name for body in scene.moving]
        for push in scene.pushes:
            on = names.index(push.body)
            arm = push.point - self._centres[on]
            at = poses[:, on, :dimensions] + turned(arm, poses[:, on])
            energy = energy - at @ push.force
        return energy / (self._mass.sum() * np.linalg.norm(scene.gravity))

    @cached_property
    def _image(self) -> NDArray[np.int64] | None:
        """The corner that is each one's mirror image across a vertical plane; None if none."""
        scene = self.scene
        if scene.pushes or scene.gravity[0] != 0:
            return None
        start = self.corners(self.start)
        away = np.linalg.norm(self.mirrored(start)[:, None] - start, axis=-1)
        nearest = away.argmin(axis=1)
        near = away[np.arange(len(start)), nearest] < NEARLY * scene.size
        return nearest if near.all() else None

    def mirrored(self, corners: Array) -> Array:
        """Mirror corners across the plane x = that of the common centre of mass."""
        middle = self._mass @ self._centres[:, 0] / self._mass.sum()
        flip = np.ones(self.scene.dimensions)
        flip[0] = -1
        return corners * flip + 2 * middle * (flip < 0)

    def asymmetry(self, poses: Array) -> float | None:
        """Return how far corners are from the mirror images of others at the end [m].

        None where the scene is no mirror image of itself.
        """
        if self._image is None:
            return None
        at = self.corners(poses[-1])
        return float(np.linalg.norm(self.mirrored(at) - at[self._image], axis=-1).max())
