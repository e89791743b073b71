"""The options that questions share, and how they override a scenario."""

from __future__ import annotations

import json
import math
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from typing import Annotated

import typer

from blocksim.arch.circular import Arch
from blocksim.arch.limit import least_thickness
from blocksim.arch.scenario import Scenario, load_scenario
from blocksim.ask.families import FAMILIES
from blocksim.ask.methods import CHOICES
from blocksim.ask.search import ETA_MAX
from blocksim.blocks.shaking import COLUMNS, SHAPES
from blocksim.common.checks import is_number, require, require_friction
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
Alpha = Annotated[
    float | None, typer.Option(help="Half-angle of embrace in degrees, 0 to 180.")
]
Eta = Annotated[float | None, typer.Option(help="Thickness-to-radius ratio, up to 2.")]
Ratio = Annotated[
    float | None,
    typer.Option(help="Instead of --eta: thickness over the least that stands, as built."),
]
Depth = Annotated[
    float | None,
    typer.Option(help="Depth out of the plane in m; 1 if left out, as the radius is."),
]
Mu = Annotated[float | None, typer.Option(help="Friction coefficient, above 0; inf allowed.")]
Voussoirs = Annotated[
    int | None, typer.Option(help="Number of voussoirs, 3 to 1000; 27 if left out.")
]
WeightOption = Annotated[
    str | None, typer.Option(help="Where weight acts: centreline (if left out) or sector.")
]
MethodOption = Annotated[str, typer.Option(help=f"{', '.join(CHOICES)}.")]
Load = Annotated[float | None, typer.Option(help="Factor on the live loads of a structure.")]
Tilt = Annotated[
    float | None,
    typer.Option(help="Tilt of the table in the plane, in degrees: its right side goes down."),
]
Shake = Annotated[
    str | None,
    typer.Option(
        metavar="SHAPE|FILE",
        help=f"Ground that shakes: {', '.join(SHAPES)}, or a .csv file "
        f"({','.join(COLUMNS)}); does it survive?",
    ),
]
Amplitude = Annotated[
    float | None, typer.Option(help="Largest acceleration of the ground, in g.")
]
Duration = Annotated[float | None, typer.Option(help="How long the ground shakes, in s.")]
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
Lean = Annotated[
    float | None,
    typer.Option(help="Angle by which gravity leans out of the plane, in degrees."),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help=f"Setting of the engine instead of its rule; repeatable: {', '.join(SETTINGS)}.",
    ),
]
With = Annotated[
    list[str] | None,
    typer.Option(
        "--with",
        metavar="NAME=VALUE",
        help="Parameter of a kind of structure (blocksim kinds NAME lists them); repeatable.",
    ),
]
Reduce = Annotated[
    bool,
    typer.Option("--reduce", help="Simulate half the arch, in no more blocks than it takes."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]


NO_SCENARIO = Scenario(
    name="",
    title="",
    source="",
    half_angle=math.pi / 2,
    mu=math.inf,
    voussoirs=27,
    weight="centreline",
    eta=None,
    radius=1.0,
    depth=1.0,
    specific_weight=20_000.0,
    lean=0.0,
    expected_modes=(),
    expected_eta=None,
    expected_verdict=None,
    quick=False,
)
"""Defaults of the options; half-angle and friction have none and are always replaced."""


ASIDE = 0.99
"""Thickness of a scenario that sets none, over its least: it collapses, in one mode."""


@dataclass(frozen=True, kw_only=True)
class Given:
    """The options that say what is built, as given; None where they are not.

    All but `parameters`, of a kind, and `mu` and `lean` are of symmetric circular arches.
    """

    alpha: float | None = None
    eta: float | None = None
    ratio: float | None = None
    mu: float | None = None
    voussoirs: int | None = None
    weight: str | None = None
    depth: float | None = None
    lean: float | None = None
    parameters: list[str] | None = None

    @property
    def of_arches(self) -> dict[str, object]:
        """Those that say how an arch is built."""
        others = {"mu", "lean", "parameters"}
        return {name: each for name, each in asdict(self).items() if name not in others}


def require_given(**options: object) -> None:
    """Name all options that are missing at once."""
    absent = [f"--{name}" for name, value in options.items() if value is None]
    if absent:
        listed = " and ".join(filter(None, (", ".join(absent[:-1]), absent[-1])))
        raise InputError(listed, MISSING if len(absent) == 1 else ALL_MISSING, "given")


def question(
    scene: str | None, given: Given, *, thick: bool = False, **needed: object
) -> Scenario:
    """Merge a scenario, where there is one, with the options that override it.

    Parameters
    ----------
    scene : str or None
    given : Given
    thick : bool
        Whether a thickness has to be given where there is no scenario.
    needed : object
        Other options that have to be given, by name.
    """
    if scene is None:
        eta = given.eta if given.ratio is None else given.ratio
        thickness = {"eta": eta} if thick else {}
        require_given(**needed, alpha=given.alpha, mu=given.mu, **thickness)
    require_given(**needed)
    no_kind = "left out: it is for kinds of structures"
    require(given.parameters is None, "--with", " ".join(given.parameters or ()), no_kind)
    alpha, lean, depth = given.alpha, given.lean, given.depth
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
    if lean is not None:
        ok = is_number(lean, -90, math.nextafter(90, 0))
        require(ok, "--lean", lean, "above -90 and below 90 deg")
    both = given.eta is not None and given.ratio is not None
    require(not both, "--ratio", given.ratio, "left out where --eta is given")
    asked = load_scenario(scene) if scene is not None else NO_SCENARIO
    changes: dict[str, object] = {
        "half_angle": None if alpha is None else math.radians(alpha),
        "mu": given.mu,
        "voussoirs": given.voussoirs,
        "weight": given.weight,
        "depth": depth,
        "eta": given.eta,
        "lean": None if lean is None else math.radians(lean),
    }
    return replace(asked, **{key: value for key, value in changes.items() if value is not None})


def arch_of(asked: Scenario, ratio: float | None) -> Arch:
    """Return the arch asked about.

    At a share of the least thickness as built where that is given, else at the scenario's
    thickness, else at `ASIDE` of the least.
    """
    with named_options():
        if asked.eta is not None and ratio is None:
            return asked.arch(asked.eta)
        if ratio is not None:
            require(is_number(ratio, 0, 100), "--ratio", ratio, "above 0 and at most 100")
        require_friction(asked.mu)
        # Checked by the arch before anything is made of them.
        asked.arch(1.0)
        arch = asked.half_angle, asked.mu, asked.voussoirs, asked.weight
        least = least_thickness(*arch).eta
        if least is None:
            field = "--eta" if ratio is None else "--ratio"
            value = MISSING if ratio is None else ratio
            allowed = "given" if ratio is None else "left out for --eta"
            raise InputError(field, value, f"{allowed}: no thickness up to 2 stands here")
        eta = (ratio or ASIDE) * least
        if ratio is not None:
            require(eta <= ETA_MAX, "--ratio", ratio, f"at most {ETA_MAX / least:.6g}, eta = 2")
        return asked.arch(eta)


def thickness_words(asked: Scenario, ratio: float | None) -> str:
    """Say which thickness was taken where none was given, to be added to a reason."""
    if asked.eta is not None or ratio is not None:
        return ""
    return f"; no thickness was given, so it is {ASIDE:g} of the least as built"


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
