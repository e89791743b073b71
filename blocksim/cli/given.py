"""The options that say what is built, what acts on it and crosses it, each declared once."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import ClassVar, Literal

from blocksim.arch.dimensions import LINES, friction_of
from blocksim.blocks.assembly import STANDARD_GRAVITY
from blocksim.blocks.shaking import COLUMNS, SHAPES, UPWARDS
from blocksim.cli.arguments import option
from blocksim.common.checks import (
    FRICTION_ANGLE,
    GRAVITY,
    LEAN_DEG,
    PUSH,
    RATIO,
    TILT_DEG,
    Range,
    require,
)
from blocksim.common.fields import same

OF_ANY = {"mu", "friction_angle", "unit_weight", "lean", "parameters", "tolerance", "depth",
          "unit", "layer", "snap", "up"}  # fmt: skip
"""Options that say how anything is built, not only an arch."""
PARAMETERS = {"alpha": "half_angle_deg"}
"""Options that are not called as the parameter that they give."""
LARGEST_FRICTION = 10.0
"""Coefficient above which, up to 90, one is taken for an angle."""

MU = option("Friction coefficient, 0 or more (above 0 with --alpha or --span); inf allowed.")
DEPTH = option("Depth out of the plane in m; 1 if left out.")
TOLERANCE = option(
    "Mortar joints, gaps and overlaps of a drawing up to this are closed, in m; "
    "what rounding of its coordinates explains if left out."
)
UNIT = option("Of a drawing that has none: m, mm, cm, dm, in, ft, or metres that a unit is.")
LAYER = option(
    "Layer of a drawing that is read as blocks or as supports, or is ignored; "
    "repeatable. If left out, layers of these names are.",
    metavar="ROLE=NAME",
)
SNAP = option(
    "Ends of lines of a drawing that are so near are one corner, in m; 1e-4 of "
    "the shorter line if left out."
)
UP = option("Coordinate of a mesh that points upwards, y or z; z if left out, in GLB y.")


@dataclass(frozen=True, kw_only=True)
class Given:
    """Options that say what is built. Those not given are None.

    All but those of `OF_ANY` are parameters of the circular arch, and of each kind that has
    one of that name.
    """

    heading: ClassVar[str] = "What is built"

    alpha: float | None = option("Half-angle of embrace in degrees, 0 to 180.")
    eta: float | None = option("Thickness-to-radius ratio, up to 2.")
    span: float | None = option(
        "Instead of --alpha and --eta: distance between the springings in m."
    )
    rise: float | None = option("Beside --span: height of the crown above them in m.")
    thickness: float | None = option("Beside --span: thickness of the arch in m.")
    at: str | None = option(
        f"Line of --span and --rise: {', '.join(LINES)}; the intrados if left out, "
        "which gives the clear span.",
        metavar="LINE",
    )
    ratio: float | None = option(
        "Instead of --eta or --thickness: thickness over the least one that stands, as built.",
        range=RATIO,
    )
    mu: float | None = MU
    friction_angle: float | None = option(
        "Instead of --mu: angle of friction in degrees.", range=FRICTION_ANGLE
    )
    voussoirs: int | None = option("Number of voussoirs, 3 to 10000; 27 if left out.")
    weight: str | None = option(
        "Where weight acts: centreline, or sector, as it does in true voussoirs. "
        "If left out: sector with --span, else centreline."
    )
    unit_weight: float | None = option(
        "Unit weight of the blocks in kN/m3; 20 in arches if left out."
    )
    depth: float | None = DEPTH
    lean: float | None = option(
        "Angle by which gravity leans out of the plane, in degrees.", range=LEAN_DEG
    )
    parameters: list[str] | None = option(
        "Parameter of a kind of structure (blocksim kinds NAME lists them); repeatable.",
        name="--with",
        metavar="NAME=VALUE",
    )
    tolerance: float | None = TOLERANCE
    unit: str | None = UNIT
    layer: list[str] | None = LAYER
    snap: float | None = SNAP
    up: str | None = UP

    @property
    def sizes(self) -> dict[str, object]:
        """Those that are parameters of a kind, friction among them, by its name of each."""
        names = [one.name for one in fields(self) if one.name not in OF_ANY]
        found = given_of(self, *names, "friction")
        return {PARAMETERS.get(name, name): each for name, each in found.items()}

    @property
    def drawn(self) -> dict[str, object]:
        """Options given of drawings."""
        return given_of(self, "tolerance", "unit", "layer", "snap", "up")

    @property
    def measured(self) -> dict[str, object]:
        """Options given of an arch in metres."""
        return given_of(self, "span", "rise", "thickness", "at")

    @property
    def friction(self) -> float | None:
        """Friction coefficient, given as such or as an angle."""
        mu, angle = self.mu, self.friction_angle
        if angle is None:
            slip = mu is not None and LARGEST_FRICTION < mu < 90
            words = f"a coefficient: as an angle it would be --friction-angle {mu or 0:g}"
            require(not slip, "--mu", mu, words)
            return mu
        require(mu is None, "--friction-angle", angle, "left out where --mu is given")
        smooth = angle < math.pi / 2
        words = f"in degrees: as a coefficient it would be --mu {angle:g}, in radians "
        words += f"--friction-angle {math.degrees(angle):.4g}"
        require(not smooth, "--friction-angle", angle, words)
        return friction_of(angle)


def given_of(options: object, *names: str) -> dict[str, object]:
    """Return those of some options that are given."""
    return {name: each for name, each in same(options, *names).items() if each is not None}


SOIL = (
    "fill_unit_weight", "fill_region", "fill_layer", "backing", "fill_friction_angle",
    "fill_pressure", "fill_passive",
)  # fmt: skip
"""Options that say what fill is made of."""


@dataclass(frozen=True, kw_only=True)
class Loading:
    """Options that say what acts besides gravity. Those not given are None."""

    heading: ClassVar[str] = "What acts on it"

    fill: float | None = option(
        "Height of fill over the crown in m, or over the highest point of what has none.",
        range=Range(low=0, high=1000, unit="m"),
    )
    fill_unit_weight: float | None = option(
        "Unit weight of the fill in kN/m3; that of the blocks if left out."
    )
    fill_region: list[tuple[float, float, float]] | None = option(
        "Other unit weight of the fill from x1 to x2 (m, as of --point-load); "
        "repeatable: on the left and on the right, of each span.",
        metavar="X1 X2 KN/M3",
    )
    fill_layer: list[tuple[float, float]] | None = option(
        "Layer of the fill below the road: its thickness and unit weight; "
        "repeatable, from the road downwards.",
        metavar="M KN/M3",
    )
    backing: tuple[float, float] | None = option(
        "Backing over the haunches, up to a height over the lowest point of the "
        "extrados, and its unit weight.",
        metavar="M KN/M3",
    )
    fill_friction_angle: float | None = option(
        "Angle of friction of the fill in degrees.",
        range=Range(low=0, high=math.nextafter(90, 0), unit="deg"),
    )
    fill_pressure: str | None = option(
        "Pressure of the fill from the side: at-rest, active, or a number, over the "
        "weight above; one, or those of the left and the right. None if left out.",
        metavar="K[,K]",
    )
    fill_passive: str | None = option(
        "Share of its passive resistance that the fill bears where it is moved into "
        "(limit); one, or those of the left and the right. None if left out.",
        metavar="SHARE[,SHARE]",
    )
    point_load: list[tuple[float, float]] | None = option(
        "Weight on the road at x (m from the crown of an arch; else from the "
        "structure's origin), live. It goes straight down to the block below, or as "
        "--dispersal says. Repeatable: an axle each.",
        metavar="X KN",
    )
    patch_load: list[tuple[float, float, float]] | None = option(
        "The same, spread evenly from x1 to x2; repeatable.", metavar="X1 X2 KN"
    )
    dispersal: str | None = option(
        "How fill spreads loads on the road: 1:2, evenly over half the depth to each "
        "side; or boussinesq, up to 30 deg from the vertical. Not at all if left out.",
        metavar="ACROSS:DOWN",
    )
    strength: float | None = option(
        "Compressive strength of the blocks in MPa: they crush where joints press by "
        "more (limit). Blocks are rigid if left out.",
        range=Range(low=0, high=1e3, unit="MPa", above=True),
    )
    load: float | None = option(
        "Factor on the live loads; if left out 1 with --point-load or --patch-load, "
        "else what the file says."
    )
    push: float | None = option(
        "Push sideways in g, over the weight of each block, to the side to which it "
        "bears less; in space towards --azimuth.",
        range=PUSH,
    )
    spread: float | None = option(
        "How far the supports have moved apart in m, or as `move` in the file says.",
        range=Range(low=0, high=1000, unit="m"),
    )
    tilt: float | None = option(
        "Tilt of the table in the plane, in degrees: its right side goes down.", range=TILT_DEG
    )
    azimuth: float | None = option(
        "Beside --tilt, --push or --shake, of blocks in space: towards where, in degrees "
        "from x towards y; 0 if left out.",
        range=TILT_DEG,
    )
    gravity: float | None = option(
        f"Acceleration of gravity in m/s2, {STANDARD_GRAVITY:g} if left out. Masses "
        "stay: weights that are given are those at that one.",
        range=GRAVITY,
    )
    shake: str | None = option(
        f"Ground that shakes: {', '.join(SHAPES)}, or a .csv file "
        f"({','.join(COLUMNS)}, and {UPWARDS} where it goes up and down, too); does it "
        "survive?",
        metavar="SHAPE|FILE",
    )
    amplitude: float | None = option("Largest acceleration of the ground, in g.")
    duration: float | None = option("How long the ground shakes, in s.")

    @property
    def given(self) -> bool:
        """Whether there is any of it."""
        return self != Loading()

    @property
    def on_road(self) -> dict[str, object]:
        """Options given of what lies on the road."""
        return given_of(self, "fill", *SOIL, "point_load", "patch_load", "dispersal")


@dataclass(frozen=True, kw_only=True)
class Crossed:
    """The options of a vehicle that crosses, as given on the command line."""

    heading: ClassVar[str] = "What crosses it"

    vehicle: str | None = option(
        "Vehicle on the road, both ways: a shipped name (blocksim scenarios), a "
        ".toml file, or axles in kN at m, as 10@0,10@1.2.",
        metavar="NAME|FILE|AXLES",
    )
    along: Literal["road"] | None = option("Where it goes; on the road if left out.")
    out: list[Path] | None = option(
        "A file to write; repeatable. With --vehicle: .csv, load factor and thrust "
        "at every place; .pdf, .svg, .png, their curve above the worst place; .dxf, the "
        "drawing at the worst place. Over push or spread: .csv, .pdf, .svg, .png of the "
        "push that is borne, or the thrust, as it moves."
    )
