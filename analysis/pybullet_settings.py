"""What limits pybullet on near-critical arches, one setting at a time.

Question: how must an arch be put into Bullet so that its contact forces converge to
balance, and stay there once it is let go? Each variant departs in one point from what
`engines/bulletblocks.py` and `engines/bulletspace.py` do:

- *soft lock*: inertias out of the plane a million times too large, not beyond reach;
- *breaking 2*: contact points of a joint's length replace each other;
- *slop 5e-5*: more slop than the overlap the faces start with.

Left: acceleration left over 0.2 % above the least thickness, against sweeps; it should
fall to round-off. Right: how far an arch 1 % above it moves after release, in steps of
different length at equal work; friction impulses start from nothing in every step.

Expected: as built, accelerations left over fall below 1e-8 g in both arches, and the arch let
go moves less than 1e-7 r; no variant does as well. A soft lock leaves a hundred times more.

    python -m analysis.pybullet_settings OUT
"""

from __future__ import annotations

import math
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from blocksim import Arch
from blocksim.arch.limit import least_thickness
from blocksim.blocks.assembly import Array, displacement
from blocksim.engines import bulletblocks, bulletspace
from blocksim.kinds.circular import arch_problem
from blocksim.simulation.simulated import Simulation
from blocksim.view.style import FONT

ARCHES = {"semicircle": (90.0, 0.35, 27), "thin": (45.0, 0.9, 13)}
"""Half-angle [deg], friction, voussoirs."""
VARIANTS = ("as built", "soft lock", "breaking 2", "slop 5e-5")
LOCK = 1e4
"""Inertias of a soft lock, about a million times those of voussoirs."""
STEPS = ((0.001, 300), (0.01, 3000), (0.1, 30000))
"""Time step and sweeps in it: the same sweeps in a unit of time."""


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    Parameters
    ----------
    accelerations : dict
        Variant to what is left over in each arch after the most sweeps [g].
    moved : dict
        Step to the motion of the semicircle after five units of time [r].
    """

    accelerations: dict[str, dict[str, float]]
    moved: dict[float, float]


@contextmanager
def variant(name: str) -> Generator[None]:
    """Put one setting of the engine out of order."""
    if name == "breaking 2":
        with patch.object(bulletblocks, "MERGED", 2.0):
            yield
    elif name == "slop 5e-5":
        with patch.object(bulletspace, "SLOP", 5e-5):
            yield
    elif name == "soft lock":
        with patch.object(bulletblocks, "LOCK", LOCK):
            yield
    else:
        yield


def simulation(arch: str, ratio: float) -> Simulation:
    """Return an arch at a ratio of its least thickness."""
    degrees, mu, voussoirs = ARCHES[arch]
    alpha = math.radians(degrees)
    least = least_thickness(alpha, mu, voussoirs).eta or 0.0
    built = Arch(half_angle=alpha, eta=least * ratio, voussoirs=voussoirs)
    return Simulation.of(arch_problem(built, mu), "pybullet")


def left_over(arch: str, name: str, sweeps: Array) -> list[float]:
    """Acceleration after single solves with ever more sweeps, each in a new world."""
    with variant(name):
        case = simulation(arch, 1.002)
        found: list[float] = []
        for count in sweeps:
            world = case.world()
            world.hold(int(count))
            # The second solve shows what is kept from the first.
            found.append(float(displacement(world.hold(int(count)), case.assembly)))
    return found


def moved(step: float, sweeps: int, until: float) -> tuple[list[float], list[float]]:
    """Let a standing semicircle go in steps of one length, all with the same sweeps."""
    case = simulation("semicircle", 1.01)
    case = replace(case, settings=replace(case.settings, step=step, sweeps=sweeps))
    world = case.world()
    for _ in range(3):
        world.hold(40 * len(case.assembly.blocks) ** 2)
    start = world.poses()
    times, ways = [], []
    for frame in range(round(until / 0.5)):
        world.advance(round(0.5 / step))
        times.append((frame + 1) * 0.5)
        ways.append(float(displacement(world.poses() - start, case.assembly)))
    return times, ways


def main(out: Path, *, quick: bool = False) -> Result:
    """Run the study, write its figure and return its numbers."""
    most = 30 if quick else 300
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(12.5, 4.2), layout="constrained")
        panels = figure.subplots(1, 3)
        accelerations: dict[str, dict[str, float]] = {name: {} for name in VARIANTS}
        for axes, arch in zip(panels, ARCHES, strict=False):
            degrees, mu, voussoirs = ARCHES[arch]
            shares = np.geomspace(3, most if arch == "semicircle" else 10 * most, 8)
            for name in VARIANTS:
                found = left_over(arch, name, shares * voussoirs**2)
                accelerations[name][arch] = found[-1]
                bold = {"lw": 2.2, "color": "k"} if name == "as built" else {"lw": 1.2}
                axes.loglog(shares, np.maximum(found, 1e-15), ".-", label=name, **bold)
            title = f"{arch}: {degrees:g} deg, mu {mu:g}, n {voussoirs}"
            axes.set_title(title, fontsize=10)
            axes.set_xlabel("sweeps / n$^2$")
            axes.set_ylabel("acceleration left over, 0.2 % above [g]")
            axes.set_ylim(1e-15, 30)
        panels[0].legend(frameon=False)
        ways: dict[float, float] = {}
        for step, sweeps in STEPS[1:] if quick else STEPS:
            times, way = moved(step, sweeps, 1.0 if quick else 5.0)
            ways[step] = way[-1]
            panels[2].semilogy(times, way, ".-", label=f"step {step:g}, {sweeps} sweeps")
        panels[2].set_title("semicircle, released 1 % above, equal work", fontsize=10)
        panels[2].set_xlabel("time [$\\sqrt{r/g}$]")
        panels[2].set_ylabel("largest displacement [r]")
        panels[2].legend(frameon=False)
        out.mkdir(parents=True, exist_ok=True)
        figure.savefig(out / "pybullet_settings.png", dpi=150)
    return Result(accelerations=accelerations, moved=ways)


if __name__ == "__main__":
    run(main)
