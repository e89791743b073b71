"""One step's contact problem: what the solvers of it share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.coulomb import (
    LEAN,
    OPEN,
    SLIDES_DOWN,
    SLIDES_UP,
    STICKS,
    Contacts,
    ContactStatus,
    Friction,
    leaning,
)

SOFT, STIFF = 1e3, 1e9
"""Least and largest stiffness."""
STIFFNESS = 1e4
"""Stiffness times accelerations, limited by round-off."""
MOVING, ROUGH = 4e5, 1e-12
"""The same where no contact has to yield by less than that: forces are asked for 1e-10 only."""
STEEPEST = 3.0
"""Friction above which springs are softer: friction multiplies their forces."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """Accelerations and forces in a step, right or not.

    `x`, (3 blocks,).
    `forces`, (joints, 4).
    `contacts`, (joints, 2): What the contacts do.
    `residual`: `Step.residual` of it; inf where it is not known.
    `systems`: Banded systems it took.
    `is_settled`: Whether no contact has to do anything else, and none yields.
    """

    x: Array
    forces: Array
    contacts: Contacts
    residual: float = math.inf
    systems: int = 0
    is_settled: bool = False

    @classmethod
    def of_nothing(cls, step: Step) -> Answer:
        """Return what is worse than any other."""
        contacts = np.full((len(step.rates), 2), OPEN, dtype=np.int8)
        return cls(x=step.free, forces=np.zeros_like(step.rates), contacts=contacts)


@dataclass(frozen=True, kw_only=True, eq=False)
class Step:
    """A step, in accelerations times the root of mass.

    `rows`, (joints, 4, 6): Normal velocities of the two contacts, then the tangential ones.
    `rates`, (joints, 4): The same velocities without acceleration, over the step.
    `free`, (3 blocks,): Accelerations without contact.
    """

    bands: Bands
    rows: Array
    rates: Array
    free: Array
    friction: Friction

    def velocities(self, x: Array) -> Array:
        """Velocities along the rows at the end of the step, over its length."""
        return self.rates + self.bands.along(self.rows, x)

    def imbalance(self, x: Array, forces: Array) -> Array:
        """Return what is left of each block's acceleration times mass."""
        return x - self.free - self.bands.pull(self.rows, forces)

    def residual(self, x: Array, forces: Array, rates: Array | None = None) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        imbalance = np.abs(self.imbalance(x, forces)).max()
        rates = self.velocities(x) if rates is None else rates
        normal, slip = rates[:, :2], rates[:, 2:]
        pressure, friction = forces[:, :2], forces[:, 2:]
        # Friction in the cone; at its edge, against the slip, or no slip.
        a, b = self.friction.room
        way, helping = np.abs(slip), np.sign(slip) * friction
        wrongs = [
            np.abs(np.minimum(pressure, normal)),
            self.friction.excess(forces),
            np.minimum(a * pressure + b * helping, way),
        ]
        if self.friction.some_steep:
            # Nor does friction help the slip, or act across a gap.
            wrongs += [
                np.where(self.friction.steep, wrong, 0.0)
                for wrong in (np.minimum(helping, way), np.minimum(np.abs(friction), normal))
            ]
        # Unlike Python's, numpy's maximum keeps nan.
        worst = np.maximum(imbalance, reduce(np.maximum, wrongs).max(initial=0.0))
        return float(worst) / max(1.0, float(np.abs(x).max()))

    def told(self, x: Array, forces: Array) -> Contacts:
        """Tell what contacts do where what is about 0 is still more than nothing."""
        rates = self.velocities(x)
        pressure, along = forces[:, :2], forces[:, 2:]
        contacts = np.where(along > 0, SLIDES_UP, SLIDES_DOWN).astype(np.int8)
        contacts[-self.friction.excess(forces) > np.abs(rates[:, 2:])] = STICKS
        contacts[pressure <= rates[:, :2]] = OPEN
        return contacts


class Slides:
    """Contacts that slide with steep friction: the border of a system (1 + matrix) x = right.

    Their pressure is a small share of their friction (none if mu = inf). Taken from pressure,
    friction would be a tiny number times a huge one. So it is an unknown w of its own, and the
    equation that goes with it is pressure's: -k n = w / mu. There are few such contacts; they
    border the banded system of the others.

    `rows`, (joints, 4, 6): Normal velocities of the two contacts, then the tangential ones.
    `contacts`, (joints, 2).
    `own`, (joints, 2): Which of them these are.
    `flat`, (joints, 1): Pressure per friction.
    """

    def __init__(
        self,
        bands: Bands,
        rows: Array,
        contacts: Contacts,
        own: NDArray[np.bool_],
        flat: Array,
    ) -> None:
        self._bands, self._own = bands, own
        joint, end = np.nonzero(own)
        self._joint, self._seen = joint, rows[joint, end]
        self._flat = flat[joint, 0]
        self._acting = LEAN[contacts[own]][:, None] * rows[joint, 2 + end]
        self._acting += self._flat[:, None] * self._seen

    def solve(
        self, solve: Callable[[Array], Array], target: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Solve the bordered system.

        `solve`: Takes what comes besides the right side, shape (3 blocks, k), and returns the
            solutions of the system with the right side first, shape (3 blocks, 1 + k).
        `target`, (joints, 2): Normal velocities that would leave contacts without pressure.
        Returns `x`, (3 blocks,).
        Returns `held`, (joints, 2): Friction of these contacts, 0 elsewhere. All is nan where
            the system is singular.
        """
        count, place = len(self._joint), self._bands.place[self._joint]
        columns = np.zeros((self._bands.size + 1, count))
        np.add.at(columns, (place, np.arange(count)[:, None]), self._acting)
        found = solve(columns[:-1])
        padded = np.vstack([found, np.zeros(1 + count)])
        seen = (self._seen[:, :, None] * padded[place]).sum(axis=1)
        small = seen[:, 1:] + np.diag(self._flat / stiffness)
        held = np.zeros(self._own.shape)
        try:
            held[self._own] = np.linalg.solve(small, target[self._own] - seen[:, 0])
        except np.linalg.LinAlgError:
            held[self._own] = np.nan
        return found[:, 0] + found[:, 1:] @ held[self._own], held


class Linear:
    """A step while its contacts do as said, with springs: one banded system, factored once.

    `contacts`, (joints, 2).
    `stiffness`: Of the springs.
    """

    def __init__(self, step: Step, contacts: Contacts, stiffness: float) -> None:
        self._step, self._stiffness = step, stiffness
        self.status = status = ContactStatus(step.friction, contacts)
        # Where nothing slides the system is symmetric.
        rows, seen = step.rows, None
        if status.some_slide:
            rows, seen = leaning(step.rows, status.slope), step.rows
        self._solve = step.bands.factored(rows, stiffness * status.springs, seen)
        self._slides = None
        if status.own is not None:
            flattest = step.friction.flattest
            self._slides = Slides(step.bands, step.rows, contacts, status.own, flattest)

    def way(self, x: Array, glued: Array, held: Array) -> tuple[Array, Array]:
        """Return the change of x that balances the springs, nan where there is none.

        And that of `held`, the friction of contacts that slide with steep friction.

        `glued`, (joints, 4): Forces of the springs at x.
        `held`, (joints, 2).
        """
        solve, nothing = self._solve, np.zeros_like(held)
        if solve is None:
            return np.full_like(x, np.nan), nothing
        forces = self.status.forces(glued, held)
        right = -self._step.imbalance(x, forces)
        if self._slides is None:
            return solve(right), nothing
        return self._slides.solve(
            lambda besides: solve(np.column_stack([right, besides])),
            (glued[:, :2] - forces[:, :2]) / self._stiffness,
            self._stiffness,
        )


def stiffness_at(friction: Friction, x: Array, precision: float = 0.0) -> float:
    """Return the stiffness that round-off allows at accelerations x.

    Preloaded with the forces found last, springs give those of rigid contact within a few
    rounds, however soft they are. The stiffer they are, the fewer systems they take, but
    round-off grows with it; yields are wanted to a precision [g].
    """
    rough = precision >= ROUGH and not friction.some_steep
    # Steep friction multiplies nothing: it is an unknown of its own.
    softer = max(1.0, friction.most_lean / STEEPEST)
    largest = max(float(np.abs(x).max()), 1e-9)
    return min(max((MOVING if rough else STIFFNESS) / softer / largest, SOFT), STIFF)
