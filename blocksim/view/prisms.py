"""Blocks of the plane as convex pieces in space, with what their joints do in colour."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.view.camera import Face, Line, Piece
from blocksim.view.canvas import Colour, colour, mixed, stone_tones
from blocksim.view.drawing import Part, along_side, words_of
from blocksim.view.placing import padded
from blocksim.view.stage import Moment, Stage
from blocksim.view.style import GROUND, INK, PAPER

WIDER = 1.12
"""Depth of the footings over that of the blocks."""
SEAM = 0.6
"""Width of a line that closes the seam between parts of a block [pixels]."""


class Prisms:
    """Pieces of a stage of the plane, footings first, with edges so wide [pixels]."""

    def __init__(self, stage: Stage, line: float) -> None:
        self._stage, self._line = stage, line
        self._tones = stone_tones(len(stage.assembly.blocks))
        wide = stage.depth / 2 * WIDER
        tone = mixed(colour(GROUND), colour(PAPER), 0.25)
        self._footings = [
            _prism(_both(padded(each, stage.sides), wide), tone, line, [], None)
            for each in stage.footings
        ]

    def at(self, moment: Moment) -> list[Piece]:
        """Return the pieces at a moment."""
        marks = self._marks(moment)
        return self._footings + [
            _prism(
                corners, self._tones[int(self._stage.owner[at])], self._line,
                marks.get(at, []), self._stage.outer.get(at),
            )
            for at, corners in enumerate(moment.corners)
        ]  # fmt: skip

    def _marks(self, moment: Moment) -> dict[int, list[tuple[Part, Colour]]]:
        """Colours of joints that take part, by the piece they are on."""
        found: dict[int, list[tuple[Part, Colour]]] = {}
        for state, faces in zip(moment.joints, self._stage.joint_sides, strict=True):
            if state is JointState.CLOSED:
                continue
            tone = colour(words_of(state, is_arch=self._stage.is_arch)[1])
            for face in faces:
                if face is not None:
                    found.setdefault(face.polygon, []).append((face, tone))
        return found


def _both(outline: Array, half: float) -> Array:
    near = np.pad(outline, ((0, 0), (0, 1)), constant_values=half)
    return np.stack([near, near * [1, 1, -1]])


def _normals(corners: Array) -> tuple[Array, Array]:
    """Outward normals of a prism: of its near face, and of its sides."""
    near, far = corners
    across = near.mean(axis=0) - far.mean(axis=0)
    across /= np.linalg.norm(across)
    sides = np.cross(np.roll(near, -1, axis=0) - near, across)
    length = np.linalg.norm(sides, axis=-1, keepdims=True)
    return across, np.where(length > 0, sides / np.where(length > 0, length, 1.0), 0.0)


def _prism(
    corners: Array,
    tone: Colour,
    width: float,
    marks: Sequence[tuple[Part, Colour]],
    outer: Sequence[Part] | None,
) -> Piece:
    """Make a piece of a prism, (2, sides, 3): its outer sides edged, joints on it marked."""
    across, normals = _normals(corners)
    edge = mixed(tone, colour(INK), 0.72)
    faces, lines = list[Face](), list[Line]()
    for end, out in zip(corners, (across, -across), strict=True):
        whole = outer is None
        faces.append(Face(end, out, tone, edge if whole else tone, width if whole else SEAM))
        lines += [Line(along_side(end, *part[1:]), [out], edge, width) for part in outer or ()]
    sides = range(len(normals))
    parts = [Part(0, side, 0.0, 1.0) for side in sides] if outer is None else outer
    drawn = [(part, tone, edge) for part in parts]
    drawn += [(part, mixed(tone, mark, 0.8), edge) for part, mark in marks]
    for (_, side, start, stop), fill, rim in drawn:
        front, back = (along_side(end, side, start, stop) for end in corners)
        quad = np.array([*front, *back[::-1]])
        faces.append(Face(quad, normals[side], fill, rim, width))
    for (_, side, start, stop), mark in marks:
        front, back = (along_side(end, side, start, stop) for end in corners)
        own = normals[side]
        # Each edge of the side, and the face beyond it: shown where either is seen.
        before = normals[side - 1] if start == 0 else own
        after = normals[(side + 1) % len(normals)] if stop == 1 else own
        ends = (front, across), (back, -across)
        rims = (np.array([front[at], back[at]]) for at in (0, 1))
        beside = [*ends, *zip(rims, (before, after), strict=True)]
        lines += [Line(points, [own, beyond], mark, 2.2 * width) for points, beyond in beside]
    return Piece(corners.reshape(-1, 3), faces, lines)
