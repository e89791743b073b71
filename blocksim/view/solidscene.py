"""Blocks in space as convex pieces, what their joints are seen to do in colour, forces."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.parting import parted
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.limit.resultants import Resultants
from blocksim.limit.space.statics import state_of
from blocksim.view.camera import Face, Line, Piece
from blocksim.view.canvas import Colour, colour, mixed, stone_tones
from blocksim.view.drawing import state_of_any, words_of
from blocksim.view.style import GROUND, INK, PAPER
from blocksim.view.timeline import SEEN, UPRIGHT

BED = 0.25
"""How far supports are drawn beyond what moves, in units of the size."""
WIDER = 0.2
"""By how much an unknown support is wider than its joint."""
WAY = 0.15
"""How far a mechanism is drawn: its largest way in units of the size."""
Marked = Sequence[tuple[Array, Array, str]]
"""Marks on faces: corners or ends of the joint, normal out of the block, colour."""
Marks = Mapping[int, Marked]
"""Marks by the number of the block."""
GONE = 0.1
"""Opening of all points from which on it is no joint any more [size]."""
LONGEST = 0.25
"""Length of the largest force [size]."""
NEAR, ALONG = 1e-3, 0.99
"""How far off a face what lies on it may be, over the thickness of the part; and the least
cosine between a joint and the face it is on."""
SEAM, RIM = 0.6, 2.2
"""Width of a line that closes the seam between parts of a block [pixels], and of that around a
joint, over the width of edges."""
FAINT = 1e-6
"""Share of the largest force below which there is none."""


class Solids:
    """Pieces of blocks where they have gone, supports first [size].

    `line`: Width of edges [pixels].
    `size`: Length in units of which they are [m].
    `is_arch`: Whether hinges are told by the side on which they are.
    """

    def __init__(
        self,
        assembly: SpatialAssembly,
        supports: Sequence[Polyhedron],
        line: float,
        size: float,
        *,
        is_arch: bool,
    ) -> None:
        self._assembly, self._line, self._size, self._is_arch = assembly, line, size, is_arch
        tones = stone_tones(len(assembly.blocks))
        tone = mixed(colour(GROUND), colour(PAPER), 0.25)
        self._supports = [self._piece((each,), each, np.zeros(3), tone) for each in supports]
        self._blocks = [
            (at, hull, self._piece(block.hulls, hull, block.centre, tones[at]))
            for at, block in enumerate(assembly.blocks)
            for hull in block.hulls
        ]

    def at(self, turns: Array, places: Array, joints: Sequence[JointState]) -> list[Piece]:
        """Return pieces of blocks by turns, (blocks, 3, 3), and centres, (blocks, 3)."""
        marks: Marks = marks_of(self._assembly, joints, is_arch=self._is_arch)
        found = list(self._supports)
        for at, hull, piece in self._blocks:
            own = [each for each in marks.get(at, ()) if hull is self._nearest(at, *each[:2])]
            found.append(self._marked(piece, hull, own, at).moved(turns[at], places[at]))
        return found

    def _put(self, points: Array, about: Array) -> Array:
        return (points - about) / self._size @ UPRIGHT.T

    def _piece(
        self, hulls: Sequence[Polyhedron], hull: Polyhedron, about: Array, tone: Colour
    ) -> Piece:
        """Return a part of a block. Parts of one block have no edge between them."""
        edge, line = mixed(tone, colour(INK), 0.72), self._line
        others = [each for each in hulls if each is not hull]

        def is_inside(points: Array) -> bool:
            return any(_lies_in(points, each) for each in others)

        faces: list[Face] = []
        for each in hull.faces:
            corners, normal = self._put(each.corners, about), UPRIGHT @ each.normal
            rim, wide = (tone, SEAM) if others else (edge, line)
            wide = 0.0 if is_inside(each.corners) else wide
            faces.append(Face(corners, normal, tone, rim, wide))
        lines = [
            self._line_on(hull, ends, about, edge, line)
            for ends in (hull.edges if others else ())
            if not is_inside(ends)
        ]
        return Piece(self._put(hull.corners, about), faces, lines)

    def _line_on(
        self, hull: Polyhedron, ends: Array, about: Array, tone: Colour, wide: float
    ) -> Line:
        """Return a line on a part, seen where one of the faces is on which it lies."""
        normals, offsets = hull.planes
        on = np.abs(ends @ normals.T - offsets).max(axis=0) < NEAR * hull.thickness
        return Line(self._put(ends, about), list(normals[on] @ UPRIGHT.T), tone, wide)

    def _nearest(self, at: int, points: Array, normal: Array) -> Polyhedron:
        """Return the part of a block that has the face on which a joint is."""
        hulls = self._assembly.blocks[at].hulls
        if len(hulls) == 1:
            return hulls[0]
        return min(hulls, key=lambda hull: _off(points, normal, hull))

    def _marked(self, piece: Piece, hull: Polyhedron, marks: Marked, at: int) -> Piece:
        """Paint what joints do on the faces they are on, and around it."""
        about, faces, lines = (
            self._assembly.blocks[at].centre,
            list(piece.faces),
            list(piece.lines),
        )
        for points, normal, name in marks:
            tone, own = colour(name), UPRIGHT @ normal
            if len(points) > 2:
                faces.append(Face(self._put(points, about), own, tone, tone, self._line))
            for ends in np.stack([points, np.roll(points, -1, axis=0)], axis=1):
                line = self._line_on(hull, ends, about, tone, RIM * self._line)
                lines.append(line._replace(normals=[*line.normals, own]))
        return piece._replace(faces=faces, lines=lines)


def _off(points: Array, normal: Array, hull: Polyhedron) -> float:
    """Return how far a joint is off the face of a part with the same normal."""
    normals, offsets = hull.planes
    off = np.abs(points @ normals.T - offsets).max(axis=0)
    return float(np.where(normals @ normal > ALONG, off, np.inf).min())


def _lies_in(points: Array, hull: Polyhedron) -> bool:
    """Tell whether points are all in a part, or on its rim."""
    normals, offsets = hull.planes
    return bool((points @ normals.T <= offsets + NEAR * hull.thickness).all())


def moving_box(assembly: SpatialAssembly) -> Array:
    """Return least and largest places of what moves, as built, (2, 3) [m]."""
    boxes = np.array([hull.box for each in assembly.blocks for hull in each.hulls])
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def supports_of(assembly: SpatialAssembly, low: Array, high: Array) -> list[Polyhedron]:
    """Return what stays, cut off beyond a box [m].

    Of what is not known a slab behind the joint, a little wider than it.
    """
    bed = BED * assembly.size
    hulls = [hull for each in assembly.supports for hull in each.hulls]
    for joint in assembly.joints:
        if SUPPORT in (joint.before, joint.after) and joint.support is None:
            out = joint.normal * (-bed if joint.before == SUPPORT else bed)
            wide = joint.points + WIDER * (joint.points - joint.points.mean(axis=0))
            hulls.append(Polyhedron(np.concatenate([wide, wide + out])))
    found = [_cut(hull, low - bed, high + bed) for hull in hulls]
    return [each for each in found if each is not None]


def _cut(hull: Polyhedron, low: Array, high: Array) -> Polyhedron | None:
    """Return a support, or the box around it cut off beyond what is shown."""
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


def marks_of(
    assembly: SpatialAssembly, states: Sequence[JointState], *, is_arch: bool = False
) -> Marks:
    """Return joints that take part by block, each with its normal out of it and a colour."""
    told: dict[int, list[tuple[Array, Array, str]]] = {}
    for joint, state in zip(assembly.joints, states, strict=True):
        if state is JointState.CLOSED or len(joint.points) < 2:
            continue
        tone = words_of(state, is_arch=is_arch)[1]
        for side, sign in ((joint.before, 1.0), (joint.after, -1.0)):
            told.setdefault(side, []).append((joint.points, sign * joint.normal, tone))
    return told


def told(states: Iterable[JointState]) -> list[tuple[str, str]]:
    """Return words and colours of what joints do, for a legend."""
    seen = {state_of_any(each) for each in states} - {JointState.CLOSED}
    return [words_of(each, is_arch=False) for each in sorted(seen)]


def force_lines(assembly: SpatialAssembly, found: Resultants) -> tuple[Array, Array]:
    """Return where the resultants of joints act, and how large they are.

    Returns `lines`, (joints, 2, 3): From end to end through the centre of pressure, in
        proportion to the force [m].
    Returns `shares`, (joints,): Of the largest force.
    """
    sizes = np.linalg.norm(found.force, axis=1)
    largest = float(sizes.max(initial=0.0)) or 1.0
    way = LONGEST * assembly.size * found.force / largest / 2
    lines = np.stack([found.point - way, found.point + way], axis=1)
    return lines, np.where(sizes > FAINT * largest, sizes / largest, 0.0)
