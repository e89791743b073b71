"""The view in space: a recording in perspective, with shadows on the ground."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.view.canvas import (
    Colour,
    Label,
    Panel,
    Shape,
    colour,
    edge_width,
    mixed,
    stone_tones,
)
from blocksim.view.drawing import Part, along_side, words_of
from blocksim.view.order import painting_order
from blocksim.view.placing import padded
from blocksim.view.stage import Moment, Stage
from blocksim.view.style import GROUND, INK, PAPER, THRUST

ASIDE, ABOVE = math.radians(-32.0), math.radians(14.0)
"""Where the eye is: turned about the vertical, and raised."""
DISTANCE = 4.2
"""Of the eye from the middle, in half-diagonals of what is shown."""
MARGIN = 0.05
LIGHT = np.array([-0.42, 0.78, 0.46]) / math.hypot(0.42, 0.78, 0.46)
"""Towards the sun: left, up, forward."""
AMBIENT = 0.52
"""Brightness of a face in shade; one that faces the sun has 1."""
SHADOW = 0.72
"""Brightness of the ground in the shade."""
WIDER = 1.12
"""Depth of the footings over that of the blocks."""
NEAREST = 0.3
"""Least distance from the eye at which anything is seen, over what is shown."""
SEAM = 0.6
"""Width of a line that closes the seam between parts of a block [pixels]."""
RINGS = 60
"""Discs that the ground fades out in."""


class SpatialView:
    """Draws the moments of a stage into a panel, in perspective.

    Parameters
    ----------
    stage : Stage
    panel : Panel
    shown : (k, 3) float
        Points that find place in the panel, x from the middle of the blocks at rest.

    Attributes
    ----------
    still : list of Shape
        What stays the same.
    """

    def __init__(self, stage: Stage, panel: Panel, shown: Array) -> None:
        self._stage = stage
        wide = stage.depth / 2 * WIDER
        self._footings = np.array(
            [_prism(padded(each, stage.sides), wide) for each in stage.footings]
        )
        shown = shown + np.array([stage.middle, 0.0, 0.0])
        low, high = float(shown[:, 0].min()), float(shown[:, 0].max())
        aside = 0.0 if stage.is_arch else (low + high) / 2
        middle = np.array([aside, (stage.ground + shown[:, 1].max()) / 2, 0.0])
        reach = float(np.linalg.norm(shown - middle, axis=1).max())
        away = np.array(
            [
                math.sin(ASIDE) * math.cos(ABOVE),
                math.sin(ABOVE),
                math.cos(ASIDE) * math.cos(ABOVE),
            ]
        )
        self._eye = middle + DISTANCE * reach * away
        right = np.array([math.cos(ASIDE), 0.0, -math.sin(ASIDE)])
        self._axes = np.stack([right, np.cross(away, right), -away])
        self._scale, self._shift = 1.0, np.zeros(2)
        flat = self._to_pixels(shown)
        size = flat.max(axis=0) - flat.min(axis=0)
        free = np.array([panel.width, panel.height]) * (1 - 2 * MARGIN)
        self._scale = float((free / size).min())
        centre = (flat.max(axis=0) + flat.min(axis=0)) / 2 * self._scale
        self._shift = np.array([panel.x + panel.width / 2, panel.y + panel.height / 2]) - centre
        self._reach, self._aside = reach, aside
        self._line = edge_width(self._scale / (DISTANCE * reach), stage.grain)
        self._tones = stone_tones(len(stage.assembly.blocks))
        self.still = self._ground()

    def scale_bar(self, length: float, words: str) -> tuple[list[Shape], list[Label]]:
        """Lay a bar of a length [r] on the ground in front of the arch, with its words."""
        near = self._stage.depth / 2 + 0.35
        level, wide = self._stage.ground, 0.035
        shapes: list[Shape] = []
        ink, paper = colour(INK), colour(PAPER)
        for part in range(4):
            x = [self._aside + (part - 2 + end) * length / 4 for end in (0, 1)]
            strip = [(x[0], near), (x[1], near), (x[1], near + wide), (x[0], near + wide)]
            ground = np.array([(a, level, b) for a, b in strip])
            fill = paper if part % 2 else ink
            shapes.append(Shape(self._to_pixels(ground), fill=fill, edge=ink, width=0.8))
        place = self._to_pixels(np.array([[self._aside, level, near + wide]]))[0]
        return shapes, [Label(place[0], place[1] - 20, words, size=13, across="center")]

    def shapes(self, moment: Moment) -> list[Shape]:
        """Draw a moment: ground, shadows, then blocks and footings from back to front."""
        corners = np.concatenate([self._footings, moment.corners])
        count, _, sides, _ = corners.shape
        normals, offsets = _planes(corners)
        flat = self._to_pixels(corners.reshape(-1, 3)).reshape(count, 2 * sides, 2)
        boxes = np.stack([flat.min(axis=1), flat.max(axis=1)], axis=1)
        order = painting_order(
            corners.reshape(count, -1, 3), normals, offsets, self._eye, boxes
        )
        seen = normals @ self._eye > offsets
        shade = AMBIENT + (1 - AMBIENT) * np.clip(normals @ LIGHT, 0.0, 1.0)
        active = self._active(moment)
        plain = len(self._footings)
        drawn = self._shadows(corners)
        for body in order:
            marks = active.get(body - plain, []) if body >= plain else []
            drawn += _faces(
                flat[body].reshape(2, sides, 2), seen[body], shade[body],
                self._tone(body - plain), marks, self._line,
                self._stage.outer.get(body - plain),
            )  # fmt: skip
        return drawn + self._thrust(moment)

    def _tone(self, piece: int) -> Colour:
        if piece < 0:
            return mixed(colour(GROUND), colour(PAPER), 0.25)
        return self._tones[int(self._stage.owner[piece])]

    def _active(self, moment: Moment) -> dict[int, list[tuple[Part, Colour]]]:
        """Colours of joints that take part, by the piece they are on."""
        active: dict[int, list[tuple[Part, Colour]]] = {}
        for state, faces in zip(moment.joints, self._stage.joint_sides, strict=True):
            if state is JointState.CLOSED:
                continue
            tone = colour(words_of(state, is_arch=self._stage.is_arch)[1])
            for face in faces:
                if face is not None:
                    active.setdefault(face.polygon, []).append((face, tone))
        return active

    def _thrust(self, moment: Moment) -> list[Shape]:
        """Draw the line of thrust on the near face, while the arch is at rest."""
        if moment.statics == 0.0:
            return []
        tone = colour(THRUST, moment.statics)
        half = self._stage.depth / 2
        return [
            Shape(
                self._to_pixels(np.pad(piece, ((0, 0), (0, 1)), constant_values=half)),
                edge=tone, width=2.4, closed=False,
            )
            for piece in self._stage.thrust
        ]  # fmt: skip

    def places(self, points: Array) -> Array:
        """Return where points in space are seen, (k, 2) [pixels]."""
        # What is beside the eye or behind it is seen as far away as can be.
        depth = np.maximum((points - self._eye) @ self._axes[2], NEAREST * self._reach)
        flat = (points - self._eye) @ self._axes[:2].T
        return flat / depth[..., None] * self._scale + self._shift

    @property
    def centre(self) -> Array:
        """The place that stays as the camera draws back: below the middle, on the ground."""
        return self._to_pixels(np.array([[self._aside, self._stage.ground, 0.0]]))[0]

    def _to_pixels(self, points: Array) -> Array:
        seen = (points - self._eye) @ self._axes.T
        return seen[:, :2] / seen[:, 2:] * self._scale + self._shift

    def _ground(self) -> list[Shape]:
        """Discs about the middle that fade into the paper."""
        turn = np.linspace(0, 2 * np.pi, 72, endpoint=False)
        ring = np.column_stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)])
        ground, paper = colour(GROUND), colour(PAPER)
        centre = np.array([self._aside, self._stage.ground, 0.0])
        return [
            Shape(
                self._to_pixels(centre + ring * self._reach * (2.6 - 1.5 * share)),
                fill=mixed(paper, ground, 0.75 * share * share * (3 - 2 * share)),
            )
            for share in np.linspace(1 / RINGS, 1, RINGS)
        ]

    def _shadows(self, corners: Array) -> list[Shape]:
        """Lay the shadows on the ground, their edges softened."""
        level = self._stage.ground
        down = corners - (corners[..., 1:2] - level) / LIGHT[1] * LIGHT
        down[..., 1] = level
        flat = self._to_pixels(down.reshape(-1, 3)).reshape(len(corners), -1, 2)
        above = corners[..., 1].max(axis=(1, 2)) > level
        pieces = [hull for each in flat[above] if (hull := _hull(each)) is not None]
        ground = mixed(colour(PAPER), colour(GROUND), 0.75)
        dark = mixed((0.0, 0.0, 0.0, 1.0), ground, SHADOW)
        soft = mixed(dark, ground, 0.5)
        return [
            *(Shape(piece, fill=soft, edge=soft, width=4 * self._line) for piece in pieces),
            *(Shape(piece, fill=dark, edge=dark, width=1.0) for piece in pieces),
        ]


def _hull(points: Array) -> Array | None:
    """Return the corners of what points span; None where that has no width."""
    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return None


def _prism(outline: Array, half: float) -> Array:
    near = np.pad(outline, ((0, 0), (0, 1)), constant_values=half)
    return np.stack([near, near * [1, 1, -1]])


def _planes(corners: Array) -> tuple[Array, Array]:
    """Outward normals and offsets of the faces of prisms: near, far, then the sides."""
    near, far = corners[:, 0], corners[:, 1]
    across = near.mean(axis=1) - far.mean(axis=1)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    along = np.roll(near, -1, axis=1) - near
    sides = np.cross(along, across[:, None])
    length = np.linalg.norm(sides, axis=-1, keepdims=True)
    sides = np.where(length > 0, sides / np.where(length > 0, length, 1.0), 0.0)
    normals = np.concatenate([across[:, None], -across[:, None], sides], axis=1)
    points = np.concatenate([near[:, :1], far[:, :1], near], axis=1)
    return normals, (normals * points).sum(axis=-1)


def _faces(
    flat: Array,
    seen: Array,
    shade: Array,
    tone: Colour,
    marks: Sequence[tuple[Part, Colour]],
    line: float,
    outer: Sequence[Part] | None,
) -> list[Shape]:
    """Draw the faces of one piece that are seen, and active joints on its sides in colour.

    Of a block in several pieces only the outer parts of sides are drawn.
    """
    dark = (0.0, 0.0, 0.0, 1.0)
    edge = mixed(tone, colour(INK), 0.72)
    drawn: list[Shape] = []
    sides = flat.shape[1]
    for end in (0, 1):
        if seen[end]:
            fill = mixed(dark, tone, float(shade[end]))
            if outer is None:
                drawn.append(Shape(flat[end], fill=fill, edge=edge, width=line))
                continue
            drawn.append(Shape(flat[end], fill=fill, edge=fill, width=SEAM))
            drawn += [
                Shape(along_side(flat[end], *part[1:]), edge=edge, width=line, closed=False)
                for part in outer
            ]
    whole = [Part(0, side, 0.0, 1.0) for side in range(sides)]
    for _, side, start, stop in whole if outer is None else outer:
        if seen[2 + side]:
            front, back = (along_side(face, side, start, stop) for face in flat)
            quad = np.array([*front, *back[::-1]])
            fill = mixed(dark, tone, float(shade[2 + side]))
            drawn.append(Shape(quad, fill=fill, edge=edge, width=line))
    for (_, side, start, stop), mark in marks:
        after, before = (side + 1) % sides, (side - 1) % sides
        front, back = (along_side(face, side, start, stop) for face in flat)
        if seen[2 + side]:
            fill = mixed(dark, mixed(tone, mark, 0.8), float(shade[2 + side]))
            quad = np.array([*front, *back[::-1]])
            drawn.append(Shape(quad, fill=fill, edge=edge, width=line))
        # Each edge of the side, and the face beyond it: shown where either is seen.
        edges = (
            (front, 0), (back, 1),
            (np.array([front[0], back[0]]), 2 + before if start == 0 else 2 + side),
            (np.array([front[1], back[1]]), 2 + after if stop == 1 else 2 + side),
        )  # fmt: skip
        drawn += [
            Shape(pair, edge=mark, width=2.2 * line, closed=False)
            for pair, beyond in edges
            if seen[2 + side] or seen[beyond]
        ]
    return drawn
