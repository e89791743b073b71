"""Blocks as the solid bodies they are, for engines with shapes of their own.

While joints are joints their two sides are all that touches (`faces`). From the motion on at
which anything else can touch, blocks, what they stand on and the floor are solid: their
polygons meet, except those that a joint still holds. A joint that has come apart, slid off
or turned far is given up for good, and its blocks are two like any others. The rules are
those of `direct` (`contact.neighbours`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.outlines import outwards, width
from blocksim.blocks.problem import Problem
from blocksim.engines.contact.geometry import Geometry
from blocksim.engines.contact.neighbours import TIGHT, Neighbours
from blocksim.engines.energy import Balance
from blocksim.engines.ground import ground_level, standing

FLOOR = 100.0
"""Half the width of the floor, and its depth, beyond the blocks [size]."""
LARGEST = 0.004
"""Way in a step, in units of a block's least extent, that keeps overlaps small."""

SHARPEST = 0.05
"""Of one and the cosine between two faces, where the corner between them is set back."""


class Solids:
    """The polygons of an assembly, and which of them may meet.

    `moving`, list of (int, (k, 2) float): Polygons of blocks: the block, and corners from its
        centre of mass, scaled.
    `fixed`, list of (k, 2): Polygons of what blocks stand on, scaled; they are numbered on from
        the others.
    `floor`, (4, 2): That of the floor, numbered last.
    `level`: Height of the floor.
    `loose`: Whether blocks may meet that share no joint.
    `left`: How much farther blocks have to move for that [size].
    `holds`, (joints,): Which joints still are joints.
    """

    def __init__(self, assembly: Assembly) -> None:
        size = assembly.size
        self._assembly = assembly
        self._geometry, neighbours = Geometry(assembly), Neighbours(assembly)
        self._start, self._reach = assembly.centres / size, assembly.reach / size
        self.moving = [
            (index, (polygon - block.centre) / size)
            for index, block in enumerate(assembly.blocks)
            for polygon in block.polygons
        ]
        self.level = level = ground_level(assembly) / size
        wide = FLOOR + float(np.abs(self._start).max())
        floor = np.array([(-wide, level - FLOOR), (wide, level - FLOOR), (wide, level)])
        self.floor = np.vstack([floor, [(-wide, level)]])
        self.fixed = [each / size for each in standing(assembly)]
        self.loose = False
        self.holds = np.ones(len(assembly.joints), dtype=np.bool_)
        self._free = neighbours.free
        self.left = max(TIGHT, self._free)
        self._joints: dict[tuple[int, int], list[int]] = defaultdict(list)
        self.sides: dict[int, set[int]] = defaultdict(set)
        for joint, one, other in zip(
            *(each.tolist() for each in neighbours.sides), strict=True
        ):
            self._joints[one, other].append(joint)
            self.sides[joint] |= {one, other}
        self.largest = LARGEST * min(width(polygon) for _, polygon in self.moving)

    def update(self, poses: Array) -> NDArray[np.int64]:
        """Look where blocks are, and return the joints that have ended since.

        `poses`, (blocks, 3).
        """
        moved = poses.copy()
        moved[:, :2] -= self._start
        moved[:, 2] *= self._reach
        way = float(np.abs(moved).max())
        self.left = max(TIGHT, self._free) - way
        self.loose = self.loose or self.left < 0
        if not self.loose:
            return np.zeros(0, dtype=np.int64)
        _, holds = self._geometry.touch(poses)
        ended = np.flatnonzero(self.holds & ~holds)
        self.holds &= holds
        return ended

    def may_meet(self, one: int, other: int) -> bool:
        """Tell whether two polygons are solid to each other."""
        first, second = min(one, other), max(one, other)
        if second < len(self.moving) and self.moving[first][0] == self.moving[second][0]:
            return False
        return not any(self.holds[joint] for joint in self._joints.get((first, second), ()))


class Polygons:
    """Blocks of a problem of the plane: energy, and when they may meet others."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.assembly = problem, problem.assembly

    @cached_property
    def solids(self) -> Solids:
        """Polygons, and from when on they may meet."""
        return Solids(self.assembly)

    def balance(self, poses: Array) -> Balance[Array]:
        """Return what looks at the energy, from where blocks are let go."""
        return Balance.of(self.problem, poses)


Faces = Sequence[Sequence[int]]
"""Of a convex hull, by its corners, seen from outside counter-clockwise."""


def prism(polygon: Array, depth: float) -> tuple[Array, Faces]:
    """Return a polygon of some depth, halved by the plane: corners, (2 k, 3), and faces."""
    count = len(polygon)
    ends = [np.column_stack([polygon, np.full(count, z)]) for z in (-depth / 2, depth / 2)]
    around = zip(range(count), [*range(1, count), 0], strict=True)
    sides = [[low, high, high + count, low + count] for low, high in around]
    return np.concatenate(ends), [range(count)[::-1], range(count, 2 * count), *sides]


def obj_text(hulls: Iterable[tuple[Array, Faces]]) -> str:
    """Return convex hulls, corners and faces of each, as the text of an .obj file."""
    lines, first = list[str](), 1
    for number, (corners, faces) in enumerate(hulls):
        lines.append(f"o {number}")
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()]
        lines += ["f " + " ".join(str(first + each) for each in face) for face in faces]
        first += len(corners)
    return "\n".join(lines) + "\n"


def smaller(polygon: Array, inset: float) -> Array:
    """Return a convex, counter-clockwise polygon with its faces set back."""
    inward = -outwards(polygon)
    kept = inward.any(axis=1)
    polygon, after = polygon[kept], inward[kept]
    before = np.roll(after, 1, axis=0)
    bend = 1 + (before * after).sum(axis=1, keepdims=True)
    return polygon + inset * (before + after) / np.maximum(bend, SHARPEST)
