"""One step's contact problem: unilateral contact and Coulomb friction, solved to its end.

For x, the mean accelerations over the step, and p, the contact forces,

    M (x - f) = H^T p,    0 <= p_n  _|_  n >= 0,    |p_t| <= mu p_n, against the slip t,

where n = n0 + N x and t = t0 + T x are the normal and tangential velocities at the end of
the step over its length. Each pass keeps n >= mu (|t| - s) with a given slip s: for s = 0
the associated problem, whose friction dilates, for s = |t| Coulomb's. A pass is a
strictly convex quadratic programme. The method of multipliers turns it into a few
piecewise quadratic minimisations without constraints, and Newton's method with an exact
line search ends each of them after finitely many steps, from anywhere. Only neighbours
touch, so all matrices are banded and a step costs as much as the number of blocks.

The slip is part of the unknowns where a contact slides: Newton's method then sees s = |t|
itself (no longer symmetric, banded all the same). Where that fails to converge, s is
replaced by the slip of the last pass, again and again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.assembly import Array
from blocksim.contact.banded import Bands, line_search

COLD = 1e8
"""Weight of the constraints to start with when nothing is known."""
SOFT, STIFF = 1e3, 1e9
"""Least and largest weight of the constraints."""
STIFFNESS = 1e4
"""Weight of the constraints times accelerations, limited by round-off."""
BALANCE = 1e-11
"""Forces out of balance at which a minimisation ends, in mean weights."""
STIFFER = 1e3
"""Largest factor on the stiffness where progress is slow."""
ROUND_OFF = 1e-14
"""The same, in units of the stiffest forces."""
STALLED = 30.0
"""Multiple of that below which an imbalance that no longer halves is round-off."""
CLOSED = 1e-16
"""Violation of a constraint that is round-off, with accelerations of 1 [g]."""
STEEPEST = 3.0
"""Edges of friction cones steeper than that are not scaled to length 1: normals would fade."""
MOST_NEWTON = 100
MOST_SLIDING_NEWTON = 8
MOST_OUTER = 30
MOST_PASSES = 100
PLAIN = 5
"""Every so many passes the slip found is taken as it is, lest guesses go round."""
SLIDING = 1e-6
"""Share of the largest slip from which a contact counts as sliding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """Accelerations and contact forces of a step.

    Parameters
    ----------
    acceleration : (blocks, 3) float
    multipliers : (joints, 4) float
        Forces along the edges of the friction cones, where to start the next step from.
    residual : float
        Worst of force imbalance (mean weights), penetration rate and complementarity.
    iterations : int
        Banded systems solved.
    passes : int
        Of the slip.
    """

    acceleration: Array
    multipliers: Array
    residual: float
    iterations: int
    passes: int


class ContactProblem:
    """Blocks, what they touch, and friction: everything that stays from step to step.

    Parameters
    ----------
    before, after : (joints,) int
        Blocks on both sides of each joint, -1 for the ground.
    mass : (blocks, 3) float
        Mass, mass and moment of inertia, in mean masses.
    mu : float
        Friction coefficient, finite.
    """

    def __init__(
        self, before: NDArray[np.int64], after: NDArray[np.int64], mass: Array, mu: float
    ) -> None:
        self.mu = mu
        self.root = np.sqrt(mass)
        self.bands = Bands(before, after, len(mass))
        self.scale = self.bands.of_joints(1 / self.root.ravel())[:, None, :]

    def solve(
        self,
        normal: Array,
        tangent: Array,
        free: Array,
        normal_rate: Array,
        slip_rate: Array,
        start: Solution | None = None,
        precision: float = CLOSED,
    ) -> Solution:
        """Solve one step.

        Parameters
        ----------
        normal, tangent : (joints, 2, 6) float
            Velocities at the contacts from those of the two blocks (N and T).
        free : (blocks, 3) float
            Accelerations without contact (f).
        normal_rate, slip_rate : (joints, 2) float
            What the contacts' velocities are without acceleration, over the step (n0, t0).
        start : Solution, optional
            Of a similar step.
        precision : float
            Largest violation of a constraint at which the step counts as solved [g].

        Returns
        -------
        Solution
        """
        return _Step(self, normal, tangent, free, normal_rate, slip_rate, precision).solve(
            start
        )


class _Step:
    """The contact problem of one step, in accelerations times the root of mass."""

    def __init__(
        self,
        problem: ContactProblem,
        normal: Array,
        tangent: Array,
        free: Array,
        normal_rate: Array,
        slip_rate: Array,
        precision: float,
    ) -> None:
        self._bands, self._root, self._mu = problem.bands, problem.root, problem.mu
        self._normal, self._tangent = normal * problem.scale, tangent * problem.scale
        self._norm = min(math.sqrt(1 + self._mu**2), STEEPEST)
        self._friction = self._mu / self._norm
        slope = self._friction * self._tangent
        self._slope = np.concatenate([slope, slope], axis=1)
        upright = self._normal / self._norm
        self._edges = np.concatenate([upright + slope, upright - slope], axis=1)
        rate, lean = normal_rate / self._norm, self._friction * slip_rate
        self._offset = np.concatenate([rate + lean, rate - lean], axis=1)
        self._normal_rate, self._slip_rate = normal_rate, slip_rate
        self._free = (free * self._root).ravel()
        self._iterations = 0
        self._precision = precision

    def solve(self, start: Solution | None) -> Solution:
        """Pass after pass until the slip assumed is the slip found."""
        joints = len(self._offset)
        if start is None:
            x, forces = np.zeros_like(self._free), np.zeros((joints, 4))
        else:
            x = (start.acceleration * self._root).ravel()
            forces = start.multipliers
        slip = np.zeros((joints, 2))
        passes = 0
        while passes < MOST_PASSES:
            found = np.abs(self._slip(x))
            pressed = (forces[:, :2] + forces[:, 2:]) > 0
            largest = float(found[pressed].max(initial=0.0))
            change = float(np.abs(found - slip)[pressed].max(initial=0.0))
            if passes and change <= max(10 * self._precision, 1e-11 * largest):
                break
            follow, newton = pressed, None
            if passes or start is not None:
                slip = np.where(pressed, found, slip)
                follow = found > SLIDING * largest
                newton = self._sliding(x, forces, slip, follow)
                if newton is None and passes % PLAIN:
                    slip = self._guess(x, forces, slip, follow)
            if newton is None:
                x, forces = self._multipliers(
                    x, forces, slip, cold=start is None and not passes
                )
            else:
                x, forces = newton
                slip = np.where(follow, np.abs(self._slip(x)), slip)
            passes += 1
        return Solution(
            acceleration=x.reshape(-1, 3) / self._root,
            multipliers=forces,
            residual=self._residual(x, forces),
            iterations=self._iterations,
            passes=passes,
        )

    def _slip(self, x: Array) -> Array:
        return self._slip_rate + self._bands.along(self._tangent, x)

    def _multipliers(
        self, x: Array, forces: Array, slip: Array, *, cold: bool
    ) -> tuple[Array, Array]:
        """Solve a pass by the method of multipliers, ever stiffer as it comes to rest."""
        widened = self._friction * np.concatenate([slip, slip], axis=1)
        stiffness = COLD if cold else self._stiffness(x)
        stiffer, last = 1.0, math.inf
        for _ in range(MOST_OUTER):
            x, found = self._minimise(x, forces, self._offset + widened, stiffness)
            violation = np.abs(found - forces).max() / stiffness
            forces = found
            if violation <= self._least_violation(x):
                break
            # Slow progress asks for stiffness, at the cost of digits.
            stiffer *= 4.0 if violation > last / 10 and stiffer < STIFFER else 1.0
            last = violation
            stiffness = stiffer * self._stiffness(x)
        return x, forces

    def _least_violation(self, x: Array) -> float:
        size = float(np.abs(x).max())
        return max(self._precision * max(1.0, size), 10 * ROUND_OFF * size)

    def _stiffness(self, x: Array) -> float:
        steep = max(1.0, self._friction)
        return float(np.clip(STIFFNESS / steep / max(np.abs(x).max(), 1e-9), SOFT, STIFF))

    def _minimise(
        self, x: Array, forces: Array, offset: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Minimise |x - f|^2 / 2 + stiffness/2 |max(0, forces/stiffness - rate)|^2."""
        edges = self._edges
        trial = forces - stiffness * (offset + self._bands.along(edges, x))
        size = math.inf
        for _ in range(MOST_NEWTON):
            gradient = x - self._free - self._bands.pull(edges, np.maximum(trial, 0.0))
            size, last = float(np.abs(gradient).max()), size
            if self._balanced(size, last, x, stiffness):
                break
            way = self._bands.solve_symmetric(edges, stiffness * (trial > 0), -gradient)
            self._iterations += 1
            turn = -stiffness * self._bands.along(edges, way)
            length = line_search(
                float(way @ gradient), float(way @ way), trial, turn, stiffness
            )
            x = x + length * way
            trial = forces - stiffness * (offset + self._bands.along(edges, x))
        return x, np.maximum(trial, 0.0)

    def _balanced(self, size: float, last: float, x: Array, stiffness: float) -> bool:
        """Whether a gradient is as small as it gets."""
        noise = ROUND_OFF * stiffness * float(np.abs(x).max())
        stalled = STALLED * max(1.0, self._friction) * noise
        return size <= max(BALANCE, noise) or last / 2 <= size <= stalled

    def _sliding(
        self, x: Array, forces: Array, slip: Array, follow: NDArray[np.bool_]
    ) -> tuple[Array, Array] | None:
        """Newton's method with the slip of sliding contacts as an unknown; None if it fails."""
        edges = self._edges
        stiffer, last = 1.0, math.inf
        for _ in range(MOST_OUTER):
            stiffness = stiffer * self._stiffness(x)
            size = math.inf
            for _ in range(MOST_SLIDING_NEWTON):
                found = self._slip(x)
                widened = self._friction * np.where(follow, np.abs(found), slip)
                rate = self._offset + np.tile(widened, 2) + self._bands.along(edges, x)
                trial = forces - stiffness * rate
                gradient = x - self._free - self._bands.pull(edges, np.maximum(trial, 0.0))
                size, last = float(np.abs(gradient).max()), size
                if self._balanced(size, last, x, stiffness):
                    break
                x = x + self._way(gradient, stiffness * (trial > 0), np.sign(found) * follow)
            else:
                return None
            found = np.maximum(trial, 0.0)
            violation = np.abs(found - forces).max() / stiffness
            forces = found
            if violation <= self._least_violation(x):
                return x, forces
            stiffer *= 4.0 if violation > last / 10 and stiffer < STIFFER else 1.0
            last = violation
        return None

    def _guess(self, x: Array, forces: Array, slip: Array, follow: NDArray[np.bool_]) -> Array:
        """Slip at which assumed and found agree if no contact changes what it does."""
        stiffness = self._stiffness(x)
        found = self._slip(x)
        widened = self._friction * np.where(follow, np.abs(found), slip)
        rate = self._offset + np.tile(widened, 2) + self._bands.along(self._edges, x)
        active = forces > 0
        held = np.where(active, forces - stiffness * rate, 0.0)
        gradient = x - self._free - self._bands.pull(self._edges, held)
        ahead = self._slip(x + self._way(gradient, stiffness * active, np.sign(found) * follow))
        kept = follow & (ahead * found > 0)
        return np.where(kept, np.abs(ahead), slip)

    def _way(self, gradient: Array, weight: ArrayLike, sign: Array) -> Array:
        """Newton step where contacts with a sign slide that way, the slip being unknown."""
        seen = self._edges + np.tile(sign, 2)[:, :, None] * self._slope
        self._iterations += 1
        return self._bands.solve(self._edges, weight, seen, -gradient)

    def _residual(self, x: Array, forces: Array) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        imbalance = np.abs(x - self._free - self._bands.pull(self._edges, forces)).max()
        plus, minus = forces[:, :2], forces[:, 2:]
        pressure, friction = (plus + minus) / self._norm, (plus - minus) * self._friction
        rate = self._normal_rate + self._bands.along(self._normal, x)
        slip = self._slip(x)
        unilateral = np.abs(np.minimum(pressure, rate)).max()
        # Friction at the edge of the cone, against the slip, or no slip.
        against = self._mu * pressure + np.sign(slip) * friction
        coulomb = np.minimum(against, np.abs(slip)).max()
        return float(max(imbalance, unilateral, coulomb))
