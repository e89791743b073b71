"""What a contact may do.

Its law is piecewise linear in the forces its springs would have if it were glued, normal q
and tangential s: it is open where q <= 0, sticks where |s| <= mu q, and slides either way
beyond, with pressure q and friction mu q.

Contacts without slip (mu = inf) are the limit of that: whoever is pressed sticks, whatever
the friction; whoever is open carries nothing. In between, where q = 0, friction is anything
from 0 to s: a contact there has no pressure and may slip against its friction. Without
that piece the law would jump, and some steps would have no solution. Rest with friction
but no pressure is part of the law, as it is in limit analysis (the closed cone n >= 0).

So q no longer tells friction, and for all steep friction tells it badly. There y stands in
its place: the friction of a contact that slides, q of one that is open, and
q + (1 - 1/mu) |s| of one that sticks. In y and s the law has the edges of mu = 1, and is
continuous for every mu up to inf.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import Array

Contacts = NDArray[np.int8]
"""What each contact does, shape (joints, 2): one of the four pieces of its law each."""
OPEN, STICKS, SLIDES_UP, SLIDES_DOWN = range(4)
LEAN = np.array([0.0, 0.0, 1.0, -1.0])
"""Friction over its largest, on each piece where that is known."""
STEEP = 10.0
"""Friction above which that of a sliding contact is an unknown of its own."""
FLATTEST = 1e-6
"""Least pressure per friction along a way to the solution, though not in it."""


@dataclass(frozen=True, eq=False)
class Friction:
    """The friction of every joint.

    `mu`, (joints, 1): Coefficients, 0 and inf allowed.
    """

    mu: Array

    @classmethod
    def of(cls, mu: ArrayLike, joints: int) -> Friction:
        """Take one coefficient for all joints, or one for each."""
        return cls(np.broadcast_to(np.asarray(mu, dtype=np.float64), (joints,))[:, None])

    def at_most(self, most: float) -> Friction:
        """Return the same without what is above a coefficient."""
        return Friction(np.minimum(self.mu, most))

    @cached_property
    def steep(self) -> NDArray[np.bool_]:
        """Which joints have steep friction, shape (joints, 1)."""
        return self.mu > STEEP

    @cached_property
    def some_steep(self) -> bool:
        """Whether any joint has."""
        return bool(self.steep.any())

    @cached_property
    def lean(self) -> Array:
        """Friction per pressure where that is known and a contact slides, else 0."""
        return np.where(self.steep, 0.0, self.mu)

    @cached_property
    def most_lean(self) -> float:
        """Largest of these."""
        return float(self.lean.max(initial=0.0))

    @cached_property
    def flat(self) -> Array:
        """Pressure per friction of steep contacts that slide."""
        return np.where(self.steep, 1 / np.maximum(self.mu, STEEP), 0.0)

    @cached_property
    def flattest(self) -> Array:
        """The same along a way to the solution, where there is no less than `FLATTEST`.

        With mu = inf two contacts of a joint that both slide without pressure would leave it
        without a direction.
        """
        return np.where(self.steep, np.maximum(self.flat, FLATTEST), 0.0)

    @cached_property
    def room(self) -> tuple[Array, Array]:
        """Factors a, b for which |friction| is below mu p where b |friction| is below a p."""
        return np.where(self.steep, 1.0, self.mu), np.where(self.steep, self.flat, 1.0)

    def excess(self, forces: Array) -> Array:
        """Return how far friction is beyond its cone, (joints, 2); as pressure if steep.

        `forces`, (joints, 4): Pressure at both contacts, then friction.
        """
        pressure, size = forces[:, :2], np.abs(forces[:, 2:])
        if not self.some_steep:
            return size - self.mu * pressure
        a, b = self.room
        return b * size - a * pressure

    def gathered(self, forces: Array) -> Array:
        """Return equal forces whose friction is where the pressure is, for steep friction.

        Both contacts of a joint rub along one line: only the sum of their friction acts. Left
        at a contact without pressure beside one that has all of it, friction keeps that
        contact sliding, and moves over by a share of `FLATTEST` only in each system solved.

        `forces`, (joints, 4): Pressure at both contacts, then friction.
        """
        if not self.some_steep:
            return forces
        pressure, friction = forces[:, :2], forces[:, 2:]
        whole = pressure.sum(axis=1, keepdims=True)
        moves = self.steep & (whole > 0)
        shares = np.divide(pressure, whole, out=np.zeros_like(pressure), where=moves)
        moved = shares * friction.sum(axis=1, keepdims=True)
        return np.concatenate([pressure, np.where(moves, moved, friction)], axis=1)

    def own(self, contacts: Contacts) -> NDArray[np.bool_]:
        """Tell which contacts slide with friction that is an unknown of its own."""
        return self.steep & (contacts >= SLIDES_UP)


class ContactStatus:
    """Contacts that do as said: what makes forces of those of springs.

    `contacts`, (joints, 2).

    It has:
    `some_slide`: Whether any contact slides.
    `side`, (joints, 2): 1 and -1 where contacts slide, up and down.
    `slope`, (joints, 2): Friction per pressure where that is known and a contact slides.
    `own`, (joints, 2): Contacts whose friction is an unknown of its own, if there are any.
    `springs`, (joints, 4): 1 where a force is that of its spring, else 0.
    """

    def __init__(self, friction: Friction, contacts: Contacts) -> None:
        self.contacts, self._flat = contacts, friction.flat
        self.some_slide = int(contacts.max(initial=OPEN)) >= SLIDES_UP
        self.side = LEAN[contacts]
        self.slope = friction.lean * self.side
        own = friction.own(contacts) if friction.some_steep else None
        self.own = own if own is not None and own.any() else None
        self.is_open, self.sticks = contacts == OPEN, contacts == STICKS
        self.springs = np.empty((len(contacts), 4))
        self.springs[:, :2] = ~self.is_open if self.own is None else ~(self.is_open | self.own)
        self.springs[:, 2:] = self.sticks

    def forces(self, glued: Array, held: Array) -> Array:
        """Return the forces of contacts.

        `held`, (joints, 2): Size of friction; looked at where it is an unknown of its own.
        """
        forces: Array = self.springs * glued
        if self.some_slide:
            forces[:, 2:] += self.slope * forces[:, :2]
        if self.own is not None:
            size = np.where(self.own, held, 0.0)
            forces[:, :2] += self._flat * size
            forces[:, 2:] += self.side * size
        return forces


def leaning(rows: Array, slope: Array) -> Array:
    """Return rows with pressure's turned to act with its friction where a contact slides.

    `rows`, (..., 4, 6): Normal velocities of the two contacts, then the tangential ones.
    `slope`, (..., 2): As of `ContactStatus`.
    """
    if not slope.any():
        return rows
    acting = rows.copy()
    acting[..., :2, :] += slope[..., None] * rows[..., 2:, :]
    return acting


def edges(mu: Array, steep: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Two functions of q and s per piece, positive inside it: their factors.

    Where a contact with steep friction slides, the size of its friction stands for q.

    `mu`, (joints,).
    `steep`, (joints,).
    Returns `of_normal`, `of_tangential`, (joints, pieces, 2).
    """
    flat = np.where(steep, 1 / np.maximum(mu, STEEP), 1.0)
    most = np.where(steep, 1.0, mu)
    nothing, one = np.zeros_like(mu), np.ones_like(mu)
    of_normal = [[-one, nothing], [most, most], [one, -most], [one, -most]]
    of_tangential = [[nothing, nothing], [-flat, flat], [nothing, one], [nothing, -one]]
    return np.moveaxis(np.array(of_normal), 2, 0), np.moveaxis(np.array(of_tangential), 2, 0)


def beyond(old: int, edge: int, along: float) -> tuple[int, int]:
    """Return what a contact does beyond an edge of its piece, and which edge leads back."""
    if old == OPEN:
        return (SLIDES_UP if along > 0 else SLIDES_DOWN), 0
    if old == STICKS:
        return (SLIDES_DOWN if edge else SLIDES_UP), 1
    if edge == 0:
        return OPEN, 0
    return STICKS, 0 if old == SLIDES_UP else 1
