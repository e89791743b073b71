"""The options that questions share, each declared once."""

from __future__ import annotations

import json
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Annotated

import typer

from blocksim.ask.families import FAMILIES
from blocksim.ask.methods import CHOICES
from blocksim.blocks.shaking import COLUMNS, SHAPES
from blocksim.common.checks import require
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.evidence.simulation import SETTINGS
from blocksim.evidence.verdict import Verdict

Scene = Annotated[
    str | None,
    typer.Argument(
        help="Scenario of an arch, a .toml file or a shipped name; or a structure: a file, "
        ".json or .toml, or the name of a kind (blocksim kinds)."
    ),
]
EXIT_CODES = {Verdict.STANDS: 0, Verdict.COLLAPSES: 1, Verdict.UNDECIDED: 3}
MethodOption = Annotated[str, typer.Option(help=f"{', '.join(CHOICES)}.")]
Over = Annotated[
    str | None,
    typer.Option(help=f"Parameter: {', '.join(FAMILIES)}; thickness, of arches, if left out."),
]
Within = Annotated[
    tuple[float, float] | None,
    typer.Option(
        metavar="LOW HIGH", help="Where to search, instead of where limit analysis says."
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help=f"Setting of the engine instead of its rule; repeatable: {', '.join(SETTINGS)}.",
    ),
]
Reduce = Annotated[
    bool,
    typer.Option("--reduce", help="Simulate half the arch, in no more blocks than it takes."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]


@dataclass(frozen=True, kw_only=True)
class Given:
    """The options that say what is built, as given; None where they are not.

    All but `parameters`, of a kind, and `mu` and `lean` are of symmetric circular arches.
    """

    alpha: Annotated[
        float | None, typer.Option(help="Half-angle of embrace in degrees, 0 to 180.")
    ] = None
    eta: Annotated[float | None, typer.Option(help="Thickness-to-radius ratio, up to 2.")] = (
        None
    )
    ratio: Annotated[
        float | None,
        typer.Option(help="Instead of --eta: thickness over the least that stands, as built."),
    ] = None
    mu: Annotated[
        float | None, typer.Option(help="Friction coefficient, above 0; inf allowed.")
    ] = None
    voussoirs: Annotated[
        int | None, typer.Option(help="Number of voussoirs, 3 to 1000; 27 if left out.")
    ] = None
    weight: Annotated[
        str | None, typer.Option(help="Where weight acts: centreline (if left out) or sector.")
    ] = None
    depth: Annotated[
        float | None,
        typer.Option(help="Depth out of the plane in m; 1 if left out, as the radius is."),
    ] = None
    lean: Annotated[
        float | None,
        typer.Option(help="Angle by which gravity leans out of the plane, in degrees."),
    ] = None
    parameters: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            metavar="NAME=VALUE",
            help="Parameter of a kind of structure (blocksim kinds NAME lists them); "
            "repeatable.",
        ),
    ] = None

    @property
    def of_arches(self) -> dict[str, object]:
        """Those that say how an arch is built."""
        others = {"mu", "lean", "parameters"}
        return {name: each for name, each in asdict(self).items() if name not in others}


@dataclass(frozen=True, kw_only=True)
class Loading:
    """What acts besides gravity, as given on the command line; None where it is not."""

    load: Annotated[
        float | None, typer.Option(help="Factor on the live loads of a structure.")
    ] = None
    tilt: Annotated[
        float | None,
        typer.Option(
            help="Tilt of the table in the plane, in degrees: its right side goes down."
        ),
    ] = None
    shake: Annotated[
        str | None,
        typer.Option(
            metavar="SHAPE|FILE",
            help=f"Ground that shakes: {', '.join(SHAPES)}, or a .csv file "
            f"({','.join(COLUMNS)}); does it survive?",
        ),
    ] = None
    amplitude: Annotated[
        float | None, typer.Option(help="Largest acceleration of the ground, in g.")
    ] = None
    duration: Annotated[
        float | None, typer.Option(help="How long the ground shakes, in s.")
    ] = None

    @property
    def given(self) -> bool:
        """Whether there is any of it."""
        return self != Loading()


def require_given(**options: object) -> None:
    """Name all options that are missing at once."""
    absent = [f"--{name}" for name, value in options.items() if value is None]
    if absent:
        listed = " and ".join(filter(None, (", ".join(absent[:-1]), absent[-1])))
        raise InputError(listed, MISSING if len(absent) == 1 else ALL_MISSING, "given")


def parameters_of(given: list[str] | None) -> dict[str, object]:
    """Read what `--with` gives: numbers, words, or JSON."""
    found: dict[str, object] = {}
    for each in given or ():
        name, equals, value = each.partition("=")
        ok = bool(name and equals and value) and name != "kind"
        require(ok, "--with", each, "name=value, with a parameter of the kind")
        try:
            found[name] = json.loads(value)
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
        try:
            settings[name] = float(value)
        except ValueError:
            raise InputError("--set", each, allowed) from None
    return settings


OPTIONS = {
    "shake",
    "amplitude",
    "duration",
    "eta",
    "mu",
    "voussoirs",
    "weight",
    "depth",
    "method",
    "tol",
    "reduce",
}
"""Fields that are options, too."""


@contextmanager
def named_options() -> Generator[None]:
    """Name the option, not the field, in what is said of wrong input."""
    try:
        yield
    except InputError as error:
        if error.where is None and error.field in OPTIONS:
            option = error.field.replace("_", "-")
            raise InputError(f"--{option}", error.value, error.allowed) from None
        if error.where is None and error.field.startswith("settings"):
            _, _, name = error.field.partition(".")
            value = f"{name}={error.value:g}" if name else error.value
            raise InputError("--set", value, error.allowed) from None
        raise
