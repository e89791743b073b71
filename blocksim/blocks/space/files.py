"""Structure files in space: the keys of plane ones, with three coordinates.

Lengths in m, forces in N, z upwards.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, cast

import numpy as np

from blocksim.blocks.assembly import SUPPORT
from blocksim.blocks.entries import (
    Coordinate,
    Fixed,
    Friction,
    Id,
    NewId,
    Newtons,
    Said,
    Step,
    Times,
    listed,
)
from blocksim.blocks.loads import LoadsOf, acting_of, given_joints, named_blocks
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import shaking_of
from blocksim.blocks.space.assembly import FaceJoint, Solid, SolidBlock, SpatialAssembly
from blocksim.blocks.space.joining import MOST_SOLIDS, assembly_in_space
from blocksim.blocks.space.polyhedron import frame
from blocksim.blocks.structure import record_of
from blocksim.common.checks import WEIGHT, require
from blocksim.common.tables import Written, as_said

MOST_CORNERS = 1000
"""Corners of a convex part."""
MOST_PARTS = 100
SPACE = 3
Point = tuple[Coordinate, Coordinate, Coordinate]
Way = tuple[Times, Times, Times]
Force = tuple[Newtons, Newtons, Newtons]
Corners = Annotated[list[Point], listed(1, MOST_CORNERS)]


@dataclass(frozen=True, kw_only=True)
class SolidEntry(Written):
    """Entry of `blocks` in space, as `BlockEntry` in the plane.

    `vertices`: Corners of a convex polyhedron [m], in any order.
    `polyhedra`: Convex parts that move as one block [m], instead of `vertices`.
    """

    id: NewId
    vertices: Corners | None = None
    polyhedra: Annotated[list[Corners], listed(1, MOST_PARTS)] | None = None
    fixed: Fixed = False
    weight: Annotated[float, WEIGHT] | None = None
    centre: Point | None = None


@dataclass(frozen=True, kw_only=True)
class FaceEntry(Written):
    """Entry of `joints` in space, as `JointEntry` in the plane.

    `points`: Corners of the polygon that both share, ends of a segment, or a point [m].
    """

    a: Id
    b: Id
    points: Corners
    normal: Way
    friction: Friction | None = None


@dataclass(frozen=True, kw_only=True)
class SpatialLoadEntry(Written):
    """Entry of `dead` or `live` in space, as `LoadEntry` in the plane, but along no patch."""

    body: Way | None = None
    blocks: Annotated[list[Id], listed(1, MOST_SOLIDS)] | None = None
    block: Id | None = None
    point: Point | None = None
    force: Force | None = None


@dataclass(frozen=True, kw_only=True)
class SpatialAround(Said):
    """What a structure file in space says besides its blocks, of the keys of `Around`.

    `dead`: Loads that stay as they are; by default gravity, `{"body": [0, 0, -1]}`.
    """

    dead: Annotated[list[SpatialLoadEntry], listed(0, MOST_SOLIDS)] | None = None
    live: Annotated[tuple[SpatialLoadEntry, ...], listed(0, MOST_SOLIDS)] = ()


AROUND = tuple(field.name for field in fields(SpatialAround))
"""Keys of a structure file in space that are not of its blocks."""


@dataclass(frozen=True, kw_only=True)
class SpatialFile(SpatialAround):
    """A structure file of blocks in space as written: the keys of `SpatialAround`, and these.

    `blocks`: At least two, one of them fixed.
    `joints`: By default found.
    `tolerance`: Gaps and overlaps up to this are closed [m], but no more than a tenth of the
        thinner block; by default what rounding explains.
    """

    blocks: Annotated[list[SolidEntry], listed(2, MOST_SOLIDS)]
    joints: Annotated[list[FaceEntry], listed(0, 20 * MOST_SOLIDS)] | None = None
    tolerance: Step | None = None


def is_spatial(data: object) -> bool:
    """Tell whether what a structure file says lies in space: its corners have three numbers.

    Examples
    --------
    >>> is_spatial({"blocks": [{"id": 0, "vertices": [[0, 0, 0]]}]})
    True
    """
    table = cast("dict[str, Any]", data) if isinstance(data, dict) else {}
    blocks = table.get("blocks")
    listed = cast("list[Any]", blocks) if isinstance(blocks, list) else []
    for block in listed[:MOST_SOLIDS]:
        own = cast("dict[str, Any]", block) if isinstance(block, dict) else {}
        if "polyhedra" in own:
            return True
        corners = own.get("vertices")
        if isinstance(corners, list) and corners:
            first: Any = cast("list[Any]", corners)[0]
            return isinstance(first, list) and len(cast("list[Any]", first)) == SPACE
    return False


def problem_in_space(data: object) -> Problem[SpatialAssembly]:
    """Make a problem of what a structure file in space says.

    `data`: A dict with the keys of `SpatialFile`.
    """
    written = as_said(SpatialFile, data, unknown="there is no such key in space")
    solids = _solids(written)
    assembly = assembly_in_space(
        solids,
        _joints(written, solids),
        density=written.unit_weight,
        tolerance=written.tolerance,
    )
    closed = [abs(each.gap) for each in assembly.joints if each.gap]
    notes: list[str] = []
    if closed and max(closed) > 1e-9 * assembly.size:
        notes.append(f"gaps and overlaps of up to {1000 * max(closed):.3g} mm closed")
    weighed = all(each.fixed or each.weight is not None for each in solids)
    made = problem_of_solids(written, solids, assembly)
    return replace(made, weighed=made.weighed or weighed, notes=(*made.notes, *notes))


def problem_of_solids(
    written: SpatialAround, solids: Sequence[Solid], assembly: SpatialAssembly
) -> Problem[SpatialAssembly]:
    """Make a problem of an assembly and of what a file says besides.

    `solids`: Of which the assembly was made, each with a name of its own.
    """
    acts = acting_of(written, LoadsOf(solids, SPACE), np.array(SpatialAssembly.down))
    made = acts.on(assembly, written.friction)
    if (shake := written.shake) is None:
        return made
    turn = math.radians(shake.azimuth_deg or 0.0)
    return replace(made, shaking=shaking_of(shake), azimuth=turn)


def _solids(written: SpatialFile) -> list[Solid]:
    return [
        Solid(
            parts=parts,
            name=name,
            fixed=block.fixed,
            weight=block.weight,
            centre=block.centre,
        )
        for block, name, parts in named_blocks(written.blocks, "polyhedra")
    ]


def _joints(written: SpatialFile, solids: Sequence[Solid]) -> list[FaceJoint] | None:
    if written.joints is None:
        return None
    joints: list[FaceJoint] = []
    for joint, a, b in given_joints(written.joints, solids, written.tolerance):
        long = float(np.linalg.norm(joint.normal))
        require(long > 0, f"joints[{len(joints)}].normal", joint.normal, "a direction")
        joints.append(
            FaceJoint(
                before=a,
                after=b,
                points=np.array(joint.points, dtype=float),
                normal=np.array(joint.normal, dtype=float) / long,
                friction=joint.friction,
            )
        )
    return joints


def solids_record(problem: Problem[SpatialAssembly]) -> dict[str, Any]:
    """Write a problem as a structure file in space does; `problem_in_space` reads it back."""

    def solid(block: SolidBlock) -> dict[str, Any]:
        hulls = [hull.corners.tolist() for hull in block.hulls]
        return {"polyhedra": hulls, "centre": block.centre.tolist()}

    blocks = problem.assembly.blocks
    return record_of(
        problem,
        block=lambda at: {**solid(blocks[at]), "weight": blocks[at].weight},
        bed=solid,
        ground=_ground,
        joint=lambda at: {"points": at.points.tolist(), "normal": at.normal.tolist()},
    )


def _ground(joint: FaceJoint) -> list[list[float]]:
    """Return the corners of a tetrahedron behind a joint with the ground."""
    out = joint.normal * (-1 if joint.before == SUPPORT else 1)
    middle = joint.points.mean(axis=0)
    long = float(np.ptp(joint.points, axis=0).max()) or 1.0
    one, other = frame(joint.normal)
    ways = [2 * one, other - one, -other - one, out]
    return [(middle + long * way).tolist() for way in ways]
