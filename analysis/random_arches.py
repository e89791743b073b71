"""Least thickness of random arches by simulation, against limit analysis.

Question: how far is the least thickness found by an engine from the exact one? Arches are
drawn over half-angle, friction, number of voussoirs and weight model, as many of each collapse
mode as there is room for. Each is bracketed by onset tests, and let go at both ends, where the
lower tells its mode. A few hard ones are added: long, thin, steep.

Expected: every centre within half the bracket's width, or else an end is false; every end
confirmed; modes as limit analysis says. Where Coulomb's law has two answers (`onset.py`)
pybullet is undecided above the limit, and its bracket wide.

    python -m analysis.random_arches OUT [--engine pymunk|pybullet] [--processes N]

Answers are kept in OUT as they come, and not asked for again; they are written as rows, too
(random_arches_ENGINE.csv).
"""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from analysis.drawing import Draw, draws, plot_by_mode
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import bracket
from blocksim.arch.limit import least_thickness
from blocksim.kinds.circular import CircularArch
from blocksim.view.style import FONT, QUIET

SEED = 2024


@dataclass(frozen=True)
class Plan:
    """What an engine is asked: arches between which bounds, and the width of the brackets.

    `hard` are arches besides: half-angle [deg], friction, voussoirs.
    """

    arches: int
    degrees: tuple[float, float]
    counts: tuple[int, int]
    tol: float
    hard: tuple[tuple[float, float, int], ...]


PLANS = {
    "pymunk": Plan(
        arches=40,
        degrees=(30, 155),
        counts=(5, 60),
        tol=2e-4,
        hard=((90, 0.7, 101), (125, 0.9, 101), (150, 2, 101), (30, 0.9, 27), (155, 3, 27)),
    ),
    "pybullet": Plan(
        arches=40,
        degrees=(30, 155),
        counts=(5, 60),
        tol=2e-3,
        hard=((155, 3, 27),),
    ),
}


@dataclass(frozen=True)
class Result:
    """Headline numbers: of the random arches, and the error and time of each hard one.

    `within` counts brackets whose centre is exact to half their width.
    """

    engine: str
    arches: int
    within: int
    worst_error: float
    median_error: float
    undecided: int
    confirmed: int
    same_mode: int
    median_cpu_s: float
    longest_cpu_s: float
    hard: dict[str, tuple[float, float]]


def chosen(plan: Plan, count: int) -> Iterator[Draw]:
    """Choose arches, no mode more often than a third of them."""
    taken: Counter[str] = Counter()
    drawn = draws(SEED, plan.degrees, plan.counts, near=0.7, frictions=(0.3, 3.5))
    for draw in drawn:
        if draw.eta <= 1.96 and taken[draw.mode] <= count / 3.5:
            taken[draw.mode] += 1
            yield draw
        if taken.total() == count:
            return


def hard(plan: Plan) -> Iterator[Draw]:
    """Return the hard arches."""
    for degrees, mu, voussoirs in plan.hard:
        half_angle = math.radians(degrees)
        state = least_thickness(half_angle, mu, voussoirs, "centreline")
        if state.eta is not None and state.mode is not None:
            yield Draw(half_angle, mu, voussoirs, "centreline", state.eta, state.mode)


def ask(draw: Draw, engine: str) -> Row:
    """Bracket one arch."""
    started = time.process_time()
    found = bracket(
        CircularArch(
            half_angle=draw.half_angle,
            friction=draw.mu,
            voussoirs=draw.voussoirs,
            weight=draw.weight,
        ),
        method=engine,
        tol=PLANS[engine].tol,
        reduce=False,
    )
    return {
        "low": found.arch.eta_low and found.arch.eta_low / draw.eta - 1,
        "high": found.arch.eta_high and found.arch.eta_high / draw.eta - 1,
        "confirmed": found.confirmed,
        "undecided": found.undecided,
        "mode": found.arch.mode,
        "cpu_s": time.process_time() - started,
    }


def main(
    out: Path, *, quick: bool = False, engine: str = "pymunk", processes: int = 1
) -> Result:
    """Run the study, write its figure and return its numbers."""
    plan = PLANS[engine]
    if quick:
        plan = replace(plan, arches=4, degrees=(60, 150), counts=(5, 15), hard=())
    drawn, others = list(chosen(plan, plan.arches)), list(hard(plan))
    # Those that ask for the least sweeps come first: a run cut short has most of them.
    drawn.sort(key=lambda draw: draw.voussoirs**3 / math.sqrt(draw.eta))
    rows = answers(
        out / f"random_arches_{engine}.jsonl",
        [*drawn, *others],
        partial(ask, engine=engine),
        processes,
    )
    name = "random_arches" if engine == "pymunk" else f"random_arches_{engine}"
    _figure([*drawn, *others], rows, engine, out / f"{name}.png")
    asked = [
        {"kind": "random", **_facts(draw), **row}
        for draw, row in zip(drawn, rows, strict=False)
    ]
    asked += [
        {"kind": "hard", **_facts(draw), **row}
        for draw, row in zip(others, rows[len(drawn) :], strict=True)
    ]
    write_rows(out / f"random_arches_{engine}.csv", asked)
    for draw, row in zip([*drawn, *others], rows, strict=True):
        if abs(_error(row)) > plan.tol / 2 or not row["confirmed"] or row["mode"] != draw.mode:
            sys.stderr.write(f"{draw}\n    {row}\n")
    told = list(zip(drawn, rows, strict=False))
    errors = [abs(_error(row)) for _, row in told]
    seconds = [float(row["cpu_s"] or 0) for _, row in told]
    return Result(
        engine=engine,
        arches=len(drawn),
        within=sum(error <= plan.tol / 2 for error in errors),
        worst_error=max(errors),
        median_error=float(np.median(errors)),
        undecided=sum(bool(row["undecided"]) for _, row in told),
        confirmed=sum(bool(row["confirmed"]) for _, row in told),
        same_mode=sum(row["mode"] == draw.mode for draw, row in told),
        median_cpu_s=float(np.median(seconds)),
        longest_cpu_s=max(seconds),
        hard={
            f"{math.degrees(draw.half_angle):.0f} deg, mu {draw.mu:g}, n {draw.voussoirs}": (
                _error(row),
                float(row["cpu_s"] or 0),
            )
            for draw, row in zip(others, rows[len(drawn) :], strict=True)
        },
    )


def _facts(draw: Draw) -> Row:
    """Return an arch and its exact answer as columns; its answer's mode is `mode`."""
    return {
        "half_angle_deg": math.degrees(draw.half_angle),
        "mu": draw.mu,
        "voussoirs": draw.voussoirs,
        "weight": draw.weight,
        "eta": draw.eta,
        "mode_exact": draw.mode.value,
    }


def _error(row: Row) -> float:
    """Error of the bracket's centre, relative; inf where there is no bracket."""
    low, high = row["low"], row["high"]
    return math.inf if low is None or high is None else (float(low) + float(high)) / 2


def _figure(drawn: Sequence[Draw], rows: Sequence[Row], engine: str, path: Path) -> None:
    width = 100 * PLANS[engine].tol
    found = [(draw, 100 * _error(row)) for draw, row in zip(drawn, rows, strict=True)]
    inside = [(draw, error) for draw, error in found if abs(error) < width]
    outside = len(found) - len(inside)
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(7.5, 4.2), layout="constrained")
        axes = figure.add_subplot()
        axes.axhspan(-width / 2, width / 2, color="#eeeeee", label="half the bracket's width")
        axes.axhline(0, color=QUIET, lw=0.8)
        plot_by_mode(axes, [draw for draw, _ in inside], [error for _, error in inside])
        axes.set_ylim(-width, 2 * width)
        if outside:
            note = f"{outside} farther off or without a bracket"
            axes.text(0.99, 0.02, note, transform=axes.transAxes, ha="right", fontsize=8)
        axes.set_ylabel("centre of bracket over exact [%]")
        axes.set_title(f"{engine} against limit analysis: least thickness of random arches")
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)


if __name__ == "__main__":
    run(main)
