"""Early decisions: whether a moving run that ends early says what a long one would.

Question: a moving run ends when a corner has moved 2e-3 r, or after one sqrt(r/g) in which
nothing has (`motion.py`). Does it then err more often than a run of 25 sqrt(r/g) in which a
corner has to move 0.2 r, or must not have moved 1e-5 r at the end? Random arches (45-155 deg,
mu 0.3-3.5, 5-44 voussoirs, both weights) are let go by pymunk at six ratios from 0.99 to 1.01
of their least thickness, the nearest 0.05 % from it, once with each end.

Result: of 288 runs none differs and none is wrong; one, which may jam, is open in both. The
early ends take 9 % of the time simulated, and a fifth to a twentieth of the processor time.

    python -m analysis.early_decisions OUT [--processes N]

Answers are kept in OUT as they come, and not asked for again.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.drawing import Draw, draws
from analysis.saved_answers import Row, answers
from blocksim import Verdict
from blocksim.kinds.circular import arch_problem
from blocksim.simulation.observation import hold

SEED = 2026
ARCHES = 48
RATIOS = (0.99, 0.998, 0.9995, 1.0005, 1.002, 1.01)
FALLEN, UNMOVED, LONG = 0.2, 1e-5, 25.0
"""Displacements [r] and time [sqrt(r/g)] by which a long run is judged."""


@dataclass(frozen=True)
class Case:
    """An arch at a ratio of its least thickness."""

    draw: Draw
    ratio: float


@dataclass(frozen=True)
class Line:
    """Early and long runs at one ratio: wrong and open answers, and what they took.

    Times are medians, simulated in sqrt(r/g); `long_t` is when the run could have ended.
    """

    ratio: float
    runs: int
    early_wrong: int
    early_open: int
    long_wrong: int
    long_open: int
    early_t: float
    long_t: float
    early_cpu_s: float
    long_cpu_s: float


@dataclass(frozen=True)
class Result:
    """Headline numbers: how often the ends differ, and the share of time the early takes."""

    runs: int
    differ: int
    simulated_share: float
    lines: tuple[Line, ...]


def cases(count: int, most_voussoirs: int) -> list[Case]:
    """Draw arches, each at every ratio."""
    drawn = draws(SEED, (45, 155), (5, most_voussoirs), near=0.5, frictions=(0.3, 3.5))
    chosen = islice((draw for draw in drawn if draw.eta * RATIOS[-1] <= 2), count)
    return [Case(draw, ratio) for draw in chosen for ratio in RATIOS]


def ask(case: Case) -> Row:
    """Let an arch go twice, to the early end and to the late one."""
    draw = case.draw
    held = hold(arch_problem(draw.arch(case.ratio), draw.mu), "pymunk")
    started = time.process_time()
    early = held.release()
    early_cpu_s = time.process_time() - started
    again = hold(arch_problem(draw.arch(case.ratio), draw.mu), "pymunk")
    started = time.process_time()
    late = again.release(until=LONG)
    long_cpu_s = time.process_time() - started
    times, moved = late.recording.times, late.recording.displacement
    fallen = np.flatnonzero(moved > FALLEN)
    if len(fallen):
        verdict = Verdict.COLLAPSES
    elif times[-1] >= LONG * 0.99 and moved[-1] < UNMOVED:
        verdict = Verdict.STANDS
    else:
        verdict = Verdict.UNDECIDED
    return {
        "onset": held.onset.verdict.value,
        "early": early.verdict.value,
        "early_t": float(early.recording.times[-1]),
        "early_cpu_s": early_cpu_s,
        "long": verdict.value,
        "long_t": float(times[fallen[0] if len(fallen) else -1]),
        "long_moved": float(moved.max()),
        "long_cpu_s": long_cpu_s,
    }


def main(out: Path, *, quick: bool = False, processes: int = 1) -> Result:
    """Run the study and return its numbers."""
    asked = cases(2, 12) if quick else cases(ARCHES, 44)
    rows = answers(out / "early_decisions.jsonl", asked, ask, processes)
    both = list(zip(asked, rows, strict=True))
    for case, row in both:
        right = _right(case.ratio)
        if not row["early"] == row["long"] == row["onset"] == right:
            sys.stderr.write(f"{case}\n    {row}\n")
    early, late = ([float(row[key] or 0) for row in rows] for key in ("early_t", "long_t"))
    return Result(
        runs=len(rows),
        differ=sum(row["early"] != row["long"] for row in rows),
        simulated_share=sum(early) / sum(late),
        lines=tuple(
            _line(ratio, [row for case, row in both if case.ratio == ratio]) for ratio in RATIOS
        ),
    )


def _right(ratio: float) -> Verdict:
    return Verdict.STANDS if ratio > 1 else Verdict.COLLAPSES


def _line(ratio: float, rows: Sequence[Row]) -> Line:
    def middle(key: str) -> float:
        return float(np.median([float(row[key] or 0) for row in rows]))

    def count(key: str, *, undecided: bool) -> int:
        fine = {Verdict.UNDECIDED, _right(ratio)}
        said = [row[key] for row in rows]
        return said.count(Verdict.UNDECIDED) if undecided else sum(v not in fine for v in said)

    return Line(
        ratio=ratio,
        runs=len(rows),
        early_wrong=count("early", undecided=False),
        early_open=count("early", undecided=True),
        long_wrong=count("long", undecided=False),
        long_open=count("long", undecided=True),
        early_t=middle("early_t"),
        long_t=middle("long_t"),
        early_cpu_s=middle("early_cpu_s"),
        long_cpu_s=middle("long_cpu_s"),
    )


def table(result: Result) -> str:
    """Set the lines as a table in Markdown, with a line for all runs."""
    rows = [
        "| ratio | runs | early: wrong, open | long: wrong, open "
        "| early ends at | long ends at | processor time: early, long |",
        "|---|---|---|---|---|---|---|",
    ]
    rows += [
        f"| {line.ratio:g} | {line.runs} | {line.early_wrong}, {line.early_open} "
        f"| {line.long_wrong}, {line.long_open} | {line.early_t:.2f} | {line.long_t:.2f} "
        f"| {line.early_cpu_s:.3f} s, {line.long_cpu_s:.3f} s |"
        for line in result.lines
    ]
    rows.append("")
    rows.append(
        f"{result.runs} runs, {result.differ} differ; time {result.simulated_share:.3f}"
    )
    return "\n".join(rows)


if __name__ == "__main__":
    run(main, table)
