"""Up to which thickness an arch that can rest may move as well, as friction does not dilate.

Question: above the least thickness at which an arch can rest, is there a band in which
Coulomb's law lets it also start to move, and where does that band end? The end is found twice:

- `limit.starting` chooses what every contact does by branch and bound, and so proves that there
  is no motion of any kind where it finds none;
- `direct`'s solver follows a motion from thickness to thickness, begun with that of the last,
  until it is no solution any more.

It is asked just above the least thickness. A band that begins further up is not seen.

Expected: both ends agree to 0.1 %. Without sliding in the mode there is no band. It takes an
odd number of voussoirs, whose keystone slides, and friction of about cot(alpha/n).

    python -m analysis.two_answers OUT [--quick]

Rows are kept in OUT/two_answers.jsonl as they come, and written as two_answers.csv; the figure
is two_answers.png.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.rows import FIGURES, read_kept, write_rows
from analysis.saved_answers import Row, answers
from analysis.two_answers_map import draw
from blocksim import Arch, CircularArch, Problem
from blocksim.arch.circular import Weight
from blocksim.arch.limit.statics import least_thickness
from blocksim.blocks.assembly import SUPPORT
from blocksim.engines.contact.coulomb import OPEN, SLIDES_DOWN, SLIDES_UP, STICKS
from blocksim.engines.contact.solver import ContactProblem, Solution
from blocksim.limit.starting import LEAST_POWER, Start, may_start, rates_of
from blocksim.view.drawing import save_figure

ABOVE = 1.0005
"""Thickness over the least at which a band is looked for."""
STEP, FINE = 1.02, 1e-5
"""Ratio of two thicknesses at which a motion is followed, and how near its end is found."""
WIDTH = 1e-3
"""How far above the end of a followed motion another is looked for."""
THICKEST = 2.0
SECONDS = 900.0
NOTHING, SOLVED = 1e-9, 1e-9
SLIDING = (80.0, 0.25), (90.0, 0.3), (90.0, 0.35), (100.0, 0.42), (115.0, 0.68), (125.0, 0.84)
"""Half-angles and friction at which many arches slide in their mode."""
BETWEEN = (
    (7, 144.0, 2.4), (7, 146.0, 2.6), (7, 149.0, 3.2), (7, 151.5, 3.2), (7, 154.0, 3.2),
    (7, 156.0, 3.2), (9, 150.0, 3.6), (9, 152.5, 3.6), (9, 155.0, 3.6), (9, 155.0, 4.5),
    (11, 152.5, 4.5), (11, 155.0, 4.5), (11, 155.0, 5.5),
    (6, 150.0, 2.4), (6, 155.0, 2.4), (6, 155.0, 3.0),
    (8, 147.5, 2.6), (8, 150.0, 3.0), (8, 155.0, 3.0), (8, 155.0, 4.0),
)  # fmt: skip
"""More wide arches, also of an even number: voussoirs, half-angle and friction."""


@dataclass(frozen=True)
class Case:
    """An arch of the map."""

    voussoirs: int
    weight: Weight
    alpha_deg: float
    mu: float

    def problem(self, eta: float) -> Problem:
        """Return the arch of a thickness."""
        arch = Arch(
            half_angle=math.radians(self.alpha_deg),
            eta=eta,
            voussoirs=self.voussoirs,
            weight=self.weight,
        )
        return CircularArch.of(arch, self.mu).problem()


def cases() -> list[Case]:
    """Return the arches asked about: where the keystone slides, and elsewhere."""
    found: list[Case] = []
    weights: tuple[Weight, ...] = ("centreline", "sector")
    for weight in weights:
        found += [
            Case(7, weight, alpha, mu)
            for alpha in (142.5, 145.0, 147.5, 150.0, 152.5, 155.0, 157.5)
            for mu in (1.8, 2.2, 2.6, 3.0, 3.5, 4.0, 5.0)
        ]
        found += [
            Case(n, weight, alpha, mu)
            for n in (5, 7, 8)
            for alpha in (60.0, 90.0, 115.0, 135.0)
            for mu in (0.3, 0.5, 0.9, 1.4)
        ]
        found += [Case(7, weight, alpha, 2.4) for alpha in (145.0, 147.5, 150.0, 152.5, 155.0)]
        found += [Case(5, weight, alpha, mu) for alpha in (150.0, 155.0) for mu in (1.6, 2.0)]
        found += [Case(n, weight, *at) for n in (5, 7, 8) for at in SLIDING]
    found += [Case(15, "centreline", a, mu) for a in (150.0, 155.0) for mu in (4.5, 6.0, 8.0)]
    found += [Case(27, "centreline", 151.0, mu) for mu in (10.0, 13.0)]
    found += [Case(n, "centreline", *at) for n, *at in BETWEEN]
    return [each for each in found if has_limit(each)]


def has_limit(case: Case) -> bool:
    """Tell whether a least thickness exists, and arches thicker than it."""
    eta = limit_of(case)[0]
    return 0 < eta < THICKEST / ABOVE


def limit_of(case: Case) -> tuple[float, str]:
    """Return the least thickness, 0 where there is none, and its mode."""
    found = least_thickness(math.radians(case.alpha_deg), case.mu, case.voussoirs, case.weight)
    return found.eta or 0.0, str(found.mode)


def ask(case: Case) -> Row:
    """Find the end of the band."""
    least, mode = limit_of(case)
    row: Row = {
        "voussoirs": case.voussoirs,
        "weight": case.weight,
        "alpha_deg": case.alpha_deg,
        "mu": case.mu,
        "eta_limit": least,
        "mode": mode,
    }
    below, above, followed = least, least * ABOVE, least
    start = may_start(case.problem(above), seconds=SECONDS)
    power = start.power
    while start.moves:
        below, followed = above, follow(case, above, start)
        below = max(below, followed)
        above = below * (1 + WIDTH)
        if above >= THICKEST:
            start = Start(moves=True)
            break
        start = may_start(case.problem(above), seconds=SECONDS)
    known = start.moves is False
    return {
        **row,
        "band": None if start.moves is None else below > least,
        "eta_moves": below if below > least else None,
        "eta_rests": above if known else None,
        "eta_followed": followed if followed > least else None,
        "power": power,
    }


def follow(case: Case, eta: float, start: Start) -> float:
    """Follow a motion to the largest thickness at which `direct`'s solver still has it."""
    solution = settled(case.problem(eta), begun(case.problem(eta), start))
    return eta if solution is None else follow_on(case, eta, solution)


def follow_on(case: Case, eta: float, solution: Solution) -> float:
    """Follow a solution in motion to the largest thickness that the solver finds it at."""
    step = STEP
    while step - 1 > FINE:
        further = eta * step
        after = None
        if further < THICKEST:
            after = settled(case.problem(further), solution)
        if after is None:
            step = 1 + (step - 1) / 2
        else:
            eta, solution = further, after
    return eta


def begun(problem: Problem, start: Start) -> Solution:
    """Return a motion as the contact solver has it."""
    if start.accelerations is None or start.forces is None:
        raise ValueError("nothing moves")
    rates = rates_of(problem) @ start.accelerations.ravel()
    pressure, friction = start.forces[..., 0], start.forces[..., 1]
    slips = np.abs(rates[:, 2:]) > NOTHING
    contacts = np.full(pressure.shape, STICKS, dtype=np.int8)
    contacts[slips & (friction > 0)] = SLIDES_UP
    contacts[slips & (friction <= 0)] = SLIDES_DOWN
    contacts[pressure <= NOTHING] = OPEN
    return Solution(
        acceleration=start.accelerations,
        forces=np.hstack([pressure, friction]),
        contacts=contacts,
        residual=0.0,
        iterations=0,
    )


def settled(problem: Problem, start: Solution) -> Solution | None:
    """Solve the contacts at rest beginning with a motion; None where that ends in rest.

    That is where the power of the loads, over that of the fall without contacts, is least.
    """
    joints, masses = problem.assembly.joint_arrays, problem.assembly.masses
    rates = rates_of(problem).reshape(len(joints.before), 3, len(masses), 3)
    rows = np.zeros((len(joints.before), 4, 6))
    for side, blocks in enumerate((joints.before, joints.after)):
        own = np.flatnonzero(blocks != SUPPORT)
        rows[own, :, 3 * side : 3 * side + 3] = rates[own, :, blocks[own]][:, [0, 1, 2, 2]]
    contact = ContactProblem(joints.before, joints.after, masses, problem.friction)
    free = problem.applied_forces() / masses
    found = contact.solve(rows, np.zeros(rows.shape[:2]), free, start)
    power = float((problem.applied_forces() * found.acceleration).sum())
    moves = power > LEAST_POWER * float((problem.applied_forces() * free).sum())
    return found if found.residual <= SOLVED and moves else None


def drawn_again(path: Path) -> None:
    """Draw what the rows that are kept say."""
    with path.open("wb") as file:
        save_figure(draw(read_kept(FIGURES / "two_answers.csv")), file, "png")


def main(out: Path, *, processes: int = 2, quick: bool = False) -> str:
    """Draw the map of the band."""
    asked = cases()
    if quick:
        asked = [Case(7, "centreline", 155.0, 3.0), Case(5, "centreline", 90.0, 0.5)]
    rows = answers(out / "two_answers.jsonl", asked, ask, processes)
    write_rows(out / "two_answers.csv", rows)
    with (out / "two_answers.png").open("wb") as file:
        save_figure(draw(rows), file, "png")
    band = [row for row in rows if row["band"]]
    apart = [
        float(row["eta_rests"]) / float(row["eta_followed"]) - 1
        for row in band
        if row["eta_rests"]
    ]
    widest = max((float(r["eta_moves"]) / float(r["eta_limit"]) - 1 for r in band), default=0.0)
    return "\n".join(
        [
            f"{len(rows)} arches, {len(band)} with a band, the widest of {widest:.1%}",
            f"unknown: {sum(row['band'] is None for row in rows)}",
            f"both ends within {max(apart, default=0.0):.3%} at {len(apart)} arches",
        ]
    )


if __name__ == "__main__":
    run(main)
