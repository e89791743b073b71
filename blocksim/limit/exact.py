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
Vector = list[Fraction]
Point = tuple[int, int]


class Exact:
    """A problem in whole and rational numbers.

    Lengths are whole numbers of `grain` metres, a power of two of which all coordinates are
    multiples; forces are rational numbers of newtons.
    """

    def __init__(self, problem: Problem) -> None:
        assembly, joints = problem.assembly, problem.assembly.joints
        self.problem = problem
        self.sides: list[list[int]] = assembly.sides.T.tolist()
        is_corner = assembly.joint_arrays.is_corner.tolist()
        ends = np.array([column(joints, "inner"), column(joints, "outer")])
        across = np.array([(0.0, 0.0) if each is None else each.tolist()
                           for each in column(joints, "across")])  # fmt: skip
        values = [assembly.centres.ravel(), ends.ravel(), across.ravel()]
        self.grain, whole = whole_numbers(np.concatenate(values).tolist())
        pairs = list(zip(whole[::2], whole[1::2], strict=True))
        blocks, count = len(assembly.blocks), len(self.sides)
        self.centres = pairs[:blocks]
        first, second = pairs[blocks : blocks + count], pairs[blocks + count :][:count]
        self.ends = list(zip(first, second, strict=True))
        self.normals: list[Point] = []
        for corner, one, other, up in zip(
            is_corner, first, second, pairs[blocks + 2 * count :], strict=True
        ):
            self.normals.append(up if corner else (other[1] - one[1], one[0] - other[0]))
        self.friction = [
            None if each == math.inf else Fraction(each) for each in problem.friction.tolist()
        ]
        self.weights = [
            Fraction(mass * STANDARD_GRAVITY) for mass in column(assembly.blocks, "mass")
        ]
        x, y = (Fraction(each) for each in problem.gravity[:2].tolist())
        self.pull = [[weight * x, weight * y, NOTHING] for weight in self.weights]
        for factor, loads in ((1.0, problem.dead), (problem.load, problem.live)):
            for load in loads:
                self._load(Fraction(factor), load)

    def _load(self, factor: Fraction, load: Load) -> None:
        """Add a load: forces in newtons, moments in newtons times the grain."""
        force = [Fraction(each) for each in load.force.tolist()]
        for block in load.blocks:
            times = factor * (self.weights[block] if load.per_weight else 1)
            x, y, pull = times * force[0], times * force[1], self.pull[block]
            pull[0] += x
            pull[1] += y
            if load.point is not None and not load.per_weight:
                px, py = (Fraction(each) / self.grain for each in load.point.tolist())
                cx, cy = self.centres[block]
                pull[2] += (px - cx) * y - (py - cy) * x

    @cached_property
    def allowed(self) -> list[Vector]:
        """What may be left on each block."""
        assembly = self.problem.assembly
        shapes = [np.concatenate(block.polygons) for block in assembly.blocks]
        reach = [float(np.abs(shape - centre).sum(axis=1).max())
                 for shape, centre in zip(shapes, assembly.centres, strict=True)]  # fmt: skip
        most = [SLACK * weight for weight in self.weights]
        return [[one, one, one * Fraction(far) / self.grain]
                for one, far in zip(most, reach, strict=True)]  # fmt: skip


def whole_numbers(values: Sequence[float]) -> tuple[Fraction, list[int]]:
    """Return a power of two, and values as whole multiples of it."""
    ratios = [each.as_integer_ratio() for each in values]
    finest = max((each for _, each in ratios), default=1)
    return Fraction(1, finest), [above * (finest // below) for above, below in ratios]
