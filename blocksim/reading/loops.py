"""Closed outlines of lines and arcs that were drawn one by one.

Every block is drawn around, so that a line between two blocks is there twice. A region with
a block on one side of a line is told from an opening by that: nothing is guessed. Where it
cannot be told, the place is said.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.bodies import connected
from blocksim.blocks.outlines import signed_area
from blocksim.common.checks import require
from blocksim.reading.curves import Corners

MEETS = 1e-4
"""Ends of lines are one corner where they are nearer than this share of the shorter line."""
ALIKE = 1e-3
"""Lines between the same corners are one where their middles are nearer than this share."""
MOST_LINES, MOST_ENDS = 10_000, 30
"""Of a drawing, each with an end that meets others; and ends at a place, on average."""


class Loop(NamedTuple):
    """A closed outline: its corners, the lines it is made of, and how far ends were moved."""

    corners: Corners
    lines: list[int]
    moved: float


class Open(NamedTuple):
    """A line that is part of no outline: which, where, and why."""

    line: int
    at: tuple[float, float]
    why: str


@dataclass(frozen=True)
class _Edge:
    """A part of a line between two corners: its path, and how often it was drawn."""

    line: int
    ends: tuple[int, int]
    path: tuple[tuple[float, float], ...]
    times: int = 1


def loops_of(
    paths: Sequence[Corners], snap: float | None = None
) -> tuple[list[Loop], list[Open]]:
    """Find the outlines that lines make.

    `paths`, sequence of list of (x, y): Lines, arcs as chords, open polylines.
    `snap`: Ends that are so near to each other are one corner; by default `MEETS`.
    Returns: Lines that make none: all of those with an end that meets no other, or of a group
        of lines of which it cannot be told where its blocks are.
    """
    ends = np.array([(path[0], path[-1]) for path in paths])
    lengths = np.array([_length(path) for path in paths])
    # No more than a third of a line: its own ends stay apart.
    near = lengths * MEETS if snap is None else np.minimum(snap, lengths / 3)
    corner, places, moved = _corners(ends.reshape(-1, 2), np.repeat(near, 2))
    edges = _edges(paths, corner.reshape(-1, 2), places, near)
    wrong = _unmatched(edges, places)
    if wrong:
        return [], wrong
    found: list[Loop] = []
    for group in _groups(edges, len(places)):
        faces, of = _faces(group)
        inside, at = _inside(group, faces, of)
        if at is not None:
            here = group[at].path[len(group[at].path) // 2]
            why = "is between two blocks, and drawn once: draw around each block"
            wrong.append(Open(group[at].line, here, why))
            continue
        for index in inside:
            lines = list(dict.fromkeys(group[half // 2].line for half in faces[index]))
            corners = [(float(x), float(y)) for x, y in _path(group, faces[index])]
            found.append(Loop(corners, lines, moved))
    found.sort(key=lambda each: min(each.lines))
    return found, wrong


def _length(path: Corners) -> float:
    points = np.array(path)
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _corners(points: Array, near: Array) -> tuple[NDArray[np.int64], Array, float]:
    """Take ends that are near each other for one corner: its number for each, and its place."""
    # It takes a third of a second to load, and most files are no drawings.
    from scipy.spatial import KDTree

    tree, reach = KDTree(points), float(near.max())
    many = int(tree.count_neighbors(tree, reach))
    few = many <= MOST_ENDS * len(points)
    require(few, "ends of lines", "more at one place", f"at most {MOST_ENDS} on average")
    pairs = tree.query_pairs(reach, output_type="ndarray")
    far = np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T)
    meet = far <= near[pairs].min(axis=1)
    number = connected(len(points), *pairs[meet].T)
    firsts = np.unique(number, return_index=True)[1]
    return number, points[firsts], float(far[meet].max(initial=0.0))


def _edges(
    paths: Sequence[Corners], ends: NDArray[np.int64], places: Array, near: Array
) -> list[_Edge]:
    """Cut lines at the corners that lie on them; those drawn twice are counted."""
    parts: list[_Edge] = []
    for line, (path, (a, b)) in enumerate(zip(paths, ends.tolist(), strict=True)):
        first, last = map(tuple, places[[a, b]].tolist())
        parts += _cut(line, [first, *path[1:-1], last], (a, b), places, float(near[line]))
    known: dict[tuple[int, int], list[_Edge]] = defaultdict(list)
    for part in parts:
        low, high = min(part.ends), max(part.ends)
        if low == high and len(part.path) < 4:
            continue
        same = known[low, high]
        for at, other in enumerate(same):
            if _alike(part, other, float(near[part.line])):
                same[at] = replace(other, times=other.times + 1)
                break
        else:
            same.append(part)
    return [part for same in known.values() for part in same]


def _cut(
    line: int, path: Corners, ends: Sequence[int], places: Array, near: float
) -> list[_Edge]:
    """Cut a line at the corners of others that lie on it."""
    points = np.array(path)
    low, high = points.min(axis=0) - near, points.max(axis=0) + near
    inside = ((places >= low) & (places <= high)).all(axis=1)
    inside[list(ends)] = False
    near_ones = np.flatnonzero(inside)
    cuts: dict[int, tuple[int, float]] = {}
    for at, (one, other) in enumerate(pairwise(points) if len(near_ones) else ()):
        way, arm = other - one, places[near_ones] - one
        long = float(np.hypot(*way))
        if not long:
            continue
        share, off = arm @ way / long**2, np.abs(way[0] * arm[:, 1] - way[1] * arm[:, 0]) / long
        for k in np.flatnonzero((share > 0) & (share <= 1) & (off <= near)).tolist():
            cuts.setdefault(int(near_ones[k]), (at, float(share[k])))
    found: list[_Edge] = []
    last, begin, before = ends[0], 0, path[0]
    for at, _, corner in sorted((*where, corner) for corner, where in cuts.items()):
        here = tuple(places[corner].tolist())
        found.append(_Edge(line, (last, corner), (before, *path[begin + 1 : at + 1], here)))
        last, begin, before = corner, at, here
    return [*found, _Edge(line, (last, ends[1]), (before, *path[begin + 1 :]))]


def _alike(one: _Edge, other: _Edge, near: float) -> bool:
    """Whether two lines between the same corners are one that was drawn twice."""
    apart = math.dist(_middle(one.path), _middle(other.path))
    return apart <= max(near, ALIKE * _length(list(one.path)))


def _middle(path: Sequence[tuple[float, float]]) -> tuple[float, float]:
    points: Array = np.array(path)
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    x, y = (float(np.interp(float(along[-1]) / 2, along, points[:, k])) for k in (0, 1))
    return x, y


def _unmatched(edges: Sequence[_Edge], places: Array) -> list[Open]:
    """Find ends at which no outline can go on: as many lines have to come in as go out."""
    count: dict[int, int] = defaultdict(int)
    at: dict[int, int] = {}
    for edge in edges:
        for end in edge.ends:
            count[end] += edge.times
            at.setdefault(end, edge.line)
    why = {1: "ends there, and meets no other line (ends as near as --snap are one)"}
    more = "meets others there, and a line between two blocks is drawn once: draw around each"
    return [
        Open(at[end], (float(places[end][0]), float(places[end][1])), why.get(many, more))
        for end, many in count.items()
        if many % 2
    ]


def _groups(edges: Sequence[_Edge], corners: int) -> list[list[_Edge]]:
    """Sort edges into those that hang together."""
    ends = np.array([edge.ends for edge in edges], dtype=np.int64).reshape(-1, 2)
    found: dict[int, list[_Edge]] = defaultdict(list)
    labels = connected(corners, *ends.T)[ends[:, 0]].tolist()
    for edge, label in zip(edges, labels, strict=True):
        found[label].append(edge)
    return list(found.values())


def _directed(edge: _Edge, back: bool) -> tuple[tuple[float, float], ...]:
    return edge.path[::-1] if back else edge.path


def _faces(group: Sequence[_Edge]) -> tuple[list[list[int]], dict[int, int]]:
    """Trace the regions between edges: half-edge 2 k goes along edge k, 2 k + 1 back.

    Returns the half-edges around each region, which lies to their left, and the region of
    each half-edge.
    """
    leaving: dict[int, list[tuple[float, int]]] = defaultdict(list)
    for k, edge in enumerate(group):
        for back in (0, 1):
            path = _directed(edge, bool(back))
            (x, y), (to_x, to_y) = path[0], path[1]
            leaving[edge.ends[back]].append((math.atan2(to_y - y, to_x - x), 2 * k + back))
    around = {corner: [half for _, half in sorted(all_)] for corner, all_ in leaving.items()}
    place = {half: at for ring in around.values() for at, half in enumerate(ring)}
    of: dict[int, int] = {}
    faces: list[list[int]] = []
    for start in range(2 * len(group)):
        if start in of:
            continue
        face, half = list[int](), start
        while half not in of:
            of[half] = len(faces)
            face.append(half)
            back = half ^ 1
            ring = around[group[half // 2].ends[1 - half % 2]]
            # The next one clockwise after the way back.
            half = ring[place[back] - 1]
        faces.append(face)
    return faces, of


def _inside(
    group: Sequence[_Edge], faces: Sequence[Sequence[int]], of: dict[int, int]
) -> tuple[list[int], int | None]:
    """Tell regions that are blocks, from the outside in; or the edge at which it cannot be."""
    outer = min(range(len(faces)), key=lambda k: signed_area(np.array(_path(group, faces[k]))))
    full = {outer: False}
    ahead = [outer]
    while ahead:
        here = ahead.pop()
        for half in faces[here]:
            beyond, edge = of[half ^ 1], group[half // 2]
            block = not full[here] if edge.times == 1 else full[here]
            if edge.times > 2 or (edge.times == 2 and not block):
                return [], half // 2
            if beyond not in full:
                full[beyond] = block
                ahead.append(beyond)
            elif full[beyond] != block:
                return [], half // 2
    return [k for k, block in full.items() if block], None


def _path(group: Sequence[_Edge], face: Sequence[int]) -> Corners:
    return [
        point for half in face for point in _directed(group[half // 2], bool(half % 2))[:-1]
    ]
