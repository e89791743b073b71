"""One step's contact problem: unilateral contact and Coulomb friction, solved to its end.

For x, the mean accelerations over the step, and p, the contact forces,

    M (x - f) = N^T p_n + T^T p_t,    0 <= p_n  _|_  n >= 0,    |p_t| <= mu p_n, against t,

where n = n0 + N x and t = t0 + T x are the normal and tangential velocities at the end of
the step over its length. Only neighbours touch, so all matrices are banded and a step costs
as much as the number of blocks.

The method of multipliers makes the contacts springs of stiffness k with a preload, the
forces found last: p_n = max(0, q_n - k n) and p_t = q_t - k t, cut to the friction cone.
What remains is a continuous, piecewise linear system in x, and the springs' forces become
those of rigid contact within a few rounds, however soft the springs are.

- Newton's method solves it as a rule, and may run in circles: friction makes the system
  unsymmetric, and no function tells progress from regress.
- Then the path on which the imbalance shrinks in proportion is followed from piece to piece
  (Katzenelson; Lemke's method is of this kind). Contact and friction take energy at
  large velocities, so the system has degree 1: a path cannot escape, and it ends at a
  solution. It may turn back on the way where a piece reverses orientation, as sliding with
  much friction does.
- From nothing, the associated problem, whose friction dilates, is solved first. It is a
  strictly convex quadratic programme, and Newton's method with an exact line search ends it
  from anywhere. Where nothing slides, its solution is the one sought.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.assembly import Array
from blocksim.contact.banded import Bands, line_search

COLD = 1e8
"""Stiffness to start with when nothing is known."""
SOFT, STIFF = 1e3, 1e9
"""Least and largest stiffness."""
STIFFNESS = 1e4
"""Stiffness times accelerations, limited by round-off."""
BALANCE = 1e-11
"""Forces out of balance at which a system counts as solved, in mean weights."""
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
MOST_ASSOCIATED = 100
"""Newton steps; for friction as it is, `MOST_NEWTON`, before the path is followed."""
MOST_NEWTON = 10
MOST_ROUNDS = 40
MOST_PIECES = 3000
"""Pieces of a path before another is tried."""
STARTS = (1e-6, 1e-3, 1e-1, 1.0)
"""Where paths start, off the state known by random parts of the accelerations: paths from a
symmetric state would meet several bends at once."""

OPEN, STICKS, SLIDES_UP, SLIDES_DOWN = range(4)
"""What a contact does: one piece of its law each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """Accelerations and contact forces of a step.

    Parameters
    ----------
    acceleration : (blocks, 3) float
    pressure, friction : (joints, 2) float
        Contact forces along normal and tangent [mean weights].
    residual : float
        Worst of force imbalance (mean weights), penetration rate and complementarity.
    iterations : int
        Banded systems solved.
    paths : int
        Systems for which a path was followed.
    """

    acceleration: Array
    pressure: Array
    friction: Array
    residual: float
    iterations: int
    paths: int


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
        rows = np.concatenate([normal, tangent], axis=1)
        self._rows = rows * problem.scale
        self._rates = np.concatenate([normal_rate, slip_rate], axis=1)
        self._free = (free * self._root).ravel()
        self._precision = precision
        self._iterations = self._paths = 0

    def solve(self, start: Solution | None) -> Solution:
        """Round after round until contacts are rigid; forces hold normal ones, then friction."""
        if start is None:
            x, forces = self._associated()
        else:
            x = (start.acceleration * self._root).ravel()
            forces = np.concatenate([start.pressure, start.friction], axis=1)
        stiffer, last = 1.0, math.inf
        for _ in range(MOST_ROUNDS):
            stiffness = stiffer * self._stiffness(x)
            x, found = self._balance(x, forces, stiffness)
            violation = np.abs(found - forces).max() / stiffness
            forces = found
            if violation <= self._least_violation(x):
                break
            # Slow progress asks for stiffness, at the cost of digits.
            stiffer *= 4.0 if violation > last / 10 and stiffer < STIFFER else 1.0
            last = violation
        return Solution(
            acceleration=x.reshape(-1, 3) / self._root,
            pressure=forces[:, :2],
            friction=forces[:, 2:],
            residual=self._residual(x, forces),
            iterations=self._iterations,
            paths=self._paths,
        )

    def _least_violation(self, x: Array) -> float:
        size = float(np.abs(x).max())
        return max(self._precision * max(1.0, size), 10 * ROUND_OFF * size)

    def _stiffness(self, x: Array) -> float:
        steep = max(1.0, self._mu / STEEPEST)
        return float(np.clip(STIFFNESS / steep / max(np.abs(x).max(), 1e-9), SOFT, STIFF))

    def _balanced(self, size: float, last: float, x: Array, stiffness: float) -> bool:
        """Whether an imbalance is as small as it gets."""
        noise = ROUND_OFF * stiffness * float(np.abs(x).max())
        stalled = STALLED * max(1.0, self._mu / STEEPEST) * noise
        return size <= max(BALANCE, noise) or last / 2 <= size <= stalled

    def _balance(self, x: Array, forces: Array, stiffness: float) -> tuple[Array, Array]:
        """Find the accelerations whose contact springs, preloaded by forces, balance."""
        best = self._newton(x, forces, stiffness)
        if best is None:
            self._paths += 1
            rng = np.random.default_rng(0)
            size = float(np.abs(x).max())
            for part in STARTS:
                begin = x + part * size * rng.standard_normal(len(x))
                end = self._path(begin, forces, stiffness)
                if end is not None:
                    best = self._newton(end, forces, stiffness)
                    if best is not None:
                        break
        if best is None:
            best = x
        return best, self._cut(self._trial(best, forces, stiffness))[0]

    def _trial(self, x: Array, forces: Array, stiffness: float) -> Array:
        """Forces of the springs before friction and opening cut them."""
        return forces - stiffness * (self._rates + self._bands.along(self._rows, x))

    def _cut(self, trial: Array) -> tuple[Array, NDArray[np.int64]]:
        """Forces that contacts can carry, and what the contacts do."""
        normal, along = trial[:, :2], trial[:, 2:]
        most = self._mu * np.maximum(normal, 0.0)
        piece = np.where(np.abs(along) <= most, STICKS, np.where(along > 0, SLIDES_UP, SLIDES_DOWN))
        piece = np.where(normal > 0, piece, OPEN)
        cut = np.concatenate([np.maximum(normal, 0.0), np.clip(along, -most, most)], axis=1)
        return cut, piece

    def _newton(self, x: Array, forces: Array, stiffness: float) -> Array | None:
        """Newton's method; None if it does not end soon."""
        size = math.inf
        for _ in range(MOST_NEWTON):
            held, piece = self._cut(self._trial(x, forces, stiffness))
            gradient = x - self._free - self._bands.pull(self._rows, held)
            size, last = float(np.abs(gradient).max()), size
            if self._balanced(size, last, x, stiffness):
                return x
            x = x + self._way(piece, stiffness, -gradient)
        return None

    def _way(self, piece: NDArray[np.int64], stiffness: float, right: Array) -> Array:
        """Accelerations that change the imbalance by `right` where contacts stay what they are."""
        lean = self._mu * LEAN[piece][:, :, None]
        along = self._rows[:, 2:]
        rows = np.concatenate([self._rows[:, :2] + lean * along, along], axis=1)
        weight = stiffness * np.concatenate([piece != OPEN, piece == STICKS], axis=1)
        self._iterations += 1
        return self._bands.solve(rows, weight, self._rows, right)

    def _path(self, x: Array, forces: Array, stiffness: float) -> Array | None:
        """Follow the shrinking imbalance from piece to piece; None if that does not end."""
        trial = self._trial(x, forces, stiffness)
        held, piece = self._cut(trial)
        imbalance = x - self._free - self._bands.pull(self._rows, held)
        mu, done, sign = self._mu, 0.0, 1.0
        # Per piece: the two functions of normal and tangential trial that are positive on it.
        first = np.array([(-1.0, 0.0), (mu, -1.0), (1.0, 0.0), (1.0, 0.0)])
        second = np.array([(0.0, 0.0), (mu, 1.0), (-mu, 1.0), (-mu, -1.0)])
        way = self._way(piece, stiffness, -imbalance)
        crossed = None
        for _ in range(MOST_PIECES):
            turn = -stiffness * sign * self._bands.along(self._rows, way)
            edges = np.stack([first[piece], second[piece]])
            value = edges[..., 0] * trial[:, :2] + edges[..., 1] * trial[:, 2:]
            slope = edges[..., 0] * turn[:, :2] + edges[..., 1] * turn[:, 2:]
            falls = slope < 0
            if crossed is not None:
                falls[crossed] = False
            ahead = np.full(value.shape, math.inf)
            ahead[falls] = np.maximum(value[falls], 0.0) / -slope[falls]
            where = np.unravel_index(int(ahead.argmin()), ahead.shape)
            length = float(ahead[where])
            if sign > 0 and done + length >= 1:
                return x + (1 - done) * way
            if not math.isfinite(length):
                return None
            x, trial, done = x + length * sign * way, trial + length * turn, done + sign * length
            which, joint, end = (int(i) for i in where)
            gone = edges[which, joint, end]
            old = int(piece[joint, end])
            new = self._beyond(old, which, float(trial[joint, 2 + end]))
            piece[joint, end] = new
            way = self._way(piece, stiffness, -imbalance)
            drift = -stiffness * self._bands.along(self._rows, way)[joint]
            rate = gone[0] * drift[end] + gone[1] * drift[2 + end]
            sign = -1.0 if rate > 0 else 1.0
            back = 0 if (new == OPEN or (old == OPEN)) else (1 if new != STICKS else (0 if old == SLIDES_UP else 1))
            crossed = (back, joint, end)
        return None

    @staticmethod
    def _beyond(old: int, which: int, along: float) -> int:
        if old == OPEN:
            return SLIDES_UP if along > 0 else SLIDES_DOWN
        if old == STICKS:
            return SLIDES_UP if which == 0 else SLIDES_DOWN
        return OPEN if which == 0 else STICKS

    def _associated(self) -> tuple[Array, Array]:
        """Solve the problem whose friction dilates, from nothing."""
        norm = min(math.sqrt(1 + self._mu**2), STEEPEST)
        lean = self._mu / norm
        upright, along = self._rows[:, :2] / norm, lean * self._rows[:, 2:]
        edges = np.concatenate([upright + along, upright - along], axis=1)
        rate, slip = self._rates[:, :2] / norm, lean * self._rates[:, 2:]
        offset = np.concatenate([rate + slip, rate - slip], axis=1)
        x, forces = np.zeros_like(self._free), np.zeros_like(offset)
        stiffness, stiffer, last = COLD, 1.0, math.inf
        for _ in range(MOST_ROUNDS):
            x, found = self._minimise(x, forces, edges, offset, stiffness)
            violation = np.abs(found - forces).max() / stiffness
            forces = found
            if violation <= self._least_violation(x):
                break
            stiffer *= 4.0 if violation > last / 10 and stiffer < STIFFER else 1.0
            last = violation
            stiffness = stiffer * self._stiffness(x)
        plus, minus = forces[:, :2], forces[:, 2:]
        return x, np.concatenate([(plus + minus) / norm, (plus - minus) * lean], axis=1)

    def _minimise(
        self, x: Array, forces: Array, edges: Array, offset: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Minimise |x - f|^2 / 2 + stiffness/2 |max(0, forces/stiffness - rate)|^2."""
        trial = forces - stiffness * (offset + self._bands.along(edges, x))
        size = math.inf
        for _ in range(MOST_ASSOCIATED):
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

    def _residual(self, x: Array, forces: Array) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        imbalance = np.abs(x - self._free - self._bands.pull(self._rows, forces)).max()
        rates = self._rates + self._bands.along(self._rows, x)
        pressure, friction = forces[:, :2], forces[:, 2:]
        slip = rates[:, 2:]
        unilateral = np.abs(np.minimum(pressure, rates[:, :2])).max()
        # Friction at the edge of the cone, against the slip, or no slip.
        against = self._mu * pressure + np.sign(slip) * friction
        coulomb = np.minimum(against, np.abs(slip)).max()
        return float(max(imbalance, unilateral, coulomb))


LEAN = np.array([0.0, 0.0, 1.0, -1.0])
"""Friction over mu times pressure, per piece where it is known."""
