"""Scenarios: arches described in TOML files, one physical claim each."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from blocksim.arch.dimensions import friction_of, require_measured, require_unit_weight
from blocksim.arch.modes import Mode
from blocksim.blocks.entries import Density, Length
from blocksim.common.checks import (
    ETA,
    FRICTION,
    FRICTION_ANGLE,
    HALF_ANGLE_DEG,
    LEAN_DEG,
    VOUSSOIRS,
    require,
)
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import AnyPath, read_file, shipped_files, toml_of
from blocksim.common.tables import Written, as_said
from blocksim.kinds.scenario import MEASURES, USUAL, Scenario
from blocksim.simulation.verdict import Verdict

LARGEST_FILE = 64 * 1024
"""Bytes; a larger file is not read."""

RENAMED = {"alpha_deg": "half_angle_deg", "tilt_deg": "lean_deg"}
"""Keys that were called otherwise."""


def as_text(written: object) -> object:
    """Say infinity, which TOML has as a number, as the text that files of JSON have."""
    return "inf" if written == math.inf else written


@dataclass(frozen=True, kw_only=True)
class ArchTable(Written):
    """Table `[arch]` of a scenario file: by angle and ratio, or by what can be measured.

    Either `half_angle_deg` and `eta`, or `span_m`, `rise_m` and `thickness_m`.

    `voussoirs`: How many.
    `half_angle_deg`: Half-angle of embrace, crown to springing [deg].
    `eta`: Thickness over radius; without it the arch is asked about at 0.99 of its least.
    `radius`: Of the centreline [m]; 1 if left out.
    `span_m`: Distance between the springings [m].
    `rise_m`: Height of the crown over the springings [m].
    `thickness_m`: [m]
    `at`: Line that span and rise are of; the intrados if left out.
    `weight`: Where a voussoir's weight acts: at its arc of the centreline, or at its true
        centre. By default `sector` of an arch in metres, else `centreline`.
    `depth`: Length out of the plane [m].
    `specific_weight`: Weight of a unit of volume [N/m3]; 20000 if left out.
    `unit_weight_kN_per_m3`: The same [kN/m3].
    """

    voussoirs: Annotated[int, VOUSSOIRS]
    half_angle_deg: Annotated[float, HALF_ANGLE_DEG] | None = None
    eta: Annotated[float, ETA] | None = None
    radius: Length | None = None
    span_m: Length | None = None
    rise_m: Length | None = None
    thickness_m: Length | None = None
    at: Literal["intrados", "centreline", "extrados"] | None = None
    weight: Literal["centreline", "sector"] | None = None
    depth: Length = 1.0
    specific_weight: Density | None = None
    unit_weight_kN_per_m3: Annotated[float, Field(gt=0, strict=True)] | None = None  # noqa: N815 - as the unit is written


@dataclass(frozen=True, kw_only=True)
class ContactTable(Written):
    """Table `[contact]`: friction of every joint, as a coefficient or as an angle.

    `mu`: Friction coefficient; inf allowed.
    `friction_angle_deg`: The angle whose tangent it is [deg].
    """

    mu: Annotated[float, FRICTION, BeforeValidator(as_text)] | None = None
    friction_angle_deg: Annotated[float, FRICTION_ANGLE] | None = None


@dataclass(frozen=True, kw_only=True)
class GravityTable(Written):
    """Table `[gravity]`: how far it leans out of the plane.

    `lean_deg`: [deg]
    """

    lean_deg: Annotated[float, LEAN_DEG] = 0.0


@dataclass(frozen=True, kw_only=True)
class ExpectTable(Written):
    """Table `[expect]`: what the source says of the continuous arch.

    `modes`: Collapse modes: several where the arch lies on a line of the map.
    `eta`: Least thickness-to-radius ratio; absent where none stands.
    `verdict`: Of the arch at its own eta, where that is the claim.
    """

    modes: Annotated[tuple[Mode, ...], Field(min_length=1)] = ()
    eta: Annotated[float, ETA] | None = None
    verdict: Verdict | None = None


@dataclass(frozen=True, kw_only=True)
class ScenarioFile(Written):
    """A scenario file as written.

    `title`: In a line.
    `source`: Where what is known of it was published.
    `arch`: What is built.
    `contact`: Friction.
    `gravity`: Where it points.
    `expect`: What the source says, for `validate`.
    `quick`: Whether `validate --quick` asks it.
    """

    title: Annotated[str, Field(min_length=1, max_length=200)]
    source: Annotated[str, Field(min_length=1, max_length=500)]
    arch: ArchTable
    contact: ContactTable
    gravity: GravityTable = GravityTable()
    expect: ExpectTable | None = None
    quick: Annotated[bool, Field(strict=True)] = False


def shipped() -> dict[str, Path]:
    """Scenarios that come with blocksim, by name."""
    return shipped_files("*.toml")


def load_scenario(name: AnyPath) -> Scenario:
    """Read a scenario by its path, or by the name of a shipped one."""
    path = Path(name)
    known = shipped()
    if path.suffix != ".toml" and str(name) in known:
        path = known[str(name)]
    allowed = "an existing .toml file or a shipped scenario (blocksim scenarios lists them)"
    # As it was given: a name that ends in a slash is no file.
    given = name if path == Path(name) else path
    written = as_said(ScenarioFile, written_in(given, "scenario", allowed), str(path), RENAMED)
    return _scenario(path.stem, written, str(path))


def written_in(
    path: AnyPath, what: str, allowed: str, largest: int = LARGEST_FILE
) -> dict[str, Any]:
    """Read a small TOML file.

    `what`, `allowed`: What the file is and has to be, for what is said of one that is not.
    """
    text = read_file(path, what, allowed, largest)
    try:
        return toml_of(text)
    except ValueError as error:
        raise InputError("file", str(error), "valid TOML", where=str(path)) from None


def _scenario(name: str, written: ScenarioFile, where: str) -> Scenario:
    expect = written.expect or ExpectTable()
    try:
        given = {**_arch(written.arch), "friction": _friction(written.contact)}
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=where) from None
    return Scenario(
        name=name,
        title=written.title,
        source=written.source,
        given=given,
        lean=math.radians(written.gravity.lean_deg),
        expected_modes=expect.modes,
        expected_eta=expect.eta,
        expected_verdict=expect.verdict,
        quick=written.quick,
    )


def _friction(written: ContactTable) -> float:
    _require_one("contact", written, "mu", "friction_angle_deg")
    angle, mu = written.friction_angle_deg, written.mu
    return friction_of(angle) if angle is not None else mu or 0.0


def _arch(written: ArchTable) -> dict[str, Any]:
    """Return the parameters of `CircularArch` that a table says."""
    table = {name: each for name, each in asdict(written).items() if each is not None}
    heavy = table.pop("unit_weight_kN_per_m3", None)
    if heavy is not None:
        _require_one("arch", written, "unit_weight_kN_per_m3", "specific_weight")
        require_unit_weight("arch.unit_weight_kN_per_m3", heavy)
        table["specific_weight"] = 1000 * heavy
    given = {name.removesuffix("_m"): each for name, each in table.items()}
    if "specific_weight" in given:
        given["density"] = given.pop("specific_weight")
    if not given.keys() & {*MEASURES}:
        missing = "given (or span_m and rise_m)"
        require("half_angle_deg" in given, "arch.half_angle_deg", MISSING, missing)
        return {**USUAL, **given}
    for name in ("half_angle_deg", "eta", "radius"):
        allowed = "left out beside span_m, rise_m and thickness_m"
        require(name not in given, f"arch.{name}", given.get(name), allowed)
    for name in ("span", "rise"):
        require(name in given, f"arch.{name}_m", MISSING, "given")
    try:
        require_measured(given)
    except InputError as error:
        raise InputError(f"arch.{error.field}_m", error.value, error.allowed) from None
    return {**USUAL, "weight": "sector", **given}


def _require_one(table: str, written: object, one: str, other: str) -> None:
    """Raise `InputError` unless exactly one of two keys is given."""
    first, second = getattr(written, one), getattr(written, other)
    both = first is not None and second is not None
    require(not both, f"{table}.{other}", second, f"left out beside {one}")
    if first is None and second is None:
        raise InputError(f"{table}.{one}", MISSING, f"given (or {other})")
