"""Corners that rest on faces: which face carries one, and how far its block can turn."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from blocksim.blocks.block import Array
from blocksim.blocks.outlines import before, following

ALONG = 0.98
"""Least cosine between the normal of a face and that of a corner's joint."""
OFF = 0.01
"""How far a corner may lie off the face that carries it, drawn in mortar [size]."""
NEAR = 1e-6
"""Distance within which two points are the same [size]."""
FLUSH = 1e-3
"""Angle between a face and the edge at a corner on it that is none [rad]."""


def carrying_faces(
    at: Array, normal: Array, bodies: Sequence[Sequence[Array]], size: float
) -> Array:
    """Find the face that carries a corner.

    `at`, (2,): The corner [m].
    `normal`, (2,): From the first body into the second.
    `bodies`, two sequences of (k, 2): Polygons of both, counter-clockwise; none where they are
        not known.
    `size`: [m]
    Returns (2, 2, 2): Faces of both bodies, from the inner to the outer end: of that with the
        corner twice the corner. Where no face lies there, the first body's is made up.
    """
    tangent = np.array([-normal[1], normal[0]])
    best, side = OFF * size, 0
    face = np.stack([at - size * tangent, at + size * tangent])
    for body, outward in ((0, normal), (1, -normal)):
        for polygon in bodies[body]:
            start, way = polygon, following(polygon) - polygon
            length = np.hypot(*way.T)
            out = np.stack([way[:, 1], -way[:, 0]], axis=1) / length[:, None]
            share = ((at - start) * way).sum(axis=1) / length**2
            off = np.hypot(*(at - start - np.clip(share, 0, 1)[:, None] * way).T)
            # A corner of the face itself carries only where nothing else does.
            aside = np.minimum(share, 1 - share) * length <= NEAR * size
            off = np.where(out @ outward > ALONG, off + aside * OFF / 2 * size, np.inf)
            found = int(off.argmin())
            if off[found] < best:
                best, side = float(off[found]), body
                face = np.stack([start[found], start[found] + way[found]])
    if float((face[1] - face[0]) @ tangent) < 0:
        face = face[::-1]
    faces = np.broadcast_to(at, (2, 2, 2)).copy()
    faces[side] = face
    return faces


def turns(
    at: Array, outward: Array, clockwise: Array, polygons: Sequence[Array], size: float
) -> tuple[float, float]:
    """How far a block can turn on a corner until an edge of it lies on the face.

    `at`, (2,): The corner [m].
    `outward`, (2,): Normal of the face, into the block with the corner.
    `clockwise`, (2,): Tangent of the face from which `outward` is reached by turning clockwise.
    `polygons`, sequence of (k, 2): Of the block [m].
    `size`: [m]
    Returns `clockwise`, `counter-clockwise`: [rad]; pi where no edge comes down, or one already
        lies there.
    """
    least, most = 0.0, math.pi
    low, high = most, least
    for polygon in polygons:
        for corner in np.flatnonzero(np.hypot(*(polygon - at).T) <= NEAR * size):
            for edge in (
                following(polygon)[corner] - polygon[corner],
                before(polygon)[corner] - polygon[corner],
            ):
                angle = math.atan2(float(edge @ outward), float(edge @ clockwise))
                low, high = min(low, angle), max(high, angle)
    down, up = math.pi - high, low
    if low > high:
        return math.pi, math.pi
    return (down if down > FLUSH else math.pi), (up if up > FLUSH else math.pi)
