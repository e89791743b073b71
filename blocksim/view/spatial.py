"""The view in perspective: a recording in the plane or in space."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.regions import hull
from blocksim.view.camera import Camera, Face, Piece
from blocksim.view.canvas import Colour, Label, Panel, Shape, colour, edge_width, mixed
from blocksim.view.solidstage import SolidStage
from blocksim.view.stage import Stage
from blocksim.view.style import GROUND, INK, PAPER, THRUST
from blocksim.view.timeline import Moment

MARGIN = 0.05
LIGHT = np.array([-0.42, 0.78, 0.46]) / math.hypot(0.42, 0.78, 0.46)
"""Towards the sun: left, up, forward."""
AMBIENT = 0.52
"""Brightness of a face in shade; one that faces the sun has 1."""
SHADOW = 0.72
"""Brightness of the ground in the shade."""
RINGS = 60
"""Discs that the ground fades out in."""


class SpatialView:
    """Draws moments of a stage into a panel, in perspective.

    `shown`, (k, 3): Points that find room in the panel, from the middle.
    """

    def __init__(self, stage: Stage | SolidStage, panel: Panel, shown: Array) -> None:
        self._stage = stage
        shown = shown + np.array([stage.middle, 0.0, 0.0])
        low, high = shown.min(axis=0), shown.max(axis=0)
        self._aside = 0.0 if stage.is_arch else float(low[0] + high[0]) / 2
        out = 0.0 if isinstance(stage, Stage) else float(low[2] + high[2]) / 2
        middle = np.array([self._aside, (stage.ground + high[1]) / 2, out])
        self._foot = np.array([self._aside, stage.ground, out])
        self._reach = float(np.linalg.norm(shown - middle, axis=1).max())
        self._camera = camera = Camera(middle, self._reach, *stage.eye)
        flat = camera.seen(shown)
        size = flat.max(axis=0) - flat.min(axis=0)
        free = np.array([panel.width, panel.height]) * (1 - 2 * MARGIN)
        camera.scale = float((free / size).min())
        centre = (flat.max(axis=0) + flat.min(axis=0)) / 2 * camera.scale
        camera.shift = np.array([panel.x + panel.width / 2, panel.y + panel.height / 2])
        camera.shift -= centre
        far = float(np.linalg.norm(camera.eye - middle))
        self._line = edge_width(camera.scale / far, stage.grain)
        self._solids = stage.solids(self._line)
        self.still = self._ground()

    def scale_bar(
        self, length: float, words: str, size: float
    ) -> tuple[list[Shape], list[Label]]:
        """Lay a bar of a length [r] on the ground in front of the blocks, with its words."""
        near = self._foot[2] + self._stage.depth / 2 + 0.35
        level, wide = self._stage.ground, 0.035
        shapes: list[Shape] = []
        ink, paper = colour(INK), colour(PAPER)
        for part in range(4):
            x = [self._aside + (part - 2 + end) * length / 4 for end in (0, 1)]
            strip = [(x[0], near), (x[1], near), (x[1], near + wide), (x[0], near + wide)]
            ground = np.array([(a, level, b) for a, b in strip])
            fill = paper if part % 2 else ink
            shapes.append(Shape(self.places(ground), fill=fill, edge=ink, width=0.8))
        place = self.places(np.array([self._aside, level, near + wide]))
        down = place[1] - 20 * size
        return shapes, [Label(place[0], down, words, 13 * size, across="center")]

    def shapes(self, moment: Moment) -> list[Shape]:
        """Draw a moment: shadows, then blocks and footings from back to front."""
        pieces = self._solids.at(moment.turns, moment.places, moment.joints)
        drawn = self._shadows(pieces)
        for at in self._camera.order(pieces):
            drawn += self._painted(pieces[at])
        return drawn + self._forces(moment)

    def _painted(self, piece: Piece) -> list[Shape]:
        """Paint what is seen of a piece."""
        camera = self._camera
        drawn = [
            Shape(camera.seen(each.corners), _lit(each.tone, each), _edge(each), each.width)
            for each in piece.faces
            if camera.sees(each.corners[0], each.normal)
        ]
        return drawn + [
            Shape(camera.seen(each.points), edge=each.tone, width=each.width, closed=False)
            for each in piece.lines
            if any(camera.sees(each.points[0], normal) for normal in each.normals)
        ]

    def _forces(self, moment: Moment) -> list[Shape]:
        """Draw the line of thrust on the near face, or forces, while all is at rest."""
        if moment.statics == 0.0:
            return []
        tone = colour(THRUST, moment.statics)
        half = self._stage.depth / 2
        return [
            Shape(
                self.places(np.pad(piece, ((0, 0), (0, 1)), constant_values=half)),
                edge=tone, width=2.4, closed=False,
            )
            for piece in self._stage.thrust
        ]  # fmt: skip

    def places(self, points: Array) -> Array:
        """Return where points in space are seen, (k, 2) [pixels]."""
        return self._camera.seen(points)

    @property
    def centre(self) -> Array:
        """The place that stays as the camera draws back: below the middle, on the ground."""
        return self.places(self._foot)

    def _ground(self) -> list[Shape]:
        """Discs about the middle that fade into the paper."""
        turn = np.linspace(0, 2 * np.pi, 72, endpoint=False)
        ring = np.column_stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)])
        ground, paper = colour(GROUND), colour(PAPER)
        return [
            Shape(
                self.places(self._foot + ring * self._reach * (2.6 - 1.5 * share)),
                fill=mixed(paper, ground, 0.75 * share * share * (3 - 2 * share)),
            )
            for share in np.linspace(1 / RINGS, 1, RINGS)
        ]

    def _shadows(self, pieces: list[Piece]) -> list[Shape]:
        """Lay the shadows on the ground, their edges softened."""
        level = self._stage.ground
        hulls: list[Array] = []
        for each in pieces:
            down = each.corners - (each.corners[:, 1:2] - level) / LIGHT[1] * LIGHT
            down[:, 1] = level
            if each.corners[:, 1].max() > level:
                hulls.append(hull([self.places(down)]))
        ground = mixed(colour(PAPER), colour(GROUND), 0.75)
        dark = mixed((0.0, 0.0, 0.0, 1.0), ground, SHADOW)
        soft = mixed(dark, ground, 0.5)
        return [
            *(Shape(piece, fill=soft, edge=soft, width=4 * self._line) for piece in hulls),
            *(Shape(piece, fill=dark, edge=dark, width=1.0) for piece in hulls),
        ]


def _lit(tone: Colour, face: Face) -> Colour:
    """Return a colour as the sun lights a face."""
    bright = AMBIENT + (1 - AMBIENT) * max(0.0, float(face.normal @ LIGHT))
    return mixed((0.0, 0.0, 0.0, 1.0), tone, bright)


def _edge(face: Face) -> Colour:
    """Return the colour of an edge: a seam is as bright as its face."""
    return _lit(face.tone, face) if face.edge == face.tone else face.edge
