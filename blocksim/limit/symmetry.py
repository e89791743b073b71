"""Structures that are their own mirror image: the one solution that is symmetric, too.

A linear programme has many solutions, and a solver returns a corner of them: a hinge on one
side of a keystone only. The mirror image of a solution of a symmetric problem is a solution,
and so is the mean of both, since the programme is convex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.problem import Problem

ALIKE = 1e-9
"""Distance within which points, and difference within which loads, are the same: over the size,
and over the largest load."""
TURNED = np.array([-1.0, 1.0, -1.0])
"""What a mirror does to x, y and rotation."""

Places = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Mirror:
    """Which block and joint is the mirror image of which, left to right.

    `blocks`, (blocks,).
    `joints`, (joints,).
    `swaps`, (joints,): Whether the inner end of a joint lies upon the outer end of its image.
    `sense`, (joints,): -1 where the block before a joint is the image of the one after its
        image.
    """

    assembly: Assembly
    blocks: Places
    joints: Places
    swaps: NDArray[np.bool_]
    sense: Array

    def rates(self, rates: Array) -> Array:
        """Mean of the rates of blocks, (blocks, 3), and their mirror image."""
        return (rates + rates[self.blocks] * TURNED) / 2

    def forces(self, forces: Array) -> Array:
        """Mean of forces at joints, as of `Equilibrium`, and their mirror image."""
        arrays = self.assembly.joint_arrays
        axes = np.stack([arrays.normal, arrays.tangent], axis=1)
        image = (forces @ axes)[self.joints] * TURNED[:2]
        image = np.where(self.swaps[:, None, None], image[:, ::-1], image)
        image = self.sense[:, None, None] * image @ axes.swapaxes(1, 2)
        return (forces + image) / 2


def symmetric_forces(problem: Problem, forces: Array) -> Array:
    """Return forces that are symmetric where the structure, and all that acts on it, is."""
    mirror = mirror_of(problem)
    return forces if mirror is None else mirror.forces(forces)


def symmetric_rates(problem: Problem, rates: Array) -> Array:
    """Return rates of blocks that are symmetric where the structure, and all else, is."""
    mirror = mirror_of(problem)
    return rates if mirror is None else mirror.rates(rates)


def mirror_of(problem: Problem, *others: Array) -> Mirror | None:
    """Find how a structure, and all that acts on it, is its own mirror image, left to right.

    `others`, (blocks, 3): Further forces and moments on the blocks, which have to be symmetric
        as well.
    Returns: None where blocks, joints, friction or a pull are not symmetric.
    """
    assembly, arrays = problem.assembly, problem.assembly.joint_arrays
    centres = assembly.built[:-1, :2]
    ends = arrays.ends.reshape(-1, 2)
    if not len(ends):
        return None
    axis = (ends[:, 0].min() + ends[:, 0].max()) / 2
    places = np.concatenate([centres, ends]) - [axis, 0.0]
    here, there = _numbered(places), _numbered(places, mirrored=True)
    count = len(centres)
    at = {place: block for block, place in enumerate(here[:count])}
    blocks = [at.get(place) for place in there[:count]]
    if len(at) < count or None in blocks:
        return None
    image = np.array([*blocks, SUPPORT], np.int64)
    known: dict[tuple[object, ...], int] = {}
    for joint, pair in enumerate(zip(here[count::2], here[count + 1 :: 2], strict=True)):
        sides = int(arrays.before[joint]), int(arrays.after[joint])
        known[frozenset(sides), frozenset(pair)] = joint
    joints, swaps, sense = list[int](), list[bool](), list[float]()
    for joint, (inner, outer) in enumerate(
        zip(there[count::2], there[count + 1 :: 2], strict=True)
    ):
        before, after = int(image[arrays.before[joint]]), int(image[arrays.after[joint]])
        found = known.get((frozenset((before, after)), frozenset((inner, outer))))
        if found is None:
            return None
        joints.append(found)
        swaps.append(here[count + 2 * found] != inner)
        sense.append(1.0 if int(arrays.before[found]) == before else -1.0)
    order = np.array(joints, np.int64)
    friction = problem.friction
    if not (friction == friction[order]).all():
        return None
    for pull in (problem.applied_forces(), *others):
        if np.abs(pull - pull[image[:-1]] * TURNED).max() > ALIKE * np.abs(pull).max(
            initial=0.0
        ):
            return None
    return Mirror(
        assembly=assembly,
        blocks=image[:-1],
        joints=order,
        swaps=np.array(swaps, np.bool_),
        sense=np.array(sense),
    )


def _numbered(places: Array, *, mirrored: bool = False) -> list[tuple[int, int]]:
    """Give equal points equal numbers, and their images as well."""
    across = np.concatenate([places[:, 0], -places[:, 0]])
    across = _ranks(across).reshape(2, -1)[int(mirrored)]
    return list(zip(across.tolist(), _ranks(places[:, 1]).tolist(), strict=True))


def _ranks(values: Array) -> Places:
    """Rank values, those that are alike the same."""
    order = np.argsort(values, kind="stable")
    steps = np.diff(values[order], prepend=values[order[0]]) > ALIKE
    ranks = np.empty(len(values), np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks
