"""One step's contact problem: unilateral contact and Coulomb friction, solved to its end.

For x, the mean accelerations over the step, and p, the contact forces,

    M (x - f) = N^T p_n + T^T p_t,    0 <= p_n  _|_  n >= 0,    |p_t| <= mu p_n, against t,

where n = n0 + N x and t = t0 + T x are the normal and tangential velocities at the end of
the step over its length. Only neighbours touch, so all matrices are banded and a step costs
as much as the number of blocks.

What each contact does is guessed, and mended until all forces and velocities agree with it
(`active_set.py`). Guesses are taken in turn, until one leads to a solution:

- what the contacts did in the last step, then the end of a short path from there
  (`path_following.py`), of friction that is not steep;
- from nothing, the solution for friction that dilates, to half of its digits (`interior.py`),
  then to the last (`associated.py`): of the two answers that Coulomb's may have, rest and
  motion, that is rest if there is any;
- the end of an interior-point method for Coulomb friction, steep one less;
- of friction that is not steep, in motion the end of a path that goes around its folds
  (`jammed.py`), and a short one from there; from nothing short paths, and what springs make of
  the way of alternating directions (`alternating.py`);
- the end of a path from all contacts apart (`path_following.py`): from nothing, and of steep
  friction, then with the forces found so far first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.active_set import by_active_set
from blocksim.engines.contact.alternating import alternated
from blocksim.engines.contact.associated import augmented_lagrangian, parted
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.coulomb import Contacts, Friction
from blocksim.engines.contact.interior import CAREFUL, central_path
from blocksim.engines.contact.jammed import around_folds
from blocksim.engines.contact.path_following import (
    LAST_PIECES,
    NEAREST_PIECES,
    path_from_apart,
    path_from_guess,
)
from blocksim.engines.contact.step import Answer, Step

EXACT = 1e-16
"""Yield of a contact that is round-off, with accelerations of 1 [g]."""
SURE = 1e-6
"""Residual over the accelerations at which blocks surely move: faces that do not quite fit keep
what contacts do from being told."""
NEAR_REST = 1e-4
"""Accelerations below which an arch is so near its limit that half of the digits say little."""
AT_REST = 1e-11
"""Accelerations, and residual, of rest: an arch 1e-9 below its limit has 3e-10."""
SOLVED = 1e-9
"""Residual of a solution."""
TAME = 10.0, 3.0
"""Friction that is taken in place of steep one, for guesses of what contacts do."""
FAR = 4.0
"""Velocity of joints that open, over the fastest that close, from which they are left out."""
ENOUGH = 3e-8
"""Residual for which no path is followed: of a moving step, because once they have moved joints
may not close any better; from nothing if contacts are told, as a path tells them no better."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """Accelerations and contact forces of a step.

    `acceleration`, (blocks, 3).
    `forces`, (joints, 4): Pressure at the two contacts of each joint, then friction [mean
        weights].
    `contacts`, (joints, 2): What each contact does.
    `residual`: Worst of force imbalance (mean weights), penetration rate and complementarity
        [g], over the largest acceleration where that is above 1.
    `iterations`: Banded systems solved.
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

    `before`, `after`, (joints,): Blocks on both sides of each joint, -1 for the ground.
    `mass`, (blocks, 3): Mass, mass and moment of inertia, in mean masses.
    `mu`, float or (joints,): Friction coefficient of all joints, or of each; 0 and inf allowed.
    `points`, (blocks, 2): Where the blocks are, about; it makes no difference but in time.
    """

    def __init__(
        self,
        before: NDArray[np.int64],
        after: NDArray[np.int64],
        mass: Array,
        mu: ArrayLike,
        points: Array | None = None,
    ) -> None:
        self._before, self._after, self._mass, self._points = before, after, mass, points
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

        `rows`, (joints, 4, 6): Normal velocities at the two contacts from those of the two
            blocks (N), then the tangential ones (T).
        `rates`, (joints, 4): The same velocities without acceleration, over the step (n0, t0).
        `free`, (blocks, 3): Accelerations without contact (f).
        `start`: Of a similar step.
        `precision`: Yield of contacts at which the step counts as solved [g].
        """
        if not len(rates):
            # Nothing touches anything.
            return Solution(
                acceleration=free,
                forces=np.zeros((0, 4)),
                contacts=np.zeros((0, 2), dtype=np.int8),
                residual=0.0,
                iterations=0,
            )
        # What opens faster than others close carries nothing, or is taken in where it closes.
        closing = rates[:, :2] + self.bands.along(rows[:, :2], free.ravel())
        fastest = max(1.0, -float(closing.min()))
        near = rates[:, :2].min(axis=1) <= FAR * fastest
        every = np.arange(len(rates))
        while not near.all():
            which = np.flatnonzero(near)
            begun = start.carried(every, which) if start else None
            part = self._of(near)
            found = part.solve(rows[near], rates[near], free, begun, precision).carried(
                which, every
            )
            closing = rates[:, :2] + self.bands.along(rows[:, :2], found.acceleration.ravel())
            closes = ~near & (closing < 0).any(axis=1)
            if not closes.any():
                return found
            near |= closes
        return self._solved(rows, rates, free, start, precision)

    def _of(self, near: NDArray[np.bool_]) -> ContactProblem:
        """Return the problem without the other joints."""
        mu, before, after = self.friction.mu[near, 0], self._before[near], self._after[near]
        return ContactProblem(before, after, self._mass, mu, self._points)

    def _solved(
        self,
        rows: Array,
        rates: Array,
        free: Array,
        start: Solution | None,
        precision: float,
    ) -> Solution:
        """Solve a step with all joints."""
        step = Step(
            bands=self.bands,
            rows=rows * self.scale,
            rates=rates,
            free=(free * self.root).ravel(),
            friction=self.friction,
        )
        with self.bands.one_thread():
            tried = _Tried(step, precision, moves=start is not None)
            guesses = self._from(step, start, tried) if start else _from_nothing(step, tried)
            for guess in guesses:
                if guess and tried.settle(guess):
                    break
            best = tried.best
        # From nothing an answer close by may be that of another arch.
        close = SURE * min(1.0, float(np.abs(best.x).max()))
        sure = best.is_settled or start is not None or best.residual <= close
        return Solution(
            acceleration=best.x.reshape(-1, 3) / self.root,
            forces=best.forces,
            contacts=best.contacts,
            residual=best.residual if sure else math.inf,
            iterations=tried.systems,
        )

    def _from(self, step: Step, start: Solution, tried: _Tried) -> Iterator[Answer | None]:
        """Give what contacts may do after the last step, the likeliest and cheapest first."""
        x = (start.acceleration * self.root).ravel()
        guess = Answer(x=x, forces=start.forces, contacts=start.contacts)
        if step.friction.some_steep:
            yield _at_rest(step, guess)
        yield guess
        # Where friction allows both, what rests stays: other methods may let it move.
        yield path_from_guess(step, guess, LAST_PIECES)
        for tame in _tamed(step):
            if not tried.is_enough:
                yield _coulomb(tame, CAREFUL[2], moves=True)
        if not step.friction.some_steep and not tried.is_enough:
            yield (found := around_folds(step))
            yield path_from_guess(step, found, LAST_PIECES)
        if step.friction.some_steep and not tried.is_enough:
            yield path_from_apart(step)


class _Tried:
    """Answers that guesses have led to.

    `precision`: Yield of contacts at which it counts as solved [g].
    `moves`: Whether the last step is known.
    `may_rest`: Whether a motion is no solution yet, as rest has to be looked for first.
    """

    def __init__(self, step: Step, precision: float, *, moves: bool) -> None:
        self._step, self._precision = step, precision
        self.moves = moves
        self._answers: list[Answer] = []
        self.may_rest = False
        self.systems = 0

    def settle(self, guess: Answer) -> bool:
        """Look for the solution near a guess; tell whether it is found."""
        found = (
            [guess] if guess.is_settled else by_active_set(self._step, guess, self._precision)
        )
        # What is looked for near a guess may be farther off than the guess.
        self._answers += [guess, *found]
        self.systems += self._answers[-1].systems
        return self._is_solution(self._answers[-1])

    @property
    def is_enough(self) -> bool:
        """Whether nothing longer need be tried."""
        best = self.best
        return (best.is_settled or self.moves) and best.residual <= ENOUGH

    @property
    def best(self) -> Answer:
        """The best of them."""
        if self._answers and self._is_solution(self._answers[-1]):
            return self._answers[-1]
        self._answers = [
            replace(each, residual=self._step.residual(each.x, each.forces))
            if each.residual == math.inf
            else each
            for each in self._answers
        ]
        known = [each for each in self._answers if math.isfinite(each.residual)]
        nothing = Answer.of_nothing(self._step)
        return min(known, key=self._wrong, default=nothing)

    def _wrong(self, answer: Answer) -> tuple[bool, float]:
        """Return how wrong an answer is: at rest what contacts do has to be told, too."""
        return not (answer.is_settled or self.moves), answer.residual

    def _is_solution(self, answer: Answer) -> bool:
        moves = self.may_rest and float(np.abs(answer.x).max()) > AT_REST
        return answer.is_settled and answer.residual <= SOLVED and not moves


def _from_nothing(step: Step, tried: _Tried) -> Iterator[Answer | None]:
    """Give what contacts may do at rest, the likeliest and cheapest first."""
    cones = Cones.of(step)
    x, pressed, systems = central_path(step, cones, dilates=True)
    first, steep = cones.answer(step, x, pressed, systems), step.friction.some_steep
    tried.may_rest = float(np.abs(x).max()) < NEAR_REST
    if not steep:
        yield first
    if steep or tried.may_rest:
        x, pressed, systems = augmented_lagrangian(step, cones, x, pressed)
        answer = cones.answer(step, x, pressed, systems)
        yield _at_rest(step, answer)
        tried.may_rest = False
        if steep:
            yield first
        yield answer
        yield from parted(step, answer)
    last = first
    for tame in _tamed(step):
        yield (last := _coulomb(tame))
    if not tried.is_enough:
        yield path_from_guess(step, last, NEAREST_PIECES)
    if not tried.is_enough:
        yield path_from_guess(step, first)
    if not steep:
        yield from _at_last(step, tried)
        return
    if not tried.is_enough:
        yield path_from_apart(step, last.forces)
    yield path_from_apart(step)


def _at_rest(step: Step, guess: Answer) -> Answer | None:
    """Return a guess as the solution if it is rest.

    At rest Coulomb's friction asks for no more than forces within their cones. What contacts
    do is not asked: near such forces there may be a motion, and nothing else.
    """
    residual = step.residual(guess.x, guess.forces)
    rests = max(residual, float(np.abs(guess.x).max())) <= AT_REST
    return replace(guess, residual=residual, is_settled=True) if rests else None


def _tamed(step: Step) -> Iterator[Step]:
    """Give the step with friction that is not steep."""
    for most in TAME if step.friction.some_steep else (math.inf,):
        yield replace(step, friction=step.friction.at_most(most))


def _coulomb(step: Step, careful: float = CAREFUL[0], *, moves: bool = False) -> Answer:
    """Return the end of the interior-point method for Coulomb friction."""
    cones = Cones.of(step)
    found = central_path(step, cones, dilates=False, careful=careful, moves=moves)
    return cones.answer(step, *found)


def _at_last(step: Step, tried: _Tried) -> Iterator[Answer | None]:
    """Give what contacts may do at rest where nothing cheaper tells."""
    if not tried.is_enough:
        yield (guess := _coulomb(step, CAREFUL[1]))
        if tried.is_enough:
            return
        for found in alternated(step, guess.forces):
            yield found
            if tried.is_enough:
                return
        yield path_from_guess(step, tried.best, NEAREST_PIECES)
    if not tried.is_enough:
        yield path_from_apart(step)
