"""One step's contact problem: what the solvers of it share."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.banded import Bands
from blocksim.engines.contact.coulomb import (
    OPEN,
    SLIDES_DOWN,
    SLIDES_UP,
    STICKS,
    Contacts,
    Friction,
    leaning,
)
from blocksim.engines.contact.slides import Slides


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """Accelerations and forces in a step, right or not.

    Parameters
    ----------
    x : (3 blocks,) float
    forces : (joints, 4) float
    contacts : (joints, 2) int
        What the contacts do.
    residual : float
        `Step.residual` of it.
    systems : int
        Banded systems it took.
    is_settled : bool
        Whether no contact has to do anything else, and none yields.
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

    def or_better(self, other: Answer) -> Answer:
        """Return the better of the two; systems are those of both."""
        best = min(self, other, key=lambda each: (not each.is_settled, each.residual))
        return replace(best, systems=self.systems + other.systems)


@dataclass(frozen=True, kw_only=True, eq=False)
class Step:
    """A step, in accelerations times the root of mass.

    Parameters
    ----------
    bands : Bands
    rows : (joints, 4, 6) float
        Normal velocities of the two contacts, then the tangential ones.
    rates : (joints, 4) float
        The same velocities without acceleration, over the step.
    free : (3 blocks,) float
        Accelerations without contact.
    friction : Friction
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

    def way(
        self, contacts: Contacts, x: Array, glued: Array, held: Array, stiffness: float
    ) -> tuple[Array, Array]:
        """Return the change of x that balances the springs if each contact does as said.

        And that of `held`, the friction of contacts that slide with steep friction.
        """
        friction = self.friction
        forces = friction.as_said(glued, contacts, held)
        right = -self.imbalance(x, forces)
        own = friction.own(contacts)
        closed = (contacts != OPEN) & ~own
        weight = stiffness * np.concatenate([closed, contacts == STICKS], axis=-1)
        acting = leaning(self.rows, contacts, friction.lean)
        if not own.any():
            return self.bands.solve(acting, weight, self.rows, right), np.zeros(own.shape)
        slides = Slides(self.bands, self.rows, contacts, own, friction.flattest)

        def solve(besides: Array) -> Array:
            both = np.column_stack([right, besides])
            return self.bands.solve(acting, weight, self.rows, both)

        return slides.solve(solve, (glued[:, :2] - forces[:, :2]) / stiffness, stiffness)

    def residual(self, x: Array, forces: Array, rates: Array | None = None) -> float:
        """Worst of imbalance, penetration rate, and what complementarity leaves."""
        imbalance = np.abs(self.imbalance(x, forces)).max()
        rates = self.velocities(x) if rates is None else rates
        pressure, friction, slip = forces[:, :2], forces[:, 2:], rates[:, 2:]
        unilateral = np.abs(np.minimum(pressure, rates[:, :2])).max(initial=0.0)
        # Friction in the cone; at its edge, against the slip, or no slip.
        a, b = self.friction.room
        beyond = (b * np.abs(friction) - a * pressure).max(initial=0.0)
        against = a * pressure + b * np.sign(slip) * friction
        coulomb = max(beyond, np.minimum(against, np.abs(slip)).max(initial=0.0))
        if self.friction.some_steep:
            # Nor does friction help the slip, or act across a gap.
            for wrong in (
                np.minimum(np.sign(slip) * friction, np.abs(slip)),
                np.minimum(np.abs(friction), rates[:, :2]),
            ):
                coulomb = max(coulomb, float(np.where(self.friction.steep, wrong, 0.0).max()))
        return float(max(imbalance, unilateral, coulomb)) / max(1.0, float(np.abs(x).max()))

    def told(self, x: Array, forces: Array) -> Contacts:
        """Tell what contacts do where what is about 0 is still more than nothing."""
        rates = self.velocities(x)
        pressure, along = forces[:, :2], forces[:, 2:]
        a, b = self.friction.room
        contacts = np.where(along > 0, SLIDES_UP, SLIDES_DOWN).astype(np.int8)
        contacts[a * pressure - b * np.abs(along) > np.abs(rates[:, 2:])] = STICKS
        contacts[pressure <= rates[:, :2]] = OPEN
        return contacts
