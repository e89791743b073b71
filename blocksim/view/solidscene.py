"""Blocks in space in perspective: a camera, and their faces from back to front."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgb

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.view.order import painting_order
from blocksim.view.style import GROUND, STONE

ASIDE, ABOVE = math.radians(-60.0), math.radians(22.0)
"""Where the eye is: azimuth from x towards y, and height."""
DISTANCE = 5.0
"""Of the eye from the middle, in half-diagonals of what moves."""
LIGHT = np.array([-0.35, -0.55, 0.76])
AMBIENT = 0.55
"""Brightness of a face in shade; one that faces the light has 1."""
BED = 0.25
"""How far supports are drawn beyond what moves, in units of the size."""
Marks = Mapping[int, Sequence[tuple[Array, Array, str]]]
"""What is painted on the faces of blocks: corners, normal out of the block, colour."""


class Piece(NamedTuple):
    """A convex part as it is drawn: its faces with normals and colours."""

    corners: Array
    faces: list[tuple[Array, Array, str]]


class Camera:
    """An eye that sees a box in perspective.

    Parameters
    ----------
    low, high : (3,) float
        Ends of the box [m].
    """

    def __init__(self, low: Array, high: Array) -> None:
        self._away = away = np.array(
            [
                math.cos(ASIDE) * math.cos(ABOVE),
                math.sin(ASIDE) * math.cos(ABOVE),
                math.sin(ABOVE),
            ]
        )
        right = np.array([-math.sin(ASIDE), math.cos(ASIDE), 0.0])
        self._axes = np.stack([right, np.cross(away, right)])
        far = DISTANCE * float(np.linalg.norm(high - low)) / 2
        self.eye: Array = (low + high) / 2 + far * away

    def seen(self, points: Array) -> Array:
        """Return where points are in the picture, (k, 2), in no unit."""
        deep = (self.eye - points) @ self._away
        return (points - self.eye) @ self._axes.T / deep[:, None]

    def painted(self, pieces: Sequence[Piece]) -> tuple[list[Array], list[Array]]:
        """Return the faces that are seen, from back to front, and their colours."""
        polygons: list[Array] = []
        fills: list[Array] = []
        for index in self._order(pieces):
            for corners, normal, tone in pieces[index].faces:
                if normal @ (self.eye - corners[0]) > 0:
                    shade = AMBIENT + (1 - AMBIENT) * max(0.0, float(normal @ LIGHT))
                    polygons.append(self.seen(corners))
                    fills.append(np.array(to_rgb(tone)) * shade)
        return polygons, fills

    def _order(self, pieces: Sequence[Piece]) -> list[int]:
        """Order pieces from back to front."""
        count = max(len(each.corners) for each in pieces)
        planes = max(len(each.faces) for each in pieces)
        corners = np.stack([_filled(each.corners, count) for each in pieces])
        normals = np.zeros((len(pieces), planes, 3))
        offsets = np.zeros((len(pieces), planes))
        for at, each in enumerate(pieces):
            for k, (points, normal, _) in enumerate(each.faces):
                normals[at, k], offsets[at, k] = normal, points[0] @ normal
        flat = [self.seen(each.corners) for each in pieces]
        boxes = np.stack([np.stack([f.min(axis=0), f.max(axis=0)]) for f in flat])
        return painting_order(corners, normals, offsets, self.eye, boxes)


def _filled(corners: Array, count: int) -> Array:
    """Repeat the last corner until there are so many."""
    return np.concatenate([corners, np.repeat(corners[-1:], count - len(corners), axis=0)])


def moving_box(assembly: SpatialAssembly) -> Array:
    """Return least and largest places of what moves, as built, (2, 3)."""
    boxes = np.array([hull.box for each in assembly.blocks for hull in each.hulls])
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def supports_of(assembly: SpatialAssembly, low: Array, high: Array) -> list[Piece]:
    """Return what stays, cut off beyond a box."""
    bed = BED * assembly.size
    found = [
        _cut(hull, low - bed, high + bed) for each in assembly.supports for hull in each.hulls
    ]
    return [each for each in found if len(each.faces)]


def blocks_of(
    assembly: SpatialAssembly, turns: Array, shifts: Array, marks: Marks | None = None
) -> list[Piece]:
    """Return what moves, where it has gone.

    Parameters
    ----------
    assembly : SpatialAssembly
    turns : (blocks, 3, 3) float
        About their centres.
    shifts : (blocks, 3) float
        Of their centres [m].
    marks : mapping, optional
    """
    found: list[Piece] = []
    for at, block in enumerate(assembly.blocks):
        turn = turns[at]
        put = partial(_put, turn=turn, shift=shifts[at], about=block.centre)
        for hull in block.hulls:
            faces = [(put(each.corners), turn @ each.normal, STONE) for each in hull.faces]
            # What joints do is painted on the faces they are on.
            faces += [
                (put(points), turn @ normal, tone)
                for points, normal, tone in (marks or {}).get(at, [])
                if _lies_on(points, normal, hull)
            ]
            found.append(Piece(put(hull.corners), faces))
    return found


def corners_of(assembly: SpatialAssembly, turns: Array, shifts: Array) -> Array:
    """Return the corners of what moves, where it has gone, (k, 3) [m]."""
    return np.concatenate(
        [
            _put(hull.corners, turn, shift, block.centre)
            for block, turn, shift in zip(assembly.blocks, turns, shifts, strict=True)
            for hull in block.hulls
        ]
    )


def _put(points: Array, turn: Array, shift: Array, about: Array) -> Array:
    """Turn points about a point, and shift them."""
    return (points - about) @ turn.T + about + shift


def _lies_on(points: Array, normal: Array, hull: Polyhedron) -> bool:
    """Tell whether a joint lies on a face of a part."""
    near = 1e-3 * hull.thickness
    return any(
        face.normal @ normal > 0.999 and np.abs(points @ face.normal - face.offset).max() < near
        for face in hull.faces
    )


def _cut(hull: Polyhedron, low: Array, high: Array) -> Piece:
    """Return the box around a support, cut off beyond what is shown; or itself if within."""
    if not ((hull.box[0] >= low).all() and (hull.box[1] <= high).all()):
        lower, upper = np.maximum(hull.box[0], low), np.minimum(hull.box[1], high)
        if not (upper - lower > 1e-9).all():
            return Piece(np.zeros((0, 3)), [])
        hull = Polyhedron(list(itertools.product(*zip(lower, upper, strict=True))))
    return Piece(hull.corners, [(f.corners, f.normal, GROUND) for f in hull.faces])
