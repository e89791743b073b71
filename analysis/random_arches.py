"""Random arches by simulation, against limit analysis.

Question: how far is the least thickness found by an engine from the exact one, and does
it ever give a false answer? Arches are drawn over half-angle, friction, number of voussoirs
and weight model, as many of each collapse mode as there is room for. Each is bracketed (to
0.1 % in pymunk, 0.4 % in pybullet), checked below and above the exact value (by 1 % and 2 %)
by onset test and moving run, and its mode is observed below.

Expected: every centre within 0.2 % in pymunk and 1 % in pybullet, eight of ten within 0.5 %
there; no false answer; modes as limit analysis says.

    python -m analysis.random_arches OUT [pymunk|pybullet]
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.drawing import Draw, draws, plot_by_mode
from blocksim import Arch, Mode, Verdict, bracket
from blocksim.trial import trial
from blocksim.view.style import FONT

SEED = 2024


@dataclass(frozen=True)
class Plan:
    """What an engine is asked: arches, width of the brackets, how far aside of the exact."""

    arches: int
    tol: float
    aside: float


PLANS = {
    "pymunk": Plan(arches=48, tol=0.001, aside=0.01),
    "pybullet": Plan(arches=24, tol=0.004, aside=0.02),
}


@dataclass(frozen=True)
class Outcome:
    """What the engine said of it."""

    draw: Draw
    error: float
    confirmed: bool
    below: Verdict
    above: Verdict
    onset_below: Verdict
    onset_above: Verdict
    observed: Mode | None
    wall_s: float


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    `false` counts wrong verdicts of either kind of evidence aside of the exact value,
    `unsure` undecided ones.
    """

    engine: str
    arches: int
    worst_error: float
    median_error: float
    false: int
    unsure: int
    same_mode: int
    confirmed: int
    longest_bracket_s: float


def chosen(count: int) -> Iterator[Draw]:
    """Choose arches, no mode more often than a third of them."""
    taken: Counter[Mode] = Counter()
    for draw in draws(SEED, degrees=(60, 150), counts=(20, 40), near=0.7):
        if draw.eta <= 1.96 and taken[draw.mode] <= count / 3.5:
            taken[draw.mode] += 1
            yield draw
        if taken.total() == count:
            return


def ask(draw: Draw, engine: str) -> Outcome:
    """Bracket one arch, and try it to either side of the exact value."""
    plan = PLANS[engine]
    found = bracket(
        half_angle=draw.half_angle,
        mu=draw.mu,
        voussoirs=draw.voussoirs,
        weight=draw.weight,
        method=engine,
        tol=plan.tol,
    )
    below, above = (
        trial(
            Arch(
                half_angle=draw.half_angle,
                eta=draw.eta * factor,
                voussoirs=draw.voussoirs,
                weight=draw.weight,
            ),
            draw.mu,
            engine,
        )
        for factor in (1 - plan.aside, 1 + plan.aside)
    )
    return Outcome(
        draw=draw,
        error=math.inf if found.centre is None else found.centre / draw.eta - 1,
        confirmed=bool(found.confirmed),
        below=below.verdict,
        above=above.verdict,
        onset_below=below.onset.verdict,
        onset_above=above.onset.verdict,
        observed=below.mode,
        wall_s=found.wall_s,
    )


def main(out: Path, *, quick: bool = False, engine: str = "pymunk") -> Result:
    """Run the study, write its figure and return its numbers."""
    drawn = list(chosen(4 if quick else PLANS[engine].arches))
    asked = partial(ask, engine=engine)
    if quick:
        outcomes = [asked(draw) for draw in drawn]
    else:
        outcomes = []
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            for outcome in pool.map(asked, drawn):
                outcomes.append(outcome)
                sys.stderr.write(f"{outcome}\n")
    name = "random_arches" if engine == "pymunk" else f"random_arches_{engine}"
    _figure(outcomes, engine, out / f"{name}.png")
    right = {"below": Verdict.COLLAPSES, "above": Verdict.STANDS}
    said = [(o.below, right["below"]) for o in outcomes]
    said += [(o.above, right["above"]) for o in outcomes]
    said += [(o.onset_below, right["below"]) for o in outcomes]
    said += [(o.onset_above, right["above"]) for o in outcomes]
    errors = [abs(o.error) for o in outcomes]
    return Result(
        engine=engine,
        arches=len(outcomes),
        worst_error=max(errors),
        median_error=float(np.median(errors)),
        false=sum(v not in {want, Verdict.UNDECIDED} for v, want in said),
        unsure=sum(v is Verdict.UNDECIDED for v, _ in said),
        same_mode=sum(o.observed is o.draw.mode for o in outcomes),
        confirmed=sum(o.confirmed for o in outcomes),
        longest_bracket_s=max(o.wall_s for o in outcomes),
    )


def _figure(outcomes: list[Outcome], engine: str, path: Path) -> None:
    width = 100 * PLANS[engine].tol
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(7.5, 4.2), layout="constrained")
        axes = figure.add_subplot()
        axes.axhspan(-width / 2, width / 2, color="#eeeeee", label="half the bracket's width")
        axes.axhline(0, color="#888888", lw=0.8)
        plot_by_mode(axes, [o.draw for o in outcomes], [100 * o.error for o in outcomes])
        axes.set_ylim(-2 * width, 2 * width)
        axes.set_ylabel("centre of bracket over exact [%]")
        axes.set_title(f"{engine} against limit analysis: least thickness of random arches")
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/random_arches")
    chosen_engine = sys.argv[2] if len(sys.argv) > 2 else "pymunk"
    sys.stdout.write(f"{main(folder, engine=chosen_engine)}\n")
