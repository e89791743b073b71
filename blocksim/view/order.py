"""Which block hides which: convex bodies in the order in which a painter would paint them.

Two convex bodies that do not meet are parted by a plane, and whoever is on the eye's side
of it is painted later. Planes tried are those of the faces of the two, which part blocks
that touch along a face, roll over an edge or have come apart; the one with the widest gap
decides, so that a slight overlap does no harm.
"""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array

FLAT = 1e-9
"""Length of a face's normal below which it is no face."""


def painting_order(
    corners: Array, normals: Array, offsets: Array, eye: Array, boxes: Array
) -> list[int]:
    """Order bodies so that each is painted after all it hides.

    Parameters
    ----------
    corners : (bodies, corners, 3) float
    normals : (bodies, faces, 3) float
        Outwards; a normal of length 0 is no face.
    offsets : (bodies, faces) float
        Of the faces along their normals.
    eye : (3,) float
    boxes : (bodies, 2, 2) float
        Smallest and largest place of each body in the picture: only where these overlap
        can one body hide another.

    Returns
    -------
    list of int
        The farthest first. Where bodies hide each other in a ring, which convex ones
        rarely do, the farthest of them is painted first.
    """
    low, high = boxes[:, 0], boxes[:, 1]
    meet = ((low[:, None] < high[None]) & (low[None] < high[:, None])).all(axis=-1)
    one, two = np.nonzero(np.triu(meet, 1))
    gap_of_one, side_of_one = _gaps(corners[two], normals[one], offsets[one], eye)
    gap_of_two, side_of_two = _gaps(corners[one], normals[two], offsets[two], eye)
    # Beyond a face of `one` the eye sees `two` in front; beyond a face of `two`, `one`.
    two_in_front = np.where(gap_of_one >= gap_of_two, side_of_one > 0, side_of_two <= 0)
    behind = np.where(two_in_front, one, two)
    before = np.where(two_in_front, two, one)
    distance = np.linalg.norm(corners.mean(axis=1) - eye, axis=1)
    return _sorted(len(corners), behind, before, distance)


def _gaps(corners: Array, normals: Array, offsets: Array, eye: Array) -> tuple[Array, Array]:
    """Widest gap between bodies and the faces of others, and the eye's side of that face.

    Parameters
    ----------
    corners : (pairs, corners, 3) float
    normals, offsets : (pairs, faces, 3) and (pairs, faces) float
    """
    heights = np.einsum("pck,pfk->pfc", corners, normals).min(axis=-1) - offsets
    heights[np.abs(normals).max(axis=-1) < FLAT] = -np.inf
    face = heights.argmax(axis=1)
    pair = np.arange(len(face))
    side = normals[pair, face] @ eye - offsets[pair, face]
    return heights[pair, face], side


def _sorted(
    count: int, behind: NDArray[np.int64], before: NDArray[np.int64], distance: Array
) -> list[int]:
    """Sort topologically, the farthest first wherever there is a choice."""
    covers: dict[int, list[int]] = {body: [] for body in range(count)}
    waits = [0] * count
    for far, near in zip(behind.tolist(), before.tolist(), strict=True):
        covers[far].append(near)
        waits[near] += 1
    free = [(-float(distance[body]), body) for body in range(count) if waits[body] == 0]
    heapq.heapify(free)
    left = set(range(count))
    order: list[int] = []
    while left:
        body = heapq.heappop(free)[1] if free else max(left, key=lambda i: float(distance[i]))
        if body not in left:
            continue
        left.discard(body)
        order.append(body)
        for near in covers[body]:
            waits[near] -= 1
            if waits[near] == 0:
                heapq.heappush(free, (-float(distance[near]), near))
    return order
