"""Views of a recording: from the front in its plane, and in perspective."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.regions import hull
from blocksim.view.camera import Camera, Face, Piece
from blocksim.view.canvas import (
    NOTHING,
    Colour,
    Label,
    Panel,
    Shape,
    colour,
    edge_width,
    mixed,
    stone_tones,
)
from blocksim.view.drawing import words_of
from blocksim.view.stage import SolidStage, Stage
from blocksim.view.style import DASHES, GROUND, INK, PAPER, STONE
from blocksim.view.timeline import Moment

MARGIN, AROUND = 0.06, 0.05
"""Free shares of a panel on each side, from the front and in perspective."""
FLOOR = 0.1
"""Share of a panel that shows the ground, at least."""
BEYOND = 12.0
"""How far ground goes on beyond a panel [its widths and heights]."""
SEAM = 0.6
"""Width of a line that closes the seam between parts of a block [pixels]."""
LIGHT = np.array([-0.42, 0.78, 0.46]) / math.hypot(0.42, 0.78, 0.46)
"""Towards the sun: left, up, forward."""
AMBIENT = 0.52
"""Brightness of a face in shade; one that faces the sun has 1."""
SHADOW = 0.72
"""Brightness of the ground in the shade."""
RINGS = 60
"""Discs that the ground fades out in."""
AHEAD = 0.01
"""Way along a vector by which its direction in the picture is found [size]."""


class PlanarView:
    """Draws moments of a stage into a panel.

    `shown`, (k, 3): Points that find room in the panel, from the middle.
    """

    def __init__(self, stage: Stage, panel: Panel, shown: Array) -> None:
        self._stage, self._panel = stage, panel
        low, high = shown[:, :2].min(axis=0), shown[:, :2].max(axis=0)
        # Symmetric about the crown, so that side by side and from run to run arches match.
        aside = 0.0 if stage.is_arch else (low[0] + high[0]) / 2
        width, height = 2 * max(aside - low[0], high[0] - aside), high[1] - low[1]
        floor = FLOOR * panel.height
        free = panel.width * (1 - 2 * MARGIN), panel.height * (1 - MARGIN) - floor
        self._scale = min(free[0] / width, free[1] / height)
        spare = free[1] - height * self._scale
        level = panel.y + floor + min(spare / 2, floor)
        across = panel.x + panel.width / 2 - (aside + stage.middle) * self._scale
        self._origin = np.array([across, level - low[1] * self._scale])
        self._line = edge_width(self._scale, stage.grain)
        held = mixed(colour(GROUND), colour(PAPER), 0.35)
        tones = enumerate(stone_tones(len(stage.assembly.blocks)))
        self._tones = [held if at in stage.carriers else tone for at, tone in tones]
        self.still = self._surroundings()

    def scale_bar(
        self, length: float, words: str, size: float
    ) -> tuple[list[Shape], list[Label]]:
        """Draw a bar of a length [r] on the ground, with its words."""
        end = self._panel.x + self._panel.width - 0.03 * self._panel.width
        height = self._origin[1] + self._stage.ground * self._scale - 14 * size
        start = end - length * self._scale
        ink = colour(INK)
        bar = np.array([[start, height], [end, height]])
        ticks = [
            np.array([[x, height - 4 * size], [x, height + 4 * size]]) for x in (start, end)
        ]
        shapes = [Shape(line, edge=ink, width=2 * size, closed=False) for line in (bar, *ticks)]
        label = Label((start + end) / 2, height - 20 * size, words, 13 * size, across="center")
        return shapes, [label]

    def shapes(self, moment: Moment) -> list[Shape]:
        """Draw a moment."""
        edge = mixed(colour(STONE), colour(INK), 0.75)
        blocks: list[Shape] = []
        for at, outline, filled, whole in self._stage.outlines:
            tone = self._tones[at]
            # Parts of one block have no edge between them: a hair of stone closes the seam.
            line = (edge, self._line) if whole or not filled else (tone, SEAM)
            turn, place = moment.turns[at, :2, :2], moment.places[at, :2]
            points = self._to_pixels(outline @ turn.T + place)
            blocks.append(Shape(points, tone if filled else NOTHING, *line))
        return [*blocks, *self._joints(moment)]

    def places(self, points: Array) -> Array:
        """Return where points in space are seen, (k, 2) [pixels]."""
        return self._to_pixels(points[..., :2])

    @property
    def centre(self) -> Array:
        """The place that stays as the camera draws back: below the middle, on the ground."""
        ground = self._stage.ground * self._scale + self._origin[1]
        return np.array([self._panel.x + self._panel.width / 2, ground])

    def _to_pixels(self, points: Array) -> Array:
        return points * self._scale + self._origin

    def _surroundings(self) -> list[Shape]:
        """Ground and footings."""
        panel, level = self._panel, self._stage.ground * self._scale + self._origin[1]
        # Beyond the panel, for when the camera draws back.
        left, right = panel.x - BEYOND * panel.width, panel.x + (1 + BEYOND) * panel.width
        below = level - BEYOND * panel.height
        floor = np.array([[left, below], [right, below], [right, level], [left, level]])
        ground = colour(GROUND)
        stone = mixed(ground, colour(PAPER), 0.35)
        edge = mixed(ground, colour(INK), 0.45)
        footings = [
            Shape(self._to_pixels(each), fill=stone, edge=edge, width=self._line)
            for each in self._stage.footings
        ]
        line = np.array([[left, level], [right, level]])
        return [
            *footings,
            Shape(floor, fill=ground),
            Shape(line, edge=edge, width=1.5, closed=False),
        ]

    def _joints(self, moment: Moment) -> list[Shape]:
        """Colour the faces of joints that take part, and mark their hinges by dots."""
        faces, dots = list[Shape](), list[Shape]()
        width = max(2.0, 2.6 * self._line)
        carried = self._stage.faces(moment.turns, moment.places)
        for state, face in zip(moment.joints, carried, strict=True):
            if state is JointState.CLOSED:
                continue
            name = words_of(state, is_arch=self._stage.is_arch)[1]
            tone, dash = colour(name), DASHES.get(name, ())
            places = [self._to_pixels(pair) for pair in face]
            faces += [
                Shape(pair, edge=tone, width=width, closed=False, dash=dash) for pair in places
            ]
            if (hinge := state.hinge) is not None:
                middle = (places[0][hinge] + places[1][hinge]) / 2
                dots.append(
                    Shape(_circle(middle, 1.9 * width), colour(PAPER), tone, 0.7 * width)
                )
        return [*faces, *dots]


def _circle(centre: Array, radius: float) -> Array:
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    return centre + radius * np.column_stack([np.cos(turn), np.sin(turn)])


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
        free = np.array([panel.width, panel.height]) * (1 - 2 * AROUND)
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
        near, level, wide = self._stage.front, self._stage.ground, 0.035
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
        return drawn

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


View = PlanarView | SpatialView


def direction(view: View, place: Array, vector: Array) -> Array:
    """Return the direction in which a vector at a place is seen, (2,); 0 where it has none."""
    start, end = view.places(np.stack([place, place + AHEAD * vector]))
    long = float(np.hypot(*(end - start)))
    return (end - start) / long if long > 0 else np.zeros(2)
