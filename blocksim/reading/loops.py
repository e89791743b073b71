"""Closed outlines of lines and arcs that were drawn one by one.

Every block is drawn around, so that a line between two blocks is there twice. A region with
a block on one side of a line is told from an opening by that: nothing is guessed. Where it
cannot be told, the place is said.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.bodies import connected
from blocksim.common.checks import require
from blocksim.reading.curves import Corners

MEETS = 1e-4
"""Ends of lines are one corner where they are nearer than this share of the shorter line."""
MOST_PARTS, MOST_ENDS = 20_000, 30
"""Straight parts of the lines of a layer; and ends of them at a place, on average."""
OUTSIDE = -1
"""Stands for the region around a group of lines."""


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


@dataclass
class _Edge:
    """A straight part of a line between two corners, and how often it was drawn."""

    line: int
    ends: tuple[int, int]
    times: int = 0


def loops_of(
    paths: Sequence[Corners], snap: float | None = None
) -> tuple[list[Loop], list[Open]]:
    """Find the outlines that lines make.

    `paths`, sequence of list of (x, y): Lines, arcs as chords, open polylines. All that they
        are made of may be part of other outlines, too.
    `snap`: Ends that are so near to each other are one corner; by default `MEETS`.
    Returns: Lines that make none: all of those with an end that meets no other, or of a group
        of lines of which it cannot be told where its blocks are.
    """
    parts = np.array([pair for path in paths for pair in pairwise(path)])
    few, allowed = len(parts) <= MOST_PARTS, f"at most {MOST_PARTS} on a layer that is read"
    require(few, "lines", f"{len(parts)} straight parts", allowed)
    line = np.repeat(np.arange(len(paths)), [len(path) - 1 for path in paths])
    lengths = np.hypot(*(parts[:, 1] - parts[:, 0]).T)
    whole = np.bincount(line, lengths)[line]
    # No more than a third of a part: its own ends stay apart.
    near = np.minimum(MEETS * whole if snap is None else snap, lengths / 3)
    corner, places, moved = _corners(parts.reshape(-1, 2), np.repeat(near, 2))
    edges = _edges(line.tolist(), corner.reshape(-1, 2), places, near)
    wrong = _unmatched(edges, places)
    if wrong:
        return [], wrong
    found: list[Loop] = []
    for group in _groups(edges, len(places)):
        faces, beside = _faces(group, places)
        inside, at = _inside(group, beside)
        if at is not None:
            why = "is between two blocks, and drawn once: draw around each block"
            wrong.append(Open(group[at].line, _place(places, group[at].ends[1]), why))
            continue
        for index in inside:
            own = (k for k, sides in enumerate(beside) if index in sides)
            lines = list(dict.fromkeys(group[k].line for k in own))
            found.append(Loop(faces[index], lines, moved))
    found.sort(key=lambda each: min(each.lines))
    return found, wrong


def _place(places: Array, corner: int) -> tuple[float, float]:
    return float(places[corner, 0]), float(places[corner, 1])


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
    lines: Sequence[int], ends: NDArray[np.int64], places: Array, near: Array
) -> list[_Edge]:
    """Cut parts at the corners that lie on them; those drawn twice are counted."""
    found: dict[tuple[int, int], _Edge] = {}
    for line, (a, b), reach in zip(lines, ends.tolist(), near.tolist(), strict=True):
        for one, other in pairwise([a, *_on(places, a, b, reach), b]):
            known = min(one, other), max(one, other)
            if one != other:
                found.setdefault(known, _Edge(line, (one, other))).times += 1
    return list(found.values())


def _on(places: Array, a: int, b: int, near: float) -> list[int]:
    """Return the corners that lie on a straight part between two others, in order."""
    start, way = places[a], places[b] - places[a]
    long = float(np.hypot(*way))
    if not long:
        return []
    low, high = np.minimum(start, places[b]) - near, np.maximum(start, places[b]) + near
    inside = np.flatnonzero(((places >= low) & (places <= high)).all(axis=1))
    arm = places[inside] - start
    share, off = arm @ way / long**2, np.abs(way[0] * arm[:, 1] - way[1] * arm[:, 0]) / long
    on = np.flatnonzero((share > 0) & (share < 1) & (off <= near))
    return [k for k in inside[on[np.argsort(share[on])]].tolist() if k not in {a, b}]


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
        Open(at[end], _place(places, end), why.get(many, more))
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


def _faces(group: Sequence[_Edge], places: Array) -> tuple[list[Corners], list[list[int]]]:
    """Return the regions between edges, and which are on the sides of each edge."""
    # It takes a tenth of a second to load.
    from blocksim.blocks.regions import between

    ends = [(_place(places, one), _place(places, other)) for one, other in
            (edge.ends for edge in group)]  # fmt: skip
    of = {way: k for k, both in enumerate(ends) for way in (both, both[::-1])}
    faces = between(ends)
    beside: list[list[int]] = [[] for _ in group]
    for at, face in enumerate(faces):
        for way in pairwise([*face, face[0]]):
            beside[of[way]].append(at)
    return faces, [[*sides, OUTSIDE, OUTSIDE][:2] for sides in beside]


def _inside(
    group: Sequence[_Edge], beside: Sequence[Sequence[int]]
) -> tuple[list[int], int | None]:
    """Tell regions that are blocks, from the outside in; or the edge at which it cannot be."""
    around: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for k, (one, other) in enumerate(beside):
        around[one].append((k, other))
        around[other].append((k, one))
    full, ahead = {OUTSIDE: False}, [OUTSIDE]
    while ahead:
        here = ahead.pop()
        for k, beyond in around[here]:
            times = group[k].times
            block = not full[here] if times == 1 else full[here]
            if times > 2 or (times == 2 and not block):
                return [], k
            if beyond not in full:
                full[beyond] = block
                ahead.append(beyond)
            elif full[beyond] != block:
                return [], k
    return [at for at, block in full.items() if block], None
