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
from blocksim.arch.circular import Arch
from blocksim.ask.bracket import bracket
from blocksim.ask.check import check
from blocksim.ask.methods import STATIC
from blocksim.common.errors import MissingPart
from blocksim.engines import NAMES, get_engine
from blocksim.kinds.circular import CircularArch, arch_problem
from blocksim.many.case import Case, Pace, Row
from blocksim.many.statics import by_statics
from blocksim.many.structurecase import StructureCase, reason_of

AnyCase = Case | StructureCase
_ENCODER = json.JSONEncoder(allow_nan=False, check_circular=False)


class Asked(NamedTuple):
    """A case and its identity."""

    identity: bytes
    case: AnyCase

    def row(self, versions: dict[str, str]) -> Row:
        """Return its row with nothing answered."""
        return self.case.row(self.identity, versions[self.case.method])


@dataclass(kw_only=True)
class Tally:
    """What a number of rows took.

    Parameters
    ----------
    rows, failed : int
        Rows, and those that say why there is no answer.
    simulated : int
    simulated_s : float
        Time of the simulations [s].
    spared : int
        Arches an engine was asked about, and `limit` answered for.
    """

    rows: int = 0
    failed: int = 0
    simulated: int = 0
    simulated_s: float = 0.0
    spared: int = 0

    def add(self, other: Tally) -> None:
        """Count the rows of another tally, too."""
        self.rows += other.rows
        self.failed += other.failed
        self.simulated += other.simulated
        self.simulated_s += other.simulated_s
        self.spared += other.spared


class Answered(NamedTuple):
    """Rows as they are written, and what they took.

    Parameters
    ----------
    lines : list of bytes
    tally : Tally
    seconds : dict
        Per pace of cases: number of cases and time taken [s].
    """

    lines: list[bytes]
    tally: Tally
    seconds: dict[Pace, tuple[int, float]]


@cache
def version_of(method: str) -> str:
    """Version of what answers: of blocksim, and of the library an engine is made of.

    Raises
    ------
    MissingPart
        If the engine's library is not installed.
    """
    if method in STATIC:
        return blocksim.__version__
    name = NAMES[0] if method == "auto" else method
    return f"{blocksim.__version__} {name} {get_engine(name).version}"


def answer(asked: Sequence[Asked], versions: dict[str, str]) -> Answered:
    """Answer cases, in a worker.

    Parameters
    ----------
    asked : sequence of Asked
    versions : dict
        Of each method, as where the sweep was started.

    Returns
    -------
    Answered

    Raises
    ------
    MissingPart
        If an engine is not installed here, or in another version.
    """
    for method in {each.case.method for each in asked}:
        if version_of(method) != versions[method]:
            part = f"blocksim {versions[method]}"
            raise MissingPart(part, f"a worker has {version_of(method)}; install the same")
    rows = [each.row(versions) for each in asked]
    cases = [each.case for each in asked]
    arches = [k for k, case in enumerate(cases) if isinstance(case, Case)]
    simulated = set(_arches([cast(Case, cases[k]) for k in arches], [rows[k] for k in arches]))
    simulated = {arches[k] for k in simulated}
    for k, case in enumerate(cases):
        if isinstance(case, StructureCase) and case.answer(rows[k]):
            simulated.add(k)
    tally = Tally(rows=len(rows), failed=sum(row["error"] is not None for row in rows))
    seconds: defaultdict[Pace, tuple[int, float]] = defaultdict(lambda: (0, 0.0))
    for k, (case, row) in enumerate(zip(cases, rows, strict=True)):
        wall = float(str(row["wall_s"]))
        count, total = seconds[case.pace]
        seconds[case.pace] = count + 1, total + wall
        if k in simulated:
            tally.simulated += 1
            tally.simulated_s += wall
        elif isinstance(case, Case) and case.band and row["error"] is None:
            tally.spared += 1
    return Answered([encoded(row) for row in rows], tally, dict(seconds))


def _arches(cases: list[Case], rows: list[Row]) -> list[int]:
    """Fill in the rows of arches, in bulk where statics tell; return those simulated."""
    if not cases:
        return []
    started = time.perf_counter()
    simulations = by_statics(cases, rows)
    share = (time.perf_counter() - started) / len(rows)
    for row in rows:
        row["wall_s"] = share
    for k in simulations:
        _by_simulation(cases[k], rows[k])
    return simulations


def failed(asked: Asked, versions: dict[str, str], why: str) -> Answered:
    """Return the row of a case that no worker could answer."""
    row = asked.row(versions)
    row["error"] = why
    return Answered([encoded(row)], Tally(rows=1, failed=1), {})


def encoded(row: Row) -> bytes:
    """Return a row as one line of JSON."""
    return _ENCODER.encode(row).encode() + b"\n"


def _by_simulation(case: Case, row: Row) -> None:
    """Fill in what an engine shows, or why it shows nothing."""
    started = time.perf_counter()
    row.update(method=case.engine, verdict=None)
    try:
        if case.is_bracket:
            asked = CircularArch(
                half_angle=math.radians(case.half_angle_deg),
                eta=1.0,
                voussoirs=case.voussoirs,
                weight=case.weight,
                friction=case.mu,
            )
            found = bracket(
                asked,
                method=case.engine,
                tol=case.tol,
                confirm=case.confirm,
                settings=dict(case.settings),
            )
            of = found.arch
            assert of is not None  # noqa: S101
            row.update(
                mode=of.mode,
                mode_in_motion=of.mode_in_motion,
                eta_limit=of.eta_limit,
                eta_low=of.eta_low,
                eta_high=of.eta_high,
                confirmed=found.confirmed,
                reason=found.reason,
            )
        else:
            arch = Arch(
                half_angle=math.radians(case.half_angle_deg),
                eta=float(str(row["eta"])),
                voussoirs=case.voussoirs,
                weight=case.weight,
            )
            problem = arch_problem(arch, case.mu)
            seen = check(problem, method=case.engine, settings=dict(case.settings))
            told = seen.arch
            assert told is not None  # noqa: S101
            row.update(
                verdict=seen.verdict.value,
                mode=told.mode,
                mode_in_motion=told.mode_in_motion,
                eta_limit=told.eta_limit,
                reason=seen.reason,
            )
    except MissingPart:
        raise
    except Exception as error:
        row["error"] = reason_of(error)
    row["wall_s"] = time.perf_counter() - started
