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
- Then a path is followed that begins with all contacts apart and cannot fail to arrive
  (`path_following.py`).
- From nothing, the associated problem, whose friction dilates, is solved first. It is a
  strictly convex quadratic programme, and Newton's method with an exact line search ends it
  from anywhere. Where nothing slides, its solution is the one sought.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.associated import associated
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.coulomb import OPEN, STICKS, Contacts, Friction, leaning
from blocksim.engines.contact.path_following import Balance, come_together, shrink
from blocksim.engines.contact.slides import Slides
from blocksim.engines.contact.springs import MOST_ROUNDS, Springs

EXACT = 1e-16
"""Yield of a contact that is round-off, with accelerations of 1 [g]."""
MOST_NEWTON = 10
"""Newton steps before the path is followed."""
MOST_PATHS = 10
"""Paths of one step with steep friction; one that needs more is not solved by them."""
STEEP_NEWTON = 30
"""The same with steep friction, where they find their way out of more."""
ASTRAY = 1e20
"""Forces out of balance from which Newton's method does not come back [mean weights]."""
FARTHEST = 1e9
"""Repetitions of a change of forces at once."""


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
        Worst of force imbalance (mean weights), penetration rate and complementarity [g],
        over the largest acceleration where that is above 1.
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
    mu : float or (joints,) float
        Friction coefficient of all joints, or of each; 0 and inf allowed.
    """

    def __init__(
        self, before: NDArray[np.int64], after: NDArray[np.int64], mass: Array, mu: ArrayLike
    ) -> None:
        self.friction = Friction.of(mu, len(before))
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
        self._bands, self._root = problem.bands, problem.root
        self._friction = problem.friction
        self._rows, self._rates = rows * problem.scale, rates
        self._free = (free * self._root).ravel()
        self._precision = precision
        self._iterations = self._paths = 0

    def solve(self, start: Solution | None) -> Solution:
        """Round after round, until contact springs no longer yield."""
        springs = Springs(self._friction, self._precision)
        if start is None:
            x, forces, self._iterations = associated(
                self._bands,
                self._rows,
                self._rates,
                self._free,
                self._friction,
                self._precision,
            )
            forces = self._friction.gathered(forces)
            contacts = np.full((len(forces), 2), STICKS, dtype=np.int8)
            held = np.abs(forces[:, 2:])
        else:
            x, forces = (start.acceleration * self._root).ravel(), start.forces
            # The contacts do what they did, above all where accelerations have changed:
            # after an impact those of the last step say nothing.
            contacts, stiffness = start.contacts, springs.stiffness(x)
            glued, held = self._glued(x, forces, stiffness), np.abs(forces[:, 2:])
            way, more = self._way(contacts, x, glued, held, stiffness)
            x, held = x + way, held + more
        preload = forces
        for _ in range(MOST_ROUNDS):
            stiffness = springs.stiffness(x)
            x, place = self._balance(x, contacts, held, preload, stiffness, springs)
            forces, contacts = self._friction.cut(place)
            held = np.abs(forces[:, 2:])
            change = forces - preload
            if springs.rigid(x, float(np.abs(change).max(initial=0.0)) / stiffness):
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
        """Return how often a change can be repeated until a contact opens or slides.

        Two contacts of a joint that stick although the blocks turn work against each other,
        at equal accelerations, more from round to round, until one of them slides.
        """
        pressure, growth = forces[:, :2], change[:, :2]
        a, b = self._friction.room
        room = np.stack([pressure] + [a * pressure - s * b * forces[:, 2:] for s in (1, -1)])
        loss = -np.stack([growth] + [a * growth - s * b * change[:, 2:] for s in (1, -1)])
        ahead = (loss > 0) & (room > loss)
        return float((room[ahead] / loss[ahead]).min(initial=FARTHEST))

    def _balance(
        self,
        x: Array,
        contacts: Contacts,
        held: Array,
        preload: Array,
        stiffness: float,
        springs: Springs,
    ) -> tuple[Array, Array]:
        """Find the accelerations whose contact springs balance, and `Friction.unfold`."""
        balance = Balance(
            bands=self._bands,
            rows=self._rows,
            bare=preload - stiffness * self._rates,
            free=self._free,
            friction=self._friction,
            stiffness=stiffness,
        )
        solved, end, place = self._newton(x, contacts, held, balance, springs)
        if solved or (self._friction.some_steep and self._paths == MOST_PATHS):
            return end, place
        self._paths += 1
        for path in (partial(shrink, balance, x), partial(come_together, balance)):
            found, pieces = path()
            self._iterations += pieces
            if found is not None:
                solved, end, place = self._newton(
                    found.x, found.contacts, found.held, balance, springs
                )
                if solved:
                    break
        return end, place

    def _newton(
        self, x: Array, contacts: Contacts, held: Array, balance: Balance, springs: Springs
    ) -> tuple[bool, Array, Array]:
        """Newton's method; whether it ended, and where: if not, where least was left."""
        size, seen, state = math.inf, set[bytes](), b""
        glued = balance.glued(x)
        place = self._friction.unfold(glued, contacts, held)
        least, best = math.inf, (x, place)
        for _ in range(STEEP_NEWTON if self._friction.some_steep else MOST_NEWTON):
            forces, contacts = self._friction.cut(place)
            imbalance = balance.imbalance(x, forces)
            size, last = float(np.abs(imbalance).max()), size
            if self._friction.some_steep:
                size = max(size, self._unlike(forces, contacts, glued))
            if springs.balanced(size, last, x, balance.stiffness):
                return True, x, place
            if size < least:
                least, best = size, (x, place)
            # What only grows ends out of the range of numbers.
            if not size < ASTRAY:
                break
            way, more = self._way(contacts, x, glued, place[:, :2], balance.stiffness)
            held = place[:, :2] + more
            state, before = contacts.tobytes(), state
            # In a circle: half way leads out of many. Friction that is an unknown of its
            # own may take a second step where contacts do what they did.
            again = self._friction.some_steep and state == before
            x = x + way * (0.5 if state in seen and not again else 1.0)
            seen.add(state)
            glued = balance.glued(x)
            place = self._friction.unfold(glued, contacts, held)
        return False, *best

    def _unlike(self, forces: Array, contacts: Contacts, glued: Array) -> float:
        """How far the pressure of steep contacts is from that of their springs."""
        off = np.abs(forces[:, :2] - np.where(contacts == OPEN, 0.0, glued[:, :2]))
        return float(np.where(self._friction.steep, off, 0.0).max())

    def _glued(self, x: Array, preload: Array, stiffness: float) -> Array:
        """Return the springs' forces before opening and friction cut them."""
        return preload - stiffness * (self._rates + self._bands.along(self._rows, x))

    def _imbalance(self, x: Array, forces: Array) -> Array:
        return x - self._free - self._bands.pull(self._rows, forces)

    def _way(
        self, contacts: Contacts, x: Array, glued: Array, held: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Return the change of x that balances the springs if each contact does as said.

        And that of `held`, the friction of contacts that slide with steep friction.
        """
        friction = self._friction
        forces = friction.as_said(glued, contacts, held)
        right = -self._imbalance(x, forces)
        own = friction.own(contacts)
        closed = (contacts != OPEN) & ~own
        weight = stiffness * np.concatenate([closed, contacts == STICKS], axis=-1)
        acting = leaning(self._rows, contacts, friction.lean)
        self._iterations += 1
        if not own.any():
            return self._bands.solve(acting, weight, self._rows, right), np.zeros(own.shape)
        slides = Slides(self._bands, self._rows, contacts, own, friction.flattest)

        def solve(besides: Array) -> Array:
            both = np.column_stack([right, besides])
            return self._bands.solve(acting, weight, self._rows, both)

        return slides.solve(solve, (glued[:, :2] - forces[:, :2]) / stiffness, stiffness)

    def _residual(self, x: Array, forces: Array) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        imbalance = np.abs(self._imbalance(x, forces)).max()
        rates = self._rates + self._bands.along(self._rows, x)
        pressure, friction, slip = forces[:, :2], forces[:, 2:], rates[:, 2:]
        unilateral = np.abs(np.minimum(pressure, rates[:, :2])).max(initial=0.0)
        # Friction at the edge of the cone, against the slip, or no slip.
        a, b = self._friction.room
        against = a * pressure + b * np.sign(slip) * friction
        coulomb = np.minimum(against, np.abs(slip)).max(initial=0.0)
        if self._friction.some_steep:
            # Nor does friction help the slip, or act across a gap.
            for wrong in (
                np.minimum(np.sign(slip) * friction, np.abs(slip)),
                np.minimum(np.abs(friction), rates[:, :2]),
            ):
                coulomb = max(coulomb, float(np.where(self._friction.steep, wrong, 0.0).max()))
        return float(max(imbalance, unilateral, coulomb)) / max(1.0, float(np.abs(x).max()))
