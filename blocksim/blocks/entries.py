"""What a structure file may say: its keys, their types and ranges."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any, Literal

from pydantic import Field

from blocksim.blocks.polygons import MOST_BLOCKS
from blocksim.blocks.shaking import MOST_ROWS
from blocksim.blocks.shapes import MOST_CORNERS
from blocksim.common.checks import (
    AXLE,
    COORDINATE,
    ETA,
    FACTOR,
    FORCE,
    INERTIA,
    LENGTH,
    MOST_AXLES,
    PER_VOLUME,
    SMOOTH_OR_ROUGH,
    TURN,
    VELOCITY,
    WEIGHT,
    Range,
)
from blocksim.common.tables import Words, Written

Number = Annotated[float, Range(low=-1e15, high=1e15)]
"""One in a file that has no unit of its own."""
Coordinate = Annotated[float, COORDINATE]
Newtons = Annotated[float, FORCE]
Times = Annotated[float, FACTOR]
Length = Annotated[float, LENGTH]
Step = Annotated[float, Range(low=0, high=LENGTH.high, unit="m")]
Density = Annotated[float, PER_VOLUME]
SPIN = Range(low=-5e5, high=5e5, unit="deg/s")
Speed = Annotated[float, VELOCITY]
Friction = Annotated[float, SMOOTH_OR_ROUGH]
Point = tuple[Coordinate, Coordinate]
Force = tuple[Newtons, Newtons]
Way = tuple[Times, Times]
Corners = Annotated[list[Point], Field(min_length=3, max_length=MOST_CORNERS)]
Name = Annotated[str, Field(min_length=1, max_length=100, strict=True)]
_Any = Annotated[int, Field(strict=True, ge=-(10**9), le=10**9)] | Name
Id = Annotated[_Any, Words("the id of a block")]
NewId = Annotated[_Any, Words("a whole number or a name of up to 100 characters")]
Note = Annotated[str, Field(max_length=2000, strict=True)]
Fixed = Annotated[bool, Field(strict=True)]
MOST_NOTES = 20


def listed(least: int, most: int) -> Any:
    """Return what says how many entries a list may have."""
    return Field(min_length=least, max_length=most)


@dataclass(frozen=True, kw_only=True)
class BlockEntry(Written):
    """Entry of `blocks`: `vertices`, or `polygons` that move as one; see `Body`.

    `id`: Names the block, once in a file.
    `vertices`: Its corners [m], in order around it; where it is not convex it is cut into
        parts.
    `polygons`: Convex parts that move as one block [m], instead of `vertices`.
    `fixed`: Whether it is a support.
    `weight`: [N]; by default density times area times depth.
    `centre`: Where its weight acts [m]; by default the centroid.
    `inertia`: About its centre [kg m2]; by default that of the polygon.
    `depth`: Length out of the plane [m].
    `velocity`: Of its centre as it is let go [m/s]; by default it begins at rest.
    `spin_deg_s`: Its rotation per second then, counter-clockwise [deg/s].
    `free`: Whether nothing has to hold it, as before it lands.
    """

    id: NewId
    vertices: Corners | None = None
    polygons: Annotated[list[Corners], Field(min_length=1, max_length=MOST_CORNERS)] | None = (
        None
    )
    fixed: Fixed = False
    weight: Annotated[float, WEIGHT] | None = None
    centre: Point | None = None
    inertia: Annotated[float, INERTIA] | None = None
    depth: Length = 1.0
    velocity: tuple[Speed, Speed] = (0.0, 0.0)
    spin_deg_s: Annotated[float, SPIN] = 0.0
    free: Fixed = False


@dataclass(frozen=True, kw_only=True)
class JointEntry(Written):
    """Entry of `joints`: two ends, or one and a `normal` from `a` into `b`.

    `a`, `b`: The two blocks.
    `ends`: Both ends of the joint [m], or the corner that rests on a face.
    `normal`: Direction from `a` into `b`, where there is one end.
    `friction`: Of this joint, instead of that of the file; 0 allowed.
    `faces`: Faces of `a` and `b` that meet in it, two points each [m], where they are known.
    """

    a: Id
    b: Id
    ends: Annotated[list[Point], Field(min_length=1, max_length=2)]
    normal: Way | None = None
    friction: Friction | None = None
    faces: tuple[tuple[Point, Point], tuple[Point, Point]] | None = None


@dataclass(frozen=True, kw_only=True)
class LoadEntry(Written):
    """Entry of `dead` or `live`: a `body` force, or a `force` on a block or along a `patch`.

    `body`: Force on every block, in units of its weight: across, up, and out of the plane.
    `blocks`: Those `body` acts on; by default all that move.
    `block`: The one a `force` acts on.
    `point`: Where it acts [m]; by default the block's centre.
    `force`: Across and up [N].
    `patch`: From one x to another [m]: what lies uppermost there bears the force, evenly.
    """

    body: Annotated[list[Times], Field(min_length=2, max_length=3)] | None = None
    blocks: Annotated[list[Id], Field(min_length=1, max_length=MOST_BLOCKS)] | None = None
    block: Id | None = None
    point: Point | None = None
    force: Force | None = None
    patch: Point | None = None


@dataclass(frozen=True, kw_only=True)
class MoveEntry(Written):
    """Entry of `move`: how a fixed block moves as the parameter [m] grows.

    `block`: A fixed block.
    `direction`: Its way over the parameter: [1, 0] moves it to the right by as much.
    `turn_deg`: Its rotation, counter-clockwise [deg/m].
    `about`: What it turns about [m]; by default the middle of its corners.
    """

    block: Id
    direction: Way | None = None
    turn_deg: Annotated[float, TURN] = 0.0
    about: Point | None = None


@dataclass(frozen=True, kw_only=True)
class ShakeEntry(Written):
    """`shake`: a shape, how strong [g] and how long [s]; or accelerations [g] over time [s].

    `shape`: `constant`, `half-sine` or `full-sine`.
    `amplitude_g`: Its largest acceleration across [g].
    `duration_s`: [s]
    `times_s`: Times of a record [s], growing.
    `accelerations_g`: The acceleration across at each of them [g].
    `verticals_g`: The acceleration upwards at each of them [g]; by default none.
    `azimuth_deg`: In space: towards where across is, from x towards y; by default x.
    """

    shape: str | None = None
    amplitude_g: Number | None = None
    duration_s: Number | None = None
    times_s: Annotated[list[Number], Field(max_length=MOST_ROWS)] | None = None
    accelerations_g: Annotated[list[Number], Field(max_length=MOST_ROWS)] | None = None
    verticals_g: Annotated[list[Number], Field(max_length=MOST_ROWS)] | None = None
    azimuth_deg: Annotated[float, TURN] | None = None


@dataclass(frozen=True, kw_only=True)
class ExpectEntry(Written):
    """Entry of `expect`: what the source says, for `validate`.

    Either a `verdict` on the structure as it is, or the `value` of `over`, or the `modes` of a
    circular arch.

    `over`: A parameter of `bracket`.
    `value`: Where it changes from standing to falling.
    `published`: That value with the digits that were printed.
    `hinges`: Joints that open there, numbered from 0.
    `verdict`: `stands` or `collapses`, of the structure as it is.
    `modes`: Collapse modes of the continuous arch: several where it lies on a line of the map.
    `eta`: Its least thickness-to-radius ratio; absent where none stands.
    """

    over: Name | None = None
    value: Number | None = None
    published: Annotated[str, Field(pattern=r"^-?\d+(\.\d+)?$", strict=True)] | None = None
    hinges: tuple[Annotated[int, Field(ge=0, strict=True)], ...] = ()
    verdict: Literal["stands", "collapses"] | None = None
    modes: Annotated[tuple[Name, ...], Field(min_length=1)] | None = None
    eta: Annotated[float, ETA] | None = None


@dataclass(frozen=True, kw_only=True)
class Said(Written):
    """What structure files say in the plane and in space alike; see `Around`."""

    friction: Friction
    title: Annotated[str, Field(max_length=200, strict=True)] = ""
    source: Annotated[str, Field(max_length=500, strict=True)] = ""
    density: Density | None = None
    load: Times = 0.0
    shake: ShakeEntry | None = None
    notes: Annotated[tuple[Note, ...], Field(max_length=MOST_NOTES)] = ()
    expect: Annotated[tuple[ExpectEntry, ...], Field(max_length=MOST_BLOCKS)] = ()
    quick: Annotated[bool, Field(strict=True)] = False

    @property
    def unit_weight(self) -> float:
        """Weight of a unit of volume [N/m^3]."""
        return UNIT_WEIGHT if self.density is None else self.density


@dataclass(frozen=True, kw_only=True)
class Around(Said):
    """What a structure file says besides its blocks: friction, weight and loads.

    `friction`: Friction coefficient of every joint.
    `title`: Said with each answer.
    `source`: Where the structure and what is known of it come from.
    `density`: Weight of a unit of volume [N/m3]; without it only ratios of forces have a
        meaning.
    `dead`: Loads that stay as they are; by default gravity, `{"body": [0, -1]}`.
    `live`: Loads that are multiplied by the load factor.
    `move`: How supports move, for `--over spread`.
    `shake`: How the ground moves.
    `load`: Factor on the live loads when it is asked whether it stands.
    `size`: Length that displacements are compared with [m]; by default half the larger side of
        the box around all blocks that move.
    `notes`: How the file was made of another; said with each answer.
    `expect`: What its source says, for `validate`.
    `quick`: Whether `validate --quick` asks it.
    """

    dead: Annotated[list[LoadEntry], Field(max_length=MOST_BLOCKS)] | None = None
    live: Annotated[tuple[LoadEntry, ...], Field(max_length=MOST_BLOCKS)] = ()
    move: Annotated[tuple[MoveEntry, ...], Field(max_length=MOST_BLOCKS)] = ()
    size: Length | None = None


@dataclass(frozen=True, kw_only=True)
class VehicleFile(Written):
    """A file of a vehicle.

    `axles`: Place [m] and weight [kN] of each.
    `title`: Said with each answer.
    `source`: Where what is known of it comes from.
    """

    axles: Annotated[list[tuple[Coordinate, Annotated[float, AXLE]]], listed(1, MOST_AXLES)]
    title: Note = ""
    source: Note = ""


UNIT_WEIGHT = 1.0
"""Where none is given, so that only ratios of forces have a meaning [N/m^3]."""
AROUND = tuple(field.name for field in fields(Around))
"""Keys of a structure file that are not of its blocks."""


@dataclass(frozen=True, kw_only=True)
class StructureFile(Around):
    """A structure file of blocks as written: the keys of `Around`, and these.

    `blocks`: At least two, one of them fixed.
    `joints`: By default found: where faces lie on each other, and where corners rest on a face.
    `tolerance`: Gaps and overlaps up to this are closed where joints are found [m], but no more
        than a quarter of the narrower block; by default what rounding explains.
    `rounding`: Step to which corners were rounded [m]; by default as their decimals say, up to
        twelve.
    """

    blocks: Annotated[list[BlockEntry], Field(min_length=2, max_length=MOST_BLOCKS)]
    joints: Annotated[list[JointEntry], Field(max_length=20 * MOST_BLOCKS)] | None = None
    tolerance: Step | None = None
    rounding: Step | None = None
