"""Cameras: one that draws back as blocks leave the picture, and an eye in perspective.

The eye sees convex pieces and paints them from back to front. Two convex bodies that do not
meet are parted by a plane, and whoever is on the eye's side of it is painted later. Planes
tried are those of the faces of the two, which part blocks that touch along a face, roll over an
edge or have come apart; the one with the widest gap decides, so that a slight overlap does no
harm.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.view.canvas import Colour, Panel, Shape

DISTANCE = 4.2
"""Distance of the eye from the middle, in half-diagonals of what is shown."""
NEAREST = 0.3
"""Least distance from the eye at which anything is seen, over what is shown."""
FLAT = 1e-9
"""Length of a face's normal below which it is no face."""


class Face(NamedTuple):
    """A face of a piece: corners (k, 3), its normal outwards, and how it is painted."""

    corners: Array
    normal: Array
    tone: Colour
    edge: Colour
    width: float


class Line(NamedTuple):
    """A line on a piece, (2, 3), seen where one of the faces beside it is."""

    points: Array
    normals: Sequence[Array]
    tone: Colour
    width: float


class Piece(NamedTuple):
    """A convex part as it is drawn, y upwards."""

    corners: Array
    faces: Sequence[Face]
    lines: Sequence[Line] = ()

    def moved(self, turn: Array, place: Array) -> Piece:
        """Return it turned, (3, 3), about the origin, which goes to a place."""
        return Piece(
            self.corners @ turn.T + place,
            [
                each._replace(corners=each.corners @ turn.T + place, normal=turn @ each.normal)
                for each in self.faces
            ],
            [
                each._replace(
                    points=each.points @ turn.T + place,
                    normals=[turn @ normal for normal in each.normals],
                )
                for each in self.lines
            ],
        )


class Camera:
    """An eye in perspective; y is upwards.

    `middle`, (3,): What it looks at.
    `reach`: Half-diagonal of what is shown.
    `aside`, `above`: Where the eye is: turned about the vertical, and raised.

    It has:
    `eye`, (3,).
    `scale`: Pixels in a length of 1 at the distance of 1.
    `shift`, (2,): The place of the middle [pixels].
    """

    def __init__(self, middle: Array, reach: float, aside: float, above: float) -> None:
        self._away = np.array(
            [
                math.sin(aside) * math.cos(above),
                math.sin(above),
                math.cos(aside) * math.cos(above),
            ]
        )
        self.eye: Array = middle + DISTANCE * reach * self._away
        right = np.array([math.cos(aside), 0.0, -math.sin(aside)])
        self._axes = np.stack([right, np.cross(self._away, right)])
        self._nearest = NEAREST * reach
        self.scale, self.shift = 1.0, np.zeros(2)

    def seen(self, points: Array) -> Array:
        """Return where points are in the picture, (..., 2) [pixels]."""
        arms = points - self.eye
        # What is beside the eye or behind it is seen as far away as can be.
        depth = np.maximum(-arms @ self._away, self._nearest)
        return arms @ self._axes.T / depth[..., None] * self.scale + self.shift

    def sees(self, point: Array, normal: Array) -> bool:
        """Tell whether a face through a point looks at the eye."""
        return bool(normal @ (self.eye - point) > 0)

    def order(self, pieces: Sequence[Piece]) -> list[int]:
        """Order pieces from back to front."""
        count = max(len(each.corners) for each in pieces)
        planes = max(len(each.faces) for each in pieces)
        corners = np.stack(
            [np.pad(p.corners, ((0, count - len(p.corners)), (0, 0)), "edge") for p in pieces]
        )
        normals = np.zeros((len(pieces), planes, 3))
        offsets = np.zeros((len(pieces), planes))
        for at, each in enumerate(pieces):
            for k, face in enumerate(each.faces):
                normals[at, k], offsets[at, k] = face.normal, face.corners[0] @ face.normal
        flat = self.seen(corners)
        boxes = np.stack([flat.min(axis=1), flat.max(axis=1)], axis=1)
        return painting_order(corners, normals, offsets, self.eye, boxes)


def painting_order(
    corners: Array, normals: Array, offsets: Array, eye: Array, boxes: Array
) -> list[int]:
    """Order bodies so that each is painted after all it hides.

    `corners`, (bodies, corners, 3).
    `normals`, (bodies, faces, 3): Outwards; a normal of length 0 is no face.
    `offsets`, (bodies, faces): Of the faces along their normals.
    `eye`, (3,).
    `boxes`, (bodies, 2, 2): Smallest and largest place of each body in the picture: only where
        these overlap can one body hide another.
    Returns: The farthest first. Where bodies hide each other in a ring, which convex ones
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
    """Widest gap of bodies to faces of others, and the eye's side of that face."""
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


EASED = 0.5
"""How long before a block would leave the camera begins to draw back [s of film]."""
FARTHEST = 1 / 12
"""Least share of its size at the release that anything is drawn with."""
MARGIN = 0.03
"""Share of a panel on each side that blocks keep off."""


def needed(places: Array, panel: Panel, centre: Array) -> float:
    """Return the share at which places find room in a panel, about a point that stays."""
    low = np.array([panel.x + MARGIN * panel.width, panel.y])
    high = np.array([panel.x + (1 - MARGIN) * panel.width, panel.y + panel.height])
    off = places - centre
    room = np.where(off > 0, high - centre, centre - low)
    least = float((room / np.maximum(np.abs(off), 1e-9)).min(initial=1.0))
    return max(FARTHEST, min(1.0, least))


def is_lost(places: Array, panel: Panel, centre: Array) -> bool:
    """Tell whether no point is in the picture, however far the camera draws back."""
    off = FARTHEST * (places - centre) + centre - [panel.x, panel.y]
    return not bool(((off > 0) & (off < [panel.width, panel.height])).all(axis=1).any())


def eased(times: Array, shares: Array, before: float) -> tuple[Array, Array]:
    """Return times and shares of a camera that never comes nearer, and draws back smoothly.

    At each time the share is at most what is needed there: it is the mean over a while of the
    least that is needed up to the end of that while.
    """
    least: Array = np.minimum.accumulate(shares)
    fine = np.linspace(float(times[0]), float(times[-1]), 4 * len(times))
    ahead: Array = least[np.minimum(np.searchsorted(times, fine + before), len(times) - 1)]
    # Sums of the mean, with what was at first going on before the release.
    summed = np.concatenate([[0.0], np.cumsum((ahead[1:] + ahead[:-1]) / 2 * np.diff(fine))])
    back = np.interp(fine - before, fine, summed)
    early = np.maximum(0.0, before - (fine - fine[0])) * ahead[0]
    mean: Array = (summed - back + early) / before if before > 0 else ahead
    now: Array = least[np.minimum(np.searchsorted(times, fine), len(times) - 1)]
    return fine, np.minimum(mean, now)


def zoomed(shapes: Sequence[Shape], share: float, centre: Array) -> list[Shape]:
    """Draw shapes smaller about a point. Lines keep their width."""
    if share == 1:
        return list(shapes)
    return [shape._replace(points=centre + share * (shape.points - centre)) for shape in shapes]
