"""Points of contact elsewhere than where they were found: their gaps, and velocities there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.engines.solid.bodies import Bodies, Place, carried
from blocksim.engines.solid.meeting import Points


class Seen(NamedTuple):
    """Points of contact as something is asked of them.

    Rows of velocities of both blocks, (points, 3, 12), the blocks, (points, 2), and gaps.
    """

    rows: Array
    sides: NDArray[np.int64]
    gaps: Array

    def along(self, velocities: Array) -> Array:
        """Return velocities at the points, (points, 3), of scaled ones of the blocks."""
        return np.matmul(self.rows, velocities[self.sides].reshape(-1, 12, 1))[:, :, 0]


def seen(bodies: Bodies, points: Points, found: Place, there: Place) -> Seen:
    """Return rows and gaps of points that were found at one place, at another."""
    axes, places, gaps = _moved(bodies, points, found, there)
    sides = bodies.hulls.owner[np.stack([points.before, points.after], axis=1)]
    return Seen(bodies.rows(axes, places, sides, there), sides, gaps)


def gaps_of(bodies: Bodies, points: Points, found: Place, there: Place) -> Array:
    """Return their gaps alone."""
    return _moved(bodies, points, found, there)[2]


def _moved(
    bodies: Bodies, points: Points, found: Place, there: Place
) -> tuple[Array, Array, Array]:
    """Return axes, places and gaps of points elsewhere than where they were found.

    A point moves with the block after it, its plane with the one before.
    """
    before, after = bodies.hulls.owner[points.before], bodies.hulls.owner[points.after]
    turned = there.turns[before] @ found.turns[before].transpose(0, 2, 1)
    axes = np.matmul(points.axes, turned.transpose(0, 2, 1))
    places = carried(points.places, after, found, there)
    feet = points.places - points.gaps[:, None] * points.normals
    feet = carried(feet, before, found, there)
    return axes, places, np.einsum("pi,pi->p", places - feet, axes[:, 0])
