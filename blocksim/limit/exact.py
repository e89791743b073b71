"""A problem in whole and rational numbers, as the doubles that it is stored in say it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property

import numpy as np

from blocksim.blocks.problem import STANDARD_GRAVITY, Load, Problem
from blocksim.blocks.rows import column

SLACK = Fraction(1, 10**12)
"""Loads that proofs leave aside, over the weight of each block."""
NOTHING = Fraction(0)
Number = int | Fraction
Vector = list[Fraction]
Point = tuple[int, int]


class Exact:
    """A problem in whole and rational numbers.

    Lengths are whole numbers of `grain` metres, forces of `force` newtons: powers of two of
    which all that is given are multiples.
    """

    def __init__(self, problem: Problem) -> None:
        assembly, joints = problem.assembly, problem.assembly.joints
        self.problem = problem
        self.sides: list[list[int]] = assembly.sides.T.tolist()
        is_corner = assembly.joint_arrays.is_corner.tolist()
        ends = np.array([column(joints, "inner"), column(joints, "outer")])
        across = np.array([(0.0, 0.0) if each is None else each.tolist()
                           for each in column(joints, "across")])  # fmt: skip
        acting = ((1.0, problem.dead), (problem.load, problem.live))
        points = [load.point for _, loads in acting for load in loads if load.point is not None]
        values = [assembly.centres, ends, across, *points]
        self.grain, whole = whole_numbers(
            np.concatenate([each.ravel() for each in values]).tolist()
        )
        pairs = list(zip(whole[::2], whole[1::2], strict=True))
        blocks, count = len(assembly.blocks), len(self.sides)
        self.centres = pairs[:blocks]
        first, second = pairs[blocks : blocks + count], pairs[blocks + count :][:count]
        self.ends = list(zip(first, second, strict=True))
        self.normals: list[Point] = []
        for corner, one, other, up in zip(
            is_corner, first, second, pairs[blocks + 2 * count :][:count], strict=True
        ):
            self.normals.append(up if corner else (other[1] - one[1], one[0] - other[0]))
        self.friction: list[Fraction | None] = [
            None if each == math.inf else Fraction(each) for each in problem.friction.tolist()
        ]
        masses: list[float] = np.asarray(column(assembly.blocks, "mass")).tolist()
        self.weights = [Fraction(mass * STANDARD_GRAVITY) for mass in masses]
        x, y = (Fraction(each) for each in problem.gravity[:2].tolist())
        pull = [[weight * x, weight * y, NOTHING] for weight in self.weights]
        places = iter(pairs[blocks + 3 * count :])
        for factor, loads in acting:
            for load in loads:
                at = None if load.point is None else next(places)
                self._load(pull, Fraction(factor), load, at)
        finest = max(each.denominator for wrench in pull for each in wrench)
        self.force = Fraction(1, finest)
        self.pull = [
            [each.numerator * (finest // each.denominator) for each in wrench]
            for wrench in pull
        ]

    def _load(
        self, pull: list[Vector], factor: Fraction, load: Load, point: Point | None
    ) -> None:
        """Add a load: forces in newtons, moments in newtons times the grain."""
        force = [Fraction(each) for each in load.force.tolist()]
        for block in load.blocks:
            times = factor * (self.weights[block] if load.per_weight else 1)
            x, y, sums = times * force[0], times * force[1], pull[block]
            sums[0] += x
            sums[1] += y
            if point is not None and not load.per_weight:
                cx, cy = self.centres[block]
                sums[2] += (point[0] - cx) * y - (point[1] - cy) * x

    @cached_property
    def allowed(self) -> list[list[int]]:
        """What may be left on each block, in units of force, and of that times the grain."""
        assembly = self.problem.assembly
        outlines, pieces = (column(assembly.blocks, name) for name in ("vertices", "parts"))
        shapes = [np.concatenate(parts) if parts else outline
                  for outline, parts in zip(outlines, pieces, strict=True)]  # fmt: skip
        count = np.array([len(shape) for shape in shapes])
        arms = np.concatenate(shapes) - np.repeat(assembly.centres, count, axis=0)
        reach = np.maximum.reduceat(np.abs(arms).sum(axis=1), count.cumsum() - count)
        found: list[list[int]] = []
        for weight, far in zip(self.weights, reach.tolist(), strict=True):
            above, below = far.as_integer_ratio()
            most = weight.numerator * self.force.denominator * SLACK.numerator
            least = weight.denominator * SLACK.denominator
            turn = most * above * self.grain.denominator // (least * below)
            found.append([most // least, most // least, turn])
        return found


def whole_numbers(values: Sequence[float]) -> tuple[Fraction, list[int]]:
    """Return a power of two, and values as whole multiples of it."""
    ratios = [each.as_integer_ratio() for each in values]
    finest = max((each for _, each in ratios), default=1)
    return Fraction(1, finest), [above * (finest // below) for above, below in ratios]
