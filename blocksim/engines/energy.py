"""Energy of blocks in motion, and how far it rises above the least that it has been.

Engines of impulses move blocks by velocities that are those halfway between two places.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem

Where = TypeVar("Where")
"""Where blocks are: poses, or `solid.bodies.Place`."""
FELL = 1e-9
"""What counts as fallen [mean weights times the size]; the rest is round-off."""
IMPACT = 10.0
"""Acceleration from which a block has met something [g]."""


def later(velocities: Array, rates: Array, time: float) -> Array:
    """Return velocities a part of a step later, or earlier, where nothing was met meanwhile.

    `velocities`, `rates`, (blocks, 3 or 6): These, and accelerations.
    """
    sudden = np.abs(rates).max(axis=1, keepdims=True) > IMPACT
    return velocities + np.where(sudden, 0.0, rates) * time


def energy(problem: Problem, poses: Array, velocities: Array) -> float:
    """Return kinetic and potential energy, in mean weights times the size.

    `poses`, `velocities`, (blocks, 3).
    """
    return _kinetic(problem, velocities) + _potential(problem, poses)


def _kinetic(problem: Problem, velocities: Array) -> float:
    return float((problem.assembly.masses * velocities**2).sum() / 2)


def _potential(problem: Problem, poses: Array) -> float:
    pull = problem.applied_forces(poses)
    potential = -float((pull[:, :2] * poses[:, :2]).sum())
    if not problem.forces_turn:
        return potential
    # A force at a point does what its moment does about a block turned by a right angle.
    quarter = poses + np.array([0.0, 0.0, math.pi / 2])
    return potential + float(problem.applied_forces(quarter)[:, 2].sum())


class Balance(Generic[Where]):
    """How far the energy has risen above the least that it has been since the release.

    Nothing gives energy to blocks that fall, slide and hit: each rise is the engine's.

    `potential`, `kinetic`: Energies: of where blocks are, and of that and their velocities.
    `poses`, (blocks, 3) float, or Place: Where blocks are at the release, as these
        functions are told it.
    `begun`: Kinetic energy there.
    """

    def __init__(
        self,
        potential: Callable[[Where], float],
        kinetic: Callable[[Where, Array], float],
        poses: Where,
        begun: float = 0.0,
    ) -> None:
        self._potential, self._kinetic = potential, kinetic
        self._lowest = potential(poses)
        self._first = self._least = self._lowest + begun
        self._gain = 0.0

    @staticmethod
    def of(problem: Problem, poses: Array, velocities: Array | float = 0.0) -> Balance[Array]:
        """Look at the energies of a problem of the plane, from poses at the release on.

        `velocities`, (blocks, 3): Those at the release.
        """

        def kinetic(_: Array, velocities: Array) -> float:
            return _kinetic(problem, velocities)

        begun = _kinetic(problem, np.zeros_like(poses) + velocities)
        return Balance(partial(_potential, problem), kinetic, poses, begun)

    def look(self, poses: Where, before: Array, after: Array) -> None:
        """Take note of blocks at a place, with their velocities on the way to it and from it.

        At a place it is their mean, with which a block that falls keeps its energy.
        """
        still = self._potential(poses)
        moving = still + self._kinetic(poses, (before + after) / 2)
        self._gain = max(self._gain, moving - self._least)
        self._least = min(self._least, moving)
        self._lowest = min(self._lowest, still)

    @property
    def gain(self) -> float:
        """Most the energy has risen, as a share of what fell and moved at the release."""
        fallen = self._first - self._lowest
        return self._gain / fallen if fallen > FELL else 0.0
