"""An engine of your own, known to every command as module:ENGINE.

    blocksim check oppenheim_7 --method own_engine:ENGINE
    blocksim bracket column --mu 0.7 --over tilt --method own_engine:ENGINE

Joints are damped springs at both ends, pressed only, with Coulomb friction. What it can tell is
how a collapse begins. Blocks meet at their joints alone, so it does not tell how one ends.
"""

from __future__ import annotations

import math

import numpy as np

from blocksim import Assembly, Problem
from blocksim.blocks.assembly import Array
from blocksim.engines.base import FRICTION_CAP, Engine, Quality, Settings
from blocksim.engines.contact.geometry import Geometry, Touch

STIFF, DAMPED = 1e5, 0.1
"""Stiffness [mean weights / size] of springs in motion, and their share of damping."""


def rule(assembly: Assembly) -> Settings:
    """Return settings: thrust settles in a number of sweeps that grows as blocks^2."""
    return Settings(
        step=0.01, sweeps=1, hold_sweeps=max(50_000, 2000 * len(assembly.blocks) ** 2)
    )


class Springs:
    """Blocks on springs, at rest until let go; see `blocksim.engines.base.World`."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        assembly = problem.assembly
        self._problem, self._geometry = problem, Geometry(assembly)
        self._mass, self._sides = assembly.masses, assembly.sides
        self._mu = np.minimum(problem.friction, FRICTION_CAP)[:, None]
        self._poses = assembly.built[:-1]
        self._velocities = np.zeros_like(self._poses)
        # Of each joint along the normals and tangents of its ends; how blocks drift in `hold`.
        self._forces, self._drift = np.zeros((len(assembly.joints), 4)), self._velocities
        self._step = settings.step
        touch, _ = self._geometry.touch(self._poses)
        load = np.zeros(len(self._mass) + 1)  # of unit springs on each block, squared
        squares = (touch.rows.reshape(-1, 4, 2, 3) ** 2).sum(axis=1)
        weights = np.vstack([self._mass, np.full(3, np.inf)])
        for side in (0, 1):
            np.add.at(
                load, self._sides[side], (squares[:, side] / weights[self._sides[side]]).sum(1)
            )
        self._most = 2 * float(load[:-1].max())

    def hold(self, sweeps: int) -> Array:
        """Look for contact forces at rest: springs whose blocks drift in a thick fluid."""
        touch, _ = self._geometry.touch(self._poses)
        applied, thick = self._problem.applied_forces(self._poses), 2 / len(self._poses)
        for _ in range(sweeps):
            found = self._accelerations(touch, applied)
            self._drift = (self._drift + found) / (1 + thick)
            pressed = self._forces - self._rates(touch, self._drift) / self._most
            self._forces = self._allowed(pressed)
        return self._accelerations(touch, applied)

    def advance(self, steps: int) -> None:
        """Let the blocks move, in the short steps that stiff springs take."""
        parts = math.ceil(self._step * 2 * math.sqrt(STIFF * self._most))
        step, damped = self._step / parts, DAMPED * math.sqrt(STIFF / self._most)
        if not self._velocities.any():
            self._preload = self._forces[:, :2].copy()
        for _ in range(steps * parts):
            touch, holds = self._geometry.touch(self._poses)
            rates = self._rates(touch, self._velocities)
            forces = self._forces - STIFF * step * rates
            forces[:, :2] = self._preload - STIFF * touch.gap
            self._forces = self._allowed(forces) * holds[:, None]
            pushed = self._allowed(self._forces - damped * rates) * holds[:, None]
            applied = self._problem.applied_forces(self._poses)
            found = self._accelerations(touch, applied, pushed)
            self._velocities = self._velocities + step * found
            self._poses = self._poses + step * self._velocities

    def poses(self) -> Array:
        """Return centres of mass and rotations."""
        return self._poses

    def quality(self) -> Quality:
        """Tell nothing: the springs of the onset test leave no error that they know of."""
        return Quality()

    def _rates(self, touch: Touch, velocities: Array) -> Array:
        ground = np.vstack([velocities, np.zeros(3)])
        both = np.concatenate([ground[self._sides[0]], ground[self._sides[1]]], axis=1)
        return np.einsum("jck,jk->jc", touch.rows, both)

    def _allowed(self, forces: Array) -> Array:
        """Return forces that press, and rub within Coulomb's cone."""
        normal = np.maximum(forces[:, :2], 0.0)
        return np.hstack(
            [normal, np.clip(forces[:, 2:], -self._mu * normal, self._mu * normal)]
        )

    def _accelerations(self, touch: Touch, pull: Array, forces: Array | None = None) -> Array:
        on = np.einsum("jck,jc->jk", touch.rows, self._forces if forces is None else forces)
        total = np.vstack([pull, np.zeros(3)])
        np.add.at(total, self._sides.ravel(), np.vstack([on[:, :3], on[:, 3:]]))
        return total[:-1] / self._mass


ENGINE = Engine(
    name="springs",
    sees="how a collapse begins in the plane: springs at joints",
    library="numpy",
    remedy="pip install numpy",
    version_of=lambda: np.__version__,
    rule=rule,
    build=Springs,
    adjustable=("step", "hold_sweeps"),
    finest=1e-3,
)
