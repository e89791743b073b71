"""Random arches by `direct`, many of them with contacts that cannot slip.

Question: does `direct` answer every arch as limit analysis does, where mu = inf too? Arches
are drawn over half-angle, friction, number of voussoirs and weight model; two of five have
mu = inf, one of five a finite friction from 5 to 10^6. Each is held at rest at one thickness,
between half and twice its least, down to 1e-9 of it.

Result: of 1,700 arches (seed 14), 679 with mu = inf, none is answered wrongly and none is left
open. They take 0.03 s of processor time each in the mean. Three take longer than 0.4 s, 1.6 s
at most: wide arches of many voussoirs, below their least thickness, of huge friction or inf.

Run: python -m analysis.no_slip OUT [--seed N] [--processes N]. Rows are kept in
OUT/no_slip.jsonl, the same command goes on after an interruption; they are written as
OUT/no_slip.csv, too.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim.arch.circular import Arch, Weight
from blocksim.arch.limit import least_thickness
from blocksim.kinds.circular import arch_problem
from blocksim.simulation.observation import observe
from blocksim.simulation.verdict import Verdict

SEED = 14
ARCHES = 1700
ASIDE = (0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9)
"""Distances from the least thickness; twice it stands for half above."""


@dataclass(frozen=True)
class Case:
    """One arch at one thickness."""

    half_angle: float
    mu: float
    voussoirs: int
    weight: Weight
    eta: float
    ratio: float


@dataclass(frozen=True)
class Result:
    """How many were asked and answered, with mu = inf and in all."""

    arches: int
    no_slip: int
    false: int
    undecided: int
    no_slip_undecided: int
    cpu_s: float
    slowest_s: float


def cases(count: int, seed: int, most_voussoirs: int = 120) -> Iterator[Case]:
    """Draw arches."""
    random = np.random.default_rng(seed)
    while count:
        half_angle = math.radians(random.uniform(20, 159))
        voussoirs = int(random.integers(4, most_voussoirs + 1))
        weight: Weight = "centreline" if random.random() < 0.5 else "sector"
        kind = random.random()
        if kind < 0.4:
            mu = math.inf
        elif kind < 0.6:
            mu = float(10 ** random.uniform(math.log10(5), 6))
        else:
            mu = float(random.uniform(0.3, 5))
        aside = float(random.choice(ASIDE))
        ratio = 1 - aside if random.random() < 0.5 else 1 / (1 - aside)
        state = least_thickness(half_angle, mu, voussoirs, weight)
        if state.eta is None or state.eta * ratio >= 2:
            continue
        yield Case(half_angle, mu, voussoirs, weight, state.eta * ratio, ratio)
        count -= 1


def ask(case: Case) -> Row:
    """Hold one arch at rest."""
    started = time.process_time()
    arch = Arch(
        half_angle=case.half_angle,
        eta=case.eta,
        voussoirs=case.voussoirs,
        weight=case.weight,
    )
    found = observe(arch_problem(arch, case.mu), "direct", moving=False)
    return {
        "verdict": found.verdict,
        "reason": found.reason,
        "cpu_s": time.process_time() - started,
    }


def main(out: Path, *, quick: bool = False, seed: int = SEED, processes: int = 1) -> Result:
    """Run the study and return its numbers."""
    asked = list(cases(20, seed, 20) if quick else cases(ARCHES, seed))
    rows = answers(out / "no_slip.jsonl", asked, ask, processes)
    table = [asdict(case) | row for case, row in zip(asked, rows, strict=True)]
    write_rows(out / "no_slip.csv", table)
    false = undecided = free = 0
    for case, row in zip(asked, rows, strict=True):
        right = Verdict.STANDS if case.ratio > 1 else Verdict.COLLAPSES
        if row["verdict"] == right:
            continue
        sys.stderr.write(f"{case}\n    {row}\n")
        undecided += row["verdict"] == Verdict.UNDECIDED
        free += row["verdict"] == Verdict.UNDECIDED and math.isinf(case.mu)
        false += row["verdict"] != Verdict.UNDECIDED
    seconds = [float(row["cpu_s"] or 0) for row in rows]
    return Result(
        arches=len(asked),
        no_slip=sum(math.isinf(case.mu) for case in asked),
        false=false,
        undecided=undecided,
        no_slip_undecided=free,
        cpu_s=sum(seconds),
        slowest_s=max(seconds),
    )


if __name__ == "__main__":
    run(main)
