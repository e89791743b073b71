"""Error against time: the onset test of `direct` and that of pymunk.

Question: how much does solving each step's contacts to their end gain over sweeping them?
The least thickness of a few arches is bracketed by onset test alone, to finer and finer
tolerances; error is that of the bracket's centre against limit analysis, time is all of it.

The bisection is the same for both, so at equal tolerance errors are equal and times compare.

Expected: at the time pymunk needs for its finest bracket, `direct` is a hundred times nearer,
most of all for thin and for long arches, where sweeps grow with slenderness and n^2.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from blocksim import Arch, Verdict
from blocksim.bracket import Search
from blocksim.limit import least_thickness
from blocksim.trial import trial
from blocksim.view.style import FONT

ARCHES = {
    "semicircle, n = 27": (90, 0.7, 27),
    "sliding shoulder, n = 26": (125, 0.9, 26),
    "steep 154 deg, n = 31": (154, 2.6, 31),
    "thin 40 deg, n = 27": (40, 0.9, 27),
    "long, n = 61": (90, 0.7, 61),
}
TOLERANCES = {
    "direct": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    "pymunk": (1e-2, 1e-3, 1e-4),
}
COLOURS = {"direct": "#0072B2", "pymunk": "#D55E00"}
MARKERS = {"direct": "o", "pymunk": "s"}


@dataclass(frozen=True)
class Point:
    """One bracket: engine, relative width asked for, error of its centre, seconds."""

    engine: str
    tol: float
    error: float
    wall_s: float


def measure(angle: float, mu: float, voussoirs: int, engine: str, tol: float) -> Point:
    """Bracket one arch by onset test and compare with limit analysis."""
    exact = least_thickness(math.radians(angle), mu, voussoirs).eta
    if exact is None:
        message = "an arch that nothing lets stand has no error to measure"
        raise ValueError(message)

    def judge(eta: float) -> Verdict:
        arch = Arch(half_angle=math.radians(angle), eta=eta, voussoirs=voussoirs)
        return trial(arch, mu, engine, moving=False).verdict

    started = time.perf_counter()
    search = Search(judge)
    # A start that is off by a third of a percent, so that no tolerance is met by luck.
    search.expand(exact * 1.0037)
    search.bisect(tol)
    wall = time.perf_counter() - started
    if search.low is None or search.high is None:
        return Point(engine, tol, math.inf, wall)
    return Point(engine, tol, abs((search.low + search.high) / 2 / exact - 1), wall)


def main(out: Path, *, quick: bool = False) -> dict[str, float]:
    """Measure, draw, and return the gain in error at equal time, for each arch."""
    arches = {"semicircle, n = 9": (90, 0.7, 9)} if quick else ARCHES
    found: dict[str, list[Point]] = {}
    for name, arch in arches.items():
        found[name] = [
            measure(*arch, engine, tol)
            for engine, tolerances in TOLERANCES.items()
            for tol in (tolerances[:3] if quick else tolerances)
        ]
    _figure(found, out / "direct_against_pymunk.png")
    return {name: gain(points) for name, points in found.items()}


def gain(points: list[Point]) -> float:
    """Finest error of pymunk over that of `direct` in the same time or less."""
    finest = min((p for p in points if p.engine == "pymunk"), key=lambda p: p.error)
    affordable = [p.error for p in points if p.engine == "direct" and p.wall_s <= finest.wall_s]
    return finest.error / min(affordable, default=math.inf)


def _figure(found: dict[str, list[Point]], path: Path) -> None:
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(2.6 * len(found) + 0.8, 3.6), layout="constrained")
        panels = figure.subplots(1, len(found), sharex=True, sharey=True, squeeze=False)[0]
        for axes, (name, points) in zip(panels, found.items(), strict=True):
            for engine, colour in COLOURS.items():
                own = [p for p in points if p.engine == engine and math.isfinite(p.error)]
                axes.loglog(
                    [p.wall_s for p in own],
                    [p.error for p in own],
                    MARKERS[engine] + "-",
                    color=colour,
                    ms=5,
                    label=engine,
                )
            axes.set_title(name, fontsize=9)
            axes.set_xlabel("time [s]")
            axes.grid(alpha=0.3)
        panels[0].set_ylabel("error of least thickness")
        panels[0].legend(frameon=False)
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/direct_against_pymunk")
    sys.stdout.write(f"{main(folder)}\n")
