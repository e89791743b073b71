"""Forces that balance to round-off, made to balance exactly: what is left is handed on."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.common.later import linalg
from blocksim.limit.exact import Exact, Number

Column = Sequence[Number]
"""Force x, y and moment."""


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
    """Hand on what is left on a block by the three parts of its joints with most room."""
    cx, cy = exact.centres[block]
    places: list[tuple[int, int, int]] = []
    columns: list[tuple[int, int, int]] = []
    for joint in joints:
        (p, q), (before, after) = exact.normals[joint], exact.sides[joint]
        sign, other = (1, before) if after == block else (-1, after)
        for end in {exact.ends[joint][0]: 0, exact.ends[joint][1]: 1}.values():
            x, y = exact.ends[joint][end]
            for k, (u, v) in enumerate(((sign * p, sign * q), (-sign * q, sign * p))):
                places.append((4 * joint + 2 * end + k, other, joint))
                columns.append((u, v, (x - cx) * v - (y - cy) * u))
    able = np.array([room[joint] for _, _, joint in places])
    # Whole numbers are divided first: those of tiny coordinates are beyond all floats.
    rows = np.array([_by_largest(row) for row in zip(*columns, strict=True)]) * able
    rows /= np.maximum(np.abs(rows).max(axis=1, keepdims=True), 1e-300)
    if rows.shape[1] < PLANAR:
        return False
    qr: Any = linalg.qr
    chosen: list[int] = qr(rows, pivoting=True, mode="economic")[2][:PLANAR].tolist()
    a, b, c = (columns[each] for each in chosen)
    whole = _triple(a, b, c)
    if not whole:
        return False
    goal = [-each for each in left[block]]
    found = _triple(goal, b, c), _triple(a, goal, c), _triple(a, b, goal)
    left[block] = [0] * PLANAR
    for each, above in zip(chosen, found, strict=True):
        (at, other, _), (u, v, moment), more = (
            places[each],
            columns[each],
            Fraction(above) / whole,
        )
        parts[at] += more
        if other != SUPPORT:
            (ox, oy), wrench = exact.centres[other], left[other]
            wrench[0] -= more * u
            wrench[1] -= more * v
            wrench[2] -= more * (moment + (cx - ox) * v - (cy - oy) * u)
    return True


def _triple(a: Column, b: Column, c: Column) -> Number:
    """Return the determinant of three columns."""
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - b[0] * (a[1] * c[2] - a[2] * c[1])
        + c[0] * (a[1] * b[2] - a[2] * b[1])
    )


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


def _by_largest(row: Sequence[int]) -> list[float]:
    """Divide whole numbers by the largest of them."""
    largest = max(map(abs, row), default=0) or 1
    return [each / largest for each in row]
