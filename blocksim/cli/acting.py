"""The options that say what acts on a structure, and what crosses it, each declared once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from blocksim.blocks.assembly import STANDARD_GRAVITY
from blocksim.blocks.shaking import COLUMNS, SHAPES, UPWARDS
from blocksim.cli.arguments import Option
from blocksim.cli.built import given_of
from blocksim.common.checks import GRAVITY, PUSH, TILT_DEG, Range

SOIL = (
    "fill_unit_weight", "fill_region", "fill_layer", "backing", "fill_friction_angle",
    "fill_pressure", "fill_passive",
)  # fmt: skip
"""Options that say what fill is made of."""


@dataclass(frozen=True, kw_only=True)
class Loading:
    """What acts besides gravity, as given on the command line; None where it is not."""

    heading: ClassVar[str] = "What acts on it"

    fill: Annotated[
        float | None,
        Option(
            about="Height of fill over the crown in m, or over the highest point of what has "
            "none.",
            range=Range(low=0, high=1000, unit="m"),
        ),
    ] = None
    fill_unit_weight: Annotated[
        float | None,
        Option(about="Unit weight of the fill in kN/m3; that of the blocks if left out."),
    ] = None
    fill_region: Annotated[
        list[tuple[float, float, float]] | None,
        Option(
            metavar="X1 X2 KN/M3",
            about="Other unit weight of the fill from x1 to x2 (m, as of --point-load); "
            "repeatable: on the left and on the right, of each span.",
        ),
    ] = None
    fill_layer: Annotated[
        list[tuple[float, float]] | None,
        Option(
            metavar="M KN/M3",
            about="Layer of the fill below the road: its thickness and unit weight; "
            "repeatable, from the road downwards.",
        ),
    ] = None
    backing: Annotated[
        tuple[float, float] | None,
        Option(
            metavar="M KN/M3",
            about="Backing over the haunches, up to a height over the lowest point of the "
            "extrados, and its unit weight.",
        ),
    ] = None
    fill_friction_angle: Annotated[
        float | None,
        Option(
            about="Angle of friction of the fill in degrees.",
            range=Range(low=0, high=math.nextafter(90, 0), unit="deg"),
        ),
    ] = None
    fill_pressure: Annotated[
        str | None,
        Option(
            metavar="K[,K]",
            about="Pressure of the fill from the side: at-rest, active, or a number, over the "
            "weight above; one, or those of the left and the right. None if left out.",
        ),
    ] = None
    fill_passive: Annotated[
        str | None,
        Option(
            metavar="SHARE[,SHARE]",
            about="Share of its passive resistance that the fill bears where it is moved into "
            "(limit); one, or those of the left and the right. None if left out.",
        ),
    ] = None
    point_load: Annotated[
        list[tuple[float, float]] | None,
        Option(
            metavar="X KN",
            about="Weight on the road at x (m from the crown of an arch; else from the "
            "structure's origin), live. It goes straight down to the block below, or as "
            "--dispersal says. Repeatable: an axle each.",
        ),
    ] = None
    patch_load: Annotated[
        list[tuple[float, float, float]] | None,
        Option(metavar="X1 X2 KN", about="The same, spread evenly from x1 to x2; repeatable."),
    ] = None
    dispersal: Annotated[
        str | None,
        Option(
            metavar="ACROSS:DOWN",
            about="How fill spreads loads on the road: 1:2, evenly over half the depth to each "
            "side; or boussinesq, up to 30 deg from the vertical. Not at all if left out.",
        ),
    ] = None
    strength: Annotated[
        float | None,
        Option(
            about="Compressive strength of the blocks in MPa: they crush where joints press by "
            "more (limit). Blocks are rigid if left out.",
            range=Range(low=0, high=1e3, unit="MPa", above=True),
        ),
    ] = None
    load: Annotated[
        float | None,
        Option(
            about="Factor on the live loads; if left out 1 with --point-load or --patch-load, "
            "else what the file says."
        ),
    ] = None
    push: Annotated[
        float | None,
        Option(
            about="Push sideways in g, over the weight of each block, to the side to which it "
            "bears less.",
            range=PUSH,
        ),
    ] = None
    spread: Annotated[
        float | None,
        Option(
            about="How far the supports have moved apart in m, or as `move` in the file says.",
            range=Range(low=0, high=1000, unit="m"),
        ),
    ] = None
    tilt: Annotated[
        float | None,
        Option(
            about="Tilt of the table in the plane, in degrees: its right side goes down.",
            range=TILT_DEG,
        ),
    ] = None
    azimuth: Annotated[
        float | None,
        Option(
            about="Of blocks in space: towards where the table tilts, in degrees from x "
            "towards y; 0 if left out.",
            range=TILT_DEG,
        ),
    ] = None
    gravity: Annotated[
        float | None,
        Option(
            about=f"Acceleration of gravity in m/s2, {STANDARD_GRAVITY:g} if left out. Masses "
            "stay: weights that are given are those at that one.",
            range=GRAVITY,
        ),
    ] = None
    shake: Annotated[
        str | None,
        Option(
            metavar="SHAPE|FILE",
            about=f"Ground that shakes: {', '.join(SHAPES)}, or a .csv file "
            f"({','.join(COLUMNS)}, and {UPWARDS} where it goes up and down, too); does it "
            "survive?",
        ),
    ] = None
    amplitude: Annotated[
        float | None, Option(about="Largest acceleration of the ground, in g.")
    ] = None
    duration: Annotated[float | None, Option(about="How long the ground shakes, in s.")] = None

    @property
    def given(self) -> bool:
        """Whether there is any of it."""
        return self != Loading()

    @property
    def on_road(self) -> dict[str, object]:
        """Those that lie on the road; empty where none is given."""
        return given_of(self, "fill", *SOIL, "point_load", "patch_load", "dispersal")


@dataclass(frozen=True, kw_only=True)
class Crossed:
    """The options of a vehicle that crosses, as given on the command line."""

    heading: ClassVar[str] = "What crosses it"

    vehicle: Annotated[
        str | None,
        Option(
            metavar="NAME|FILE|AXLES",
            about="Vehicle on the road, both ways: a shipped name (blocksim scenarios), a "
            ".toml file, or axles in kN at m, as 10@0,10@1.2.",
        ),
    ] = None
    along: Annotated[
        Literal["road"] | None, Option(about="Where it goes; on the road if left out.")
    ] = None
    out: Annotated[
        list[Path] | None,
        Option(
            about="A file to write; repeatable. With --vehicle: .csv, load factor and thrust "
            "at every place; .pdf, .svg, .png, their curve above the worst place; .dxf, the "
            "drawing at the worst place. Over push or spread: .csv, .pdf, .svg, .png of the "
            "push that is borne, or the thrust, as it moves."
        ),
    ] = None
