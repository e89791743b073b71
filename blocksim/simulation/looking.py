"""What onset test and moving run ask of a problem, in the plane and in space."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from blocksim.blocks.assembly import Array, displacement
from blocksim.blocks.joints import overlap_share, slip_share
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.parting import (
    displacement_in_space,
    overlap_in_space,
    slip_in_space,
)
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.engines.base import FRICTION_CAP, Engine, Settings, World, trusted
from blocksim.engines.solid.bodies import Bodies
from blocksim.engines.solid.coulomb import dilating
from blocksim.engines.solid.stepping import at_rest
from blocksim.limit import equilibrium, least_motion
from blocksim.limit.space import can_rest

SLIPS, STICKS = 0.02, 1e-4
"""Slip over the largest motion of a joint above which a mechanism slides, and below which it
surely does not."""
SURE = 1e-4
"""Residual over the accelerations at which blocks in space surely move."""


class Looking(Protocol):
    """A problem as it is looked at where blocks are held, and where they move."""

    @property
    def far(self) -> float:
        """How far the farthest block is from the origin [size]."""
        ...

    @property
    def asks(self) -> bool:
        """Whether limit analysis can be asked about it."""
        ...

    def displacement(self, moved: Array) -> Array:
        """Return the largest displacement of any corner, of motions (..., blocks, columns)."""
        ...

    def overlap(self, poses: Array) -> float:
        """Return the deepest overlap at a joint, as a share of the largest motion of one."""
        ...

    def slip(self, poses: Array) -> float:
        """Return the largest slip at a joint that stays closed, likewise."""
        ...

    @property
    def slips(self) -> float:
        """Slip above which a motion slides."""
        ...

    def work(self, built: Array, rates: Array) -> tuple[float, float]:
        """Return the work of the loads on a motion, and what goes into it."""
        ...

    def equilibrium(self) -> tuple[bool, Array | None]:
        """Tell whether forces of equilibrium may exist, and return them where they do."""
        ...

    def least(self) -> Array | None:
        """Return forces that leave least acceleration, where they are found."""
        ...

    def trusts(self, world: World, settings: Settings, largest: float) -> bool:
        """Tell whether contacts were solved well enough for accelerations of that size."""
        ...

    def is_bounded(self, engine: Engine) -> bool:
        """Tell whether the engine takes friction as it is."""
        ...


class InPlane:
    """A problem of the plane.

    Parameters
    ----------
    problem : Problem
    asked : Problem, optional
        Whose forces are asked for, where the engine knows other blocks.
    """

    slips = SLIPS

    def __init__(self, problem: Problem, asked: Problem | None = None) -> None:
        self._problem, self._asked = problem, asked or problem
        self.asks = problem.is_planar
        self.far = float(np.abs(problem.assembly.centres).max()) / problem.assembly.size

    def displacement(self, moved: Array) -> Array:
        """Return the largest displacement of any corner, (...)."""
        return displacement(moved, self._problem.assembly)

    def overlap(self, poses: Array) -> float:
        """Return the deepest overlap."""
        return overlap_share(self._problem.assembly, poses)

    def slip(self, poses: Array) -> float:
        """Return the largest slip."""
        return slip_share(self._problem.assembly, poses)

    def work(self, built: Array, rates: Array) -> tuple[float, float]:
        """Return works from rest over one step."""
        masses = self._problem.assembly.spatial_masses[:, : rates.shape[1]]
        return float((self._problem.pull(built) * rates).sum()), float(
            (masses * rates**2).sum()
        )

    def equilibrium(self) -> tuple[bool, Array | None]:
        """Return forces (joints, 2, 2)."""
        forces = equilibrium(self._asked).forces
        return forces is not None, forces

    def least(self) -> Array | None:
        """Return forces (joints, 2, 2)."""
        least = least_motion(self._asked)
        return None if least is None else least.forces

    def trusts(self, world: World, settings: Settings, largest: float) -> bool:  # noqa: ARG002
        """Tell whether the world keeps within its settings."""
        return trusted(world, settings)

    def is_bounded(self, engine: Engine) -> bool:  # noqa: ARG002 - of all engines
        """Tell whether friction has bounds."""
        return bool(np.isfinite(self._problem.friction).all())


class InSpace:
    """A problem in space.

    Parameters
    ----------
    problem : SpatialProblem
    """

    asks, slips = True, STICKS

    def __init__(self, problem: SpatialProblem) -> None:
        self._problem, self._assembly = problem, problem.assembly
        self.far = float(np.abs(self._assembly.centres).max()) / self._assembly.size

    def displacement(self, moved: Array) -> Array:
        """Return the largest displacement of any corner, (...)."""
        return displacement_in_space(moved, self._assembly)

    def overlap(self, poses: Array) -> float:
        """Return the deepest overlap."""
        return overlap_in_space(self._assembly, poses)

    def slip(self, poses: Array) -> float:
        """Return the largest slip."""
        return slip_in_space(self._assembly, poses)

    def work(self, built: Array, rates: Array) -> tuple[float, float]:  # noqa: ARG002 - of both
        """Return works from rest over one step."""
        assembly = self._assembly
        gyration = np.array([block.gyration for block in assembly.blocks]) / assembly.size**2
        spin = np.einsum("bi,bij,bj->b", rates[:, 3:], gyration, rates[:, 3:])
        masses = assembly.weights / self._problem.unit_force
        moving = float(masses @ ((rates[:, :3] ** 2).sum(axis=1) + spin))
        return float((self._problem.pull() * rates).sum()), moving

    def equilibrium(self) -> tuple[bool, Array | None]:
        """Return forces (points, 3), along normals and across."""
        found = can_rest(self._problem)
        forces = found.point_forces
        if forces is not None:
            forces = forces / self._problem.unit_force
        return found.exists is not False, forces

    def least(self) -> Array | None:
        """Return forces (points, 3); where joints slide they open."""
        return dilating(at_rest(Bodies(self._problem)))

    def trusts(self, world: World, settings: Settings, largest: float) -> bool:
        """Tell whether the residual is small beside the accelerations."""
        residual = world.quality().residual
        if residual is None or math.isinf(settings.residual):
            return trusted(world, settings)
        return residual <= max(SURE * largest, settings.still)

    def is_bounded(self, engine: Engine) -> bool:
        """Tell whether no friction is above what engines take."""
        most = min(engine.most_friction, FRICTION_CAP)
        return float(self._problem.friction.max(initial=0.0)) <= most


def looking_at(
    problem: Problem | SpatialProblem, asked: Problem | SpatialProblem | None = None
) -> Looking:
    """Return a problem as it is looked at; see `InPlane`."""
    if isinstance(problem, SpatialProblem):
        return InSpace(problem)
    assert not isinstance(asked, SpatialProblem)  # noqa: S101 - of the same kind
    return InPlane(problem, asked)
