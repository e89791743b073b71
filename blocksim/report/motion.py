"""A recording as a drawing that a page can move: outlines, joints, poses in pixels.

The moving run of a check ends when a corner has moved 0.02 r, too little to see. The
drawing enlarges the motion; the page tells by how much.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly
from blocksim.blocks.joints import JointState, classify
from blocksim.kinds.circular import arch_of
from blocksim.simulation.recording import Recording
from blocksim.view.drawing import HINGES, state_of_any
from blocksim.view.stage import Stage

SHOWN = 0.13
"""Largest displacement in the drawing [r]."""
KEYS = 12
"""Poses between which the page interpolates."""
UNIT = 100.0
"""Pixels of the drawing in a radius."""
DOT = 0.017
"""Radius of the mark of a hinge, as a share of the drawing."""
MARGIN = 0.2
"""Free space around the arch, room for its motion [r]."""
FIRST = 3e-4
"""Displacement at which the joints are read: the motion still is the mechanism [r]."""


@dataclass(frozen=True, kw_only=True)
class Mark:
    """A joint that takes part, drawn on one of its blocks or on a footing.

    Parameters
    ----------
    state : str
        As a class of the page's style.
    line : str
        Its two ends, as the points of a polyline.
    hinge : (float, float) or None
        Where it turns, drawn once for each joint.
    """

    state: str
    line: str
    hinge: tuple[float, float] | None


@dataclass(frozen=True, kw_only=True)
class Piece:
    """A block: its outlines at rest, the centre it turns about, its marks."""

    outlines: tuple[str, ...]
    centre: tuple[float, float]
    marks: tuple[Mark, ...]
    moved: str


@dataclass(frozen=True, kw_only=True)
class Arrow:
    """A force: what it is (a class of the page's style), its shaft and its head."""

    what: str
    shaft: str
    head: str


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """Everything a page needs to draw blocks and to move them.

    Parameters
    ----------
    box : str
        The drawing's viewBox.
    rest : tuple of str
        Outlines at rest.
    pieces : tuple of Piece
    footings : tuple of str
    supports : tuple of Mark
        Active joints' faces that stay.
    thrust : tuple of str
        Line of thrust at rest.
    arrows : tuple of Arrow
        Forces besides gravity, and gravity where it does not pull straight down.
    ground : float or None
        Level of the ground, where there is one.
    dot : float
        Radius of the mark of a hinge.
    frames : str
        JSON: for each pose, for each piece, its shift x, y and turn [deg].
    enlarged : float or None
        How many times larger than it is the motion is drawn; None where none is.
    """

    box: str
    rest: tuple[str, ...]
    pieces: tuple[Piece, ...]
    footings: tuple[str, ...]
    supports: tuple[Mark, ...]
    thrust: tuple[str, ...]
    arrows: tuple[Arrow, ...]
    ground: float | None
    dot: float
    frames: str
    enlarged: float | None


@dataclass(frozen=True, kw_only=True)
class ArchDrawing(Drawing):
    """The drawing of a recording of an arch.

    Parameters
    ----------
    seconds : float
        Length of the motion, in seconds of the arch.
    eta : float or None
        Of an arch.
    radius : float
        Of the arch; its radius in metres.
    joints : tuple of (float, str)
        Angle [deg] and state of each joint that takes part.
    """

    seconds: float
    eta: float | None
    radius: float
    joints: tuple[tuple[float, str], ...]


def drawing(recording: Recording, gravity: float) -> ArchDrawing:
    """Turn a recording into a drawing."""
    stage = Stage(recording)
    assembly = stage.assembly
    displaced = recording.displacement
    moves = bool(displaced[-1] > FIRST)
    enlarged = SHOWN / float(displaced[-1]) if moves else None
    late = np.flatnonzero(displaced > FIRST)
    states = (
        classify(assembly, recording.poses[late[0]])
        if moves
        else classify(assembly, recording.poses[0], least=math.inf)
    )
    outlines = [block.vertices / assembly.size for block in assembly.blocks]
    frames = _frames(recording, enlarged or 0.0)
    marks = marks_of(assembly, [joint.state for joint in states])
    arrays = assembly.joint_arrays
    rest = np.concatenate([arrays.ends[:, 0], arrays.ends[::-1, 1]])
    corners = np.concatenate([rest, *stage.footings])
    low, high = corners.min(axis=0) - MARGIN, corners.max(axis=0) + MARGIN
    low[1] = stage.ground - MARGIN / 4
    last = frames[-1]
    arch = arch_of(recording.problem)
    return ArchDrawing(
        box=box_of(low, high),
        rest=(points(rest),),
        pieces=tuple(
            Piece(
                outlines=(points(outline),),
                centre=place_of(block.centre / assembly.size),
                marks=marks[index],
                moved=transform(last[index], place_of(block.centre / assembly.size)),
            )
            for index, (block, outline) in enumerate(
                zip(assembly.blocks, outlines, strict=True)
            )
        ),
        footings=tuple(points(footing) for footing in stage.footings),
        supports=marks[SUPPORT],
        thrust=tuple(points(piece[::8]) for piece in stage.thrust),
        arrows=(),
        ground=round(-stage.ground * UNIT, 2),
        dot=dot_of(low, high),
        frames=json.dumps(frames, separators=(",", ":")),
        enlarged=enlarged,
        seconds=float(recording.seconds(gravity)[-1]),
        eta=arch.eta if arch else None,
        radius=recording.assembly.size,
        joints=tuple(
            (math.degrees(joint.angle), joint.state.value)
            for joint in states
            if joint.state is not JointState.CLOSED
        ),
    )


def _frames(recording: Recording, enlarged: float) -> list[list[list[float]]]:
    """Poses spread evenly over the way moved, enlarged, y downwards."""
    displaced: Array = np.maximum.accumulate(recording.displacement)
    places = np.arange(len(displaced), dtype=np.float64)
    wanted = np.linspace(0.0, float(displaced[-1]), KEYS + 1)
    # Frames at rest share a displacement; the later of them counts.
    where: Array = np.interp(wanted, displaced + 1e-15 * places, places)
    earlier = where.astype(np.int64)
    later = np.minimum(earlier + 1, len(places) - 1)
    share = (where - earlier)[:, None, None]
    poses = recording.poses[earlier] * (1 - share) + recording.poses[later] * share
    moved = (poses - recording.poses[0])[..., :PLANAR]
    drawn: Array = moved * [enlarged * UNIT, -enlarged * UNIT, -math.degrees(enlarged)]
    # Adding zero turns -0 into 0.
    return (drawn.round(2) + 0.0).tolist()


def marks_of(
    assembly: Assembly, states: Sequence[JointState], *, is_arch: bool = True
) -> dict[int, tuple[Mark, ...]]:
    """Collect the marks of active joints by block, `SUPPORT` for the footings."""
    found: dict[int, list[Mark]] = {
        block: [] for block in (*range(len(assembly.blocks)), SUPPORT)
    }
    before, after, ends, *_ = assembly.joint_arrays
    for joint, state in enumerate(states):
        if state is JointState.CLOSED:
            continue
        end = HINGES.get(state)
        hinge = None if end is None else place_of(ends[joint, end])
        line = points(ends[joint])
        look = (state if is_arch else state_of_any(state)).value
        # The dot is drawn with the later of the two blocks, in front of both.
        owner = max(int(before[joint]), int(after[joint]))
        for block in (int(before[joint]), int(after[joint])):
            dot = hinge if block == owner else None
            found[block].append(Mark(state=look, line=line, hinge=dot))
    return {block: tuple(marks) for block, marks in found.items()}


def box_of(low: Array, high: Array) -> str:
    """Return the viewBox of what is drawn between two corners."""
    wide, tall = (high - low) * UNIT
    return f"{low[0] * UNIT:.1f} {-high[1] * UNIT:.1f} {wide:.1f} {tall:.1f}"


def dot_of(low: Array, high: Array) -> float:
    """Return the radius of the mark of a hinge in a drawing between two corners."""
    return round(DOT * UNIT * float((high - low).max()), 1)


def place_of(point: Array) -> tuple[float, float]:
    """Return where a point is drawn."""
    return round(float(point[0]) * UNIT, 2), round(-float(point[1]) * UNIT, 2)


def points(line: Array) -> str:
    """Return points as those of a polyline."""
    return " ".join("{:g},{:g}".format(*place_of(point)) for point in line)


def transform(pose: Sequence[float], centre: tuple[float, float]) -> str:
    """Say how a piece is moved: shift x, y, and turn about its centre [deg]."""
    x, y, turn = pose
    return f"translate({x:g} {y:g}) rotate({turn:g} {centre[0]:g} {centre[1]:g})"
