"""Convex polyhedra that move: padded arrays, so that all of them are looked at together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.space.assembly import FaceJoint, SpatialAssembly
from blocksim.blocks.space.parting import FACE
from blocksim.blocks.space.polyhedron import Polyhedron, frame

Places = NDArray[np.int64]
LEAST = 1e-3
"""Width of what a corner stands on [size]."""
FLOOR_WIDTH = 100.0
"""Side of the floor beyond what stands on it [size]."""


@dataclass(frozen=True, eq=False)
class Hulls:
    """Convex parts of blocks, of supports and the floor, in frames of their own.

    Rows are padded by repeating what they have, so that extremes over them are right.
    Lengths are in units of the assembly's size.

    `owner`, (hulls,): Block of each, `SUPPORT` where it is fixed.
    `support`, (hulls,): Which support it is part of; -1 for the floor, for one that is not
        known and for what moves.
    `corners`, (hulls, v, 3): From the centre of the block; of fixed ones from the origin.
    `normals`, (hulls, f, 3).
    `offsets`, (hulls, f): ``normal @ x`` on each face.
    `around`, (hulls, f, k): Corners of each face, counter-clockwise seen from outside.
    `many`, (hulls, f): How many of them there are; 0 for faces that are padding.
    `edges`, (hulls, e, 2): Corners at the ends of each edge.
    `thickness`, (hulls,): Least distance between two planes around it.
    """

    owner: Places
    support: Places
    corners: Array
    normals: Array
    offsets: Array
    around: Places
    many: Places
    edges: Places
    thickness: Array

    def placed(self, centres: Array, turns: Array) -> Hulls:
        """Return them where the blocks are.

        `centres`, (blocks + 1, 3): The last row is 0, for what is fixed.
        `turns`, (blocks + 1, 3, 3): The last one is the identity.
        """
        turn, centre = turns[self.owner], centres[self.owner]
        corners = np.einsum("hij,hvj->hvi", turn, self.corners) + centre[:, None]
        normals = np.einsum("hij,hfj->hfi", turn, self.normals)
        offsets = self.offsets + np.einsum("hfi,hi->hf", normals, centre)
        return replace(self, corners=corners, normals=normals, offsets=offsets)


def hulls_of(assembly: SpatialAssembly, axes: Array) -> Hulls:
    """Return the convex parts of all blocks, supports and the floor, in the blocks' frames.

    What a joint stands on that lies on no known support is as wide as the joint.
    The floor is level with the lowest of them. No block touches it as it is built but
    through a joint.

    `axes`, (blocks, 3, 3): Columns are the axes of each block's frame.
    """
    size = assembly.size
    made: list[Polyhedron] = []
    owner: list[int] = []
    support: list[int] = []
    for index, block in enumerate(assembly.blocks):
        for hull in block.hulls:
            own = (hull.corners - block.centre) @ axes[index]
            made.append(Polyhedron(own / size, hull.slack / size))
            owner.append(index)
            support.append(-1)
    for index, block in enumerate(assembly.supports):
        for hull in block.hulls:
            made.append(Polyhedron(hull.corners / size, hull.slack / size))
            owner.append(SUPPORT)
            support.append(index)
    for joint in assembly.joints:
        if SUPPORT in (joint.before, joint.after) and joint.support is None:
            made.append(_behind(joint, size))
            owner.append(SUPPORT)
            support.append(-1)
    made.append(_floor(assembly))
    return _padded(made, [*owner, SUPPORT], [*support, -1])


def _behind(joint: FaceJoint, size: float) -> Polyhedron:
    """Return a pyramid behind a joint with the ground."""
    out = joint.normal * (-1 if joint.before == SUPPORT else 1)
    middle = joint.points.mean(axis=0)
    wide = float(np.ptp(joint.points, axis=0).max()) or LEAST * size
    corners = joint.points
    if len(corners) < FACE:
        one, other = frame(joint.normal)
        corners = middle + wide * np.array([one, other, -one, -other])
    return Polyhedron(np.vstack([corners, middle + wide / 10 * out]) / size)


def _floor(assembly: SpatialAssembly) -> Polyhedron:
    """Return the floor as a wide and thick box."""
    bodies = (*assembly.blocks, *assembly.supports)
    boxes = np.array([hull.box for body in bodies for hull in body.hulls]) / assembly.size
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    reach = FLOOR_WIDTH + (high - low).max()
    x, y = (low + high)[:2] / 2
    return Polyhedron(
        [
            (x + i * reach, y + j * reach, low[2] - k * reach)
            for i in (-1, 1)
            for j in (-1, 1)
            for k in (0, 1)
        ]
    )


def _padded(made: Sequence[Polyhedron], owner: list[int], support: list[int]) -> Hulls:
    """Put polyhedra into arrays as long as the longest."""
    count = len(made)
    most = max(len(hull.corners) for hull in made)
    faces = max(len(hull.faces) for hull in made)
    sides = max(len(face.corners) for hull in made for face in hull.faces)
    ends = max(len(hull.edges) for hull in made)
    corners = np.zeros((count, most, 3))
    normals, offsets = np.zeros((count, faces, 3)), np.zeros((count, faces))
    around = np.zeros((count, faces, sides), dtype=np.int64)
    many = np.zeros((count, faces), dtype=np.int64)
    edges = np.zeros((count, ends, 2), dtype=np.int64)
    for at, hull in enumerate(made):
        own = hull.corners
        corners[at] = own[np.minimum(np.arange(most), len(own) - 1)]
        normals[at], offsets[at] = hull.faces[0].normal, hull.faces[0].offset
        for f, face in enumerate(hull.faces):
            places = _nearest(own, face.corners)
            normals[at, f], offsets[at, f] = face.normal, face.offset
            around[at, f] = places[np.minimum(np.arange(sides), len(places) - 1)]
            many[at, f] = len(places)
        pairs = _nearest(own, hull.edges.reshape(-1, 3)).reshape(-1, 2)
        edges[at] = pairs[np.minimum(np.arange(ends), len(pairs) - 1)]
    return Hulls(
        np.array(owner),
        np.array(support),
        corners,
        normals,
        offsets,
        around,
        many,
        edges,
        np.array([hull.thickness for hull in made]),
    )


def _nearest(corners: Array, points: Array) -> Places:
    """Return which corner each point is."""
    apart = np.linalg.norm(points[:, None] - corners[None], axis=2)
    return apart.argmin(axis=1)
