"""One step's contact problem: unilateral contact and Coulomb friction, solved to its end.

For x, the mean accelerations over the step, and p, the contact forces,

    M (x - f) = N^T p_n + T^T p_t,    0 <= p_n  _|_  n >= 0,    |p_t| <= mu p_n, against t,

where n = n0 + N x and t = t0 + T x are the normal and tangential velocities at the end of
the step over its length. Only neighbours touch, so all matrices are banded and a step costs
as much as the number of blocks.

What each contact does is guessed, and mended until all forces and velocities agree with it
(`active_set.py`). Guesses are taken in turn, until one leads to a solution:

- what the contacts did in the last step, then the end of a short path from there
  (`path_following.py`);
- from nothing, the solution for friction that dilates, to half of its digits (`interior.py`),
  then to the last (`associated.py`): of the two answers that Coulomb's may have, rest and
  motion, that is rest if there is any;
- the end of an interior-point method for Coulomb friction, steep one taken to be less;
- from nothing, the end of a path that begins at the last of these guesses, if it is short, or
  at the first;
- the end of a path that begins with all contacts apart.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.active_set import settle
from blocksim.engines.contact.associated import minimised
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.coulomb import Contacts, Friction
from blocksim.engines.contact.interior import central_path
from blocksim.engines.contact.path_following import (
    LAST_PIECES,
    NEAREST_PIECES,
    come_together,
    put_right,
)
from blocksim.engines.contact.step import Answer, Step
from blocksim.engines.contact.threads import one_thread

EXACT = 1e-16
"""Yield of a contact that is round-off, with accelerations of 1 [g]."""
SURE = 1e-6
"""Residual over the accelerations at which blocks surely move: faces that do not quite fit keep
what contacts do from being told."""
NEAR_REST = 1e-4
"""Accelerations below which an arch is so near its limit that half of the digits say little."""
SOLVED = 1e-9
"""Residual of a solution."""
TAME = 10.0, 3.0
"""Friction that is taken in place of steep one, for guesses of what contacts do."""
MOST_PARTINGS, PARTED = 5, 1e-8
"""How often steep friction is taken from joints that part; what counts as parting [g], and as
friction [mean weights]."""
ENOUGH = 3e-8
"""Residual for which no path is followed: of a moving step, because once they have moved joints
may not close any better; from nothing if contacts are told, as a path tells them no better."""


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
    """

    acceleration: Array
    forces: Array
    contacts: Contacts
    residual: float
    iterations: int

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
    points : (blocks, 2) float, optional
        Where the blocks are, about; it makes no difference but in time.
    """

    def __init__(
        self,
        before: NDArray[np.int64],
        after: NDArray[np.int64],
        mass: Array,
        mu: ArrayLike,
        points: Array | None = None,
    ) -> None:
        self.friction = Friction.of(mu, len(before))
        self.root = np.sqrt(mass)
        self.bands = Bands(before, after, len(mass), points)
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
            Yield of contacts at which the step counts as solved [g].

        Returns
        -------
        Solution
        """
        step = Step(
            bands=self.bands,
            rows=rows * self.scale,
            rates=rates,
            free=(free * self.root).ravel(),
            friction=self.friction,
        )
        with one_thread(wide=self.bands.is_wide):
            return self._solved(step, start, precision)

    def _solved(self, step: Step, start: Solution | None, precision: float) -> Solution:
        """Take guesses in turn until one leads to a solution."""
        guesses: list[Answer] = []
        tried: list[Answer] = []
        spent = 0
        for guess in self._guesses(step, start):
            guesses.append(guess)
            found = settle(step, guess, precision)
            tried += found
            best = found[-1] if found else guess
            spent += best.systems
            if best.is_settled and best.residual <= SOLVED:
                break
        else:
            best = _best(step, tried)
            for path in self._paths(step, guesses, known=start is not None):
                if (best.is_settled or start is not None) and best.residual <= ENOUGH:
                    break
                if guess := path():
                    found = settle(step, guess, precision)
                    spent += found[-1].systems if found else 0
                    best = _best(step, [best, *found])
        # From nothing an answer close by may be that of another arch.
        close = SURE * min(1.0, float(np.abs(best.x).max()))
        sure = best.is_settled or start is not None or best.residual <= close
        return Solution(
            acceleration=best.x.reshape(-1, 3) / self.root,
            forces=best.forces,
            contacts=best.contacts,
            residual=best.residual if sure else math.inf,
            iterations=spent,
        )

    def _guesses(self, step: Step, start: Solution | None) -> Iterator[Answer]:
        """Give what contacts may do, the likeliest and cheapest first."""
        if start is None:
            cones = Cones.of(step)
            x, pressed, systems = central_path(step, cones, dilates=True)
            yield cones.answer(step, x, pressed, systems)
            if step.friction.some_steep or float(np.abs(x).max()) < NEAR_REST:
                x, pressed, systems = minimised(step, cones, x, pressed)
                answer = cones.answer(step, x, pressed, systems)
                yield answer
                yield from _parted(step, answer)
            for tame in _tamed(step):
                yield _coulomb(tame)
        else:
            x = (start.acceleration * self.root).ravel()
            last = Answer(x=x, forces=start.forces, contacts=start.contacts)
            yield last
            if not step.friction.some_steep and (end := put_right(step, last, LAST_PIECES)):
                yield end

    def _paths(
        self, step: Step, guesses: list[Answer], *, known: bool
    ) -> Iterator[Callable[[], Answer | None]]:
        """Give what takes longer, the shorter one first."""
        if known:
            for tame in _tamed(step):
                yield lambda tame=tame: _coulomb(tame)
        elif not step.friction.some_steep:
            yield lambda: put_right(step, guesses[-1], NEAREST_PIECES)
            yield lambda: put_right(step, guesses[0])
        yield lambda: come_together(step, None if known else guesses[-1].forces)


def _tamed(step: Step) -> Iterator[Step]:
    """Give the step with friction that is not steep."""
    for most in TAME if step.friction.some_steep else (math.inf,):
        yield replace(step, friction=step.friction.at_most(most))


def _coulomb(step: Step) -> Answer:
    """Return the end of the interior-point method for Coulomb friction."""
    cones = Cones.of(step)
    return cones.answer(step, *central_path(step, cones, dilates=False))


def _best(step: Step, tried: list[Answer]) -> Answer:
    """Return the best of answers, a settled one if there is any."""
    known = [
        replace(each, residual=step.residual(each.x, each.forces))
        if each.residual == math.inf
        else each
        for each in tried
    ]
    known = [each for each in known if math.isfinite(each.residual)]
    nothing = Answer.of_nothing(step)
    return min(known, key=lambda each: (not each.is_settled, each.residual), default=nothing)


def _parted(step: Step, answer: Answer) -> Iterator[Answer]:
    """Take friction from joints that hold it across a gap, until none does.

    Steep friction that dilates needs no pressure. So it goes on where joints part, which
    Coulomb's may not.
    """
    for _ in range(MOST_PARTINGS):
        least = step.velocities(answer.x)[:, :2].min(axis=1, keepdims=True)
        rubs = np.abs(answer.forces[:, 2:]).max(axis=1, keepdims=True)
        parts = step.friction.steep & (np.minimum(least, rubs) > PARTED)
        if not parts.any():
            return
        step = replace(step, friction=Friction(np.where(parts, 0.0, step.friction.mu)))
        cones = Cones.of(step)
        x, pressed, systems = central_path(step, cones, dilates=True)
        x, pressed, more = minimised(step, cones, x, pressed)
        answer = cones.answer(step, x, pressed, systems + more)
        yield answer
