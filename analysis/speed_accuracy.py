"""Speed against accuracy, for every method, with settings from coarse to fine.

Question: what does accuracy cost, how much does solving each step's contacts to their end gain
over sweeping them, and how far off is an engine that is used without the onset test? The chart
of `blocksim chart`: five arches, hard ones too (thin, long, steep); error is that of a
bracket's farther end against limit analysis.

The bisection is the same for all, so at equal tolerance errors are equal and times compare.

Expected: at the time pymunk needs for its finest bracket, `direct` is a hundred times nearer
in every arch; so it is at the time pybullet needs. Let go at once, with the usual steps and
sweeps, arches fall in impulse engines at every thickness. In pymunk, which keeps impulses from
step to step, work is better spent on shorter steps, until there are sweeps enough to solve a
step from nothing; in pybullet, which forgets friction's, on sweeps.

    python -m analysis.speed_accuracy OUT
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from analysis.command import run
from blocksim import Arch
from blocksim.arch import limit
from blocksim.ask.search import Answer, Bisection
from blocksim.engines import ENGINES
from blocksim.kinds.circular import CircularArch
from blocksim.report.chart import write_chart
from blocksim.simulation.simulated import Simulation
from blocksim.studies.chart import START, ChartArch, cases, gain, measure
from blocksim.studies.refinement import STEP, TOL, let_go

SETTLED, LATE = 0.05, 10.0
"""How far a lenient judge lets arches settle [r], and how long that may take [sqrt(r/g)]."""


@dataclass(frozen=True)
class Result:
    """Headline numbers, by arch.

    Parameters
    ----------
    over_pymunk, over_pybullet : dict of str to float
        Error of an engine over that of `direct` in its time, by onset tests.
    alone : dict of str to dict of str to float
        Errors of moving runs alone, by engine and setting.
    lenient : dict of str to float
        Error of pymunk with the usual settings if arches may settle by far more: no bracket
        is for want of patience.
    """

    over_pymunk: dict[str, float]
    over_pybullet: dict[str, float]
    alone: dict[str, dict[str, float]]
    lenient: dict[str, float]


def main(out: Path, *, quick: bool = False) -> Result:
    """Measure, draw, and return the gain of `direct` at equal time and errors without it."""
    chosen = cases(quick=quick)
    points = measure(chosen, quick=quick)
    write_chart(points, out)
    own = {case.name: [p for p in points if p.case == case.name] for case in chosen}

    def over(engine: str) -> dict[str, float]:
        by_tolerance = {
            name: [p for p in here if p.knob == "tolerance"] for name, here in own.items()
        }
        return {
            name: gain(here, "direct", engine)
            for name, here in by_tolerance.items()
            if any(p.method == engine for p in here)
        }

    return Result(
        over_pymunk=over("pymunk"),
        over_pybullet=over("pybullet"),
        alone={
            name: {
                f"{p.method}, {p.knob} {p.value:.3g}": p.error
                for p in here
                if p.knob in {"step", "sweeps"}
            }
            for name, here in own.items()
        },
        lenient={case.name: lenient_error(case) for case in chosen},
    )


def lenient_error(case: ChartArch) -> float:
    """Bracket an arch by pymunk, let go at once, that stands if it settles at all."""
    exact = limit.least_thickness(case.half_angle, case.mu, case.voussoirs).eta or math.nan
    settings = {"step": STEP, "sweeps": ENGINES["pymunk"].usual_sweeps}

    def judge(eta: float) -> Answer:
        arch = Arch(half_angle=case.half_angle, eta=eta, voussoirs=case.voussoirs)
        simulation = Simulation.of(
            CircularArch.of(arch, case.mu).problem(), "pymunk", settings=settings
        )
        return Answer(let_go(simulation, moved=SETTLED, until=LATE).verdict, math.nan)

    search = Bisection(judge)
    search.expand(exact * START)
    search.bisect(TOL)
    return math.inf if search.high is None else search.high / exact - 1


if __name__ == "__main__":
    run(main)
