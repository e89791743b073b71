"""Lines of thrust of any structure: where forces cross joints, followed from block to block."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.limit import Resultants, resultants

FAINT = 1e-6
"""Share of the largest force below which a joint carries nothing."""
MEETING = 2
"""Bodies that a block of a chain touches."""
CHAINED = 0.75
"""Share of such blocks from which on a structure has lines of thrust that can be read."""

PARALLEL = 1e-9
"""Sine of the angle between forces below which a block bears nothing between them."""
AWAY = 0.35
"""Distance from the blocks beyond which a line of thrust is not drawn [largest side]."""


def thrust_of(problem: Problem, forces: Array, joint: int) -> float:
    """Horizontal part of the force through a joint, above 0 where it presses [N]."""
    sense = math.copysign(1.0, problem.assembly.joint_arrays.normal[joint, 0])
    return sense * float(resultants(problem, forces).force[joint, 0])


def is_chained(problem: Problem) -> bool:
    """Whether most blocks touch two bodies, as in an arch, on piers or not, or a column."""
    assembly = problem.assembly
    met: list[set[object]] = [set() for _ in assembly.blocks]
    for index, joint in enumerate(assembly.joints):
        ground = ("joint", index) if joint.support is None else ("support", joint.support)
        sides = [ground if side == SUPPORT else side for side in (joint.before, joint.after)]
        for mine, other in (sides, sides[::-1]):
            if isinstance(mine, int):
                met[mine].add(other)
    return sum(len(each) <= MEETING for each in met) >= CHAINED * len(met)


def thrust_lines(problem: Problem, forces: Array) -> list[Array]:
    """Follow the force from joint to joint, along its lines of action.

    Within a block of two joints it goes along the force of the one to where it meets that of
    the other, on the line of action of the block's weight and loads: it leaves each joint in
    the direction of its force. Where they do not meet between the joints it goes straight.
    A block on which several blocks lie hands what each of them brings on to all that bear it,
    straight from joint to joint.

    `forces`, (joints, 2, 2): As of `Equilibrium` [mean weights].
    Returns list of (k, 2): Open polylines [m].
    """
    carried = resultants(problem, forces)
    size = np.hypot(*carried.force.T)
    loaded = (size > FAINT * size.max(initial=0.0)) & ~np.isnan(carried.point[:, 0])
    pull = problem.gravity[:2]
    at: list[list[tuple[int, float]]] = [[] for _ in problem.assembly.blocks]
    for index, joint in enumerate(problem.assembly.joints):
        if loaded[index]:
            down = float(carried.force[index] @ pull)
            for block, sign in ((joint.before, -1.0), (joint.after, 1.0)):
                if block != SUPPORT:
                    at[block].append((index, sign * down))
    links: dict[int, list[int]] = {}
    through: dict[int, set[int]] = {}
    for block, touching in enumerate(at):
        brings = [joint for joint, down in touching if down > 0]
        bears = [joint for joint, down in touching if down <= 0]
        if len(touching) == MEETING:
            brings, bears = [touching[0][0]], [touching[1][0]]
        for one in brings:
            for other in bears:
                links.setdefault(one, []).append(other)
                links.setdefault(other, []).append(one)
                through.setdefault(one, set()).add(block)
                through.setdefault(other, set()).add(block)
    # A line goes on where it comes from one block and leads into another.
    passed = {joint for joint in links if len(links[joint]) == len(through[joint]) == MEETING}
    chained = {
        frozenset(joint for joint, _ in touching) for touching in at if len(touching) == MEETING
    }
    return [_along(carried, path, chained) for path in _paths(links, passed)]


def _along(carried: Resultants, path: Sequence[int], chained: set[frozenset[int]]) -> Array:
    """Return the corners of a line through joints: their points, and where forces meet."""
    corners: list[Array] = []
    for one, other in pairwise(path):
        start, stop = carried.point[one], carried.point[other]
        corners.append(start)
        ahead, back = carried.force[one], carried.force[other]
        turn = float(ahead[0] * back[1] - ahead[1] * back[0])
        if frozenset((one, other)) not in chained or abs(turn) <= PARALLEL * float(
            np.hypot(*ahead) * np.hypot(*back)
        ):
            continue
        way = stop - start
        along = float(way[0] * back[1] - way[1] * back[0]) / turn
        meet = start + along * ahead
        if 0 < float((meet - start) @ way) < float(way @ way):
            corners.append(meet)
    return np.array([*corners, carried.point[path[-1]]])


def _paths(links: dict[int, list[int]], passed: set[int]) -> list[list[int]]:
    """Walk all links once, from where lines end or meet."""
    left = {(one, other) for one, others in links.items() for other in others}
    # What ends or meets comes first, and rings, which have no such place, last.
    starts = sorted(links, key=lambda joint: (joint in passed, joint))
    paths: list[list[int]] = []
    for start in starts:
        for step in links[start]:
            here, ahead, path = start, step, [start]
            while (here, ahead) in left:
                left -= {(here, ahead), (ahead, here)}
                path.append(ahead)
                further = [each for each in links[ahead] if (ahead, each) in left]
                if ahead not in passed or not further:
                    break
                here, ahead = ahead, further[0]
            if len(path) > 1:
                paths.append(path)
    return paths


def force_sizes(problem: Problem, forces: Array, path: Array) -> Array:
    """Return how large the force is along the pieces of a line of thrust, (k - 1,) [N].

    It is that of the joint which is nearest to the middle of each piece.

    `forces`, (joints, 2, 2): As of `Equilibrium` [mean weights].
    `path`, (k, 2): A line of `thrust_lines` [m].
    """
    carried = resultants(problem, forces)
    loaded = ~np.isnan(carried.point[:, 0])
    points, sizes = carried.point[loaded], np.hypot(*carried.force[loaded].T)
    middles = (path[1:] + path[:-1]) / 2
    apart = np.hypot(*(middles[:, None] - points).transpose(2, 0, 1))
    return sizes[apart.argmin(axis=1)]


def near_blocks(problem: Problem, paths: Sequence[Array]) -> bool:
    """Whether lines that leave the blocks stay near them."""
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    low, high = corners.min(axis=0), corners.max(axis=0)
    slack = AWAY * float((high - low).max())
    points = np.concatenate(paths)
    return bool(((points > low - slack) & (points < high + slack)).all())
