"""Friction of Bullet's links, held within rectangles inside its cones.

Bullet takes both directions of friction of a point at once, each by how easily blocks move
that way, and shortens what is beyond the cone. Where the two are not equally easy, what slides
is not rubbed against its slip, and near the limit blocks that could rest go on sliding. Taken
one by one, each within its own bounds, directions end at rest where pressures and friction
within these bounds balance the loads.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array

STEEP = math.sqrt(0.5)
"""Of a normal along z, from which on Bullet takes other directions of friction."""
FLATTEST = 0.005
"""Least width of a rectangle, over its length."""
ROUNDING = 1e-12
"""Friction that is none [mean weights]."""


def across(normal: Array) -> Array:
    """Return the two directions in which Bullet sees friction at a link, (2, 3)."""
    x, y, z = normal
    first = np.array([0.0, -z, y] if abs(z) > STEEP else [-y, x, 0.0])
    first /= np.linalg.norm(first)
    return np.vstack([first, np.cross(normal, first)])


def rectangle(rubs: Array) -> Array:
    """Return the sides of a rectangle of which a corner lies along a force, (2,).

    Its corners are 1 from its middle.
    """
    sides = np.abs(rubs)
    sides = np.maximum(sides, max(FLATTEST * float(sides.max()), ROUNDING))
    return sides / np.linalg.norm(sides)


class Rectangles:
    """What friction of a Bullet space is held within, in place of cones.

    `client`: Bullet's functions, told in which space to act.
    """

    def __init__(self, client: Any) -> None:
        self._client = client
        self._narrowed = dict[tuple[int, int], float]()

    def narrow(self, body: int, link: int, friction: float, sides: Array) -> None:
        """Hold friction on the face of a link's box within a rectangle inside its cone.

        Bullet takes directions one by one then, in all of the space.

        `friction`: Of the pair.
        `sides`, (2,): Along the first two axes of the box, which have to be those of `across`;
            corners of a rectangle that are 1 from its middle are on the cone.
        """
        self._client.changeDynamics(body, link, anisotropicFriction=[*sides.tolist(), 1.0])
        self._client.setPhysicsEngineParameter(enableConeFriction=0)
        self._narrowed[body, link] = friction

    def widen(self) -> None:
        """Let friction have all of its cones."""
        for plate in self._narrowed:
            self._client.changeDynamics(*plate, anisotropicFriction=[1.0, 1.0, 1.0])
        self.forget()

    def forget(self) -> None:
        """Take note that all bodies were removed."""
        self._client.setPhysicsEngineParameter(enableConeFriction=1)
        self._narrowed.clear()

    def beyond(self) -> float | None:
        """Return by how much friction was beyond a cone in the last step, at most.

        What is pressed as a step is solved, and is not in the end, keeps its friction where
        directions are taken one by one. It gets none in the next. None where all have cones.
        """
        if not self._narrowed:
            return None
        most = 0.0
        for contact in self._client.getContactPoints():
            one, other, first, second = contact[1:5]
            plate = (one, first) if (one, first) in self._narrowed else (other, second)
            push, along, way, beside, beyond = contact[9:14]
            rubs = float(np.linalg.norm(along * np.array(way) + beside * np.array(beyond)))
            more = rubs - self._narrowed[plate] * push
            if push == 0 and more > 0:
                self._client.changeDynamics(*plate, anisotropicFriction=[0.0, 0.0, 1.0])
            most = max(most, more)
        return most
