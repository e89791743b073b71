"""A problem in whole and rational numbers, as the doubles that it is stored in say it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Load, Problem
from blocksim.blocks.rows import column

SLACK = Fraction(1, 10**12)
"""Loads that proofs leave aside, over the weight of each block."""
NOTHING = Fraction(0)
Number = int | Fraction
Vector = list[Fraction]
Point = tuple[int, ...]
AXES: Sequence[Point] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


class Exact:
    """A problem in whole and rational numbers, in the plane or in space.

    Lengths are whole numbers of `grain` metres, forces of `force` newtons: powers of two of
    which all that is given are multiples.

    It has:
    `sides`, (joints, 2): Blocks before and after each joint, `SUPPORT` for the ground.
    `ends`, `normals`, `friction`: Of each joint its points, a normal of any length, and its
        friction coefficient, None where nothing bounds it. In the plane a joint has two points,
        which are the same at a corner.
    `centres`, `weights`: Of each block; weights in newtons.
    `pull`: Force and moment on each block.
    """

    def __init__(self, problem: Problem[Any]) -> None:
        assembly, joints = problem.assembly, problem.assembly.joints
        self.problem, self.axes = problem, int(assembly.dimensions)
        self.sides: list[list[int]] = assembly.sides.T.tolist()
        acting = ((1.0, problem.dead), (problem.load, problem.live))
        at = [load.point for _, loads in acting for load in loads if load.point is not None]
        ends, counts = _ends(problem)
        values = [assembly.centres, ends, *at, *([] if problem.in_space else [_across(joints)])]
        self.grain, whole = whole_numbers(
            np.concatenate([each.ravel() for each in values]).tolist()
        )
        points: list[Point] = list(zip(*(whole[axis :: self.axes] for axis in range(self.axes)),
                                       strict=True))  # fmt: skip
        self.centres, points = points[: len(assembly.blocks)], points[len(assembly.blocks) :]
        last = np.cumsum(counts).tolist()
        self.ends = [points[one:other] for one, other in zip([0, *last], last, strict=False)]
        places = iter(points[len(ends) :][: len(at)])
        self.normals = self._normals(points[len(ends) + len(at) :])
        self.friction: list[Fraction | None] = [
            None if each == math.inf else Fraction(each) for each in problem.friction.tolist()
        ]
        self.weights = [Fraction(each) for each in assembly.weights.tolist()]
        down = [Fraction(each) for each in problem.gravity[: self.axes].tolist()]
        turns = [NOTHING] * len(moment(down, down))
        pull = [[*(weight * way for way in down), *turns] for weight in self.weights]
        for factor, loads in acting:
            for load in loads:
                place = None if load.point is None else next(places)
                self._load(pull, Fraction(factor), load, place)
        finest = max(each.denominator for wrench in pull for each in wrench)
        self.force = Fraction(1, finest)
        self.pull = [
            [each.numerator * (finest // each.denominator) for each in wrench]
            for wrench in pull
        ]

    def _normals(self, across: Sequence[Point]) -> list[Point]:
        """Return a normal of each joint; in the plane its ends tell it, but at a corner."""
        if self.problem.in_space:
            given = (each.normal.tolist() for each in self.problem.assembly.joints)
            return [tuple(whole_numbers(each)[1]) for each in given]
        is_corner: list[bool] = self.problem.assembly.joint_arrays.is_corner.tolist()
        return [
            up if corner else (other[1] - one[1], one[0] - other[0])
            for corner, (one, other), up in zip(is_corner, self.ends, across, strict=True)
        ]

    def _load(
        self, pull: list[Vector], factor: Fraction, load: Load, point: Point | None
    ) -> None:
        """Add a load: forces in newtons, moments in newtons times the grain."""
        force = [Fraction(each) for each in load.force.tolist()]
        for block in load.blocks:
            times = factor * (self.weights[block] if load.per_weight else 1)
            acts = [times * each for each in force]
            if point is not None and not load.per_weight:
                acts += moment(apart(point, self.centres[block]), acts)
            for at, each in enumerate(acts):
                pull[block][at] += each

    def ways(self, joint: int) -> Sequence[Point]:
        """Return the ways in which forces act at a joint: its normal, and where it rubs all.

        Across it in the plane, along the axes in space.
        """
        normal = self.normals[joint]
        if self.friction[joint] == 0:
            return [normal]
        return AXES if self.axes == 3 else [normal, (-normal[1], normal[0])]

    def moving(
        self, joint: int, rates: Sequence[list[int]]
    ) -> list[tuple[list[int], Point, int]]:
        """Return rates, centre and sense, 1 of `after`, of blocks at a joint that move."""
        return [
            (rates[side], self.centres[side], sign)
            for side, sign in zip(self.sides[joint], (-1, 1), strict=True)
            if side != SUPPORT and any(rates[side])
        ]

    @cached_property
    def allowed(self) -> list[list[int]]:
        """What may be left on each block, in units of force, and of that times the grain."""
        centres, shapes = self.problem.assembly.centres, self.problem.assembly.corners
        count = np.array([len(shape) for shape in shapes])
        arms = np.concatenate(shapes) - np.repeat(centres, count, axis=0)
        reach = np.maximum.reduceat(np.abs(arms).sum(axis=1), count.cumsum() - count)
        found: list[list[int]] = []
        turns = len(self.pull[0]) - self.axes
        for weight, far in zip(self.weights, reach.tolist(), strict=True):
            above, below = far.as_integer_ratio()
            most = weight.numerator * self.force.denominator * SLACK.numerator
            least = weight.denominator * SLACK.denominator
            turn = most * above * self.grain.denominator // (least * below)
            found.append([most // least] * self.axes + [turn] * turns)
        return found


def apart(one: Sequence[Any], other: Sequence[Any]) -> list[Any]:
    """Return the way from another point."""
    return [p - q for p, q in zip(one, other, strict=True)]


def moment(arm: Sequence[Any], force: Sequence[Any]) -> list[Any]:
    """Return the moment of a force: one number in the plane, a vector in space."""
    if len(arm) == 2:
        return [arm[0] * force[1] - arm[1] * force[0]]
    (a, b, c), (p, q, r) = arm, force
    return [b * r - c * q, c * p - a * r, a * q - b * p]


def spun(turn: Sequence[Any], arm: Sequence[Any]) -> list[Any]:
    """Return the velocity at the end of an arm by a rotation."""
    if len(arm) == 2:
        return [-turn[0] * arm[1], turn[0] * arm[0]]
    return moment(turn, arm)


def along_and_across(way: Sequence[Any], n: Point) -> tuple[Any, Any]:
    """Return the part along a normal, and the square of that across, times its length."""
    side = moment(way, n)
    return sum(p * q for p, q in zip(way, n, strict=True)), sum(each * each for each in side)


def whole_numbers(values: Sequence[float]) -> tuple[Fraction, list[int]]:
    """Return a power of two, and values as whole multiples of it."""
    ratios = [each.as_integer_ratio() for each in values]
    finest = max((each for _, each in ratios), default=1)
    return Fraction(1, finest), [above * (finest // below) for above, below in ratios]


def _ends(problem: Problem[Any]) -> tuple[Array, Array]:
    """Return the points of all joints, and how many each has."""
    joints = problem.assembly.joints
    if problem.in_space:
        counts = np.array([len(each.points) for each in joints], dtype=int)
        return problem.assembly.points, counts
    ends = np.array([column(joints, "inner"), column(joints, "outer")])
    return ends.swapaxes(0, 1).reshape(-1, 2), np.full(len(joints), 2)


def _across(joints: Sequence[Any]) -> Array:
    """Return the normals of corners in the plane, (joints, 2)."""
    return np.array([(0.0, 0.0) if each is None else each.tolist()
                     for each in column(joints, "across")])  # fmt: skip
