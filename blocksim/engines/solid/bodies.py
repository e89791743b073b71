"""Blocks in space as they move: frames that turn with them, inertia, loads and energy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.later import transform
from blocksim.engines.contact.banded import Bands
from blocksim.engines.solid.hulls import hulls_of
from blocksim.engines.solid.step import Step


class Place(NamedTuple):
    """Where blocks are: centres, (blocks + 1, 3), and frames, (blocks + 1, 3, 3).

    The last row is what is fixed.
    """

    centres: Array
    turns: Array

    def moved(self, way: Array) -> Place:
        """Return the place after ways along x, y, z and about the frames' axes, (blocks, 6)."""
        centres, turns = self.centres.copy(), self.turns.copy()
        centres[:-1] += way[:, :3]
        turns[:-1] = turns[:-1] @ transform.Rotation.from_rotvec(way[:, 3:]).as_matrix()
        return Place(centres, turns)


class Bodies:
    """Blocks of a problem with frames that turn with them, along their principal axes.

    Lengths are in units of the size, masses of the mean block's.
    """

    def __init__(self, problem: Problem[SpatialAssembly]) -> None:
        self.problem, assembly = problem, problem.assembly
        size, weights = assembly.size, assembly.weights
        masses = weights / weights.mean()
        gyration = np.array([block.gyration for block in assembly.blocks]) / size**2
        moments, axes = np.linalg.eigh(gyration)
        # A mirror image is no frame.
        axes[np.linalg.det(axes) < 0, :, 0] *= -1.0
        self.inertia: Array = masses[:, None] * np.hstack([np.ones_like(moments), moments])
        self.root: Array = np.sqrt(self.inertia)
        self.built = Place(
            np.vstack([assembly.centres / size, np.zeros(3)]),
            np.concatenate([axes, np.eye(3)[None]]),
        )
        self.hulls = hulls_of(assembly, axes)
        self.reach: Array = assembly.reach / size
        self.weights = masses
        self._loads = self._acting()

    def _acting(self) -> list[tuple[int, Array, Array]]:
        """Return block, force [mean weights] and arm in its frame of each load at a point."""
        problem, found = self.problem, list[tuple[int, Array, Array]]()
        assembly = problem.assembly
        acting = ((problem.dead, 1.0), (problem.live, problem.load))
        for factor, load in ((factor, load) for loads, factor in acting for load in loads):
            for index, force, arm in assembly.forces_of(load):
                frame = self.built.turns[index].T
                found.append(
                    (index, factor * force / assembly.unit_force, frame @ (arm / assembly.size))
                )
        return found

    def pull(self, place: Place, gravity: Array) -> Array:
        """Return gravity and loads: forces in space, moments in frames, (blocks, 6)."""
        found = np.zeros_like(self.inertia)
        found[:, :3] = self.weights[:, None] * gravity
        for index, force, arm in self._loads:
            found[index, :3] += force
            found[index, 3:] += np.cross(arm, place.turns[index].T @ force)
        return found

    def rows(self, axes: Array, places: Array, sides: NDArray[np.int64], there: Place) -> Array:
        """Return what velocities at points are of scaled ones of both blocks, (points, 3, 12).

        `axes`, (points, 3, 3): The normal into the second block, and two ways across.
        `places`, (points, 3).
        `sides`, (points, 2): Blocks, `SUPPORT` for what is fixed.
        `there`: Where the blocks are.
        """
        arms = places[:, None] - there.centres[sides]
        about = np.cross(arms[:, :, None], axes[:, None])
        about = np.matmul(about, there.turns[sides])
        along = np.broadcast_to(axes[:, None], about.shape)
        found = np.concatenate([along, about], axis=3) / self.root[sides][:, :, None]
        found *= np.where(sides == SUPPORT, 0.0, [-1.0, 1.0])[:, :, None, None]
        return found.transpose(0, 2, 1, 3).reshape(-1, 3, 12)

    def asked(
        self,
        rows: Array,
        sides: NDArray[np.int64],
        drift: Array,
        pull: Array,
        friction: Array,
    ) -> Step:
        """Return what a step asks at points; see `Step`, and `pull` for forces without them."""
        bands = Bands(sides[:, 0], sides[:, 1], len(self.root), each=6)
        return Step(bands, rows, drift, (pull / self.root).ravel(), friction)

    def turning(self, velocities: Array) -> Array:
        """Return what keeps a turning block turning: - w x I w, (blocks, 6)."""
        spin = velocities[:, 3:]
        found = np.zeros_like(velocities)
        found[:, 3:] = -np.cross(spin, self.inertia[:, 3:] * spin)
        return found

    def potential(self, place: Place) -> float:
        """Return the potential energy [mean weights times the size]."""
        centres = place.centres[:-1]
        height = -float((self.weights[:, None] * self.problem.gravity * centres).sum())
        for index, force, arm in self._loads:
            height -= float(force @ (centres[index] + place.turns[index] @ arm))
        return height

    def kinetic(self, velocities: Array) -> float:
        """Return the kinetic energy of velocities in frames, (blocks, 6), likewise."""
        return float((self.inertia * velocities**2).sum() / 2)

    def poses(self, place: Place) -> Array:
        """Return centres and rotation vectors since they were built, (blocks, 6)."""
        turned = place.turns[:-1] @ self.built.turns[:-1].transpose(0, 2, 1)
        return np.hstack(
            [place.centres[:-1], transform.Rotation.from_matrix(turned).as_rotvec()]
        )


def carried(places: Array, block: NDArray[np.int64], found: Place, there: Place) -> Array:
    """Return where places have gone that move with blocks, from one place to another."""
    own = np.einsum("pji,pj->pi", found.turns[block], places - found.centres[block])
    return np.einsum("pij,pj->pi", there.turns[block], own) + there.centres[block]
