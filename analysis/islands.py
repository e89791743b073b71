"""No false islands: whether answers stay right away from the limit, not only next to it.

Question: as an arch grows thicker, does the answer change once, at the least thickness, or are
there islands of falling arches among standing ones? Arches are drawn over half-angle (30-155
deg), friction (0.3-3.5), voussoirs (5-60), and weight model, half of them with little more
friction than stands at all. Each is held at rest at twelve ratios from 0.9 to 1.1 of its exact
least thickness, none nearer than 1 %; every fifth is let go, too.

    python -m analysis.islands OUT [--engine direct|pymunk|pybullet] [--processes N]

Answers are kept in OUT as they come, and not asked for again.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from analysis.drawing import Draw, draws
from analysis.saved_answers import Row, answers
from blocksim import Verdict
from blocksim.kinds.circular import arch_problem
from blocksim.simulation.observation import conclude, hold
from blocksim.view.style import FONT, MISS, QUIET, VERDICTS

SEED = 2025
ARCHES = {"direct": 200, "pymunk": 200, "pybullet": 40}
"""Drawn for each engine."""
MOST_VOUSSOIRS = {"direct": 60, "pymunk": 60, "pybullet": 30}
RATIOS = (0.9, 0.93, 0.96, 0.98, 0.985, 0.9895, 1.0105, 1.015, 1.02, 1.04, 1.07, 1.1)
LET_GO = 5
"""One arch in so many is let go."""


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    Of the answers of the onset test, `may_rest` of those undecided say that friction allows
    both. `not_monotone` counts arches that fall where a thinner one stands; `parted`, of the
    `let_go`, moving runs that say other than the onset test.
    """

    engine: str
    arches: int
    right: int
    wrong: int
    undecided: int
    may_rest: int
    not_monotone: int
    let_go: int
    parted: int
    cpu_s: float
    slowest_s: float


@dataclass(frozen=True)
class Case:
    """An arch at a ratio of its least thickness."""

    draw: Draw
    ratio: float
    let_go: bool


def cases(engine: str, count: int) -> list[Case]:
    """Draw arches, each at every ratio; first those that need the fewest sweeps."""
    drawn = draws(SEED, (30, 155), (5, MOST_VOUSSOIRS[engine]), near=0.5, frictions=(0.3, 3.5))
    chosen = islice((draw for draw in drawn if draw.eta * RATIOS[-1] <= 2), count)
    in_order = sorted(chosen, key=lambda draw: draw.voussoirs**3 / math.sqrt(draw.eta))
    return [
        Case(draw, ratio, number % LET_GO == 0)
        for number, draw in enumerate(in_order)
        for ratio in RATIOS
    ]


def ask(case: Case, engine: str) -> Row:
    """Hold an arch at rest, and let it go if that is asked for."""
    draw = case.draw
    started = time.process_time()
    held = hold(arch_problem(draw.arch(case.ratio), draw.mu), engine)
    cpu_s = time.process_time() - started
    ended = conclude(held, moving=case.let_go)
    return {
        "verdict": held.onset.verdict.value,
        "may_rest": held.onset.may_rest,
        "moving": ended.motion.verdict.value if ended.motion else None,
        "reason": ended.reason,
        "cpu_s": cpu_s,
    }


def main(
    out: Path, *, quick: bool = False, engine: str = "direct", processes: int = 1
) -> Result:
    """Run the study, write its figure and return its numbers."""
    asked = cases(engine, 4 if quick else ARCHES[engine])
    rows = answers(
        out / f"islands_{engine}.jsonl", asked, partial(ask, engine=engine), processes
    )
    _figure(asked, rows, engine, out / f"islands_{engine}.png")
    kinds = [_kind(case, row) for case, row in zip(asked, rows, strict=True)]
    for case, row, kind in zip(asked, rows, kinds, strict=True):
        if kind != "right" or row["moving"] not in {None, row["verdict"]}:
            sys.stderr.write(f"{case}\n    {row}\n")
    moved = [row for row in rows if row["moving"]]
    seconds = [float(row["cpu_s"] or 0) for row in rows]
    return Result(
        engine=engine,
        arches=len(asked) // len(RATIOS),
        right=kinds.count("right"),
        wrong=kinds.count("wrong"),
        undecided=len(kinds) - kinds.count("right") - kinds.count("wrong"),
        may_rest=kinds.count("may rest"),
        not_monotone=sum(not monotone(group) for group in _by_arch(rows)),
        let_go=len(moved),
        parted=sum(row["moving"] != row["verdict"] for row in moved),
        cpu_s=sum(seconds),
        slowest_s=max(seconds),
    )


def _kind(case: Case, row: Row) -> str:
    if row["verdict"] == Verdict.UNDECIDED:
        return "may rest" if row["may_rest"] else "not converged"
    right = Verdict.STANDS if case.ratio > 1 else Verdict.COLLAPSES
    return "right" if row["verdict"] == right else "wrong"


def _by_arch(rows: Sequence[Row]) -> list[Sequence[Row]]:
    return [rows[start : start + len(RATIOS)] for start in range(0, len(rows), len(RATIOS))]


def monotone(rows: Sequence[Row]) -> bool:
    """Tell whether no arch falls that is thicker than one that stands."""
    verdicts = [row["verdict"] for row in rows]
    if Verdict.STANDS not in verdicts:
        return True
    return Verdict.COLLAPSES not in verdicts[verdicts.index(Verdict.STANDS) :]


MARKS = {Verdict.COLLAPSES: "v", Verdict.STANDS: "s", Verdict.UNDECIDED: "o"}


def _figure(asked: Sequence[Case], rows: Sequence[Row], engine: str, path: Path) -> None:
    """Draw a column of answers for each arch, in the order of their half-angles."""
    angles = sorted(math.degrees(case.draw.half_angle) for case in asked[:: len(RATIOS)])
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(9, 4.2), layout="constrained")
        axes = figure.add_subplot()
        axes.axhline(1, color=QUIET, lw=0.8)
        wrong: list[tuple[int, float]] = []
        points: dict[str, list[tuple[int, float]]] = {verdict: [] for verdict in MARKS}
        for case, row in zip(asked, rows, strict=True):
            place = angles.index(math.degrees(case.draw.half_angle)), case.ratio
            points[str(row["verdict"])].append(place)
            if _kind(case, row) == "wrong":
                wrong.append(place)
        for verdict, marker in MARKS.items():
            if points[verdict]:
                at = zip(*points[verdict], strict=True)
                look = {"color": VERDICTS[verdict], "ms": 3.5, "mew": 0}
                axes.plot(*at, marker, label=verdict.value, **look)
        if wrong:
            at = zip(*wrong, strict=True)
            axes.plot(*at, "o", mfc="none", mec=MISS, ms=8, mew=0.9, label="wrong")
        ticks = [angle for angle in range(30, 160, 10) if angles[0] <= angle <= angles[-1]]
        places = np.searchsorted(angles, ticks)
        # The last of those too near to each other to be read.
        apart = np.append(np.diff(places) > len(angles) / 25, True)
        shown = [str(angle) for angle, far in zip(ticks, apart, strict=True) if far]
        axes.set_xticks(places[apart], shown)
        axes.set_xlabel("arches in the order of half-angle [deg]")
        axes.set_ylabel("thickness over the least")
        count = len(asked) // len(RATIOS)
        axes.set_title(f"{engine}: {count} random arches, each at twelve thicknesses")
        figure.legend(frameon=False, ncols=4, loc="outside lower center")
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)


if __name__ == "__main__":
    run(main)
