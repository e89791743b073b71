"""Random arches, reduced as an engine is asked by default, against limit analysis.

Question: do half an arch and merged voussoirs (`blocksim.arch.reduction`) ever lead an impulse
engine to a wrong answer? Random arches of all modes, thin and thick, few voussoirs and many,
both weights, some without slip, are checked 1 % and 0.1 % to both sides of their least
thickness: held at rest, then let go.

Expected: none false; what is open is counted.

    python -m analysis.reduced_arches OUT --engine pymunk

Answers are kept as they come: a run that was stopped goes on where it was.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.drawing import Draw, draws
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import check
from blocksim.arch.limit import least_thickness
from blocksim.kinds.circular import CircularArch

SEED = 1919
DEGREES, FRICTIONS = (20.0, 159.0), (0.3, 3.5)
EVERY = 6
"""One arch in so many has no bound on friction."""
SIDES = (0.99, 0.999, 1.001, 1.01)
"""Thickness over the least."""


@dataclass(frozen=True)
class Case:
    """One arch at one thickness, as an engine is asked about it."""

    engine: str
    draw: Draw
    ratio: float
    reduce: bool | None


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    Parameters
    ----------
    asked, right, false, undecided : int
    whole : int
        Answers for which all voussoirs had to be asked.
    median_s, worst_s : float
        Processor time of a check.
    """

    asked: int
    right: int
    false: int
    undecided: int
    whole: int
    median_s: float
    worst_s: float


def arches(counts: tuple[int, int]) -> Iterator[Draw]:
    """Draw arches, some of them without bound on friction."""
    drawn = draws(SEED, degrees=DEGREES, counts=counts, near=0.4, frictions=FRICTIONS)
    for index, draw in enumerate(drawn):
        if index % EVERY:
            if draw.eta * SIDES[-1] < 2:
                yield draw
            continue
        state = least_thickness(draw.half_angle, math.inf, draw.voussoirs, draw.weight)
        if state.eta and state.mode and state.eta * SIDES[-1] < 2:
            yield replace(draw, mu=math.inf, eta=state.eta, mode=state.mode)


def ask(case: Case) -> Row:
    """Check one arch."""
    draw, started = case.draw, time.process_time()
    seen = check(
        CircularArch.of(draw.arch(case.ratio), friction=draw.mu),
        method=case.engine,
        reduce=case.reduce,
    )
    taken = time.process_time() - started
    expected = "collapses" if case.ratio < 1 else "stands"
    return {
        "half_angle_deg": round(math.degrees(draw.half_angle), 3),
        "mu": str(draw.mu) if math.isinf(draw.mu) else draw.mu,
        "voussoirs": draw.voussoirs,
        "weight": draw.weight,
        "mode": draw.mode.value,
        "ratio": case.ratio,
        "expected": expected,
        "verdict": seen.verdict.value,
        "blocks": seen.blocks,
        "splits": seen.splits,
        "processor_s": round(taken, 3),
        "reason": seen.reason,
    }


def main(
    out: Path,
    *,
    engine: str = "pymunk",
    count: int = 64,
    most: int = 301,
    all_voussoirs: bool = False,
    processes: int = 1,
    quick: bool = False,
) -> Result:
    """Run the study, write its rows, and return its numbers.

    Parameters
    ----------
    out : Path
        Folder of `reduced_arches_ENGINE.csv`.
    engine : str
    count : int
        Arches.
    most : int
        Most voussoirs of one.
    all_voussoirs : bool
        Ask without reduction, to compare times.
    processes : int
    quick : bool
        Two arches of at most 20 voussoirs.
    """
    if quick:
        count, most = 2, 20
    drawn = islice(arches((5, most)), count)
    reduce = False if all_voussoirs else None
    name = f"reduced_arches_{engine}{'_all' * all_voussoirs}"
    cases = [Case(engine, draw, ratio, reduce) for draw in drawn for ratio in SIDES]
    rows = answers(out / f"{name}.jsonl", cases, ask, processes)
    write_rows(out / f"{name}.csv", rows)
    said = [(row["verdict"], row["expected"]) for row in rows]
    times = [float(str(row["processor_s"])) for row in rows]
    right = sum(verdict == expected for verdict, expected in said)
    undecided = sum(verdict == "undecided" for verdict, _ in said)
    return Result(
        asked=len(rows),
        right=right,
        false=len(rows) - right - undecided,
        undecided=undecided,
        whole=sum(row["blocks"] == row["voussoirs"] for row in rows),
        median_s=float(np.median(times)),
        worst_s=max(times),
    )


if __name__ == "__main__":
    run(main)
