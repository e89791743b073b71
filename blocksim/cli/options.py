"""The options that questions share, each declared once."""

from __future__ import annotations

import math
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from blocksim.arch.dimensions import LINES, friction_of
from blocksim.ask.families import FAMILIES
from blocksim.ask.methods import CHOICES
from blocksim.blocks.shaking import COLUMNS, SHAPES
from blocksim.cli.arguments import Argument, Option
from blocksim.common.checks import (
    FRICTION_ANGLE,
    LEAN_DEG,
    PUSH,
    RATIO,
    TILT_DEG,
    Range,
    require,
)
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.common.files import json_of
from blocksim.simulation.simulated import SETTINGS
from blocksim.simulation.verdict import Verdict

Scene = Annotated[
    str | None,
    Argument(
        about="Scenario of an arch, a .toml file or a shipped name; or a structure: a file, "
        ".json or .toml, or a kind: its name (blocksim kinds), or module:CLASS of your own."
    ),
]
EXIT_CODES = {Verdict.STANDS: 0, Verdict.COLLAPSES: 1, Verdict.UNDECIDED: 3}
OWN = ", or an engine of your own: its name, or module:ENGINE"
MethodOption = Annotated[str, Option(about=f"{', '.join(CHOICES)}{OWN}.")]
Over = Annotated[
    str | None,
    Option(about=f"Parameter: {', '.join(FAMILIES)}; thickness, of arches, if left out."),
]
Within = Annotated[
    tuple[float, float] | None,
    Option(
        metavar="LOW HIGH",
        about="Where an engine searches, instead of where limit analysis says. Other methods "
        "search nowhere and refuse it.",
    ),
]
Set = Annotated[
    list[str] | None,
    Option(
        name="--set",
        metavar="NAME=VALUE",
        about=f"Setting of the engine instead of its rule; repeatable: {', '.join(SETTINGS)}.",
    ),
]
Reduce = Annotated[
    bool | None,
    Option(
        name="--reduce/--no-reduce",
        about="Simulate blocks that stay together as one, and half of an arch: pymunk does, "
        "pybullet does with arches.",
    ),
]
MustRest = Annotated[
    bool,
    Option(
        name="--must-rest",
        about="Find out as well whether it must rest, or friction may let it move: "
        "a second with 8 joints, ten with 28.",
    ),
]
ProofFile = Annotated[
    Path | None,
    Option(
        name="--proof",
        about="Write proofs of the answer by limit, JSON, which blocksim verify checks.",
    ),
]
Spatial = Annotated[
    bool,
    Option(
        name="--spatial",
        about="Ask in space: blocks of the plane are prisms, which may lean out of it.",
    ),
]
AtJoint = Annotated[
    str | None,
    Option(
        name="--joint",
        metavar="A-B",
        about="Joint whose thrust is printed, named by its two blocks; the crown if left out.",
    ),
]
Json = Annotated[bool, Option(name="--json", about="Print one JSON object, nothing else.")]


THICKNESS = "thickness"
"""The parameter of `bracket` that is left out: of arches."""
SOIL = (
    "fill_unit_weight", "fill_region", "fill_layer", "backing", "fill_friction_angle",
    "fill_pressure", "fill_passive",
)  # fmt: skip
"""Options that say what fill is made of."""
OF_ANY = {"mu", "friction_angle", "unit_weight", "lean", "parameters", "tolerance", "depth",
          "unit", "layer", "snap"}  # fmt: skip
"""Options that say how anything is built, not only an arch."""
LARGEST_FRICTION = 10.0
"""Coefficient above which, up to 90, one is taken for an angle."""


@dataclass(frozen=True, kw_only=True)
class Given:
    """The options that say what is built, as given; None where they are not.

    All but those of `OF_ANY` are of symmetric circular arches.
    """

    heading: ClassVar[str] = "What is built"

    alpha: Annotated[
        float | None, Option(about="Half-angle of embrace in degrees, 0 to 180.")
    ] = None
    eta: Annotated[float | None, Option(about="Thickness-to-radius ratio, up to 2.")] = None
    span: Annotated[
        float | None,
        Option(about="Instead of --alpha and --eta: distance between the springings in m."),
    ] = None
    rise: Annotated[
        float | None, Option(about="Beside --span: height of the crown above them in m.")
    ] = None
    thickness: Annotated[
        float | None, Option(about="Beside --span: thickness of the arch in m.")
    ] = None
    at: Annotated[
        str | None,
        Option(
            metavar="LINE",
            about=f"Line of --span and --rise: {', '.join(LINES)}; the intrados if left out, "
            "which gives the clear span.",
        ),
    ] = None
    ratio: Annotated[
        float | None,
        Option(
            about="Instead of --eta or --thickness: thickness over the least one that stands, "
            "as built.",
            range=RATIO,
        ),
    ] = None
    mu: Annotated[float | None, Option(about="Friction coefficient, above 0; inf allowed.")] = (
        None
    )
    friction_angle: Annotated[
        float | None,
        Option(about="Instead of --mu: angle of friction in degrees.", range=FRICTION_ANGLE),
    ] = None
    voussoirs: Annotated[
        int | None, Option(about="Number of voussoirs, 3 to 10000; 27 if left out.")
    ] = None
    weight: Annotated[
        str | None,
        Option(
            about="Where weight acts: centreline, or sector, as it does in true voussoirs. "
            "If left out: sector with --span, else centreline."
        ),
    ] = None
    unit_weight: Annotated[
        float | None,
        Option(about="Unit weight of the blocks in kN/m3; 20 in arches if left out."),
    ] = None
    depth: Annotated[
        float | None,
        Option(about="Depth out of the plane in m; 1 if left out."),
    ] = None
    lean: Annotated[
        float | None,
        Option(
            about="Angle by which gravity leans out of the plane, in degrees.", range=LEAN_DEG
        ),
    ] = None
    parameters: Annotated[
        list[str] | None,
        Option(
            name="--with",
            metavar="NAME=VALUE",
            about="Parameter of a kind of structure (blocksim kinds NAME lists them); "
            "repeatable.",
        ),
    ] = None
    tolerance: Annotated[
        float | None,
        Option(
            about="Mortar joints, gaps and overlaps of a drawing up to this are closed, in m; "
            "what rounding of its coordinates explains if left out."
        ),
    ] = None
    unit: Annotated[
        str | None,
        Option(
            about="Of a drawing that has none: m, mm, cm, dm, in, ft, or metres that a unit is."
        ),
    ] = None
    layer: Annotated[
        list[str] | None,
        Option(
            metavar="ROLE=NAME",
            about="Layer of a drawing that is read as blocks or as supports, or is ignored; "
            "repeatable. If left out, layers of these names are.",
        ),
    ] = None
    snap: Annotated[
        float | None,
        Option(
            about="Ends of lines of a drawing that are so near are one corner, in m; 1e-4 of "
            "the shorter line if left out."
        ),
    ] = None

    @property
    def of_arches(self) -> dict[str, object]:
        """Those that say how an arch is built."""
        return {name: each for name, each in asdict(self).items() if name not in OF_ANY}

    @property
    def drawn(self) -> dict[str, object]:
        """Those of drawings, by option; empty where none is given."""
        named = {"--tolerance": self.tolerance, "--unit": self.unit,
                 "--layer": self.layer, "--snap": self.snap}  # fmt: skip
        return {name: each for name, each in named.items() if each is not None}

    @property
    def measured(self) -> dict[str, object]:
        """Those that give an arch in metres; empty where none is given."""
        return _given(self, "span", "rise", "thickness", "at")

    @property
    def friction(self) -> float | None:
        """Friction coefficient, given as such or as an angle.

        Raises
        ------
        InputError
            If both are given, or one is out of range or looks like the other.
        """
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


@dataclass(frozen=True, kw_only=True)
class Loading:
    """What acts besides gravity, as given on the command line; None where it is not.

    What is on the road, fill or loads, goes straight down to the blocks below.
    """

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
    shake: Annotated[
        str | None,
        Option(
            metavar="SHAPE|FILE",
            about=f"Ground that shakes: {', '.join(SHAPES)}, or a .csv file "
            f"({','.join(COLUMNS)}); does it survive?",
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
        return _given(self, "fill", *SOIL, "point_load", "patch_load", "dispersal")


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


def _given(options: object, *names: str) -> dict[str, object]:
    """Return those of some options that are given."""
    found = {name: getattr(options, name) for name in names}
    return {name: each for name, each in found.items() if each is not None}


def require_given(instead: str = "", /, **options: object) -> None:
    """Name all options that are missing at once, and what may stand in their place."""
    absent = [name for name, value in options.items() if value is None]
    if absent:
        named = [option_of(name) for name in absent]
        listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
        raise InputError(listed, MISSING if len(named) == 1 else ALL_MISSING, f"given{instead}")


def option_of(field: str) -> str:
    """Return the option of a field."""
    return NAMED.get(field) or f"--{field.replace('_', '-')}"


def parameters_of(given: list[str] | None) -> dict[str, object]:
    """Read what `--with` gives: numbers, words, or JSON."""
    found: dict[str, object] = {}
    for each in given or ():
        name, equals, value = each.partition("=")
        ok = bool(name and equals and value) and name != "kind"
        require(ok, "--with", each, "name=value, with a parameter of the kind")
        require(name not in found, "--with", each, f"given once for {name}")
        try:
            found[name] = json_of(value.encode())
        except ValueError:
            found[name] = value
    return found


def settings_of(given: list[str] | None) -> dict[str, float]:
    """Read what `--set` gives."""
    settings: dict[str, float] = {}
    for each in given or ():
        name, _, value = each.partition("=")
        allowed = f"name=value, with a number and one of {', '.join(SETTINGS)}"
        require(name in SETTINGS, "--set", each, allowed)
        require(name not in settings, "--set", each, f"given once for {name}")
        try:
            settings[name] = float(value)
        except ValueError:
            raise InputError("--set", each, allowed) from None
    return settings


NAMED = {"parameters": "--with", "half_angle_deg": "--alpha", "friction": "--mu"}
"""Options that are not called as their fields."""
OPTIONS = {
    *NAMED,
    *(each.name for group in (Given, Loading, Crossed) for each in fields(group)),
    *("must_rest", "over", "within", "method", "tol", "reduce"),
}
"""Fields that are options, too."""


@contextmanager
def named_options() -> Generator[None]:
    """Name the option, not the field, in what is said of wrong input."""
    try:
        yield
    except InputError as error:
        if error.where is None and error.field in OPTIONS:
            raise InputError(option_of(error.field), error.value, error.allowed) from None
        if error.where is None and error.field.startswith("settings"):
            _, _, name = error.field.partition(".")
            value = f"{name}={error.value:g}" if name else error.value
            raise InputError("--set", value, error.allowed) from None
        raise
