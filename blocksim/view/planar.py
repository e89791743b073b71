"""The view from the front: a recording in its plane."""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.view.canvas import (
    NOTHING,
    Label,
    Panel,
    Shape,
    colour,
    edge_width,
    mixed,
    stone_tones,
)
from blocksim.view.drawing import words_of
from blocksim.view.stage import Stage
from blocksim.view.style import DASHES, GROUND, INK, PAPER, STONE, THRUST
from blocksim.view.timeline import Moment

MARGIN = 0.06
"""Free share of a panel on each side."""
FLOOR = 0.1
"""Share of a panel that shows the ground, at least."""
BEYOND = 12.0
"""How far ground goes on beyond a panel [its widths and heights]."""
SEAM = 0.6
"""Width of a line that closes the seam between parts of a block [pixels]."""


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
        return [*blocks, *self._joints(moment), *self._thrust(moment)]

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

    def _thrust(self, moment: Moment) -> list[Shape]:
        """Draw the line of thrust while the arch is at rest."""
        if moment.statics == 0.0:
            return []
        tone = colour(THRUST, moment.statics)
        return [
            Shape(self._to_pixels(piece), edge=tone, width=2.4, closed=False)
            for piece in self._stage.thrust
        ]


def _circle(centre: Array, radius: float) -> Array:
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    return centre + radius * np.column_stack([np.cos(turn), np.sin(turn)])
