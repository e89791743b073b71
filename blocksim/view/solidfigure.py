"""A problem in space in perspective, with its answer and how it begins to fall."""
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.view.drawing import literal, state_of_any, words_of
from blocksim.view.order import painting_order
from blocksim.view.style import FONT, GROUND, INK, PAPER, QUIET, STONE, VERDICTS

if TYPE_CHECKING:
    from blocksim.ask.space import SpatialCheck

ASIDE, ABOVE = math.radians(-60.0), math.radians(22.0)
"""Where the eye is: azimuth from x towards y, and height."""
DISTANCE = 5.0
"""Of the eye from the middle, in half-diagonals of what moves."""
LIGHT = np.array([-0.35, -0.55, 0.76])
AMBIENT = 0.55
"""Brightness of a face in shade; one that faces the light has 1."""
WAY = 0.15
"""How far the mechanism is drawn: its largest way in units of the size."""
BED = 0.25
"""How far supports are drawn beyond what moves, in units of the size."""


class _Piece(NamedTuple):
    """A convex part as it is drawn: its faces with normals and colours."""

    corners: Array
    faces: list[tuple[Array, Array, str]]


def solid_figure(answer: SpatialCheck) -> Figure:
    """Draw blocks in space; of what falls, moved as its collapse begins.

    Parameters
    ----------
    answer : SpatialCheck

    Returns
    -------
    Figure
    """
    low, high = _box(answer)
    pieces = _pieces(answer, low, high)
    middle = (low + high) / 2
    away = np.array(
        [math.cos(ASIDE) * math.cos(ABOVE), math.sin(ASIDE) * math.cos(ABOVE), math.sin(ABOVE)]
    )
    eye = middle + DISTANCE * float(np.linalg.norm(high - low)) / 2 * away
    right = np.array([-math.sin(ASIDE), math.cos(ASIDE), 0.0])
    axes = np.stack([right, np.cross(away, right)])

    def seen(points: Array) -> Array:
        deep = (eye - points) @ away
        return (points - eye) @ axes.T / deep[:, None]

    polygons: list[Array] = []
    fills: list[Array] = []
    for index in _order(pieces, eye, seen):
        for corners, normal, tone in pieces[index].faces:
            if normal @ (eye - corners[0]) > 0:
                shade = AMBIENT + (1 - AMBIENT) * max(0.0, float(normal @ LIGHT))
                polygons.append(seen(corners))
                fills.append(np.array(to_rgb(tone)) * shade)
    with mpl.rc_context(FONT):
        return _figure(answer, polygons, fills)


def _pieces(answer: SpatialCheck, low: Array, high: Array) -> list[_Piece]:
    """Return the convex parts of supports and blocks, where they are drawn."""
    assembly = answer.problem.assembly
    bed = BED * assembly.size
    found = [
        _cut(hull, low - bed, high + bed) for each in assembly.supports for hull in each.hulls
    ]
    found = [each for each in found if len(each.faces)]
    rates, marks = answer.mechanism, _marks(answer)
    for at, block in enumerate(assembly.blocks):
        turn, shift = np.eye(3), np.zeros(3)
        if rates is not None:
            turn = Rotation.from_rotvec(WAY * rates[at, 3:]).as_matrix()
            shift = WAY * assembly.size * rates[at, :3]

        put = partial(_put, turn=turn, shift=shift, about=block.centre)
        for hull in block.hulls:
            faces = [(put(each.corners), turn @ each.normal, STONE) for each in hull.faces]
            # What joints do is painted on the faces they are on.
            faces += [
                (put(points), turn @ normal, tone)
                for points, normal, tone in marks.get(at, [])
                if _lies_on(points, normal, hull)
            ]
            found.append(_Piece(put(hull.corners), faces))
    return found


def _put(points: Array, turn: Array, shift: Array, about: Array) -> Array:
    """Turn points about a point, and shift them."""
    return (points - about) @ turn.T + about + shift


def _marks(answer: SpatialCheck) -> dict[int, list[tuple[Array, Array, str]]]:
    """Return joints that take part by block, each with its normal out of it and a colour."""
    told: dict[int, list[tuple[Array, Array, str]]] = {}
    for joint, state in zip(answer.problem.assembly.joints, answer.joints, strict=True):
        if state is JointState.CLOSED or len(joint.points) < 3:
            continue
        tone = words_of(state, is_arch=False)[1]
        for side, sign in ((joint.before, 1.0), (joint.after, -1.0)):
            told.setdefault(side, []).append((joint.points, sign * joint.normal, tone))
    return told


def _lies_on(points: Array, normal: Array, hull: Polyhedron) -> bool:
    """Tell whether a joint lies on a face of a part."""
    near = 1e-3 * hull.thickness
    return any(
        face.normal @ normal > 0.999 and np.abs(points @ face.normal - face.offset).max() < near
        for face in hull.faces
    )


def _cut(hull: Polyhedron, low: Array, high: Array) -> _Piece:
    """Return the box around a support, cut off beyond what is shown; or itself if within."""
    if not ((hull.box[0] >= low).all() and (hull.box[1] <= high).all()):
        lower, upper = np.maximum(hull.box[0], low), np.minimum(hull.box[1], high)
        if not (upper - lower > 1e-9).all():
            return _Piece(np.zeros((0, 3)), [])
        hull = Polyhedron(list(itertools.product(*zip(lower, upper, strict=True))))
    return _Piece(hull.corners, [(f.corners, f.normal, GROUND) for f in hull.faces])


def _box(answer: SpatialCheck) -> Array:
    """Return least and largest places of what moves, (2, 3)."""
    boxes = np.array([h.box for each in answer.problem.assembly.blocks for h in each.hulls])
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def _order(pieces: list[_Piece], eye: Array, seen: Callable[[Array], Array]) -> list[int]:
    """Order pieces from back to front."""
    count = max(len(each.corners) for each in pieces)
    planes = max(len(each.faces) for each in pieces)
    corners = np.stack([_filled(each.corners, count) for each in pieces])
    normals = np.zeros((len(pieces), planes, 3))
    offsets = np.zeros((len(pieces), planes))
    for at, each in enumerate(pieces):
        for k, (points, normal, _) in enumerate(each.faces):
            normals[at, k], offsets[at, k] = normal, points[0] @ normal
    flat = [seen(each.corners) for each in pieces]
    boxes = np.stack([np.stack([f.min(axis=0), f.max(axis=0)]) for f in flat])
    return painting_order(corners, normals, offsets, eye, boxes)


def _filled(corners: Array, count: int) -> Array:
    """Repeat the last corner until there are so many."""
    return np.concatenate([corners, np.repeat(corners[-1:], count - len(corners), axis=0)])


def _figure(answer: SpatialCheck, polygons: list[Array], fills: list[Array]) -> Figure:
    """Put polygons, title and legend on paper."""
    figure = Figure(figsize=(8, 6), facecolor=PAPER)
    axes = figure.add_axes((0.03, 0.09, 0.94, 0.8))
    axes.add_collection(
        PolyCollection(polygons, facecolors=fills, edgecolors=INK, linewidths=0.4)
    )
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    problem = answer.problem
    figure.text(
        0.04, 0.94, answer.verdict.value.upper(),
        color=VERDICTS[answer.verdict], fontsize=13, fontweight="bold",
    )  # fmt: skip
    words = f"{problem.title or 'blocks in space'}, {len(problem.assembly.blocks)} blocks, "
    figure.text(0.04, 0.905, literal(f"{words}mu {problem.mu:g}"), color=QUIET, fontsize=9)
    states = {state_of_any(each) for each in answer.joints} - {JointState.CLOSED}
    told = [words_of(each, is_arch=False) for each in sorted(states)]
    if told:
        figure.legend(
            handles=[Patch(facecolor=tone, label=said) for said, tone in told],
            loc="lower left", bbox_to_anchor=(0.03, 0.02), ncols=len(told), frameon=False,
        )  # fmt: skip
    if answer.mechanism is not None:
        figure.text(0.97, 0.035, "as it begins to fall, enlarged", ha="right", color=QUIET)
    return figure
