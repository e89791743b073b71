"""What an answer costs by each method: the figures of the table of methods.

Question: how long do a check and a bracket take, and how far is the bracket from the exact
value? Five arches of 27 voussoirs, spread over the map, are checked 1 % below and above their
least thickness and bracketed, moving runs included, inside a running process. It is processor
time, so that other work on the machine counts little; median of the repeats, then median and
largest of the arches. OUT/costs.csv has the rows that the pages quote.

    python -m analysis.costs OUT
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import TypeVar

from analysis.command import run
from analysis.rows import write_rows
from blocksim import CircularArch, bracket, check
from blocksim.ask.methods import METHODS

ARCHES = ((90, 0.7), (125, 0.9), (145, 1.6), (155, 3.0), (65, 0.6))
"""Half-angle [deg] and friction."""
VOUSSOIRS = 27
TOLERANCES = {"direct": (1e-3, 1e-8), "pybullet": (4e-3,)}
"""Widths of the brackets; `COMMON` for any other method."""
COMMON = (1e-3,)
REPEATS, LONG = 3, 1.0
"""Times a question is asked; once if it takes longer than `LONG` [s]."""

Said = TypeVar("Said")


@dataclass(frozen=True)
class Cost:
    """Processor time of one question by one method [s], median and largest of the arches.

    `error` is the largest error of a bracket's centre, relative; 0 for a check. A check that is
    not right is told on standard error.
    """

    method: str
    question: str
    median_s: float
    longest_s: float
    error: float


def main(out: Path, *, quick: bool = False) -> list[Cost]:
    """Measure, write a table and return its lines."""
    methods = ("theory", "limit", "direct") if quick else tuple(METHODS)
    arches = ARCHES[:2] if quick else ARCHES
    costs: list[Cost] = []
    for method in methods:
        if not METHODS[method].missing:
            costs.append(_checks(method, arches))
            costs += [_brackets(method, arches, tol) for tol in TOLERANCES.get(method, COMMON)]
            sys.stderr.write(f"{method}\n")
    write_rows(out / "costs.csv", [asdict(cost) for cost in costs])
    return costs


def _arch(degrees: float, mu: float, eta: float | None = None) -> CircularArch:
    return CircularArch(
        half_angle=math.radians(degrees), friction=mu, eta=eta, voussoirs=VOUSSOIRS,
        weight="centreline",
    )  # fmt: skip


def _checks(method: str, arches: tuple[tuple[float, float], ...]) -> Cost:
    seconds: list[float] = []
    for degrees, mu in arches:
        for ratio, right in ((0.99, "collapses"), (1.01, "stands")):
            eta = _arch(degrees, mu).but(ratio=ratio).eta
            took, said = _timed(
                lambda d=degrees, m=mu, e=eta: check(_arch(d, m, e), method=method).verdict
            )
            # The continuous arch differs from that of 27 voussoirs by up to 2 %.
            if said != right and method != "theory":
                sys.stderr.write(f"{method}, {degrees} deg at {ratio}: {said}\n")
            seconds.append(took)
    return Cost(method, "check", median(seconds), max(seconds), 0.0)


def _brackets(method: str, arches: tuple[tuple[float, float], ...], tol: float) -> Cost:
    seconds, errors = list[float](), list[float]()
    for degrees, mu in arches:
        took, found = _timed(
            lambda d=degrees, m=mu: bracket(_arch(d, m), method=method, tol=tol)
        )
        seconds.append(took)
        known = found.arch
        exact = known.eta_theory if method == "theory" else known.eta_limit
        errors.append(abs((known.centre or math.inf) / (exact or math.nan) - 1))
    return Cost(method, f"bracket to {tol:g}", median(seconds), max(seconds), max(errors))


def _timed(ask: Callable[[], Said]) -> tuple[float, Said]:
    seconds: list[float] = []
    while True:
        started = time.process_time()
        said = ask()
        seconds.append(time.process_time() - started)
        if len(seconds) == REPEATS or seconds[0] > LONG:
            return median(seconds), said


if __name__ == "__main__":
    run(main, lambda costs: "\n".join(map(str, costs)))
