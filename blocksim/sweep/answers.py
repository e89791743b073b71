"""Cases to rows: static methods in bulk, simulation where it is worth it."""

from __future__ import annotations

import json
import math
import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

import blocksim
from blocksim.arch import Arch, Weight
from blocksim.assembly import Array
from blocksim.bracket import ETA_MAX, bracket
from blocksim.check import check
from blocksim.engines import get_engine
from blocksim.errors import MissingPart
from blocksim.ladder import STATIC
from blocksim.limit.bulk import joints_of, least_thickness_of_joints, which_stand
from blocksim.sweep.case import AUTO_ENGINE, Case, Given
from blocksim.theory.arrays import least_thicknesses
from blocksim.verdict import Verdict

Row = dict[str, object]
_ENCODER = json.JSONEncoder(allow_nan=False, check_circular=False)


class Asked(NamedTuple):
    """A case and its identity."""

    identity: bytes
    case: Case


class Kind(NamedTuple):
    """Cases that take about the same time."""

    method: str
    voussoirs: int
    is_bracket: bool
    settings: Given

    @classmethod
    def of(cls, case: Case) -> Kind:
        """Return the kind of a case."""
        return cls(case.method, case.voussoirs, case.is_bracket, case.settings)


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
        Per kind: number of cases and time taken [s].
    """

    lines: list[bytes]
    tally: Tally
    seconds: dict[Kind, tuple[int, float]]


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
    name = AUTO_ENGINE if method == "auto" else method
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
    started = time.perf_counter()
    rows = [_question(each, versions[each.case.method]) for each in asked]
    cases = [each.case for each in asked]
    simulations = _by_statics(cases, rows)
    share = (time.perf_counter() - started) / len(rows)
    for row in rows:
        row["wall_s"] = share
    for k in simulations:
        _by_simulation(cases[k], rows[k])
    tally = Tally(rows=len(rows), failed=sum(row["error"] is not None for row in rows))
    seconds: defaultdict[Kind, tuple[int, float]] = defaultdict(lambda: (0, 0.0))
    simulated = set(simulations)
    for k, (case, row) in enumerate(zip(cases, rows, strict=True)):
        kind, wall = Kind.of(case), float(str(row["wall_s"]))
        count, total = seconds[kind]
        seconds[kind] = count + 1, total + wall
        if k in simulated:
            tally.simulated += 1
            tally.simulated_s += wall
        elif case.band and row["error"] is None:
            tally.spared += 1
    return Answered([encoded(row) for row in rows], tally, dict(seconds))


def failed(asked: Asked, versions: dict[str, str], why: str) -> Answered:
    """Return the row of a case that no worker could answer."""
    row = _question(asked, versions[asked.case.method])
    row["error"] = why
    return Answered([encoded(row)], Tally(rows=1, failed=1), {})


def encoded(row: Row) -> bytes:
    """Return a row as one line of JSON."""
    return _ENCODER.encode(row).encode() + b"\n"


def _question(asked: Asked, version: str) -> Row:
    """Return the row of a case with nothing answered."""
    case = asked.case
    return {
        "id": asked.identity.hex(),
        "alpha_deg": case.alpha_deg,
        "mu": "inf" if math.isinf(case.mu) else case.mu,
        "voussoirs": case.voussoirs,
        "weight": case.weight,
        "eta": case.eta,
        "ratio": case.ratio,
        "asked": case.method,
        "settings": dict(case.settings) or None,
        "method": "limit" if case.method == "auto" else case.method,
        "version": version,
        "verdict": None,
        "mode": None,
        "mode_theory": None,
        "eta_theory": None,
        "eta_limit": None,
        "eta_low": None,
        "eta_high": None,
        "confirmed": None,
        "reason": None,
        "error": None,
        "wall_s": 0.0,
    }


def _by_statics(cases: Sequence[Case], rows: list[Row]) -> list[int]:
    """Fill in what closed form and limit analysis tell; return which are left to simulate."""
    groups: defaultdict[tuple[int, Weight], list[int]] = defaultdict(list)
    for k, case in enumerate(cases):
        groups[case.voussoirs, case.weight].append(k)
    left: list[int] = []
    for (voussoirs, weight), group in groups.items():
        alpha = np.radians([cases[k].alpha_deg for k in group])
        mu = np.array([cases[k].mu for k in group])
        continuous = least_thicknesses(alpha, mu, weight)
        names, least = continuous.mode.tolist(), _or_none(continuous.eta)
        for k, mode, eta in zip(group, names, least, strict=True):
            rows[k].update(mode_theory=mode, eta_theory=eta)
        _least_as_built(cases, rows, group, alpha, mu, voussoirs, weight)
        judged = [i for i, k in enumerate(group) if rows[k]["eta"] is not None]
        if judged:
            chosen = [group[i] for i in judged]
            arches = alpha[judged], mu[judged], voussoirs, weight
            left += _verdicts(cases, rows, chosen, arches)
        for k in group:
            if cases[k].is_bracket and not _bracketed(cases[k], rows[k]):
                left.append(k)
    return left


def _least_as_built(
    cases: Sequence[Case],
    rows: list[Row],
    group: Sequence[int],
    alpha: Array,
    mu: Array,
    voussoirs: int,
    weight: Weight,
) -> None:
    """Find the least thickness of the voussoirs where the question needs it."""
    needed = [
        i
        for i, k in enumerate(group)
        if (cases[k].eta is None and cases[k].method != "theory") or cases[k].ratio is not None
    ]
    if not needed:
        return
    found = least_thickness_of_joints(joints_of(alpha[needed], voussoirs), mu[needed], weight)
    for i, least in zip(needed, _or_none(found), strict=True):
        row, ratio = rows[group[i]], cases[group[i]].ratio
        row["eta_limit"] = least
        if ratio is None:
            continue
        if least is None:
            row["error"] = "no thickness up to eta = 2 stands, of which a ratio could be taken"
        elif ratio * least > ETA_MAX:
            row["error"] = f"eta = {ratio * least:.6g}: must be above 0 and at most 2"
        else:
            row["eta"] = ratio * least


Arches = tuple[Array, Array, int, Weight]


def _verdicts(
    cases: Sequence[Case], rows: list[Row], group: Sequence[int], arches: Arches
) -> list[int]:
    """Judge arches by statics; return those to be simulated instead."""
    alpha, mu, voussoirs, weight = arches
    eta = np.array([rows[k]["eta"] for k in group], dtype=float)
    band = np.array([cases[k].band for k in group])
    least = np.array([rows[k]["eta_theory"] for k in group], dtype=float)
    by_theory = np.array([cases[k].method == "theory" for k in group])
    stands = eta >= least  # False where none stands
    built = np.flatnonzero(~by_theory & np.isfinite(band))
    near = np.isinf(band)
    if built.size:
        a, m, e, b = alpha[built], mu[built], eta[built], band[built]
        stands[built] = which_stand(a, e, m, voussoirs, weight)
        within = np.flatnonzero(b)
        if within.size:
            # Within the band if a little thinner falls, or a little thicker stands.
            a, m, e, b = a[within], m[within], e[within], b[within]
            thinner = which_stand(a, e / (1 + b), m, voussoirs, weight)
            thicker = which_stand(a, np.minimum(e * (1 + b), ETA_MAX), m, voussoirs, weight)
            near[built[within]] = thinner != thicker
    for k, stood, theory in zip(group, stands.tolist(), by_theory.tolist(), strict=True):
        row = rows[k]
        row["verdict"] = (Verdict.STANDS if stood else Verdict.COLLAPSES).value
        row["method"] = "theory" if theory else "limit"
        if theory and not stood:
            row["mode"] = row["mode_theory"]
    return [k for k, simulate in zip(group, near.tolist(), strict=True) if simulate]


def _bracketed(case: Case, row: Row) -> bool:
    """Fill in a static bracket: both ends are the least thickness, or none stands."""
    if case.method not in {*STATIC, "auto"}:
        return False
    least = row["eta_theory" if case.method == "theory" else "eta_limit"]
    row.update(eta_low=ETA_MAX if least is None else least, eta_high=least)
    if case.method == "theory":
        row["mode"] = row["mode_theory"]
    return True


def _by_simulation(case: Case, row: Row) -> None:
    """Fill in what an engine shows, or why it shows nothing."""
    started = time.perf_counter()
    row.update(method=case.engine, verdict=None)
    try:
        if case.is_bracket:
            found = bracket(
                half_angle=math.radians(case.alpha_deg),
                mu=case.mu,
                voussoirs=case.voussoirs,
                weight=case.weight,
                method=case.engine,
                tol=case.tol,
                confirm=case.confirm,
                settings=dict(case.settings),
            )
            row.update(
                mode=found.mode,
                eta_limit=found.eta_limit,
                eta_low=found.eta_low,
                eta_high=found.eta_high,
                confirmed=found.confirmed,
                reason=found.reason,
            )
        else:
            arch = Arch(
                half_angle=math.radians(case.alpha_deg),
                eta=float(str(row["eta"])),
                voussoirs=case.voussoirs,
                weight=case.weight,
            )
            seen = check(arch, mu=case.mu, method=case.engine, settings=dict(case.settings))
            row.update(
                verdict=seen.verdict.value,
                mode=seen.mode,
                eta_limit=seen.eta_limit,
                reason=seen.reason,
            )
    except MissingPart:
        raise
    except Exception as error:
        row["error"] = reason_of(error)
    row["wall_s"] = time.perf_counter() - started


def reason_of(error: BaseException) -> str:
    """Say in one line what went wrong."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _or_none(values: Array) -> Iterable[float | None]:
    return [None if math.isnan(value) else value for value in values.tolist()]
