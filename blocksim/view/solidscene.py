"""Blocks in space as convex pieces, what their joints are seen to do in colour, forces."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.parting import parted
from blocksim.blocks.space.polyhedron import Polyhedron, frame
from blocksim.limit.space.statics import state_of
from blocksim.view.camera import Face, Piece
from blocksim.view.canvas import Colour, colour, mixed, stone_tones
from blocksim.view.drawing import state_of_any, words_of
from blocksim.view.style import GROUND, INK, PAPER
from blocksim.view.timeline import SEEN

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""From z upwards to y upwards."""
BED = 0.25
"""How far supports are drawn beyond what moves, in units of the size."""
WAY = 0.15
"""How far a mechanism is drawn: its largest way in units of the size."""
Marks = Mapping[int, Sequence[tuple[Array, Array, str]]]
"""What is painted on the faces of blocks: corners, normal out of the block, colour."""
GONE = 0.1
"""Opening of all points from which on it is no joint any more [size]."""
LONGEST = 0.25
"""Length of the largest force [size]."""
FAINT = 1e-6
"""Share of the largest force below which there is none."""


class Solids:
    """Pieces of blocks in space where they have gone, supports first [size], edges [pixels]."""

    def __init__(
        self, assembly: SpatialAssembly, supports: Sequence[Polyhedron], line: float
    ) -> None:
        self._assembly, self._line = assembly, line
        self._tones = stone_tones(len(assembly.blocks))
        tone = mixed(colour(GROUND), colour(PAPER), 0.25)
        self._supports = [
            self._piece(each, np.eye(3), np.zeros(3), np.zeros(3), tone) for each in supports
        ]

    def at(self, turns: Array, shifts: Array, joints: Sequence[JointState]) -> list[Piece]:
        """Return pieces of blocks turned, (blocks, 3, 3), and shifted, (blocks, 3) [m]."""
        marks: Marks = marks_of(self._assembly, joints)
        return self._supports + [
            self._piece(
                hull, turns[at], shifts[at], block.centre, self._tones[at], marks.get(at, ())
            )
            for at, block in enumerate(self._assembly.blocks)
            for hull in block.hulls
        ]

    def _piece(
        self, hull: Polyhedron, turn: Array, shift: Array, about: Array, tone: Colour,
        marks: Sequence[tuple[Array, Array, str]] = (),
    ) -> Piece:  # fmt: skip
        def put(points: Array) -> Array:
            return placed(points, turn, shift, about) / self._assembly.size @ UPRIGHT.T

        edge, way = mixed(tone, colour(INK), 0.72), UPRIGHT @ turn
        shown = [(each.corners, each.normal, tone, edge) for each in hull.faces]
        # What joints do is painted on the faces they are on.
        shown += [
            (points, normal, colour(mark), colour(mark))
            for points, normal, mark in marks
            if _lies_on(points, normal, hull)
        ]
        faces = [
            Face(put(each), way @ n, fill, rim, self._line) for each, n, fill, rim in shown
        ]
        return Piece(put(hull.corners), faces)


def placed(points: Array, turn: Array, shift: Array, about: Array) -> Array:
    """Turn points about a point, and shift them."""
    return (points - about) @ turn.T + about + shift


def corners_of(assembly: SpatialAssembly, turns: Array, shifts: Array) -> Array:
    """Return the corners of what moves, where it has gone, (k, 3) [size], y upwards."""
    found = [
        placed(hull.corners, turn, shift, block.centre)
        for block, turn, shift in zip(assembly.blocks, turns, shifts, strict=True)
        for hull in block.hulls
    ]
    return np.concatenate(found) / assembly.size @ UPRIGHT.T


def moving_box(assembly: SpatialAssembly) -> Array:
    """Return least and largest places of what moves, as built, (2, 3) [m]."""
    boxes = np.array([hull.box for each in assembly.blocks for hull in each.hulls])
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def supports_of(assembly: SpatialAssembly, low: Array, high: Array) -> list[Polyhedron]:
    """Return what stays, cut off beyond a box [m]."""
    bed = BED * assembly.size
    hulls = [hull for each in assembly.supports for hull in each.hulls]
    found = [_cut(hull, low - bed, high + bed) for hull in hulls]
    return [each for each in found if each is not None]


def _lies_on(points: Array, normal: Array, hull: Polyhedron) -> bool:
    """Tell whether a joint lies on a face of a part."""
    near = 1e-3 * hull.thickness
    return any(
        face.normal @ normal > 0.999 and np.abs(points @ face.normal - face.offset).max() < near
        for face in hull.faces
    )


def _cut(hull: Polyhedron, low: Array, high: Array) -> Polyhedron | None:
    """Return the box around a support, cut off beyond what is shown; or itself if within."""
    if (hull.box[0] >= low).all() and (hull.box[1] <= high).all():
        return hull
    lower, upper = np.maximum(hull.box[0], low), np.minimum(hull.box[1], high)
    if not (upper - lower > 1e-9).all():
        return None
    return Polyhedron(list(itertools.product(*zip(lower, upper, strict=True))))


def states_at(assembly: SpatialAssembly, poses: Array) -> tuple[JointState, ...]:
    """Tell what joints are seen to do at poses, (blocks, 6) [size, rotation vectors]."""
    gap, slip = parted(assembly, poses)
    ends = np.cumsum([len(each.points) for each in assembly.joints])[:-1]
    found: list[JointState] = []
    for opens, slides in zip(np.split(gap, ends), np.split(slip, ends), strict=True):
        away = float(opens.min()) > GONE or float(slides.min()) > GONE
        together = opens <= SEEN
        state = state_of(together, together & (slides > SEEN))
        found.append(JointState.CLOSED if away else state)
    return tuple(found)


def marks_of(assembly: SpatialAssembly, states: Sequence[JointState]) -> Marks:
    """Return joints that take part by block, each with its normal out of it and a colour."""
    told: dict[int, list[tuple[Array, Array, str]]] = {}
    for joint, state in zip(assembly.joints, states, strict=True):
        if state is JointState.CLOSED or len(joint.points) < 3:
            continue
        tone = words_of(state, is_arch=False)[1]
        for side, sign in ((joint.before, 1.0), (joint.after, -1.0)):
            told.setdefault(side, []).append((joint.points, sign * joint.normal, tone))
    return told


def told(states: Iterable[JointState]) -> list[tuple[str, str]]:
    """Return words and colours of what joints do, for a legend."""
    seen = {state_of_any(each) for each in states} - {JointState.CLOSED}
    return [words_of(each, is_arch=False) for each in sorted(seen)]


def force_lines(problem: Problem[SpatialAssembly], forces: Array) -> tuple[Array, Array]:
    """Return where the resultants of joints act, and how large they are.

    `problem`.
    `forces`, (points, 3): At the points of all joints, along their normals and across, as of
        `SpatialStatics`.
    Returns `lines`, (joints, 2, 3): From end to end through the centre of pressure, in
        proportion to the force [m].
    Returns `shares`, (joints,): Of the largest force.
    """
    sums, places = pressed(problem, forces)
    sizes = np.linalg.norm(sums, axis=1)
    largest = float(sizes.max(initial=0.0)) or 1.0
    way = LONGEST * problem.assembly.size * sums / largest / 2
    lines = np.stack([places - way, places + way], axis=1)
    return lines, np.where(sizes > FAINT * largest, sizes / largest, 0.0)


def pressed(problem: Problem[SpatialAssembly], forces: Array) -> tuple[Array, Array]:
    """Return the resultants of joints along x, y and z, and their centres of pressure [m]."""
    sums, places = np.zeros((2, len(problem.assembly.joints), 3))
    ends = np.cumsum([len(each.points) for each in problem.assembly.joints])[:-1]
    for at, part in enumerate(np.split(forces, ends)):
        joint = problem.assembly.joints[at]
        sums[at] = part.sum(axis=0) @ np.vstack([joint.normal, frame(joint.normal)])
        press = np.maximum(part[:, 0], 0.0)
        weights = press if press.sum() > 0 else np.ones(len(press))
        places[at] = np.average(joint.points, axis=0, weights=weights)
    return sums, places
