"""Blocks in motion: smooth between impacts, impacts where they are.

Between impacts a step is of second order (Moreau and Jean, theta = 1/2): forces are those of
its middle, contact and friction hold for the velocities at its end, and blocks go on by the
mean of the velocities at both ends. What is open is left alone. Where it has closed by the end
of the step, the step ends where it closes, and an impact follows: velocities jump there, as
contact and friction ask, and nothing moves meanwhile. What approaches so slowly that the moment
makes no difference closes within a step of first order, but does not pass. What overlaps all
the same is pushed apart, which changes no velocity.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.engines.contact.coulomb import OPEN, STICKS
from blocksim.engines.contact.events import first_closing
from blocksim.engines.contact.geometry import Touch
from blocksim.engines.contact.solver import Solution
from blocksim.engines.placed import Placed

RESIDUAL = 1e-7
UNSOLVED = 1e-4
"""Residual of a step that is not taken."""
PRECISION = 1e-12
"""Yield of contacts left in a moving step [g]."""
HALVINGS = 5
"""How often a step that is not solved is halved."""
CLOSED = 1e-12
"""Gap that counts as none: round-off of the corners' places."""
BENT = 1e-7
"""Most of a gap that counts as none at a contact that was closed. A step goes straight where
blocks turn, which leaves gaps as large as the square of its way. Those of blocks that turn as
one contradict each other: no contact forces close them all in the next step."""
SHUT, PRESSED = 1e-6, 1e-4
"""Gap up to which a contact that moves slowly is closed, and one that pressed [size]."""
SLOWLY = 1e-3
"""Velocity of blocks [sqrt(size g)]; they hit with more than the accuracy's share of theirs."""
MATTERS = 1e-3
"""Way of what hits in a step, over the accuracy, up to which the moment makes no difference."""
LOCATED = 1e-10
"""Overlap at an impact that is none [size]."""
ROUNDS, MOST_PARTS, FEW, CROWD = 5, 4, 4, 32
"""Most looks for one moment; most impacts in a step, before the rest of it and some steps after
it are of first order: twice as many each time it happens again, one less where it does not."""
LEAST = 1e-9
"""Share of a step that is none."""
SHORT = 0.1
"""Share of the usual step below which a step tells nothing of accelerations."""
REGAIN = 1.0
"""Share of a small gap or overlap that is made up for in a step."""
DEEP = 1e-5
"""Overlap that a step makes up for at most [size]."""
FAR = 1e3
"""Velocity that a contact taken for open cannot lose in a step, over those there are."""
MOVES = 1e-6
"""Acceleration that begins a motion [g]."""
Passing = NDArray[np.bool_]
"""Of contacts, shape (joints, 2)."""


class Stepping(Placed):
    """Poses and velocities of blocks, carried on by steps.

    `accuracy`: Share by which motion may be off.
    `restitution`: Share of the velocity with which blocks hit that they part with (Newton's).
    """

    def __init__(self, problem: Problem, accuracy: float, restitution: float) -> None:
        super().__init__(problem)
        self._accuracy, self._restitution = accuracy, restitution
        self._speeding: Array = np.zeros_like(self._poses)
        self._usual = self._penetration = 0.0
        self._way: float = 0.0
        self._crowded, self._crowd = 0, FEW

    def _move(self, step: float) -> None:
        """Go on from impact to impact; by steps of first order where they crowd."""
        self._usual = left = step
        parts = MOST_PARTS if self._crowded else 0
        if self._crowded:
            self._crowded -= 1
        while left > LEAST * step:
            if not self._residual <= UNSOLVED:
                # A step that cannot be solved was the last: the blocks stay.
                return
            if parts < MOST_PARTS:
                left -= self._part(left)
            else:
                left -= self._solved(self._closing, left)[1]
                self._push_apart()
            parts += 1
            if parts == MOST_PARTS:
                self._crowd = self._crowded = min(2 * self._crowd, CROWD)
        if parts < MOST_PARTS:
            self._crowd = max(FEW, self._crowd - 1)

    def _part(self, step: float) -> float:
        """Take a step, or what of it comes before the first impact; return its length."""
        before = vars(self).copy()
        passing, step = self._solved(self._smooth, step)
        if passing.any():
            if self._fastest(passing) * step > MATTERS * self._accuracy:
                taken = self._to_impact(before, step, passing)
                if taken is not None:
                    return taken
            vars(self).update(before)
            _, step = self._solved(self._closing, step)
        self._push_apart()
        return step

    def _solved(self, take: Callable[[float], Passing], step: float) -> tuple[Passing, float]:
        """Take a step, halved until it is solved; return what passed, and its length."""
        before = vars(self).copy()
        found = take(step)
        for _ in range(HALVINGS):
            if self._residual <= max(RESIDUAL, before["_residual"]):
                break
            vars(self).update(before)
            step /= 2
            found = take(step)
        return found, step

    def _to_impact(
        self, before: dict[str, object], step: float, passing: Passing
    ) -> float | None:
        """Take a step up to the first impact; return its length, None if none is found."""
        whole = step
        for _ in range(ROUNDS):
            (gap, rate), (later, at_end) = (
                (one[passing], two[passing]) for one, two in (self._begins, self._ends)
            )
            step = first_closing(gap + LOCATED / 2, rate, later + LOCATED / 2, at_end, step)
            found = self._keys, self._solution
            vars(self).update(before)
            if step < LEAST * whole:
                # What touches and approaches at the start hits there.
                self._look(whole)
                return 0.0 if self._impact() else None
            # What contacts do in a part of a step is what they did in all of it.
            self._guess = found
            passing = self._smooth(step)
            if not self._residual <= RESIDUAL:
                return None
            passing &= self._ends[0] < -LOCATED
            if not passing.any():
                return step if self._impact() else None
        return None

    def _fastest(self, passing: Passing) -> float:
        """Return the largest velocity with which contacts pass."""
        return -float(self._ends[1][passing].min())

    def _smooth(self, step: float) -> Passing:
        """Take a step in which what is open stays open; tell what would have closed."""
        self._drive(step)
        speeding = self._speeding
        self._looked = self._poses + step / 2 * (self._velocities + step / 4 * speeding)
        self._pull()
        self._shake(step)
        touch = self._touch(self._looked, step)
        start = self._contacts()
        touch = self._neighbours.followed(touch, self._looked, start)
        rate = self._rates(start.rows, self._velocities)
        shut = self._is_shut(start.gap, rate[:, :2])
        rates = self._rates(touch.rows, self._velocities)
        rates += self._rates(self._turn(start, touch, step), self._velocities + step * speeding)
        gap = np.where(np.abs(start.gap) > self._closed(touch), start.gap, 0.0)
        rates[:, :2] += REGAIN * np.maximum(gap, -DEEP) / max(step, self._usual)
        rates[:, :2][~shut] += FAR * (1 + float(np.abs(rates).max(initial=0.0)))
        began = _moves(self._solution)
        solution = self._solve(touch, rates / step, PRECISION)
        if self._is_at_rest and not began and _moves(solution):
            solution = self._or_rest(touch, rates / step, solution)
        self._shut = shut
        self._begins = start.gap, rate[:, :2]
        if not solution.residual <= UNSOLVED:
            return np.zeros_like(shut)
        self._advance(step, step * solution.acceleration, 0.5)
        if step > SHORT * self._usual:
            self._speeding = solution.acceleration
        end = self._neighbours.followed(self._contacts(), self._poses, start)
        self._ends = end.gap, self._rates(end.rows, self._velocities)[:, :2]
        self._ended = end
        passes = end.gap < np.minimum(0.0, start.gap) - CLOSED
        return ~shut & passes & (self._ends[1] < 0)

    def _or_rest(self, touch: Touch, rates: Array, moves: Solution) -> Solution:
        """Return the rest of blocks at rest that may also start to move, if there is one.

        Friction may allow both, and what is known of the last step leads to either.
        """
        found = self._problem.solve(touch.rows, rates, self._free, None, PRECISION)
        if not found.residual <= RESIDUAL or _moves(found):
            return moves
        self._solution = found
        return found

    def _look(self, step: float) -> None:
        """See what is closed, and what approaches, where the blocks are."""
        self._touch(self._poses, step)
        found = self._ended = self._contacts()
        self._ends = found.gap, self._rates(found.rows, self._velocities)[:, :2]
        self._shut = self._is_shut(*self._ends)

    def _is_shut(self, gap: Array, rate: Array) -> Passing:
        """Tell which contacts are closed, and not about to hit or to leave."""
        fastest = np.append(self._speeds(), 0.0)[self._pairs].max(axis=1, keepdims=True)
        stays = np.abs(rate) <= self._accuracy * np.maximum(fastest, SLOWLY)
        stays &= gap <= SHUT
        if self._solution is not None:
            stays |= (self._solution.contacts != OPEN) & (gap <= PRESSED)
        return stays

    def _turn(self, start: Touch, middle: Touch, step: float) -> Array:
        """Return by how much rows change from the middle to the end of a step."""
        turn = middle.rows - start.rows
        # A contact that has gone to another corner has not turned.
        most = 2 * step * float(np.abs(self._velocities).max(initial=0.0)) + SHUT
        turn[np.abs(turn).max(axis=(1, 2)) > most] = 0.0
        if len(self._smooth_joints):
            turn[self._smooth_joints, 2:] = 0.0
        return turn

    def _impact(self) -> bool:
        """Let velocities jump so that nothing closes further; tell whether they could."""
        gap, rate = self._ends
        # What passes the line of a face beyond its end does not touch it.
        there = self._contacts().gap.min(axis=1, keepdims=True) <= SHUT
        # What closes a moment later hits as well, or the order would be that of round-off.
        shut = self._shut | ((gap <= SHUT) & (rate < 0) & there)
        hits = shut & ~self._shut
        if not hits.any():
            return True
        speed = -float(rate[hits].min())
        touch = self._ended
        if len(self._smooth_joints):
            touch.rows[self._smooth_joints, 2:] = 0.0
        rates = self._rates(touch.rows, self._velocities) / speed
        rates[:, :2][hits] *= 1 + self._restitution
        rates[:, :2][~shut] += FAR * (1 + float(np.abs(rates).max()))
        last = self._solution
        assert last is not None  # noqa: S101
        guess = replace(
            last,
            acceleration=np.zeros_like(self._poses),
            forces=np.zeros_like(last.forces),
            contacts=np.where(hits, STICKS, last.contacts).astype(np.int8),
        )
        found = self._problem.solve(
            touch.rows, rates, np.zeros_like(self._poses), guess, PRECISION
        )
        if not found.residual <= RESIDUAL:
            return False
        self._residual = max(self._residual, found.residual)
        self._velocities = self._velocities + speed * found.acceleration
        self._solution = replace(last, contacts=found.contacts)
        return True

    def _closing(self, step: float) -> Passing:
        """Take a step of first order, in which what is open closes and does not pass."""
        self._drive(step)
        self._looked = self._poses + step / 2 * self._velocities
        self._pull()
        self._shake(step)
        touch = self._touch(self._looked, step)
        rates = self._rates(touch.rows, self._velocities)
        gap = touch.gap - step / 2 * rates[:, :2]
        gap = np.where(np.abs(gap) > self._closed(touch), gap, 0.0)
        rates[:, :2] += np.maximum(gap, -DEEP) / step
        solution = self._solve(touch, rates / step, PRECISION)
        if solution.residual <= UNSOLVED:
            self._advance(step, step * solution.acceleration, 1.0)
        return np.zeros(gap.shape, dtype=np.bool_)

    def _advance(self, step: float, gained: Array, share: float) -> None:
        """Go on with velocities that gain, and with a share of that on the way."""
        way = step * (self._velocities + share * gained)
        self._poses = self._poses + way
        self._velocities = self._velocities + gained
        self._way = max(self._way, float(np.abs(way).max()))

    def _push_apart(self) -> None:
        """Move blocks that overlap apart, as little as contact and friction allow."""
        if not self._residual <= UNSOLVED:
            return
        touch = self._contacts()
        gap = touch.gap
        deep = -float(gap.min(initial=0.0))
        if (gap < self._deepest).any() and self._solution is not None:
            rates = np.zeros((len(gap), 4))
            rates[:, :2] = gap / deep
            nothing = np.zeros_like(self._poses)
            guess = replace(
                self._solution,
                acceleration=nothing,
                forces=np.zeros_like(rates),
                contacts=np.where(gap < 0, STICKS, OPEN).astype(np.int8),
            )
            found = self._problem.solve(touch.rows, rates, nothing, guess, PRECISION)
            if found.residual <= UNSOLVED:
                self._poses = self._poses + deep * found.acceleration
                deep = -float(self._contacts().gap.min())
        self._penetration = max(self._penetration, deep)

    def _closed(self, touch: Touch) -> Array:
        """Return gaps that count as none, shape (joints, 2)."""
        none = np.full(touch.gap.shape, CLOSED)
        if self._solution is not None:
            none[self._solution.contacts != OPEN] += min(self._way**2, BENT)
        return none


def _moves(solution: Solution | None) -> bool:
    """Tell whether blocks are known to begin to move."""
    return solution is not None and float(np.abs(solution.acceleration).max()) > MOVES
