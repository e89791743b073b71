"""A structure as it falls, or stands, as a drawing that a page can move."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.report.motion import (
    MARGIN,
    SHOWN,
    UNIT,
    Arrow,
    Drawing,
    Piece,
    box_of,
    dot_of,
    marks_of,
    place_of,
    points,
    transform,
)
from blocksim.studies.questions import Drawn
from blocksim.view.arrows import forces_of
from blocksim.view.drawing import carried, clipped

FOOT = 0.12
"""How far beyond the blocks their supports are drawn [size]."""
LONG, HEAD, GAP = 0.32, 0.1, 0.12
"""Length of an arrow and of its head, and its distance from the blocks [size]."""


def mechanism_drawing(drawn: Drawn) -> Drawing:
    """Draw a structure, moved along its mechanism where it has one."""
    assembly = drawn.problem.assembly
    size = assembly.size
    outlines = [tuple(part / size for part in block.polygons) for block in assembly.blocks]
    centres = assembly.centres / size
    corners = np.concatenate([part for each in outlines for part in each])
    poses, scale = _moved(drawn, outlines, centres)
    low, high = corners.min(axis=0), corners.max(axis=0)
    feet = [
        clipped(part / size, low - FOOT, high + FOOT)
        for support in assembly.supports
        for part in support.polygons
    ]
    footings = [foot for foot in feet if len(foot)]
    marks = marks_of(assembly, drawn.states, is_arch=False)
    lines = _lines(drawn.problem, low, high)
    shown = np.concatenate([corners, *footings, *(line for _, line in lines)])
    low, high = shown.min(axis=0) - MARGIN, shown.max(axis=0) + MARGIN
    return Drawing(
        box=box_of(low, high),
        rest=tuple(points(part) for each in outlines for part in each) if scale else (),
        pieces=tuple(
            Piece(
                outlines=tuple(points(part) for part in outline),
                centre=place_of(centre),
                marks=marks[index],
                moved=transform(pose, place_of(centre)),
            )
            for index, (outline, centre, pose) in enumerate(
                zip(outlines, centres, poses, strict=True)
            )
        ),
        footings=tuple(points(foot) for foot in footings),
        supports=marks[SUPPORT],
        thrust=(),
        arrows=tuple(_arrow(what, line) for what, line in lines),
        ground=None,
        dot=dot_of(low, high),
        frames=json.dumps([[[0.0] * PLANAR] * len(poses), poses], separators=(",", ":")),
        enlarged=scale,
    )


def _moved(
    drawn: Drawn, outlines: Sequence[Sequence[Array]], centres: Array
) -> tuple[list[list[float]], float | None]:
    """Shift each block in pixels and turn it, and say how many times its rates that is."""
    if drawn.rates is None:
        return [[0.0] * PLANAR] * len(centres), None
    rates = drawn.rates[:, :PLANAR]
    ways = [
        np.hypot(*carried(np.concatenate(outline), centre, rate).T).max()
        for outline, centre, rate in zip(outlines, centres, rates, strict=True)
    ]
    scale = SHOWN / float(max(ways))
    # Adding zero turns -0 into 0.
    moved = (rates * scale * [UNIT, -UNIT, -math.degrees(1.0)]).round(2) + 0.0
    return moved.tolist(), scale


def _lines(problem: Problem, low: Array, high: Array) -> list[tuple[str, Array]]:
    """Return what acts besides gravity, by the blocks it acts on, from tail to tip [size].

    A force on every block, and gravity that does not pull straight down, are one arrow
    beside the structure.
    """
    assembly = problem.assembly
    size, found = assembly.size, list[tuple[str, Array]]()

    def beside(what: str, force: Array) -> tuple[str, Array]:
        way = LONG * force / np.hypot(*force)
        # Left of what pushes to the right, above what pulls down.
        side = float(low[0]) - GAP if force[0] >= 0 else float(high[0]) + GAP
        tip = np.array([side, (low[1] + high[1]) / 2 + max(0.0, -float(way[1])) / 2])
        return what, np.array([tip - way, tip])

    for what, loads in (("dead", problem.dead), ("live", problem.live)):
        for load in loads:
            if load.per_weight or len(load.blocks) > 1:
                found.append(beside(what, load.force))
                continue
            for place, force in forces_of(problem, load):
                tip = place / size
                found.append((what, np.array([tip - LONG * force / np.hypot(*force), tip])))
    pull = problem.gravity[:2]
    if abs(pull[0]) > 1e-9:
        found.append(beside("gravity", pull))
    return found


def _arrow(what: str, line: Array) -> Arrow:
    tail, tip = line
    along = (tip - tail) / np.hypot(*(tip - tail))
    across = np.array([-along[1], along[0]])
    back = tip - HEAD * along
    head = np.array([tip, back + 0.4 * HEAD * across, back - 0.4 * HEAD * across])
    return Arrow(what=what, shaft=points(np.array([tail, back])), head=points(head))
