"""Where each engine stops working, and how far from there its settings are.

Question: over which arches, and with which settings, are answers right, undecided or wrong?
Truth is the least thickness of the same voussoirs by limit analysis; arches 0.5 % and 2 % to
both sides of it are asked about.

- *released*: the verdict of one release (no repetition with more sweeps) over time step and
  sweeps in a step, as multiples of what the engine's rule chooses. The onset test is as ever;
- *held*: the verdict of the onset test over length of joints and sweeps allowed;
- *lines*: onset test and release over half-angle, friction, number of voussoirs and scale;
- *lasting*: how far an arch 0.5 % above its least thickness moves in 500 sqrt(r/g), a hundred
  times as long as a release is watched;
- *energy*: the most energy a collapse ever gains, over what its weight has given, by step;
- *away*: the onset test with the arch built far from the origin of the engine's space, where
  by rule it is not asked.

Expected: by the rules' own settings nothing is wrong, and undecided only where friction allows
both answers to an engine that cannot be given forces; with up to twice the step and half the
sweeps all releases are right; the onset test needs at most a third of the sweeps allowed;
nothing that stands moves by 1e-5 r in 500 sqrt(r/g).

    python -m analysis.stability OUT [--engines NAME ...]
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.stability_figure import draw
from analysis.stability_grids import GRIDS, QUICK, Case, Grid
from blocksim import Arch
from blocksim.arch.limit import least_thickness
from blocksim.blocks.assembly import Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.common.files import write_whole
from blocksim.engines import ENGINES, get_engine
from blocksim.engines.base import Engine
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.motion import moving_run
from blocksim.simulation.observation import observe
from blocksim.simulation.onset import onset
from blocksim.simulation.recording import Recording
from blocksim.simulation.simulated import Simulation
from blocksim.simulation.verdict import Verdict

RATIOS = (0.98, 0.995, 1.005, 1.02)
COLLAPSING, WATCHED = 0.9, 1.5
"""Ratio and time of the collapses whose energy is looked at."""


@dataclass(frozen=True)
class Row:
    """One answer.

    Parameters
    ----------
    part : str
        Of the study.
    engine : str
    case : tuple
        Half-angle [deg], friction, voussoirs.
    ratio : float
        Of the least thickness.
    at : dict
        What was varied.
    outcome : str
        right, undecided or wrong.
    value : float
        A measure: motion [r], sweeps over voussoirs squared, or a share of energy.
    """

    part: str
    engine: str
    case: Case
    ratio: float
    at: dict[str, float]
    outcome: str
    value: float


def arch_at(case: Case, ratio: float) -> Arch:
    """Return an arch at a ratio of its least thickness."""
    degrees, mu, voussoirs = case
    alpha = math.radians(degrees)
    least = least_thickness(alpha, mu, voussoirs).eta
    if least is None or not 0 < least * ratio <= 2:
        message = f"no thickness lets {case} stand"
        raise ValueError(message)
    return Arch(half_angle=alpha, eta=least * ratio, voussoirs=voussoirs)


def simulation_of(engine: str, case: Case, ratio: float) -> Simulation:
    """Return such an arch in an engine."""
    return Simulation.of(CircularArch.of(arch_at(case, ratio), case[1]).problem(), engine)


def judged(verdict: Verdict, ratio: float) -> str:
    """Hold a verdict against the truth."""
    if verdict is Verdict.UNDECIDED:
        return "undecided"
    return "right" if (verdict is Verdict.STANDS) == (ratio > 1) else "wrong"


def released(engine: str, grid: Grid) -> Iterator[Row]:
    """Release arches in steps and with sweeps that are multiples of the rule's."""
    for case in grid.arches:
        for ratio in RATIOS:
            simulation = simulation_of(engine, case, ratio)
            sure = onset(
                simulation.world(), simulation.engine, simulation.taken, simulation.settings
            )
            for step in grid.steps:
                for sweeps in grid.sweeps:
                    chosen = replace(
                        simulation.settings,
                        repeats=0,
                        step=simulation.settings.step * step,
                        sweeps=max(1, round(simulation.settings.sweeps * sweeps * step)),
                    )
                    trying = replace(simulation, settings=chosen)
                    world = trying.world()
                    sure.repeat(world)
                    seen = moving_run(trying, world, sure.repeat)
                    at = {"step": step, "sweeps": sweeps, "overlap": seen.overlap}
                    way = float(seen.recording.displacement[-1])
                    yield Row(
                        "released", engine, case, ratio, at, judged(seen.verdict, ratio), way
                    )


def held(engine: str, grid: Grid) -> Iterator[Row]:
    """Ask the onset test with ever fewer sweeps allowed."""
    for case in grid.held:
        for ratio in RATIOS:
            simulation = simulation_of(engine, case, ratio)
            length, squared = simulation.assembly.shortest, case[2] ** 2
            rule = simulation.settings.hold_sweeps / squared
            decided = False
            for share in (*grid.allowed, rule):
                if decided and share != rule:
                    continue  # More of them are not spent.
                allowed = replace(simulation.settings, hold_sweeps=math.ceil(share * squared))
                seen = onset(simulation.world(), simulation.engine, simulation.taken, allowed)
                at = {"length": length, "allowed": share, "rule": rule}
                yield Row(
                    "held",
                    engine,
                    case,
                    ratio,
                    at,
                    judged(seen.verdict, ratio),
                    seen.sweeps / squared,
                )
                decided |= seen.verdict is not Verdict.UNDECIDED


def lines(engine: str, grid: Grid) -> Iterator[Row]:
    """Ask about one arch after the other along a line, onset test and release."""
    n = grid.number
    asked: list[tuple[str, float, Case, float]] = [
        *(("alpha", a, (a, 0.9 if a < 120 else 4.0, n), 1.0) for a in grid.alphas),
        *(("mu", mu, (90.0, mu, n), 1.0) for mu in grid.mus),
        *(("n", count, (90.0, 0.7, count), 1.0) for count in grid.counts),
        *(("radius", radius, (125.0, 0.9, n), radius) for radius in grid.radii),
    ]
    for name, value, case, radius in asked:
        for ratio in RATIOS:
            arch = replace(arch_at(case, ratio), radius=radius, depth=radius)
            seen = observe(CircularArch.of(arch, case[1]).problem(), engine)
            yield Row(
                "lines",
                engine,
                case,
                ratio,
                {name: value},
                judged(seen.verdict, ratio),
                seen.onset.acceleration,
            )


def lasting(engine: str, grid: Grid) -> Iterator[Row]:
    """Watch arches that stand for a hundred times as long."""
    for case in grid.lasting:
        simulation = simulation_of(engine, case, 1.005)
        world = simulation.world()
        sure = onset(world, simulation.engine, simulation.taken, simulation.settings)
        seen = moving_run(simulation, world, sure.repeat, until=grid.last)
        ways, times = seen.recording.displacement, seen.recording.times
        for mark in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0):
            if mark <= times[-1] + simulation.settings.step:
                way = float(ways[: np.searchsorted(times, mark) + 1].max())
                state = "right" if way < simulation.settings.rest else "wrong"
                yield Row("lasting", engine, case, 1.005, {"time": mark}, state, way)


def energy_gained(recording: Recording, assembly: Assembly) -> float:
    """Most energy ever gained over what the weight has given, from poses alone.

    Velocities are those that have carried the blocks to where they are: so engines step.
    """
    path = recording.poses - recording.poses[0]
    speed = np.diff(path, axis=0) / np.diff(recording.times)[:, None, None]
    masses = assembly.spatial_masses[:, : path.shape[-1]]
    kinetic = (masses * speed**2).sum(axis=(1, 2)) / 2
    given = -(masses[:, 1] * path[1:, :, 1]).sum(axis=1)
    return float((kinetic - given).max() / given.max())


def energy(engine: str, grid: Grid) -> Iterator[Row]:
    """Let arches collapse in ever longer steps, and see what energy they gain."""
    for case in grid.arches:
        simulation = simulation_of(engine, case, COLLAPSING)
        for factor in grid.steps:
            step = simulation.settings.step * factor
            sweeps = max(1, round(simulation.settings.sweeps * factor))
            trying = replace(
                simulation, settings=replace(simulation.settings, step=step, sweeps=sweeps)
            )
            world = trying.world()
            onset(world, simulation.engine, simulation.taken, trying.settings)
            poses = [world.poses()]
            for _ in range(max(3, math.ceil(WATCHED / step))):
                world.advance(1)
                poses.append(world.poses())
            recording = trying.record(
                [k * step for k in range(len(poses))], poses, world.quality()
            )
            gained = energy_gained(recording, simulation.assembly)
            state = "right" if gained < 0.01 else "wrong"
            yield Row("energy", engine, case, COLLAPSING, {"step": factor}, state, gained)


def moved_away(assembly: Assembly, distance: float) -> Assembly:
    """Return the same built elsewhere, by a distance to the right [size]."""
    by = np.array([distance * assembly.size, 0.0])
    return replace(
        assembly,
        blocks=tuple(
            replace(block, vertices=block.vertices + by, centre=block.centre + by)
            for block in assembly.blocks
        ),
        joints=tuple(
            replace(joint, inner=joint.inner + by, outer=joint.outer + by)
            for joint in assembly.joints
        ),
    )


def away(engine: str, grid: Grid) -> Iterator[Row]:
    """Ask the onset test about arches built far away."""
    library: Engine = get_engine(engine)
    for case in grid.away:
        for ratio in RATIOS:
            simulation = simulation_of(engine, case, ratio)
            start = simulation.world().hold(10_000)
            for distance in grid.distances:
                assembly = moved_away(simulation.assembly, distance)
                problem = Problem(assembly=assembly, mu=simulation.problem.mu)
                world = library.build(problem, simulation.settings)
                off = float(displacement(world.hold(10_000) - start, simulation.assembly))
                world = library.build(problem, simulation.settings)
                anywhere = replace(simulation.settings, farthest=math.inf)
                verdict = onset(world, library, problem, anywhere).verdict
                at = {"distance": distance}
                yield Row("away", engine, case, ratio, at, judged(verdict, ratio), off)


def counted(rows: Sequence[Row]) -> str:
    """Say how many answers were right, undecided and wrong."""
    counts = Counter(row.outcome for row in rows)
    return ", ".join(f"{counts[each]} {each}" for each in ("right", "undecided", "wrong"))


PARTS = (released, held, lines, energy, away, lasting)


def main(out: Path, *, quick: bool = False, engines: list[str] | None = None) -> list[Row]:
    """Run the study, write its rows and its figures, and return the rows.

    What an earlier run has written of an engine and part is kept, not asked again.
    """
    out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for engine in engines or ENGINES:
        if ENGINES[engine].missing:
            continue
        for part in PARTS:
            kept = out / f"{engine}-{part.__name__}.json"
            if not kept.exists():
                began = time.process_time()
                found = list(part(engine, QUICK if quick else GRIDS[engine]))
                text = json.dumps([asdict(row) for row in found])
                write_whole(kept, lambda file, text=text: file.write(text.encode()))
                took = time.process_time() - began
                sys.stderr.write(f"{engine} {part.__name__}: {counted(found)}, {took:.0f} s\n")
            rows += [
                Row(**{**row, "case": tuple(row["case"])})
                for row in json.loads(kept.read_text(encoding="utf-8"))
            ]
    draw(rows, out)
    return rows


if __name__ == "__main__":
    run(main, counted)
