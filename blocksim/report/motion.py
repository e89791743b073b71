"""Blocks as a drawing that a page can move: outlines, joints, loads, poses in pixels.

The moving run of a check ends when a corner has moved 0.02 r, too little to see, and a
mechanism has no size. The drawing enlarges both; the page tells by how much.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly
from blocksim.blocks.joints import JointState, ObservedJoint, classify
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import fill_loads
from blocksim.simulation.recording import Recording
from blocksim.view.arrows import FEW, forces_of
from blocksim.view.canvas import NOTHING, TIP, arrow
from blocksim.view.drawing import carried, state_of_any
from blocksim.view.stage import Stage
from blocksim.view.structure import supports_shown

SHOWN = 0.13
"""Largest displacement in the drawing [size]."""
KEYS = 12
"""Poses between which the page interpolates."""
UNIT = 100.0
"""Pixels of the drawing in a size."""
DOT = 0.017
"""Radius of the mark of a hinge, as a share of the drawing."""
MARGIN = 0.2
"""Free space around the blocks, room for their motion [size]."""
FIRST = 3e-4
"""Displacement at which the joints are read: the motion still is the mechanism [size]."""
LONG, HEAD, GAP = 0.32, 0.1, 0.12
"""Length of an arrow and of its head, and its distance from the blocks [size]."""


class Mark(NamedTuple):
    """A joint that takes part, on one of its blocks or on a support.

    Its state is a class of the page's style; a hinge, where it turns, is drawn with one block.
    """

    state: str
    line: str
    hinge: tuple[float, float] | None


class Piece(NamedTuple):
    """A block: its outlines at rest, the centre it turns about, its marks."""

    outlines: tuple[str, ...]
    centre: tuple[float, float]
    marks: tuple[Mark, ...]
    moved: str


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """Everything a page needs to draw blocks and to move them.

    `box`: The drawing's viewBox.
    `rest`: Outlines at rest, of what moves.
    `supports`: Active joints' faces that stay.
    `thrust`: Lines of thrust at rest.
    `arrows`: Forces besides gravity, and gravity where it does not pull straight down: what
        each is (a class of the page's style), its shaft and its head.
    `dot`: Radius of the mark of a hinge.
    `frames`: JSON: for each pose, for each piece, its shift x, y and turn [deg].
    `enlarged`: How many times larger than it is the motion is drawn; None where none is.
    """

    box: str
    rest: tuple[str, ...]
    pieces: tuple[Piece, ...]
    footings: tuple[str, ...]
    supports: tuple[Mark, ...]
    thrust: tuple[str, ...]
    arrows: tuple[tuple[str, str, str], ...]
    dot: float
    frames: str
    enlarged: float | None


def recorded_drawing(recording: Recording) -> Drawing:
    """Draw a recording, its poses spread evenly over the way moved."""
    displaced: Array = np.maximum.accumulate(recording.displacement)
    enlarged = SHOWN / float(displaced[-1]) if displaced[-1] > FIRST else None
    places = np.arange(len(displaced), dtype=np.float64)
    wanted = np.linspace(0.0, float(displaced[-1]), KEYS + 1)
    # Frames at rest share a displacement; the later of them counts.
    where: Array = np.interp(wanted, displaced + 1e-15 * places, places)
    earlier = where.astype(np.int64)
    later = np.minimum(earlier + 1, len(places) - 1)
    share = (where - earlier)[:, None, None]
    poses = recording.poses[earlier] * (1 - share) + recording.poses[later] * share
    moved = poses - recording.poses[0]
    states = [joint.state for joint in joints_of(recording)]
    return _drawing(recording.problem, states, moved, enlarged, Stage(recording).thrust)


def mechanism_drawing(
    problem: Problem, rates: Array | None, states: Sequence[JointState]
) -> Drawing:
    """Draw a structure of the plane, moved along its mechanism where it has one."""
    blocks, size = problem.assembly.blocks, problem.assembly.size
    still = np.zeros((1, len(blocks), PLANAR))
    if rates is None:
        return _drawing(problem, states, still, None)
    scale = SHOWN / max(
        float(np.hypot(*carried(block.vertices / size, block.centre / size, rate).T).max())
        for block, rate in zip(blocks, rates, strict=True)
    )
    moved = np.concatenate([still, rates[None]])
    return _drawing(problem, states, moved, scale)


def joints_of(recording: Recording) -> tuple[ObservedJoint, ...]:
    """Return what each joint does as the motion of a recording starts."""
    displaced = recording.displacement
    if displaced[-1] <= FIRST:
        return classify(recording.assembly, recording.poses[0], least=math.inf)
    first = int(np.flatnonzero(displaced > FIRST)[0])
    return classify(recording.assembly, recording.poses[first])


def _drawing(
    problem: Problem,
    states: Sequence[JointState],
    moved: Array,
    enlarged: float | None,
    thrust: Sequence[Array] = (),
) -> Drawing:
    """Draw blocks; `moved` is how far from rest they are, (frames, blocks, 3) in sizes."""
    assembly, size = problem.assembly, problem.assembly.size
    outlines = [tuple(part / size for part in block.polygons) for block in assembly.blocks]
    corners = np.concatenate([part for each in outlines for part in each])
    low, high = corners.min(axis=0), corners.max(axis=0)
    feet = [part / size for parts in supports_shown(problem) for part in parts]
    lines = _lines(problem, low, high)
    shown = np.concatenate([corners, *feet, *(line for _, line in lines)])
    low, high = shown.min(axis=0) - MARGIN, shown.max(axis=0) + MARGIN
    wide, tall = (high - low) * UNIT
    # Downwards is positive on a page; adding zero turns -0 into 0.
    frames = moved * (enlarged or 0.0) * [UNIT, -UNIT, -math.degrees(1.0)]
    frames = (frames.round(2) + 0.0).tolist()
    marks = _marks(assembly, states, is_arch=problem.is_arch)
    centres = [_place(block.centre / size) for block in assembly.blocks]
    return Drawing(
        box=f"{low[0] * UNIT:.1f} {-high[1] * UNIT:.1f} {wide:.1f} {tall:.1f}",
        rest=tuple(_points(part) for each in outlines for part in each) if enlarged else (),
        pieces=tuple(
            Piece(tuple(map(_points, outline)), centre, marks[index], _transform(pose, centre))
            for index, (outline, centre, pose) in enumerate(
                zip(outlines, centres, frames[-1], strict=True)
            )
        ),
        footings=tuple(map(_points, feet)),
        supports=marks[SUPPORT],
        thrust=tuple(map(_points, thrust)),
        arrows=tuple(_arrow(what, line) for what, line in lines),
        dot=round(DOT * float(max(wide, tall)), 1),
        frames=json.dumps(frames, separators=(",", ":")),
        enlarged=enlarged,
    )


def _marks(
    assembly: Assembly, states: Sequence[JointState], *, is_arch: bool
) -> dict[int, tuple[Mark, ...]]:
    """Collect the marks of active joints by block, `SUPPORT` for the footings."""
    found: dict[int, list[Mark]] = {
        block: [] for block in (*range(len(assembly.blocks)), SUPPORT)
    }
    before, after, ends, *_ = assembly.joint_arrays
    for joint, state in enumerate(states):
        if state is JointState.CLOSED:
            continue
        end = state.hinge
        hinge = None if end is None else _place(ends[joint, end])
        look = (state if is_arch else state_of_any(state)).value
        # The dot is drawn with the later of the two blocks, in front of both.
        owner = max(int(before[joint]), int(after[joint]))
        for block in (int(before[joint]), int(after[joint])):
            dot = hinge if block == owner else None
            found[block].append(Mark(look, _points(ends[joint]), dot))
    return {block: tuple(marks) for block, marks in found.items()}


def _lines(problem: Problem, low: Array, high: Array) -> list[tuple[str, Array]]:
    """Return what acts besides gravity (fill is not shown), from tail to tip [size]."""
    size, found = problem.assembly.size, list[tuple[str, Array]]()
    dead = problem.dead[fill_loads(problem) :]
    many = sum(len(load.blocks) for load in (*dead, *problem.live)) > FEW
    long = LONG / 2 if many else LONG

    def beside(what: str, force: Array) -> tuple[str, Array]:
        way = LONG * force / np.hypot(*force)
        # Left of what pushes to the right, above what pulls down.
        side = float(low[0]) - GAP if force[0] >= 0 else float(high[0]) + GAP
        tip = np.array([side, (low[1] + high[1]) / 2 + max(0.0, -float(way[1])) / 2])
        return what, np.array([tip - way, tip])

    for what, loads in (("dead", dead), ("live", problem.live)):
        for load in loads:
            if load.per_weight or len(load.blocks) > 1:
                found.append(beside(what, load.force))
                continue
            for block, (place, force) in zip(
                load.blocks, forces_of(problem, load), strict=True
            ):
                tip, way = place / size, force / np.hypot(*force)
                parts = [part / size for part in problem.assembly.blocks[block].polygons]
                # From where it meets the block on, lest it covers what moves.
                tip = tip - way * max(_depth(part, tip, -way) for part in parts)
                found.append((what, np.array([tip - long * way, tip])))
    pull = problem.gravity[:2]
    if abs(pull[0]) > 1e-9:
        found.append(beside("gravity", pull))
    return found


def _depth(corners: Array, point: Array, way: Array) -> float:
    """Return how far it is from a point within a polygon to its edge, in a direction."""
    edge = np.roll(corners, -1, axis=0) - corners
    arm, turn = corners - point, way[0] * edge[:, 1] - way[1] * edge[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (arm[:, 0] * edge[:, 1] - arm[:, 1] * edge[:, 0]) / turn
        share = (arm[:, 0] * way[1] - arm[:, 1] * way[0]) / turn
    meets = np.isfinite(far) & (far > 0) & (share >= 0) & (share <= 1)
    return float(far[meets].max(initial=0.0))


def _arrow(what: str, line: Array) -> tuple[str, str, str]:
    tail, tip = line
    size = min(HEAD, float(np.hypot(*(tip - tail))) / 3)
    shaft, head = arrow(tail, tip, NOTHING, size / TIP)
    return what, _points(shaft.points), _points(head.points)


def _place(point: Array) -> tuple[float, float]:
    """Return where a point is drawn."""
    return round(float(point[0]) * UNIT, 2), round(-float(point[1]) * UNIT, 2)


def _points(line: Array) -> str:
    """Return points as those of a polyline."""
    return " ".join("{:g},{:g}".format(*_place(point)) for point in line)


def _transform(pose: Sequence[float], centre: tuple[float, float]) -> str:
    """Say how a piece is moved: shift x, y, and turn about its centre [deg]."""
    x, y, turn = pose
    return f"translate({x:g} {y:g}) rotate({turn:g} {centre[0]:g} {centre[1]:g})"
