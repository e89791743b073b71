"""What onset test and moving run ask of a problem, in the plane and in space."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import overlap_and_slip
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.parting import overlap_and_slip_in_space
from blocksim.engines.base import Settings, World, trusted
from blocksim.limit import equilibrium, least_motion

STICKS = 1e-4
"""Slip over the largest motion of a joint up to which a mechanism does not slide.

Walls of tall blocks slide by a hundredth as they part."""
WORK = 0.99
"""Work of the loads, over what goes into a motion, from which on they drive it."""
SURE = 1e-4
"""Residual over the accelerations at which blocks in space surely move."""


class Looking:
    """A problem as it is looked at where blocks are held, and where they move.

    `asked`: Whose forces are asked for, where the engine knows other blocks.

    It has:
    `far`: How far the farthest block is from the origin [size].
    """

    def __init__(self, problem: Problem[Any], asked: Problem[Any] | None = None) -> None:
        self._problem, self._asked, self._in_space = problem, asked or problem, problem.in_space
        self.assembly = problem.assembly
        self.far = float(np.abs(self.assembly.centres).max()) / self.assembly.size

    def _shares(self, poses: Array) -> tuple[float, float]:
        found = overlap_and_slip_in_space if self._in_space else overlap_and_slip
        return found(self.assembly, poses)

    def overlap(self, poses: Array) -> float:
        """Return the deepest overlap at a joint, as a share of the largest motion of one."""
        return self._shares(poses)[0]

    def slip(self, poses: Array) -> float:
        """Return the largest slip at a joint that stays closed, likewise."""
        return self._shares(poses)[1]

    def driven(self, built: Array, rates: Array) -> bool:
        """Tell whether the loads do the work that a motion takes, from rest over one step."""
        assembly = self.assembly
        if self._in_space:
            inner = np.array([block.gyration for block in assembly.blocks]) / assembly.size**2
            spin = np.einsum("bi,bij,bj->b", rates[:, 3:], inner, rates[:, 3:])
            masses = assembly.weights / self._problem.unit_force
            moving = float(masses @ ((rates[:, :3] ** 2).sum(axis=1) + spin))
        else:
            moving = float((assembly.masses * rates**2).sum())
        return float((self._problem.applied_forces(built) * rates).sum()) > WORK * moving

    def equilibrium(self) -> tuple[bool, Array | None]:
        """Tell whether forces of equilibrium may exist, and return them [mean weights].

        (joints, 2, 2), in space (points, 3), along normals and across.
        """
        if not self._in_space:
            forces = equilibrium(self._asked).forces
            return forces is not None, forces
        found = equilibrium(self._problem)
        forces = found.point_forces
        if forces is not None:
            forces = forces / self._problem.unit_force
        return found.exists is not False, forces

    def least(self) -> Array | None:
        """Return such forces that leave least acceleration; in space joints that slide open."""
        if self._in_space:
            from blocksim.engines.solid.bodies import Bodies
            from blocksim.engines.solid.dilation import dilating
            from blocksim.engines.solid.stepping import at_rest

            return dilating(at_rest(Bodies(self._problem)))
        least = least_motion(self._asked)
        return None if least is None else least.forces

    def trusts(self, world: World, settings: Settings, largest: float) -> bool:
        """Tell whether contacts were solved well enough for accelerations of that size."""
        if self._in_space and world.quality().residual is not None:
            settings = replace(settings, residual=max(SURE * largest, settings.still))
        return trusted(world, settings)
