"""Blocks where they are: what touches, what pulls, and the contact problem of a step."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.engines.contact.geometry import Touch
from blocksim.engines.contact.neighbours import Neighbours
from blocksim.engines.contact.solver import ContactProblem, Solution
from blocksim.engines.shaken import OnGround

DEEPEST = 1e-3
"""Overlap that is pushed apart at once, over how far the corners of the smaller block are from
its centre."""
NO_GUESS: tuple[NDArray[np.int64] | None, Solution | None] = None, None
"""Pairs, and what their contacts do, where no more is known than of the last step."""


class Placed(OnGround):
    """Poses and velocities of blocks, their contacts, and what is known of them."""

    def __init__(self, problem: Problem) -> None:
        self._asked, assembly = problem, problem.assembly
        self._mass = assembly.masses
        self._mu, self._friction = problem.mu, problem.friction
        self._reach = assembly.reach / assembly.size
        self._neighbours = Neighbours(assembly)
        self._keys = self._neighbours.keys
        self._joints = len(assembly.joints)
        self._poses: Array = assembly.built[:-1]
        self._problem = self._new_problem()
        self._looked: Array = self._poses
        self._velocities: Array = np.zeros_like(self._poses)
        self._turning, self._time = problem.forces_turn, 0.0
        self._sets_off = False
        self._free = self._still = problem.applied_forces() / self._mass
        self._solution: Solution | None = None
        self._guess = NO_GUESS
        self._seen: tuple[Array, NDArray[np.int64], Touch] | None = None
        self._residual = 0.0

    def _speeds(self) -> Array:
        """Return the largest velocity of each block's corners, at most, (blocks,)."""
        speed: Array = np.hypot(*self._velocities[:, :2].T)
        return speed + np.abs(self._velocities[:, 2]) * self._reach

    def _drive(self, step: float) -> None:
        """Set the velocities of what is moved; here nothing is."""

    def _pull(self) -> None:
        """Find the accelerations without contact, which change as blocks with loads turn."""
        if self._turning:
            self._free = self._asked.applied_forces(self._looked) / self._mass

    def _shake(self, step: float) -> None:
        """Add what the ground's acceleration does in a step to the accelerations."""
        if self._asked.shaking is not None:
            seen = self._gravity_in(step) - self._asked.gravity
            self._free = (self._free if self._turning else self._still).copy()
            self._free[:, :2] += seen[:2]

    def _touch(self, poses: Array, step: float) -> Touch:
        """Find the contacts; what is known of those that stay is kept."""

        def reach() -> float:
            fastest = max(1.0, float(np.abs(self._free[:, :2]).max()))
            return step * (float(self._speeds().max()) + step * fastest)

        touch = self._neighbours.touch(poses, reach)
        keys = self._neighbours.keys
        if keys is not self._keys and not np.array_equal(keys, self._keys):
            if self._solution is not None:
                self._solution = self._solution.carried(self._keys, keys)
            self._keys = keys
            self._problem = self._new_problem()
        # Friction never sees a slip that is not in the rows.
        if len(self._smooth_joints):
            touch.rows[self._smooth_joints, 2:] = 0.0
        return touch

    def _contacts(self) -> Touch:
        """Find the contacts of the pairs known, where the blocks are."""
        seen = self._seen
        if seen is None or seen[0] is not self._poses or seen[1] is not self._keys:
            seen = self._poses, self._keys, self._neighbours.again(self._poses)
            self._seen = seen
        return seen[2]

    def _new_problem(self) -> ContactProblem:
        before, after = self._neighbours.before, self._neighbours.after
        self._pairs = np.stack([before, after], axis=1)
        reach = np.append(self._reach, math.inf)[self._pairs].min(axis=1, keepdims=True)
        self._deepest = -DEEPEST * reach
        held = self._keys < self._joints
        friction = np.full(len(self._keys), self._mu)
        friction[held] = self._friction[self._keys[held]]
        self._smooth_joints = np.flatnonzero(friction == 0)
        return ContactProblem(before, after, self._mass, friction, self._poses[:, :2])

    def _rates(self, rows: Array, velocities: Array) -> Array:
        """Return velocities along rows, shape (joints, 4)."""
        of_joints = self._problem.bands.of_joints(velocities.ravel())
        return np.matmul(rows, of_joints[:, :, None])[:, :, 0]

    def _solve(self, touch: Touch, rates: Array, precision: float) -> Solution:
        self._rows = touch.rows
        keys, guess = self._guess
        if guess is None or keys is not self._keys:
            guess = self._solution
        solution = self._problem.solve(touch.rows, rates, self._free, guess, precision)
        self._guess, self._solution = NO_GUESS, solution
        # Unlike max, this keeps nan.
        self._residual = float(np.maximum(self._residual, solution.residual))
        return solution
