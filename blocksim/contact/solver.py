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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from blocksim.assembly import Array
from blocksim.contact.associated import associated
from blocksim.contact.banded import Bands
from blocksim.contact.springs import MOST_ROUNDS, Springs

EXACT = 1e-16
"""Yield of a contact that is round-off, with accelerations of 1 [g]."""
MOST_NEWTON = 10
"""Newton steps before the path is followed."""
MOST_PIECES = 20_000
FARTHEST = 1e9
"""Repetitions of a change of forces at once."""
Contacts = NDArray[np.int8]
"""What each contact does, shape (joints, 2): one of the four pieces of its law."""
OPEN, STICKS, SLIDES_UP, SLIDES_DOWN = range(4)
LEAN = np.array([0.0, 0.0, 1.0, -1.0])
"""Friction over its largest, on each piece where that is known."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """Accelerations and contact forces of a step.

    Parameters
    ----------
    acceleration : (blocks, 3) float
    forces : (joints, 4) float
        Pressure at the two contacts of each joint, then friction [mean weights].
    contacts : (joints, 2) int
        What each contact does.
    residual : float
        Worst of force imbalance (mean weights), penetration rate and complementarity.
    iterations : int
        Banded systems solved.
    paths : int
        Systems for which a path was followed.
    """

    acceleration: Array
    forces: Array
    contacts: Contacts
    residual: float
    iterations: int
    paths: int

    def carried(self, old: NDArray[np.int64], new: NDArray[np.int64]) -> Solution:
        """Return the same for another list of joints; those not there before are open."""
        forces, contacts = np.zeros((len(new), 4)), np.zeros((len(new), 2), dtype=np.int8)
        _, was, now = np.intersect1d(old, new, assume_unique=True, return_indices=True)
        forces[now], contacts[now] = self.forces[was], self.contacts[was]
        return replace(self, forces=forces, contacts=contacts)


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
        rows: Array,
        rates: Array,
        free: Array,
        start: Solution | None = None,
        precision: float = EXACT,
    ) -> Solution:
        """Solve one step.

        Parameters
        ----------
        rows : (joints, 4, 6) float
            Normal velocities at the two contacts from those of the two blocks (N), then
            the tangential ones (T).
        rates : (joints, 4) float
            The same velocities without acceleration, over the step (n0, t0).
        free : (blocks, 3) float
            Accelerations without contact (f).
        start : Solution, optional
            Of a similar step.
        precision : float
            Largest yield of a contact at which the step counts as solved [g].

        Returns
        -------
        Solution
        """
        return _Step(self, rows, rates, free, precision).solve(start)


class _Step:
    """The contact problem of one step, in accelerations times the root of mass."""

    def __init__(
        self, problem: ContactProblem, rows: Array, rates: Array, free: Array, precision: float
    ) -> None:
        self._bands, self._root, self._mu = problem.bands, problem.root, problem.mu
        self._rows, self._rates = rows * problem.scale, rates
        self._free = (free * self._root).ravel()
        self._precision = precision
        self._iterations = self._paths = 0

    def solve(self, start: Solution | None) -> Solution:
        """Round after round, until contact springs no longer yield."""
        springs = Springs(self._mu, self._precision)
        if start is None:
            x, forces, self._iterations = associated(
                self._bands, self._rows, self._rates, self._free, self._mu, self._precision
            )
        else:
            x, forces = (start.acceleration * self._root).ravel(), start.forces
            # The contacts do what they did, above all where accelerations have changed:
            # after an impact those of the last step say nothing.
            x = x + self._way(start.contacts, x, forces, springs.stiffness(x))
        contacts = np.zeros((len(forces), 2), dtype=np.int8)
        preload = forces
        for _ in range(MOST_ROUNDS):
            stiffness = springs.stiffness(x)
            x = self._balance(x, preload, stiffness, springs)
            forces, contacts = self._cut(self._trial(x, preload, stiffness))
            change = forces - preload
            if springs.rigid(x, float(np.abs(change).max()) / stiffness):
                break
            far = self._reach(forces, change) if springs.drifts else 0.0
            preload = forces + far * change
        return Solution(
            acceleration=x.reshape(-1, 3) / self._root,
            forces=forces,
            contacts=contacts,
            residual=self._residual(x, forces),
            iterations=self._iterations,
            paths=self._paths,
        )

    def _reach(self, forces: Array, change: Array) -> float:
        """How often a change can be repeated until a contact opens or slides.

        Two contacts of a joint that stick although the blocks turn work against each other,
        at equal accelerations, more from round to round, until one of them slides.
        """
        pressure, growth = forces[:, :2], change[:, :2]
        room = np.stack([pressure] + [self._mu * pressure - s * forces[:, 2:] for s in (1, -1)])
        loss = -np.stack([growth] + [self._mu * growth - s * change[:, 2:] for s in (1, -1)])
        ahead = (loss > 0) & (room > loss)
        return float((room[ahead] / loss[ahead]).min(initial=FARTHEST))

    def _balance(self, x: Array, forces: Array, stiffness: float, springs: Springs) -> Array:
        """Find the accelerations whose contact springs, preloaded by forces, balance."""
        solved, end = self._newton(x, forces, stiffness, springs)
        if solved:
            return end
        self._paths += 1
        found = self._path(forces, stiffness)
        return self._newton(found, forces, stiffness, springs)[1]

    def _trial(self, x: Array, forces: Array, stiffness: float) -> Array:
        """Forces of the springs before friction and opening cut them."""
        return forces - stiffness * (self._rates + self._bands.along(self._rows, x))

    def _cut(self, trial: Array) -> tuple[Array, Contacts]:
        """Forces that contacts can carry, and what the contacts do."""
        along = trial[:, 2:]
        pressure = np.maximum(trial[:, :2], 0.0)
        most = self._mu * pressure
        friction = np.minimum(np.maximum(along, -most), most)
        contacts = np.where(along > most, SLIDES_UP, STICKS)
        contacts[along < -most] = SLIDES_DOWN
        contacts[pressure == 0] = OPEN
        return np.concatenate([pressure, friction], axis=1), contacts.astype(np.int8)

    def _newton(
        self, x: Array, forces: Array, stiffness: float, springs: Springs
    ) -> tuple[bool, Array]:
        """Newton's method; whether it ended, and where."""
        size, seen = math.inf, set[bytes]()
        for _ in range(MOST_NEWTON):
            held, contacts = self._cut(self._trial(x, forces, stiffness))
            imbalance = self._imbalance(x, held)
            size, last = float(np.abs(imbalance).max()), size
            if springs.balanced(size, last, x, stiffness):
                return True, x
            state = contacts.tobytes()
            if state in seen and size > last / 2:
                break
            seen.add(state)
            x = x + self._solve(contacts, stiffness, -imbalance)
        return False, x

    def _imbalance(self, x: Array, forces: Array) -> Array:
        return x - self._free - self._bands.pull(self._rows, forces)

    def _way(self, contacts: Contacts, x: Array, forces: Array, stiffness: float) -> Array:
        """Change of x that balances the springs if each contact does what is said."""
        trial = self._trial(x, forces, stiffness)
        pressure = np.where(contacts != OPEN, trial[:, :2], 0.0)
        slides = self._mu * LEAN[contacts] * pressure
        friction = np.where(contacts == STICKS, trial[:, 2:], slides)
        imbalance = self._imbalance(x, np.concatenate([pressure, friction], axis=1))
        return self._solve(contacts, stiffness, -imbalance)

    def _solve(self, contacts: Contacts, stiffness: float, right: Array) -> Array:
        """Change of x that adds `right` to the imbalance if each contact does what is said."""
        weight = stiffness * np.concatenate([contacts != OPEN, contacts == STICKS], axis=1)
        self._iterations += 1
        return self._bands.solve(self._leaning(contacts), weight, self._rows, right)

    def _leaning(self, contacts: Contacts) -> Array:
        """Rows along which pressure acts: with its friction where a contact slides."""
        rows = self._rows.copy()
        rows[:, :2] += (self._mu * LEAN[contacts])[:, :, None] * rows[:, 2:]
        return rows

    def _path(self, forces: Array, stiffness: float) -> Array:
        """Let all contacts start apart and come together, from piece to piece.

        On each piece x is linear in how far they are kept apart. Where a contact comes to
        the edge of what it does, it changes over, and they go on coming together or part
        again for a while: whichever carries that contact across.
        """
        x, mu, sign = self._free.copy(), self._mu, 1.0
        # Each kept apart by another share, lest two change over at once, as by symmetry.
        shares = np.random.default_rng(0).uniform(1.0, 2.0, (len(forces), 2))
        trial = self._trial(x, forces, stiffness)
        apart = float(np.maximum(trial[:, :2] / shares, 0.0).max()) / stiffness
        trial[:, :2] -= stiffness * apart * shares
        contacts = np.full((len(forces), 2), OPEN, dtype=np.int8)
        # Two functions of a contact's trial forces, positive while it does what it does.
        edges = np.array(
            [
                [(-1.0, 0.0), (mu, -1.0), (1.0, 0.0), (1.0, 0.0)],
                [(0.0, 0.0), (mu, 1.0), (-mu, 1.0), (-mu, -1.0)],
            ]
        )
        way, turn = np.zeros_like(x), np.zeros_like(trial)
        turn[:, :2] = stiffness * shares
        crossed: tuple[int, int, int] | None = None
        for _ in range(MOST_PIECES):
            edge = edges[:, contacts]
            value = edge[..., 0] * trial[:, :2] + edge[..., 1] * trial[:, 2:]
            slope = sign * (edge[..., 0] * turn[:, :2] + edge[..., 1] * turn[:, 2:])
            if crossed is not None:
                slope[crossed] = 0.0
            lengths = np.full(value.shape, math.inf)
            np.divide(np.maximum(value, 0.0), -slope, out=lengths, where=slope < 0)
            which, joint, end = (int(i) for i in np.unravel_index(lengths.argmin(), value.shape))
            length = float(lengths[which, joint, end])
            if sign > 0 and length >= apart:
                return x + apart * way
            if not math.isfinite(length):
                break
            x, trial, apart = x + length * sign * way, trial + length * sign * turn, apart - sign * length
            left = edge[which, joint, end]
            old = int(contacts[joint, end])
            new = _beyond(old, which, float(trial[joint, 2 + end]))
            contacts[joint, end] = new
            pressed = np.zeros_like(trial)
            pressed[:, :2] = stiffness * shares * (contacts != OPEN)
            right = self._bands.pull(self._leaning(contacts), pressed)
            way = self._solve(contacts, stiffness, right)
            turn = -stiffness * self._bands.along(self._rows, way)
            turn[:, :2] += stiffness * shares
            onward = left[0] * turn[joint, end] + left[1] * turn[joint, 2 + end]
            sign = 1.0 if onward < 0 else -1.0
            crossed = (_beyond_edge(old, new), joint, end)
        return x

    def _residual(self, x: Array, forces: Array) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        imbalance = np.abs(self._imbalance(x, forces)).max()
        rates = self._rates + self._bands.along(self._rows, x)
        pressure, friction, slip = forces[:, :2], forces[:, 2:], rates[:, 2:]
        unilateral = np.abs(np.minimum(pressure, rates[:, :2])).max()
        # Friction at the edge of the cone, against the slip, or no slip.
        against = self._mu * pressure + np.sign(slip) * friction
        coulomb = np.minimum(against, np.abs(slip)).max()
        return float(max(imbalance, unilateral, coulomb))


def _beyond(old: int, which: int, along: float) -> int:
    """What a contact does beyond one of the two edges of what it does."""
    if old == OPEN:
        return SLIDES_UP if along > 0 else SLIDES_DOWN
    if old == STICKS:
        return SLIDES_DOWN if which else SLIDES_UP
    return STICKS if which else OPEN


def _beyond_edge(old: int, new: int) -> int:
    """Which of its edges leads back."""
    if new == STICKS:
        return 0 if old == SLIDES_UP else 1
    return 1 if old == STICKS else 0
