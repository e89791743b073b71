"""Forces that balance to round-off, made to balance exactly: what is left is handed on."""

from __future__ import annotations

import heapq
import math
import operator
from collections.abc import Sequence
from fractions import Fraction
from itertools import islice
from typing import Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.common.later import flint
from blocksim.limit.exact import Exact, Number, apart, moment

FINE = 1 << 20
"""Into how many parts the room of a point is told."""


def handed_on(
    exact: Exact, whole: list[int], unbalanced: list[list[int]], forces: Array
) -> list[Number] | None:
    """Hand on what is left on each block through the strongest joints to a support.

    None where the joints on the way cannot take it.
    """
    parts: list[Number] = [*whole]
    left: list[list[Number]] = [[*wrench] for wrench in unbalanced]
    room = _room(exact, forces)
    for block, joints in reversed(ways(exact, room)):
        if not any(left[block]):
            continue
        (x, y), far = exact.ends[joints[0]]
        if (x, y) == far:
            if not _by_parts(exact, parts, left, room, block, joints):
                return None
            continue
        joint = joints[0]
        u, v, moment = left[block]
        before, after = exact.sides[joint]
        other, sign = (before, -1) if after == block else (after, 1)
        cx, cy = exact.centres[block]
        # On the block after the joint: about the first end.
        about = moment - (x - cx) * v + (y - cy) * u
        p, q = exact.normals[joint]
        double, half = 2 * sign * (p * p + q * q), v * p - u * q
        more = (2 * (u * p + v * q + about), half, -2 * about, half)
        for at, above in enumerate(more, 4 * joint):
            parts[at] = Fraction(parts[at] * double + above, double)
        if other != SUPPORT:
            (ox, oy), wrench = exact.centres[other], left[other]
            wrench[0] += u
            wrench[1] += v
            wrench[2] += moment + (cx - ox) * v - (cy - oy) * u
    return parts


def _by_parts(
    exact: Exact,
    parts: list[Number],
    left: list[list[Number]],
    room: Array,
    block: int,
    joints: list[int],
) -> bool:
    """Hand on what is left on a block by all parts of its joints."""
    found = borne(exact, block, joints, left[block], [[each] * 2 for each in fine(room)])
    for joint, forces in (found or {}).items():
        ways, (before, after) = exact.ways(joint), exact.sides[joint]
        other, sign = (before, -1) if after == block else (after, 1)
        for end, force in enumerate(forces):
            for k, part in enumerate(force):
                parts[4 * joint + 2 * end + k] += part
            if other != SUPPORT:
                u, v = (sum(map(operator.mul, force, each)) for each in zip(*ways, strict=True))
                turn = moment(apart(exact.ends[joint][end], exact.centres[other]), (u, v))
                for at, each in enumerate((u, v, *turn)):
                    left[other][at] += sign * each
    return found is not None


def borne(
    exact: Exact,
    block: int,
    joints: Sequence[int],
    wrench: Sequence[Number],
    shares: Sequence[list[int]],
) -> dict[int, list[list[Fraction]]] | None:
    """Return forces at the points of joints that bear what is left on a block, exactly.

    Each point is a spring as stiff as it has room, without friction along its normal alone.
    They bear what is left as the block moves. None where they cannot: springs at an edge bear
    no moment about it.

    `shares`: Stiffness of each point of each joint.
    Returns: Along `Exact.ways`, on the block after, for each point of each joint.
    """
    rows: list[list[int]] = []
    stiff: list[int] = []
    for joint in joints:
        along = exact.ways(joint)
        for point, share in zip(exact.ends[joint], shares[joint], strict=True):
            arm = apart(point, exact.centres[block])
            rows += [[*way, *moment(arm, way)] for way in along]
            stiff += [share] * len(along)
    columns, size = np.array(rows, dtype=object), len(wrench)
    springs = columns * np.array(stiff, dtype=object)[:, None]
    common = math.lcm(*(each.denominator for each in wrench))
    right = [-int(each * common) for each in wrench]
    matrix: Any = flint.fmpz_mat(size, size, (columns.T @ springs).ravel().tolist())
    try:
        moves, scale = matrix.solve(flint.fmpz_mat(size, 1, right)).numer_denom()
    except ZeroDivisionError:
        return None
    below = common * int(scale)
    pushes = iter((springs @ np.array([int(each) for each in moves.entries()])).tolist())
    found: dict[int, list[list[Fraction]]] = {}
    for joint in joints:
        sense, count = 1 if exact.sides[joint][1] == block else -1, len(exact.ways(joint))
        found[joint] = [
            [Fraction(sense * each, below) for each in islice(pushes, count)]
            for _ in exact.ends[joint]
        ]
    return found


def fine(room: Array) -> list[int]:
    """Return room in whole numbers, 1 where there is none."""
    shares: Array = np.maximum(room / max(float(room.max()), 1e-300) * FINE, 1)
    return shares.astype(np.int64).tolist()


def _room(exact: Exact, forces: Array) -> Array:
    """Return by how much forces may change at each joint before they leave their cones."""
    mu = exact.problem.friction[:, None]
    finite = np.where(np.isinf(mu), 0.0, mu)
    pressure, friction = forces[..., 0], np.abs(forces[..., 1])
    room = np.where(np.isinf(mu), pressure, np.minimum(finite * pressure - friction, pressure))
    return np.maximum(room.min(axis=1), 0.0)


def ways(exact: Exact, room: Array) -> list[tuple[int, list[int]]]:
    """Return each block after those on its widest way to a support, and its joints with them.

    The widest joint is the first. Those come last that cannot bear every force and moment:
    corners, and in space also edges.

    `room`, (joints,): How wide each joint is.
    """
    at: dict[int, list[int]] = {}
    for joint, sides in enumerate(exact.sides):
        for side in sides:
            at.setdefault(side, []).append(joint)
    seen, found = {SUPPORT}, list[tuple[int, list[int]]]()
    heap = list[tuple[bool, float, int, int]]()

    def reach(block: int) -> None:
        for joint in at.get(block, ()):
            one, other = exact.sides[joint]
            far = other if one == block else one
            if far not in seen:
                narrow = len({*exact.ends[joint]}) < exact.axes
                heapq.heappush(heap, (narrow, -float(room[joint]), joint, far))

    reach(SUPPORT)
    while heap:
        _, _, joint, block = heapq.heappop(heap)
        if block not in seen:
            seen.add(block)
            others = [
                each for each in at[block] if each != joint and seen >= {*exact.sides[each]}
            ]
            found.append((block, [joint, *others]))
            reach(block)
    return found
