"""Cases to rows: static methods in bulk, simulation where it is worth it."""

from __future__ import annotations

import json
import math
import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple, cast

import blocksim
from blocksim.arch.answers import ArchAnswer, ArchBracket
from blocksim.ask.bracket import Bracket, bracket
from blocksim.ask.check import Check, check
from blocksim.ask.methods import STATIC
from blocksim.common.checks import endless_text
from blocksim.common.errors import MissingPart
from blocksim.common.fields import same
from blocksim.engines import NAMES, get_engine
from blocksim.sweeps.case import Case, Pace, Row
from blocksim.sweeps.statics import by_statics

_ENCODER = json.JSONEncoder(allow_nan=False, check_circular=False)


class Asked(NamedTuple):
    """A case and its identity."""

    identity: bytes
    case: Case

    def row(self, versions: dict[str, str]) -> Row:
        """Return its row with nothing answered."""
        return self.case.row(self.identity, versions[self.case.method])


@dataclass(kw_only=True)
class Tally:
    """Counts and times of a number of rows.

    `rows`, `failed`: Rows, and those that say why there is no answer.
    `simulated_s`: Time of the simulations [s].
    `spared`: Arches an engine was asked about, and `limit` answered for.
    """

    rows: int = 0
    failed: int = 0
    simulated: int = 0
    simulated_s: float = 0.0
    spared: int = 0

    def add(self, other: Tally) -> None:
        """Count the rows of another tally, too."""
        for name, value in vars(other).items():
            setattr(self, name, getattr(self, name) + value)


class Answered(NamedTuple):
    """Rows as they are written, and what they took.

    `seconds`: Per pace of cases: number of cases and time taken [s].
    """

    lines: list[bytes]
    tally: Tally
    seconds: dict[Pace, tuple[int, float]]


@cache
def version_of(method: str) -> str:
    """Version of what answers: of blocksim, and of the library an engine is made of."""
    if method in STATIC:
        return blocksim.__version__
    name = NAMES[0] if method == "auto" else method
    return f"{blocksim.__version__} {name} {get_engine(name).version}"


def answer(asked: Sequence[Asked], versions: dict[str, str]) -> Answered:
    """Answer cases, in a worker.

    `versions`: Of each method, as where the sweep was started.
    """
    for method in {each.case.method for each in asked}:
        if version_of(method) != versions[method]:
            part = f"blocksim {versions[method]}"
            raise MissingPart(part, f"a worker has {version_of(method)}; install the same")
    rows = [each.row(versions) for each in asked]
    cases = [each.case for each in asked]
    simulated = _fill_in(cases, rows)
    tally = Tally(rows=len(rows), failed=sum("error" in row for row in rows))
    seconds: defaultdict[Pace, tuple[int, float]] = defaultdict(lambda: (0, 0.0))
    for k, (case, row) in enumerate(zip(cases, rows, strict=True)):
        wall = cast("float", row["wall_s"])
        pace = case.pace
        count, total = seconds[pace]
        seconds[pace] = count + 1, total + wall
        if k in simulated:
            tally.simulated += 1
            tally.simulated_s += wall
        elif case.band and "error" not in row:
            tally.spared += 1
    return Answered([encoded(row) for row in rows], tally, dict(seconds))


def _fill_in(cases: list[Case], rows: list[Row]) -> set[int]:
    """Answer in bulk where statics tell, else one by one. Return which were simulated."""
    plain = [k for k, case in enumerate(cases) if case.is_plain]
    left = [*range(len(cases))]
    if plain:
        started = time.perf_counter()
        near = by_statics([cases[k] for k in plain], [rows[k] for k in plain])
        share = (time.perf_counter() - started) / len(plain)
        for k in plain:
            rows[k]["wall_s"] = share
        left = [*{*left}.difference(plain), *(plain[k] for k in near)]
    for k in left:
        _alone(cases[k], rows[k])
    return {k for k in left if "error" not in rows[k] and rows[k]["method"] not in STATIC}


def failed(asked: Asked, versions: dict[str, str], why: str) -> Answered:
    """Return the row of a case that no worker could answer."""
    row = asked.row(versions)
    row["error"] = why
    return Answered([encoded(row)], Tally(rows=1, failed=1), {})


def encoded(row: Row) -> bytes:
    """Return a row as one line of JSON."""
    return _ENCODER.encode(row).encode() + b"\n"


def _alone(case: Case, row: Row) -> None:
    """Fill in the answer of one case, or why there is none."""
    started = time.perf_counter()
    if case.is_plain:
        row["method"] = NAMES[0] if case.method == "auto" else case.method
    row.pop("verdict", None)
    try:
        problem = case.problem(cast("float | None", row.get("eta")))
        method, settings = str(row["method"]), dict(case.settings)
        if case.over is None:
            seen = check(problem, method=method, settings=settings)
            row.update(_checked(seen), **_of_arch(row, seen.arch))
        else:
            found = bracket(
                problem,
                over=case.over,
                method=method,
                tol=case.tol,
                confirm=case.confirm,
                settings=settings,
            )
            row.update(_bracketed(found), **_of_arch(row, found.arch))
    except MissingPart:
        raise
    except Exception as error:
        row["error"] = reason_of(error)
    row["wall_s"] = time.perf_counter() - started


def _checked(seen: Check) -> Row:
    found: Row = {
        "method": seen.method,
        "verdict": seen.verdict.value,
        "rest": seen.rest,
        "load_factor": endless_text(seen.load_factor),
        "reason": seen.reason,
    }
    if seen.shaken is not None:
        found["largest_rotation_deg"] = math.degrees(seen.shaken.rocking.rotation)
        found["first_impact_s"] = seen.shaken.first_impact_s
    return found


def _bracketed(found: Bracket) -> Row:
    said = same(found, "method", "unit", "limit", "low", "high", "confirmed", "reason")
    return {**said, "limit": endless_text(found.limit)}


def _of_arch(row: Row, told: ArchAnswer | None) -> Row:
    """Return what the row does not say yet of an arch."""
    if told is None:
        return {}
    found: Row = {
        "half_angle_deg": math.degrees(told.shape.half_angle),
        **same(told.shape, "voussoirs", "weight"),
        **same(told, "mode", "mode_in_motion", "mode_theory", "eta_theory", "eta_limit"),
    }
    is_bracket = isinstance(told, ArchBracket)
    found |= same(told, "eta_low", "eta_high") if is_bracket else same(told.shape, "eta")
    return {name: value for name, value in found.items() if row.get(name) is None}


def reason_of(error: BaseException) -> str:
    """Say in one line what went wrong."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
