"""Rubble: a wall of irregular stones, the cells nearest to random points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.spatial import Voronoi

from blocksim.blocks.assembly import Array
from blocksim.blocks.given import Body
from blocksim.blocks.made import Made
from blocksim.blocks.maker import Maker, count, metres, parameter
from blocksim.blocks.outlines import counter_clockwise
from blocksim.kinds.blockwork import floor

SLENDER = 1000.0
"""Most that one side of the wall may be of the other."""


@dataclass(frozen=True, kw_only=True)
class Rubble(Maker):
    """Voronoi cells in a rectangle; the origin is its lower left corner."""

    name: ClassVar[str] = "rubble"
    about: ClassVar[str] = "a wall of irregular stones, from a seed"

    width: float = metres(2.0, "width of the wall")
    height: float = metres(1.0, "height of the wall")
    stones: int = count(40, "number of stones", low=2)
    seed: int = parameter(1, "of the random numbers", whole=True, high=1e9, above=False)
    smoothing: int = parameter(
        3, "times each point moves to the middle of its cell: how even the stones are",
        whole=True, high=100, above=False,
    )  # fmt: skip
    depth: float = metres(1.0, "depth out of the plane")

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: cells of a wall that is all but a line are none."""
        low, high = super().limits(name)
        if name == "height":
            low, high = max(low, self.width / SLENDER), min(high, self.width * SLENDER)
        return low, high

    def made(self, density: float) -> Made:  # noqa: ARG002
        """Make a floor and the stones; joints are found."""
        size = np.array([self.width, self.height])
        points = np.random.default_rng(self.seed).random((self.stones, 2)) * size
        for _ in range(self.smoothing):
            points = np.array([_middle(cell) for cell in _cells(points, size)])
        stones = [
            Body(polygons=(cell,), name=str(index + 1), depth=self.depth)
            for index, cell in enumerate(_cells(points, size))
        ]
        reach = self.width / 4
        return Made(bodies=(floor(-reach, self.width + reach, 0.0, reach / 2), *stones))


def _cells(points: Array, size: Array) -> list[Array]:
    """Return the cells of points in a rectangle, closed by the points' mirror images."""
    images = [points]
    for axis in (0, 1):
        for edge in (0.0, size[axis]):
            image = points.copy()
            image[:, axis] = 2 * edge - image[:, axis]
            images.append(image)
    diagram: Any = Voronoi(np.concatenate(images))
    corners = np.array(diagram.vertices)
    for axis in (0, 1):
        # Sides of the wall are exactly straight, or stones would touch the floor by corners.
        for edge in (0.0, size[axis]):
            corners[np.abs(corners[:, axis] - edge) < 1e-9 * size[axis], axis] = edge
    cells: list[Array] = [
        corners[diagram.regions[diagram.point_region[index]]] for index in range(len(points))
    ]
    return [counter_clockwise(cell) for cell in cells]


def _middle(cell: Array) -> Array:
    """Centroid of a polygon: another sum would move all stones by a last digit."""
    ahead = np.roll(cell, -1, axis=0)
    turn = cell[:, 0] * ahead[:, 1] - cell[:, 1] * ahead[:, 0]
    return ((cell + ahead) * turn[:, None]).sum(axis=0) / (3 * turn.sum())
