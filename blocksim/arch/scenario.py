"""Scenarios: arches described in TOML files, one physical claim each."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationError

from blocksim.arch.asked import Scenario as Scenario
from blocksim.arch.dimensions import (
    Dimensions,
    Line,
    friction_of,
    require_measured,
    require_unit_weight,
)
from blocksim.arch.modes import Mode
from blocksim.blocks.entries import SHOULD, Density, Length
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
from blocksim.simulation.verdict import Verdict

LARGEST_FILE = 64 * 1024
"""Bytes; a larger file is not read."""

RENAMED = {"alpha_deg": "half_angle_deg", "tilt_deg": "lean_deg"}
"""Keys that were called otherwise."""
Table = TypeVar("Table")


def as_text(written: object) -> object:
    """Say infinity, which TOML has as a number, as the text that files of JSON have."""
    return "inf" if written == math.inf else written


@dataclass(frozen=True, kw_only=True)
class ArchTable:
    """Table `[arch]` of a scenario file: by angle and ratio, or by what can be measured.

    Either `half_angle_deg` and `eta`, or `span_m`, `rise_m` and `thickness_m`.

    Parameters
    ----------
    voussoirs : int
        How many.
    half_angle_deg : float
        Half-angle of embrace, crown to springing [deg].
    eta : float
        Thickness over radius; without it the arch is asked about at 0.99 of its least.
    radius : float
        Of the centreline [m]; 1 if left out.
    span_m : float
        Distance between the springings [m].
    rise_m : float
        Height of the crown over the springings [m].
    thickness_m : float
        [m]
    at : str
        Line that span and rise are of; the intrados if left out.
    weight : str
        Where a voussoir's weight acts: at its arc of the centreline, or at its true centre.
        By default `sector` of an arch in metres, else `centreline`.
    depth : float
        Length out of the plane [m].
    specific_weight : float
        Weight of a unit of volume [N/m3]; 20000 if left out.
    unit_weight_kN_per_m3 : float
        The same [kN/m3].
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

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
class ContactTable:
    """Table `[contact]`: friction of every joint, as a coefficient or as an angle.

    Parameters
    ----------
    mu : float
        Friction coefficient; inf allowed.
    friction_angle_deg : float
        The angle whose tangent it is [deg].
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    mu: Annotated[float, FRICTION, BeforeValidator(as_text)] | None = None
    friction_angle_deg: Annotated[float, FRICTION_ANGLE] | None = None


@dataclass(frozen=True, kw_only=True)
class GravityTable:
    """Table `[gravity]`: how far it leans out of the plane.

    Parameters
    ----------
    lean_deg : float
        [deg]
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    lean_deg: Annotated[float, LEAN_DEG] = 0.0


@dataclass(frozen=True, kw_only=True)
class ExpectTable:
    """Table `[expect]`: what the source says of the continuous arch.

    Parameters
    ----------
    modes : tuple of Mode
        Collapse modes: several where the arch lies on a line of the map.
    eta : float, optional
        Least thickness-to-radius ratio; absent where none stands.
    verdict : Verdict, optional
        Of the arch at its own eta, where that is the claim.
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    modes: Annotated[tuple[Mode, ...], Field(min_length=1)] = ()
    eta: Annotated[float, ETA] | None = None
    verdict: Verdict | None = None


@dataclass(frozen=True, kw_only=True)
class ScenarioFile:
    """A scenario file as written.

    Parameters
    ----------
    title : str
        In a line.
    source : str
        Where what is known of it was published.
    arch : table
        What is built.
    contact : table
        Friction.
    gravity : table
        Where it points.
    expect : table
        What the source says, for `validate`.
    quick : bool
        Whether `validate --quick` asks it.
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

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
    """Read a scenario by its path, or by the name of a shipped one.

    Raises
    ------
    InputError
        In one line, with file, field, value and what is allowed.
    """
    path = Path(name)
    known = shipped()
    if path.suffix != ".toml" and str(name) in known:
        path = known[str(name)]
    allowed = "an existing .toml file or a shipped scenario (blocksim scenarios lists them)"
    # As it was given: a name that ends in a slash is no file.
    given = name if path == Path(name) else path
    written = read_table(given, ScenarioFile, "scenario", allowed)
    return _scenario(path.stem, written, str(path))


def read_table(path: AnyPath, schema: type[Table], what: str, allowed: str) -> Table:
    """Read a TOML file as a dataclass says.

    Parameters
    ----------
    path : Path
    schema : type
        A dataclass; unknown keys are refused where it forbids them.
    what, allowed : str
        What the file is and has to be, for what is said of one that is not.

    Raises
    ------
    InputError
        In one line, with file, field, value and what is allowed.
    """
    return as_said(schema, written_in(path, what, allowed), str(path))


def written_in(path: AnyPath, what: str, allowed: str) -> dict[str, Any]:
    """Read a TOML file; as of `read_table`."""
    text = read_file(path, what, allowed, LARGEST_FILE)
    try:
        return toml_of(text)
    except ValueError as error:
        raise InputError("file", str(error), "valid TOML", where=str(path)) from None


def as_said(schema: type[Table], table: object, where: str | None = None) -> Table:
    """Check what a file says; as of `read_table`."""
    try:
        return _adapter(schema).validate_python(table)
    except ValidationError as error:
        raise _first_of(error, where) from None


@cache
def _adapter(schema: type[Table]) -> TypeAdapter[Table]:
    return TypeAdapter(schema)


def _first_of(error: ValidationError, where: str | None) -> InputError:
    """Turn the first of pydantic's complaints into one line."""
    errors = error.errors(include_url=False, include_context=False)
    # A misspelt key shows twice, as unknown and as missing: the first says more.
    first = min(errors, key=lambda each: each["type"] != "unexpected_keyword_argument")
    field = ".".join(str(part) for part in first["loc"])
    if first["type"] == "unexpected_keyword_argument":
        now = RENAMED.get(str(first["loc"][-1]))
        if now:
            return InputError(field, first["input"], f"named {now}", where=where)
        return InputError(field, first["input"], "left out: there is no such key", where=where)
    if first["type"] in {"missing", "missing_argument"}:
        return InputError(field, MISSING, "given", where=where)
    said = first["msg"].removeprefix(SHOULD)
    return InputError(field, first["input"], said, where=where)


def _scenario(name: str, written: ScenarioFile, where: str) -> Scenario:
    arch, expect = written.arch, written.expect
    try:
        line, half_angle, eta, radius = _shape(arch)
        _require_one("contact", written.contact, "mu", "friction_angle_deg")
        if arch.unit_weight_kN_per_m3 is not None:
            _require_one("arch", arch, "unit_weight_kN_per_m3", "specific_weight")
            require_unit_weight("arch.unit_weight_kN_per_m3", arch.unit_weight_kN_per_m3)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=where) from None
    angle, mu = written.contact.friction_angle_deg, written.contact.mu
    return Scenario(
        name=name,
        title=written.title,
        source=written.source,
        half_angle=half_angle,
        mu=friction_of(angle) if angle is not None else mu or 0.0,
        voussoirs=arch.voussoirs,
        weight=arch.weight or ("centreline" if line is None else "sector"),
        eta=eta,
        line=line,
        radius=radius,
        depth=arch.depth,
        specific_weight=1000 * arch.unit_weight_kN_per_m3
        if arch.unit_weight_kN_per_m3 is not None
        else arch.specific_weight or 20_000.0,
        lean=math.radians(written.gravity.lean_deg),
        expected_modes=expect.modes if expect else (),
        expected_eta=expect.eta if expect else None,
        expected_verdict=expect.verdict if expect else None,
        quick=written.quick,
    )


def _shape(arch: ArchTable) -> tuple[Line | None, float, float | None, float]:
    """Return the line that was measured, half-angle [rad], eta and mean radius [m]."""
    measured = {name: getattr(arch, name) for name in ("span_m", "rise_m", "thickness_m", "at")}
    if all(each is None for each in measured.values()):
        if arch.half_angle_deg is None:
            raise InputError("arch.half_angle_deg", MISSING, "given (or span_m and rise_m)")
        return None, math.radians(arch.half_angle_deg), arch.eta, arch.radius or 1.0
    for name in ("half_angle_deg", "eta", "radius"):
        allowed = "left out beside span_m, rise_m and thickness_m"
        require(getattr(arch, name) is None, f"arch.{name}", getattr(arch, name), allowed)
    span, rise, thickness = arch.span_m, arch.rise_m, arch.thickness_m
    if span is None or rise is None:
        raise InputError("arch.span_m" if span is None else "arch.rise_m", MISSING, "given")
    line = Line(span=span, rise=rise, at=arch.at or "intrados")
    try:
        require_measured(line, thickness)
    except InputError as error:
        raise InputError(f"arch.{error.field}_m", error.value, error.allowed) from None
    if thickness is None:
        return line, line.half_angle, None, line.radius
    found = Dimensions(span=span, rise=rise, thickness=thickness, at=line.at)
    return line, found.half_angle, found.eta, found.radius


def _require_one(table: str, written: object, one: str, other: str) -> None:
    """Raise `InputError` unless exactly one of two keys is given."""
    first, second = getattr(written, one), getattr(written, other)
    both = first is not None and second is not None
    require(not both, f"{table}.{other}", second, f"left out beside {one}")
    if first is None and second is None:
        raise InputError(f"{table}.{one}", MISSING, f"given (or {other})")
