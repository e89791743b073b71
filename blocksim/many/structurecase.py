"""A case of a structure: one question about one kind with its parameters."""

from __future__ import annotations

import json
import math
import time
from typing import Any, NamedTuple, cast

from blocksim.ask.bracket import bracket
from blocksim.ask.check import Check, check
from blocksim.ask.families import family_of
from blocksim.ask.methods import STATIC
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import LONGEST, SHORTEST, STRONGEST
from blocksim.common.checks import FACTOR
from blocksim.common.errors import MissingPart
from blocksim.kinds.files import structure_of
from blocksim.many.case import Given, Pace, Row, identity_of

ACTING: dict[str, tuple[float, float]] = {
    "load": (-FACTOR.high, FACTOR.high),
    "tilt_deg": (-180.0, 180.0),
    "amplitude_g": (0.0, STRONGEST),
    "duration_s": (SHORTEST, LONGEST),
}
"""What acts on a structure, and the range of each: factor on the live loads, tilt of the table,
how strongly and how long the ground shakes."""


class StructureCase(NamedTuple):
    """One question about one structure.

    Parameters
    ----------
    kind : str
    parameters : tuple of (str, value)
        Those that the design sets, by name; `arch.thickness`: of its arch.
    rest : str
        JSON of what all cases of a design have in common: tables, loads, density.
    mu : float
    acting : tuple of (str, float)
        What acts on it besides, of `ACTING`, as far as the design sets it.
    over : str or None
        Parameter to bracket over; None: does it stand?
    method : str
    tol : float
        Relative width of a bracket; 0 where nothing is bracketed.
    settings : tuple of (str, float)
        Given to the engine instead of what its rule says.
    """

    kind: str
    parameters: tuple[tuple[str, float | str], ...]
    rest: str
    mu: float
    acting: tuple[tuple[str, float], ...]
    over: str | None
    method: str
    tol: float
    settings: Given = ()

    def identity(self, version: str) -> bytes:
        """Hash of what is asked and of the version of the method that answers."""
        return identity_of(self, version)

    @property
    def pace(self) -> Pace:
        """What cases that take about the same time have in common."""
        return self.method, self.kind, self.over, self.settings

    @property
    def table(self) -> dict[str, Any]:
        """The structure file it asks about."""
        table: dict[str, Any] = {"kind": self.kind, **json.loads(self.rest)}
        for name, value in self.parameters:
            inside = table
            *path, last = name.split(".")
            for part in path:
                inside = cast("dict[str, Any]", inside.setdefault(part, {}))
            inside[last] = value
        acting = dict(self.acting)
        if isinstance(table.get("shake"), str):
            table["shake"] = {"shape": table["shake"]}
        if "shake" in table:
            table["shake"] |= {
                name: acting[name] for name in ("amplitude_g", "duration_s") if name in acting
            }
        if "load" in acting:
            table["load"] = acting["load"]
        return {**table, "friction": "inf" if math.isinf(self.mu) else self.mu}

    def problem(self) -> Problem:
        """Build it, under its load and on its slope."""
        built = structure_of(self.table)
        return built.tilted(math.radians(dict(self.acting).get("tilt_deg", 0.0)))

    def row(self, identity: bytes, version: str) -> Row:
        """Return the row with nothing answered."""
        acting = dict(self.acting)
        return {
            "id": identity.hex(),
            "kind": self.kind,
            "parameters": dict(self.parameters),
            "mu": "inf" if math.isinf(self.mu) else self.mu,
            **{name: acting.get(name) for name in ACTING},
            "over": self.over,
            "unit": None,
            "asked": self.method,
            "settings": dict(self.settings) or None,
            "method": self.method,
            "version": version,
            "verdict": None,
            "rest": None,
            "load_factor": None,
            "largest_rotation_deg": None,
            "first_impact_s": None,
            "limit": None,
            "low": None,
            "high": None,
            "confirmed": None,
            "reason": None,
            "error": None,
            "wall_s": 0.0,
        }

    def answer(self, row: Row) -> bool:
        """Fill in the answer, or why there is none; return whether an engine gave it."""
        started = time.perf_counter()
        try:
            row.update(self._checked() if self.over is None else self._bracketed(self.over))
        except MissingPart:
            raise
        except Exception as error:
            row["error"] = reason_of(error)
        row["wall_s"] = time.perf_counter() - started
        return row["error"] is None and row["method"] not in STATIC

    def _checked(self) -> Row:
        seen = check(self.problem(), method=self.method, settings=dict(self.settings))
        return {
            "method": seen.method,
            "verdict": seen.verdict.value,
            "rest": seen.rest,
            "load_factor": _written(seen.load_factor),
            **_rocking(seen),
            "reason": seen.reason,
        }

    def _bracketed(self, over: str) -> Row:
        family = family_of(self.problem(), over)
        found = bracket(family, method=self.method, tol=self.tol, settings=dict(self.settings))
        return {
            "method": found.method,
            "unit": family.unit,
            "limit": _written(found.limit),
            "low": found.low,
            "high": found.high,
            "confirmed": found.confirmed,
            "reason": found.reason,
        }


def _rocking(seen: Check) -> Row:
    """Tell how blocks turned on ground that shakes."""
    if seen.shaken is None:
        return {}
    return {
        "largest_rotation_deg": math.degrees(seen.shaken.rocking.rotation),
        "first_impact_s": seen.shaken.first_impact_s,
    }


def reason_of(error: BaseException) -> str:
    """Say in one line what went wrong."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _written(value: float | None) -> float | str | None:
    """Return a number that JSON can write."""
    return "inf" if value is not None and math.isinf(value) else value
