"""Stacks and towers: what joints carry there by statics alone, and so their margin.

Where each block reaches the ground through one joint only, as in a stack, a joint carries all
that is above it, whatever friction may do elsewhere: force and moment follow from equilibrium.
How they best lie on the ends of a joint in the plane has a closed form; so has it in space
where nothing rubs. The margin is that of the programmes (`equilibrium`, `can_rest`), which
other assemblies need.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.bodies import about
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.points import JointPoints
from blocksim.blocks.space.polyhedron import Vector, across
from blocksim.limit.bearing import bears
from blocksim.limit.cones import carried_weights, joint_weights

MOST = 1.0
"""Margin that is told at most, as of the programmes."""
RUBS = 1e-13
"""Force across, over that along the normal, up to which it is rounding."""


class Stacked(NamedTuple):
    """Margin and forces of a stack, as of `Equilibrium`, and what has least to spare.

    `weakest`: The joint of which the margin is.
    `above`: Blocks that it carries.
    `way`: How they would part there: 0 and 1 turn about that end, 2 and 3 slide along the
        tangent and against it.
    """

    margin: float
    forces: Array
    weakest: int
    above: set[int]
    way: int


def statics_of_stack(problem: Problem) -> Stacked | None:
    """Return what `equilibrium` says of a stack.

    Returns: None where blocks reach the ground in more ways than one, where a corner rests on a
        face, where friction is 0 or has no bound, or where soil bears what moves into it.

    Examples
    --------
    >>> from blocksim.kinds.column import Column
    >>> column = Column(drums=3, drum_height=1, width=1, friction=0.5).problem()
    >>> statics_of_stack(column).margin
    0.125
    """
    assembly, mu = problem.assembly, problem.friction
    joints = assembly.joint_arrays
    if joints.is_corner.any() or not (np.isfinite(mu) & (mu > 0)).all() or bears(problem):
        return None
    pull = about(problem.applied_forces(), -assembly.built[:-1, :2])
    ways = _ways(assembly.sides, len(pull))
    if ways is None:
        return None
    sums = _carried(ways, assembly.sides, pull)
    normal, tangent, (start, end) = joints.normal, joints.tangent, joints.ends.swapaxes(0, 1)
    along = (sums[:, :2] * normal).sum(axis=1)
    across = (sums[:, :2] * tangent).sum(axis=1)
    # Of moments about the first end only the other end's normal force has one.
    turning = sums[:, 2] - start[:, 0] * sums[:, 1] + start[:, 1] * sums[:, 0]
    way = end - start
    second = turning / (way[:, 0] * normal[:, 1] - way[:, 1] * normal[:, 0])
    # Parts along both edges of both cones: the least is largest where friction is shared so
    # that both ends have as much to spare, if both press by that much.
    spare = np.stack([second, along - second, (along - np.abs(across) / mu) / 2])
    unit = joint_weights(problem, carried_weights(problem))
    margins = spare.min(axis=0) * np.maximum(1.0, mu) / (2 * unit)
    weakest = int(margins.argmin())
    way = int(spare[:, weakest].argmin())
    if way == 2 and across[weakest] > 0:
        way = 3
    above = set[int]()
    for block, joint, below in ways:
        if joint == weakest or below in above:
            above.add(block)
    pressing = np.stack([along - second, second], axis=1)
    # Each end bears its share of the force across.
    rubbing = pressing * (across / np.where(along == 0.0, 1.0, along))[:, None]
    forces = np.stack([pressing, rubbing], axis=2)
    return Stacked(min(MOST, float(margins[weakest])), forces, weakest, above, way)


def margin_of_tower(problem: Problem[SpatialAssembly]) -> float | None:
    """Return the margin of `can_rest`, of a tower in which nothing rubs.

    Returns: None where blocks reach the ground in more ways than one, where a joint is no face,
        carries a force across or a moment about its normal, or would have to pull as a whole.
    """
    assembly = problem.assembly
    pull = problem.applied_forces() * problem.assembly.units
    pull[:, 3:] += np.cross(assembly.centres, pull[:, :3])
    ways = _ways(assembly.sides, len(pull))
    if ways is None:
        return None
    sums = _carried(ways, assembly.sides, pull)
    own, margin = JointPoints(problem).own * problem.unit_force, MOST
    first = 0
    for joint, mu, (x, y, z, *turning) in zip(
        assembly.joints, problem.friction.tolist(), sums.tolist(), strict=True
    ):
        found = _pressed(joint.points, joint.normal, mu, (x, y, z), turning)
        if found is None:
            return None
        margin = min(margin, found / float(own[first]))
        first += len(joint.points)
    return margin


def _pressed(
    points: Array, normal: Array, mu: float, force: Vector, turning: list[float]
) -> float | None:
    """Return how hard all corners of a face can press at once, which carries a force [N].

    The force acts at a place within the face. What is left when each corner presses by t acts
    on the ray from the corners' middle through that place, and leaves the face at its rim.
    """
    count = len(points)
    a, b, c = normal.tolist()
    x, y, z = force
    along = a * x + b * y + c * z
    corners = points.tolist()
    u, v, w = (sum(each) / count for each in zip(*corners, strict=True))
    away = [(i - u, j - v, k - w) for i, j, k in corners]
    i, j, k = turning
    # The moment about the corners' middle.
    i, j, k = i - (v * z - w * y), j - (w * x - u * z), k - (u * y - v * x)
    reach = max(abs(each) for spot in away for each in spot)
    aside = max(abs(x - along * a), abs(y - along * b), abs(z - along * c))
    rubs = max(aside, abs(i * a + j * b + k * c) / reach)
    if count < 3 or not along > 0 or not rubs <= RUBS * along * min(mu, 1.0):
        return None
    first, second = across((a, b, c))
    place = b * k - c * j, c * i - a * k, a * j - b * i
    x, y = _dot(first, place) / along, _dot(second, place) / along
    spots = [(_dot(first, each), _dot(second, each)) for each in away]
    share = 0.0
    for (a, b), (c, d) in zip(spots, spots[1:] + spots[:1], strict=True):
        # On which side of the edge the place is, over that of the middle.
        share = max(share, (x * (d - b) - y * (c - a)) / (a * (d - b) - b * (c - a)))
    return along / count * (1.0 - share)


def _dot(one: Vector, other: Vector) -> float:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def _ways(sides: NDArray[np.int64], count: int) -> list[tuple[int, int, int]] | None:
    """Return blocks from the ground up, with the joint that bears each, and what is below it.

    None where a block reaches the ground in no way, or in more than one.
    """
    pairs: list[tuple[int, int]] = list(zip(*sides.tolist(), strict=True))
    if len(pairs) != count:
        return None
    at: dict[int, list[int]] = {index: [] for index in (SUPPORT, *range(count))}
    for joint, pair in enumerate(pairs):
        for block in pair:
            at[block].append(joint)
    ways, reached = [(SUPPORT, -1, SUPPORT)], {SUPPORT}
    for block, by, _ in ways:
        for joint in at[block]:
            if joint == by:
                continue
            other = sum(pairs[joint]) - block
            if other in reached:
                return None
            reached.add(other)
            ways.append((other, joint, block))
    return ways[1:] if len(reached) > count else None


def _carried(ways: list[tuple[int, int, int]], sides: NDArray[np.int64], pull: Array) -> Array:
    """Return force and moment at each joint on the block after it, about the origin.

    (joints, 3 or 6) float, of pulls about the origin.
    """
    above, sums = pull.copy(), np.zeros_like(pull)
    for block, joint, below in reversed(ways):
        sums[joint] = above[block] * (-1.0 if sides[1, joint] == block else 1.0)
        if below != SUPPORT:
            above[below] += above[block]
    return sums
