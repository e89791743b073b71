"""LMGC90, a program for the dynamics of contacts, on the arches of the chart.

Question: what does accuracy cost there? LMGC90 (non-smooth contact dynamics, implicit, in three
dimensions, Gauss and Seidel's sweeps) is driven by its own Python package, `compas_lmgc90`,
with no help of blocksim's: it moves, and an arch stands that has not moved.

An arch of r = 10 m is let go for a second, 1 sqrt(r/g); it stands if no voussoir has moved by
5e-4 m, 5e-5 r. Gravity, density and the law of contact (IQS_CLB) are the package's. Its least
thickness is bracketed to 0.1 % at time steps from coarse to fine, and held against exact limit
analysis of the same polyhedra: their weight is at their own centroids, which is neither of
blocksim's two models (up to 1 % in the least thickness), so the exact value is found here, from
forces of equilibrium.

Expected: an error that falls with the time step, 1.2 % at 4 ms and 0.06 % at 0.5 ms for the
semicircle of 27 voussoirs, several times that where joints slide. The thin arch is off by
40 % at the finest; of 101 voussoirs no thickness stands. The steep arch of the chart does not
stand at any thickness under this weight.

    pip install compas_lmgc90
    python -m analysis.lmgc90 OUT
    blocksim chart --beside OUT/lmgc90.json
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.util import find_spec
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from analysis.command import run
from blocksim.arch.circular import GRAVITY, Arch
from blocksim.ask.search import Answer, Bisection
from blocksim.blocks.assembly import SUPPORT, Array, Block
from blocksim.blocks.problem import Problem
from blocksim.limit import equilibrium
from blocksim.report.chart import write_points
from blocksim.simulation.verdict import Verdict
from blocksim.studies.chart import LONG, REPEATS, START, ChartArch, Point, cases

REMEDY = "LMGC90 is missing: pip install compas_lmgc90"
RADIUS, DEPTH = 10.0, 5.0
"""Of the arches [m]."""
DURATION, MOVED = 1.0, 5e-4
"""How long they are let go [s], and how far a voussoir that stands may move [m]."""
STEPS = (4e-3, 2e-3, 1e-3, 5e-4)
"""Time steps, from coarse to fine [s]."""
TOL = 1e-3
LOOK = 20
"""Time steps between two looks at how far blocks have moved."""
EXACT = 1e-9
THICKEST = 1.99


@dataclass(frozen=True)
class Result:
    """Headline numbers: error of the bracket's farther end by arch and time step [s].

    Empty where LMGC90 is not installed.
    """

    errors: dict[str, dict[float, float]]
    seconds: dict[str, dict[float, float]]


def main(out: Path, *, quick: bool = False) -> Result:
    """Bracket the arches, write `lmgc90.json`, and return errors and times."""
    if find_spec("compas_lmgc90") is None:
        sys.stderr.write(REMEDY + "\n")
        return Result({}, {})
    chosen = cases(quick=quick)[:1] if quick else cases(quick=False)
    points: list[Point] = []
    errors: dict[str, dict[float, float]] = {}
    seconds: dict[str, dict[float, float]] = {}
    for case in chosen:
        exact = least(case)
        if exact is None:
            sys.stderr.write(f"{case.name}: weighing these solids, no thickness stands\n")
            continue
        for step in STEPS[:1] if quick else STEPS:
            point = measured(case, exact, step, 1e-2 if quick else TOL)
            points.append(point)
            errors.setdefault(case.name, {})[step] = point.error
            seconds.setdefault(case.name, {})[step] = point.time
            write_points(points, out / "lmgc90.json")
            sys.stderr.write(
                f"{case.name}, {step:g} s: {point.error:.1e}, {point.time:.1f} s\n"
            )
            if point.time > 5 * LONG:
                break
    return Result(errors, seconds)


def measured(case: ChartArch, exact: float, step: float, tol: float) -> Point:
    """Bracket one arch at one time step, again and again if that does not take long."""
    processor_s: list[float] = []
    wall_s: list[float] = []
    while len(processor_s) < REPEATS and max(processor_s, default=0.0) <= LONG:
        started = os.times()
        search, work = bracketed(case, exact, step, tol)
        ended = os.times()
        # User and system, of this process and of those it has ended.
        processor_s.append(sum(ended[:4]) - sum(started[:4]))
        wall_s.append(ended.elapsed - started.elapsed)
    ends = (search.low, search.high)
    return Point(
        case=case.name,
        method="lmgc90",
        knob="step",
        value=step * math.sqrt(GRAVITY / RADIUS),
        error=max(math.inf if end is None else abs(end / exact - 1) for end in ends),
        low=search.low,
        high=search.high,
        undecided=search.undecided,
        work=work,
        processor_s=tuple(processor_s),
        wall_s=tuple(wall_s),
    )


def bracketed(
    case: ChartArch, exact: float, step: float, tol: float
) -> tuple[Bisection, float]:
    """Bracket one arch, and count contacts solved times the sweeps over them."""
    work = 0.0

    def judge(eta: float) -> Answer:
        nonlocal work
        try:
            # What it cannot do ends its process; a fork finds this file whatever it is called.
            with ProcessPoolExecutor(1, get_context("fork")) as pool:
                run = pool.submit(let_go, polygons(case, eta), case.mu, step)
                moved, taken = run.result()
        except BrokenProcessPool:
            return Answer(Verdict.UNDECIDED, math.nan)
        work += 4.0 * (case.voussoirs + 1) * taken
        return Answer(Verdict.COLLAPSES if moved > MOVED else Verdict.STANDS, math.nan)

    search = Bisection(judge)
    search.expand(exact * START)
    search.bisect(tol)
    return search, work


def arch_of(case: ChartArch, eta: float) -> Arch:
    """Return an arch of the case."""
    return Arch(
        half_angle=case.half_angle,
        eta=eta,
        voussoirs=case.voussoirs,
        radius=RADIUS,
        depth=DEPTH,
    )


def polygons(case: ChartArch, eta: float) -> list[Array]:
    """Outlines of the voussoirs [m], and last of the two supports: more of the same ring."""
    assembly = arch_of(case, eta).assembly()
    outlines = [np.array(block.vertices) for block in assembly.blocks]
    beyond = min(2 * case.half_angle / case.voussoirs, (math.pi - case.half_angle) / 2)
    for joint in assembly.joints:
        if SUPPORT not in (joint.before, joint.after):
            continue
        # Seen from above x grows clockwise from the crown; the arch goes on past its springing.
        turn = -beyond if joint.after == SUPPORT else beyond
        cos, sin = math.cos(turn), math.sin(turn)
        rotation = np.array([[cos, -sin], [sin, cos]])
        near = [joint.inner, joint.outer]
        far = [rotation @ end for end in reversed(near)]
        outlines.append(counter_clockwise(np.array([*near, *far])))
    return outlines


def counter_clockwise(outline: Array) -> Array:
    """Return a polygon's corners in that order."""
    x, y = outline.T
    area = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum()
    return outline if area > 0 else outline[::-1]


def centroid(outline: Array) -> tuple[Array, float]:
    """Return a polygon's centroid and area."""
    x, y = outline.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2
    middle = ((outline + np.roll(outline, -1, axis=0)) * cross[:, None]).sum(axis=0) / (
        6 * area
    )
    return middle, float(area)


def let_go(outlines: Sequence[Array], mu: float, step: float) -> tuple[float, int]:
    """Let an arch go in LMGC90.

    Returns
    -------
    moved : float
        Largest displacement of a voussoir's centre [m].
    taken : int
        Time steps taken; no more once it has moved by `MOVED`.
    """
    package = import_module("compas_lmgc90.solver")
    solver = package.Solver(dt=step)
    solver.geometry_from_v_f([prism(outline) for outline in outlines])
    fixed = np.zeros(6)
    for support in (len(outlines) - 2, len(outlines) - 1):
        solver.v_drvdof[support] = dict.fromkeys(range(1, 7), fixed)
    solver.contact_law("IQS_CLB", mu)
    solver.preprocess()
    start = np.array(solver.init_coor)
    moved, taken = 0.0, 0
    count = round(DURATION / step)
    while taken < count and moved <= MOVED:
        for _ in range(min(LOOK, count - taken)):
            # The package's own loop moves meshes, too, for pictures.
            state = solver.lmgc90.compute_one_step()
            taken += 1
        moved = float(np.linalg.norm(np.array(state.bodies) - start, axis=1).max())
    solver.finalize()
    return moved, taken


def prism(outline: Array) -> dict[str, list[list[float]] | list[list[int]]]:
    """Return a polygon of the plane as a solid, upright; faces wound outwards."""
    count = len(outline)
    vertices = [[float(x), y, float(z)] for y in (-DEPTH / 2, DEPTH / 2) for x, z in outline]
    sides = [[k, (k + 1) % count, (k + 1) % count + count, k + count] for k in range(count)]
    front, back = list(range(count)), list(range(2 * count - 1, count - 1, -1))
    return {"vertices": vertices, "faces": [front, back, *sides]}


def least(case: ChartArch, *, centroids: bool = True) -> float | None:
    """Exact least thickness of the polygons under their weight; None where none stands.

    Parameters
    ----------
    case : ChartArch
    centroids : bool
        Weight at the polygons' centroids; otherwise where blocksim's arch has it, by which
        this is held to `limit`.
    """

    def stands(eta: float) -> bool:
        assembly = arch_of(case, eta).assembly()
        if centroids:
            blocks = (_even(block) for block in assembly.blocks)
            assembly = replace(assembly, blocks=tuple(blocks))
        return equilibrium(Problem(assembly=assembly, mu=case.mu)).forces is not None

    low, high = 1e-4, THICKEST
    if not stands(high):
        return None
    while high / low > 1 + EXACT:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if stands(middle) else (middle, high)
    return high


def _even(block: Block) -> Block:
    """Return a block whose mass is spread evenly over its outline."""
    centre, area = centroid(np.array(block.vertices))
    return replace(block, centre=centre, mass=area)


if __name__ == "__main__":
    run(main)
