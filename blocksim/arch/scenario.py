"""Scenarios: arches described in TOML files, one physical claim each."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Literal, TypeVar

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationError

from blocksim.arch.circular import Arch, Weight
from blocksim.arch.modes import Mode
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import AnyPath, require_file, shipped_files
from blocksim.evidence.verdict import Verdict

LARGEST_FILE = 64 * 1024
"""Bytes; a larger file is not read."""

RENAMED = {"alpha_deg": "half_angle_deg", "tilt_deg": "lean_deg"}
"""Keys that were called otherwise."""
Table = TypeVar("Table")


def infinite(written: object) -> object:
    """Take the text "inf" for infinity, as JSON has it."""
    return math.inf if written == "inf" else written


Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]


@dataclass(frozen=True, kw_only=True)
class ArchTable:
    """Table `[arch]` of a scenario file; see `Arch` for the fields."""

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    half_angle_deg: Annotated[float, Field(gt=0, lt=180, strict=True)]
    voussoirs: Annotated[int, Field(ge=3, le=1000, strict=True)]
    eta: Annotated[float, Field(gt=0, le=2, strict=True)] | None = None
    weight: Literal["centreline", "sector"] = "centreline"
    radius: Positive = 1.0
    depth: Positive = 1.0
    specific_weight: Positive = 20_000.0


@dataclass(frozen=True, kw_only=True)
class ContactTable:
    """Table `[contact]`: friction of every joint."""

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    mu: Annotated[float, Field(gt=0, strict=True), BeforeValidator(infinite)]


@dataclass(frozen=True, kw_only=True)
class GravityTable:
    """Table `[gravity]`: how far it leans out of the plane."""

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    lean_deg: Annotated[float, Field(gt=-90, lt=90, strict=True)] = 0.0


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
    eta: Annotated[float, Field(gt=0, le=2, strict=True)] | None = None
    verdict: Verdict | None = None


@dataclass(frozen=True, kw_only=True)
class ScenarioFile:
    """A scenario file as written."""

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    title: Annotated[str, Field(min_length=1, max_length=200)]
    source: Annotated[str, Field(min_length=1, max_length=500)]
    arch: ArchTable
    contact: ContactTable
    gravity: GravityTable = GravityTable()
    expect: ExpectTable | None = None
    quick: Annotated[bool, Field(strict=True)] = False


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """An arch to ask about, and what is known of it.

    Parameters
    ----------
    name : str
        File name without its ending.
    title, source : str
    half_angle : float
        alpha [rad].
    mu : float
    voussoirs : int
    weight : str
    eta : float or None
        Thickness-to-radius ratio, where the scenario sets one.
    radius, depth, specific_weight : float
    lean : float
        Angle by which gravity leans out of the plane [rad].
    expected_modes : tuple of Mode
        Empty where nothing is said.
    expected_eta : float or None
    expected_verdict : Verdict or None
        Of the arch at its `eta`.
    quick : bool
        Whether `validate --quick` takes it.
    """

    name: str
    title: str
    source: str
    half_angle: float
    mu: float
    voussoirs: int
    weight: Weight
    eta: float | None
    radius: float
    depth: float
    specific_weight: float
    lean: float
    expected_modes: tuple[Mode, ...]
    expected_eta: float | None
    expected_verdict: Verdict | None
    quick: bool

    def arch(self, eta: float) -> Arch:
        """Return the arch at a thickness-to-radius ratio."""
        return Arch(
            half_angle=self.half_angle,
            eta=eta,
            voussoirs=self.voussoirs,
            weight=self.weight,
            radius=self.radius,
            depth=self.depth,
            specific_weight=self.specific_weight,
        )


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
    return _scenario(path.stem, read_table(path, ScenarioFile, "scenario", allowed))


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
    path = Path(path)
    require_file(path, what, allowed, LARGEST_FILE)
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        # No TOML or no UTF-8, numbers beyond all bounds, or nested too deeply.
        raise InputError("file", str(error), "valid TOML", where=str(path)) from None
    try:
        return TypeAdapter(schema).validate_python(table)
    except ValidationError as error:
        raise _first_of(error, str(path)) from None


def _first_of(error: ValidationError, where: str) -> InputError:
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
    return InputError(
        field, first["input"], first["msg"].removeprefix("Input should be "), where=where
    )


def _scenario(name: str, written: ScenarioFile) -> Scenario:
    arch, expect = written.arch, written.expect
    return Scenario(
        name=name,
        title=written.title,
        source=written.source,
        half_angle=math.radians(arch.half_angle_deg),
        mu=written.contact.mu,
        voussoirs=arch.voussoirs,
        weight=arch.weight,
        eta=arch.eta,
        radius=arch.radius,
        depth=arch.depth,
        specific_weight=arch.specific_weight,
        lean=math.radians(written.gravity.lean_deg),
        expected_modes=expect.modes if expect else (),
        expected_eta=expect.eta if expect else None,
        expected_verdict=expect.verdict if expect else None,
        quick=written.quick,
    )
