"""A case: one question about what a maker makes, its identity, and its row."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import replace
from hashlib import blake2b
from typing import Any, Literal, NamedTuple, TypedDict, get_args, get_type_hints

from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import AMPLITUDE, DURATION
from blocksim.common.checks import FACTOR, TILT_DEG, endless_text
from blocksim.common.fields import Field
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import structure_of

ARCH = CircularArch.name
NEEDED = {"half_angle_deg", "mu", "voussoirs", "weight"}
PLAIN = NEEDED | {"eta", "ratio"}
"""Parameters of an arch that is answered in bulk. Each has a column of its own."""
ACTING = {
    "load": Field(about="factor on the live loads", range=FACTOR),
    "tilt_deg": Field(about="tilt of the table", range=TILT_DEG),
    "azimuth_deg": Field(
        about="in space, towards where it tilts, from x towards y", range=TILT_DEG
    ),
    "amplitude_g": Field(about="how strongly the ground shakes", range=AMPLITUDE),
    "duration_s": Field(about="how long it shakes", range=DURATION),
}
"""Quantities that act on a structure."""
Text = str | None
Number = float | None
Infinite = float | Literal["inf", "-inf"] | None


class SweepRow(TypedDict):
    """A row of a sweep, as `read_rows` gives it. What is not known is None."""

    id: str
    kind: Text
    half_angle_deg: Number
    mu: Infinite
    voussoirs: int | None
    weight: Text
    eta: Number
    ratio: Number
    parameters: dict[str, object] | None
    load: Number
    tilt_deg: Number
    azimuth_deg: Number
    amplitude_g: Number
    duration_s: Number
    over: Text
    unit: Text
    asked: str
    settings: dict[str, float] | None
    method: Text
    version: Text
    verdict: Text
    rest: Text
    load_factor: Infinite
    largest_rotation_deg: Number
    first_impact_s: Number
    limit: Infinite
    low: Number
    high: Number
    mode: Text
    mode_in_motion: Text
    mode_theory: Text
    eta_theory: Number
    eta_limit: Number
    eta_low: Number
    eta_high: Number
    confirmed: bool | None
    reason: Text
    error: Text
    wall_s: float


_ARROW: dict[object, str] = {str: "string", float: "double", int: "int64", bool: "bool"}
COLUMNS = {
    name: _ARROW.get((*get_args(kind), kind)[0], name)
    for name, kind in get_type_hints(SweepRow).items()
}
"""The keys of a row, and what Arrow calls their types; each kind has parameters of its own."""
Row = dict[str, object]
EMPTY: Row = {**dict.fromkeys(COLUMNS)}
Pace = tuple[object, ...]
Value = float | str
Given = tuple[tuple[str, Value], ...]
Overrides = tuple[tuple[str, float], ...]


class Case(NamedTuple):
    """One question about one structure.

    `given`: What the design sets: parameters of the kind (`arch.thickness`: of its arch), `mu`,
        and what acts on it, of `ACTING`. `ratio` of an arch is its thickness over the least
        thickness of the voussoirs as built.
    `over`: Parameter to bracket over; None: does it stand?
    `rest`: JSON of what all cases of a design have in common: tables, loads, density.
    `band`: An engine simulates arches within this share of their least thickness.
    `tol`: Relative width of a bracket; 0 where nothing is bracketed.
    `confirm`: Let blocks go at both ends of an engine's bracket.
    `settings`: Given to the engine instead of what its rule says.
    """

    kind: str
    given: Given
    method: str
    over: str | None = None
    rest: str = "{}"
    band: float = 0.0
    tol: float = 0.0
    confirm: bool = True
    settings: Overrides = ()

    @property
    def is_plain(self) -> bool:
        """Whether statics answer it in bulk."""
        return is_plain(self.kind, [name for name, _ in self.given], self.over, self.rest)

    @property
    def pace(self) -> Pace:
        """Properties that cases of about the same time have in common."""
        blocks = dict(self.given).get("voussoirs")
        return self.method, self.kind, blocks, self.over, self.settings

    def identity(self, version: str) -> bytes:
        """Hash of what is asked and of the version of the method that answers."""
        names, values = zip(*self.given, strict=True)
        said = f"{self.kind} {' '.join(names)} {values!r} {self[2:]!r} {version}"
        return blake2b(said.encode(), digest_size=12).digest()

    def row(self, identity: bytes, version: str) -> Row:
        """Return the row with nothing answered. What is not given has no key."""
        own = PLAIN if self.kind == ARCH else {"mu"}
        row: Row = {"id": identity.hex(), "kind": self.kind}
        parameters: Row = {}
        for name, value in self.given:
            (row if name in own or name in ACTING else parameters)[name] = value
        row["mu"] = endless_text(row["mu"])
        for key, said in (
            ("parameters", parameters),
            ("over", self.over),
            ("settings", dict(self.settings)),
        ):
            if said:
                row[key] = said
        row["asked"] = row["method"] = self.method
        row["version"] = version
        row["wall_s"] = 0.0
        return row

    def problem(self, eta: float | None = None) -> Problem:
        """Build it, under its load and on its slope. An arch of a ratio gets this eta."""
        given: dict[str, Any] = dict(self.given)
        mu = given.pop("mu")
        if self.is_plain:
            given.pop("ratio", None)
            # A search begins at another.
            given["eta"] = 1.0 if eta is None else eta
            return CircularArch(**given, friction=mu).problem()
        acting = {name: given.pop(name) for name in ACTING if name in given}
        problem = structure_of(self._table(given, mu, acting))
        if problem.in_space:
            azimuth = acting.get("azimuth_deg", 0.0)
            problem = replace(problem, azimuth=math.radians(azimuth))
        return problem.tilted(math.radians(acting.get("tilt_deg", 0.0)))

    def _table(
        self, given: dict[str, Any], mu: float, acting: dict[str, float]
    ) -> dict[str, Any]:
        """Return the structure file that says it."""
        table: dict[str, Any] = {"kind": self.kind, **json.loads(self.rest)}
        for name, value in given.items():
            inside = table
            *path, last = name.split(".")
            for part in path:
                inside = inside.setdefault(part, {})
            inside[last] = value
        if isinstance(table.get("shake"), str):
            table["shake"] = {"shape": table["shake"]}
        if "shake" in table:
            shaken = ("amplitude_g", "duration_s")
            table["shake"] |= {name: acting[name] for name in shaken if name in acting}
        if "load" in acting:
            table["load"] = acting["load"]
        return {**table, "friction": endless_text(mu)}


def is_plain(kind: str, names: Iterable[str], over: str | None, rest: str) -> bool:
    """Tell whether statics answer arches in bulk of which that is given.

    They are symmetric, under their own weight, by half-angle and ratio; or without one, and the
    question is how thin they can be.
    """
    if kind != ARCH or rest != "{}" or over not in {None, "thickness"}:
        return False
    known = {*names}
    is_sized = "eta" in known or "ratio" in known
    return NEEDED <= known <= PLAIN and is_sized == (over is None)
