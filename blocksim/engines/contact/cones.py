"""The friction cones of contacts, by their edges.

Forces in a cone are forces along its edges, and each edge has a velocity of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.step import Answer, Step

STEEPEST = 3.0
"""Friction above which edges are not scaled to length 1: normals would fade."""
OF_SIDES = 4
"""Edges of a joint's two cones that lean; there may be more."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cones:
    """The friction cones of all contacts, by their edges.

    Steep ones take what normals they have, down to none, and have the normal itself as a third
    edge; where other joints have a third, it is far from any contact.

    `edges`, (joints, 4 or 6, 6): Velocities along the edges: up of both contacts, down of both,
        normal ones.
    `offset`, (joints, 4 or 6): The same without acceleration.
    `norm`, `lean`, (joints, 1): What normals were divided by, and tangents multiplied with.
    `steep`, (joints, 1).
    """

    edges: Array
    offset: Array
    norm: Array
    lean: Array
    steep: NDArray[np.bool_]

    @classmethod
    def of(cls, step: Step) -> Cones:
        """Take those of a step."""
        friction, steep, mu = step.friction, step.friction.steep, step.friction.mu
        with np.errstate(invalid="ignore"):
            norm = np.where(steep, mu, np.minimum(np.sqrt(1 + mu**2), STEEPEST))
            lean = np.where(steep, 1.0, mu / norm)

        def along(values: Array) -> Array:
            upright, aside = values[:, :2] / norm[..., None], lean[..., None] * values[:, 2:]
            found = [upright + aside, upright - aside]
            if friction.some_steep:
                found.append(steep[..., None] * values[:, :2])
            return np.concatenate(found, axis=1)

        offset = along(step.rates[..., None])[..., 0]
        if friction.some_steep:
            offset[:, OF_SIDES:] += ~steep
        return cls(edges=along(step.rows), offset=offset, norm=norm, lean=lean, steep=steep)

    def answer(self, step: Step, x: Array, pressed: Array, systems: int) -> Answer:
        """Return what accelerations x and forces along the edges are in the step."""
        forces = step.friction.gathered(self.forces(pressed))
        contacts = step.told(x, forces)
        return Answer(x=x, forces=forces, contacts=contacts, systems=systems)

    def forces(self, pressed: Array) -> Array:
        """Return the forces along `rows` from those along the edges."""
        up, down = pressed[:, :2], pressed[:, 2:4]
        pressure = (up + down) / self.norm
        if pressed.shape[1] > OF_SIDES:
            pressure = pressure + np.where(self.steep, pressed[:, OF_SIDES:], 0.0)
        return np.concatenate([pressure, (up - down) * self.lean], axis=1)
