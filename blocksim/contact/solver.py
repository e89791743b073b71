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
from numpy.typing import NDArray
from scipy.linalg import solve_banded, solveh_banded

from blocksim.assembly import Array

SOFT, STIFF = 1e3, 1e9
"""Least and largest weight of the constraints."""
STIFFNESS = 1e4
"""Weight of the constraints times accelerations, limited by round-off."""
BALANCE = 1e-11
"""Forces out of balance at which a minimisation ends, in mean weights."""
ROUND_OFF = 1e-14
CLOSED = 1e-16
"""Violation of a constraint that is round-off, with accelerations of 1 [g]."""
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
        self._mu = mu
        self._norm = math.sqrt(1 + mu * mu)
        self._root = np.sqrt(mass).ravel()
        self._size = mass.size
        pair = np.repeat(np.stack([before, after], 1), 3, axis=1)
        place = 3 * pair + np.tile(np.arange(3), 2)
        # Entries of the ground go to one place past the end and are dropped.
        self._place = np.where(pair < 0, self._size, place)
        self._flat = self._place.ravel()
        padded = np.append(1 / self._root, 0.0)
        self._scale = padded[self._place][:, None, :]
        row, column = np.broadcast_arrays(self._place[:, :, None], self._place[:, None, :])
        inside = (row < self._size) & (column < self._size)
        apart = row - column
        self._band = int(np.abs(apart[inside]).max())
        lower = inside & (apart >= 0)
        self._lower = np.flatnonzero(lower)
        self._lower_at = (apart * self._size + column)[lower]
        self._whole = np.flatnonzero(inside)
        self._whole_at = ((self._band + apart) * self._size + column)[inside]

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
        self._problem = problem
        self._normal = normal * problem._scale
        self._tangent = tangent * problem._scale
        self._friction = problem._mu / problem._norm
        slope = self._friction * self._tangent
        self._slope = np.concatenate([slope, slope], axis=1)
        upright = self._normal / problem._norm
        self._edges = np.concatenate([upright + slope, upright - slope], axis=1)
        rate, lean = normal_rate / problem._norm, self._friction * slip_rate
        self._offset = np.concatenate([rate + lean, rate - lean], axis=1)
        self._normal_rate, self._slip_rate = normal_rate, slip_rate
        self._free = free.ravel() * problem._root
        self._iterations = 0
        self._precision = precision

    def solve(self, start: Solution | None) -> Solution:
        """Pass after pass until the slip assumed is the slip found."""
        joints = len(self._offset)
        if start is None:
            x, forces = np.zeros_like(self._free), np.zeros((joints, 4))
        else:
            x = start.acceleration.ravel() * self._problem._root
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
            acceleration=(x / self._problem._root).reshape(-1, 3),
            multipliers=forces,
            residual=self._residual(x, forces),
            iterations=self._iterations,
            passes=passes,
        )

    def _at(self, rows: Array, x: Array) -> Array:
        """Velocities along rows, shape (joints, rows)."""
        return np.matmul(rows, np.append(x, 0.0)[self._problem._place][:, :, None])[:, :, 0]

    def _pull(self, rows: Array, forces: Array) -> Array:
        """Forces along rows, summed on the blocks."""
        parts = np.matmul(forces[:, None, :], rows).ravel()
        return np.bincount(self._problem._flat, parts, self._problem._size + 1)[:-1]

    def _slip(self, x: Array) -> Array:
        return self._slip_rate + self._at(self._tangent, x)

    def _multipliers(
        self, x: Array, forces: Array, slip: Array, *, cold: bool
    ) -> tuple[Array, Array]:
        """Solve a pass by the method of multipliers, ever stiffer as it comes to rest."""
        widened = self._friction * np.concatenate([slip, slip], axis=1)
        stiffness = SOFT if cold else self._stiffness(x)
        for _ in range(MOST_OUTER):
            x, found = self._minimise(x, forces, self._offset + widened, stiffness)
            violation = np.abs(found - forces).max() / stiffness
            forces = found
            if violation <= self._precision * max(1.0, np.abs(x).max()):
                break
            stiffness = self._stiffness(x)
        return x, forces

    def _stiffness(self, x: Array) -> float:
        return float(np.clip(STIFFNESS / max(np.abs(x).max(), 1e-9), SOFT, STIFF))

    def _minimise(
        self, x: Array, forces: Array, offset: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Minimise |x - f|^2 / 2 + stiffness/2 |max(0, forces/stiffness - rate)|^2."""
        problem, edges = self._problem, self._edges
        trial = forces - stiffness * (offset + self._at(edges, x))
        for _ in range(MOST_NEWTON):
            gradient = x - self._free - self._pull(edges, np.maximum(trial, 0.0))
            if np.abs(gradient).max() <= self._balance(x, stiffness):
                break
            active = stiffness * (trial > 0)
            blocks = np.matmul(edges.transpose(0, 2, 1) * active[:, None, :], edges).ravel()
            rows = problem._band + 1
            band = np.bincount(
                problem._lower_at, blocks[problem._lower], rows * problem._size
            ).reshape(rows, -1)
            band[0] += 1.0
            way = solveh_banded(band, -gradient, lower=True, check_finite=False)
            self._iterations += 1
            turn = -stiffness * self._at(edges, way)
            length = _line_search(
                float(way @ gradient), float(way @ way), trial, turn, stiffness
            )
            x = x + length * way
            trial = forces - stiffness * (offset + self._at(edges, x))
        return x, np.maximum(trial, 0.0)

    def _balance(self, x: Array, stiffness: float) -> float:
        return max(BALANCE, ROUND_OFF * stiffness * float(np.abs(x).max()))

    def _sliding(
        self, x: Array, forces: Array, slip: Array, follow: NDArray[np.bool_]
    ) -> tuple[Array, Array] | None:
        """Newton's method with the slip of sliding contacts as an unknown; None if it fails."""
        edges = self._edges
        for _ in range(MOST_OUTER):
            stiffness = self._stiffness(x)
            for _ in range(MOST_SLIDING_NEWTON):
                found = self._slip(x)
                widened = self._friction * np.where(follow, np.abs(found), slip)
                rate = self._offset + np.tile(widened, 2) + self._at(edges, x)
                trial = forces - stiffness * rate
                gradient = x - self._free - self._pull(edges, np.maximum(trial, 0.0))
                if np.abs(gradient).max() <= self._balance(x, stiffness):
                    break
                x = x + self._way(gradient, stiffness * (trial > 0), np.sign(found) * follow)
            else:
                return None
            found = np.maximum(trial, 0.0)
            violation = np.abs(found - forces).max() / stiffness
            forces = found
            if violation <= self._precision * max(1.0, np.abs(x).max()):
                return x, forces
        return None

    def _guess(self, x: Array, forces: Array, slip: Array, follow: NDArray[np.bool_]) -> Array:
        """Slip at which assumed and found agree if no contact changes what it does."""
        stiffness = self._stiffness(x)
        found = self._slip(x)
        widened = self._friction * np.where(follow, np.abs(found), slip)
        rate = self._offset + np.tile(widened, 2) + self._at(self._edges, x)
        active = forces > 0
        held = np.where(active, forces - stiffness * rate, 0.0)
        gradient = x - self._free - self._pull(self._edges, held)
        ahead = self._slip(x + self._way(gradient, stiffness * active, np.sign(found) * follow))
        kept = follow & (ahead * found > 0)
        return np.where(kept, np.abs(ahead), slip)

    def _way(self, gradient: Array, weight: Array, sign: Array) -> Array:
        """Newton step where contacts with a sign slide that way, the slip being unknown."""
        problem, edges = self._problem, self._edges
        seen = edges + np.tile(sign, 2)[:, :, None] * self._slope
        blocks = np.matmul(edges.transpose(0, 2, 1) * weight[:, None, :], seen).ravel()
        rows = 2 * problem._band + 1
        band = np.bincount(
            problem._whole_at, blocks[problem._whole], rows * problem._size
        ).reshape(rows, -1)
        band[problem._band] += 1.0
        self._iterations += 1
        both = (problem._band, problem._band)
        return -solve_banded(both, band, gradient, check_finite=False)

    def _residual(self, x: Array, forces: Array) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        problem = self._problem
        imbalance = np.abs(x - self._free - self._pull(self._edges, forces)).max()
        plus, minus = forces[:, :2], forces[:, 2:]
        pressure, friction = (plus + minus) / problem._norm, (plus - minus) * self._friction
        rate = self._normal_rate + self._at(self._normal, x)
        slip = self._slip(x)
        unilateral = np.abs(np.minimum(pressure, rate)).max()
        # Friction at the edge of the cone, against the slip, or no slip.
        against = problem._mu * pressure + np.sign(slip) * friction
        coulomb = np.minimum(against, np.abs(slip)).max()
        return float(max(imbalance, unilateral, coulomb))


def _line_search(
    slope: float, curvature: float, trial: Array, turn: Array, stiffness: float
) -> float:
    """Step along a Newton direction to the minimum, exact as the function is piecewise quadratic.

    The derivative along the way is slope + curvature t plus, for each constraint while it is
    active, (turn^2 t)/stiffness; here `slope` holds all terms at t = 0.
    """
    ahead = trial + turn
    bends = np.flatnonzero(((trial > 0) != (ahead > 0)).ravel())
    if not len(bends):
        return 1.0
    flat, change = trial.ravel(), turn.ravel()
    moving = change != 0
    flat, change = flat[moving], change[moving]
    weight = change * change / stiffness
    active = (flat > 0) | ((flat == 0) & (change > 0))
    where = -flat / change
    bends = np.flatnonzero(where > 0)
    order = bends[np.argsort(where[bends])]
    edges = np.append(0.0, where[order])
    steepness = np.cumsum(
        np.append(curvature + weight[active].sum(), np.sign(change[order]) * weight[order])
    )
    values = slope + np.append(0.0, np.cumsum(steepness[:-1] * np.diff(edges)))
    last = max(int(np.searchsorted(values, 0.0)) - 1, 0)
    return float(edges[last] - values[last] / steepness[last])
