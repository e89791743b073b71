"""The options that questions share, and how they override a scenario."""

from __future__ import annotations

import math
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import replace
from typing import Annotated

import typer

from blocksim.arch.circular import Arch
from blocksim.arch.scenario import Scenario, load_scenario
from blocksim.ask.methods import CHOICES
from blocksim.common.checks import is_number, require
from blocksim.common.errors import MISSING, InputError
from blocksim.evidence.setup import SETTINGS

Scene = Annotated[str | None, typer.Argument(help="Scenario: a .toml file or a shipped name.")]
Alpha = Annotated[
    float | None, typer.Option(help="Half-angle of embrace in degrees, 0 to 180.")
]
Eta = Annotated[float | None, typer.Option(help="Thickness-to-radius ratio, up to 2.")]
Mu = Annotated[float | None, typer.Option(help="Friction coefficient, above 0; inf allowed.")]
Voussoirs = Annotated[
    int | None, typer.Option(help="Number of voussoirs, 3 to 1000; 27 if left out.")
]
WeightOption = Annotated[
    str | None, typer.Option(help="Where weight acts: centreline (if left out) or sector.")
]
MethodOption = Annotated[str, typer.Option(help=f"{', '.join(CHOICES)}.")]
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


def question(
    scene: str | None,
    alpha: float | None,
    mu: float | None,
    voussoirs: int | None,
    weight: str | None,
    lean: float | None = None,
) -> Scenario:
    """Merge a scenario, where there is one, with the options that override it."""
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
    if lean is not None:
        ok = is_number(lean, -90, math.nextafter(90, 0))
        require(ok, "--lean", lean, "above -90 and below 90 deg")
    if scene is None:
        require(alpha is not None, "--alpha", MISSING, "given where no scenario is")
        require(mu is not None, "--mu", MISSING, "given where no scenario is")
    asked = load_scenario(scene) if scene is not None else NO_SCENARIO
    changes: dict[str, object] = {
        "half_angle": None if alpha is None else math.radians(alpha),
        "mu": mu,
        "voussoirs": voussoirs,
        "weight": weight,
        "lean": None if lean is None else math.radians(lean),
    }
    return replace(asked, **{key: value for key, value in changes.items() if value is not None})


def arch_of(asked: Scenario, eta: float | None) -> Arch:
    """Return the arch asked about, at the thickness given or else the scenario's."""
    ratio_given = asked.eta if eta is None else eta
    if ratio_given is None:
        raise InputError("--eta", MISSING, "given where no scenario sets it")
    with named_options():
        return asked.arch(ratio_given)


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


OPTIONS = {"eta", "mu", "voussoirs", "weight", "method", "tol", "reduce"}
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
