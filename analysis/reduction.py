"""Half an arch in a few blocks against all its voussoirs: the same answers, and the time saved.

Question: what does it save to simulate no more blocks than it takes
(`blocksim.arch.reduction`), and does it ever change an answer? Arches of four modes, both
weights, of more and more voussoirs, are bracketed by each engine with and without, ends let
go. Where all voussoirs would take minutes an arch (`LARGEST`) only the reduced arch is
asked, and held to limit analysis. Random arches are put to `direct` on either side of their
least thickness, by onset test: verdicts and accelerations must be those of all voussoirs.

Expected: the same brackets and modes, in a time that hardly grows with the voussoirs.

    python -m analysis.reduction OUT
"""

from __future__ import annotations

import math
import sys
import time
from collections import defaultdict
from dataclasses import dataclass
from itertools import cycle, islice
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.command import run
from analysis.drawing import Draw, draws
from blocksim import Arch, Bracket, Mode, bracket
from blocksim.arch.circular import Weight
from blocksim.arch.reduction import Reduction
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.observation import Observation, observe
from blocksim.simulation.onset import PROBE, Onset
from blocksim.view.style import FONT, INK, METHODS

ARCHES = ((90, 0.7), (125, 0.9), (145, 1.6), (154, 2.6))
"""Half-angles [deg] and friction: rrr, srr, rrs, rs."""
WEIGHTS: tuple[Weight, ...] = ("centreline", "sector")
SIZES = {"direct": (27, 101, 301), "pymunk": (27, 101, 301), "pybullet": (27, 101)}
LARGEST = {"direct": 301, "pymunk": 101, "pybullet": 27}
"""Most voussoirs that are simulated one by one."""
TOLERANCES = {"direct": 1e-6, "pymunk": 1e-3, "pybullet": 4e-3}
RATIOS = (0.9, 0.99, 1 - 1e-3, 1 - 1e-6, 1 + 1e-6, 1 + 1e-3, 1.02, 1.2)
"""Thickness over the least at which random arches are tried."""
RANDOM, SEED = 400, 20


@dataclass(frozen=True)
class Row:
    """One arch in one engine, all voussoirs (None where not tried) and reduced.

    Times are processor seconds.
    """

    engine: str
    half_angle_deg: float
    mu: float
    weight: Weight
    voussoirs: int
    whole: Bracket | None
    whole_s: float
    reduced: Bracket
    reduced_s: float

    @property
    def same(self) -> bool:
        """Whether both brackets are the same, to a hundredth of their width."""
        few, every = self.reduced.arch.centre, self.whole and self.whole.arch.centre
        return bool(few and every) and abs(few / every - 1) < self.reduced.tol / 100

    @property
    def error(self) -> float:
        """Distance of the reduced bracket's centre from the exact value, relative."""
        exact, centre = self.reduced.arch.eta_limit, self.reduced.arch.centre
        return math.nan if exact is None or centre is None else centre / exact - 1


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    Parameters
    ----------
    gain : dict
        Median of the time saved, whole over reduced, by engine and voussoirs.
    worst_error : dict
        Of reduced brackets, by engine.
    arches, compared, same, confirmed, same_mode : int
        Reduced brackets; those to compare with all voussoirs, and the same as theirs;
        confirmed by moving runs; of the exact mode.
    random, false, most_splits : int
        Random arches, verdicts that differ, most joints of one split again.
    worst_difference : float
        Of their accelerations, over the largest or 1e-6 g.
    """

    gain: dict[tuple[str, int], float]
    worst_error: dict[str, float]
    arches: int
    compared: int
    same: int
    confirmed: int
    same_mode: int
    random: int
    false: int
    most_splits: int
    worst_difference: float


def ask(row: tuple[str, float, float, Weight, int]) -> Row | None:
    """Bracket one arch both ways; None where no thickness stands."""
    engine, half_angle_deg, mu, weight, voussoirs = row

    def timed(*, reduce: bool) -> tuple[Bracket, float]:
        started = time.process_time()
        found = bracket(
            CircularArch(
                half_angle=math.radians(half_angle_deg),
                friction=mu,
                voussoirs=voussoirs,
                weight=weight,
            ),
            method=engine,
            tol=TOLERANCES[engine],
            reduce=reduce,
        )
        return found, time.process_time() - started

    reduced, reduced_s = timed(reduce=True)
    if reduced.arch.eta_limit is None:
        return None
    whole, whole_s = None, math.nan
    if voussoirs <= LARGEST[engine]:
        whole, whole_s = timed(reduce=False)
    return Row(*row, whole=whole, whole_s=whole_s, reduced=reduced, reduced_s=reduced_s)


def pair(draw: Draw, ratio: float) -> tuple[Arch, Observation, Observation]:
    """Put one arch to the onset test of `direct`, all voussoirs and reduced."""
    arch = draw.arch(ratio)
    whole, reduced = (
        observe(
            CircularArch.of(arch, draw.mu).problem(),
            "direct",
            moving=False,
            reduction=Reduction.of(arch, draw.mu) if reduce else None,
        )
        for reduce in (False, True)
    )
    return arch, whole, reduced


def difference(arch: Arch, whole: Onset, reduced: Onset) -> float:
    """Return how far the accelerations of any voussoir differ, over the largest or 1e-6 g."""
    assembly = arch.assembly()
    still = np.column_stack([assembly.centres / arch.radius, np.zeros(arch.voussoirs)])
    # A mechanism is a small way along the accelerations.
    apart = [(each.mechanism - still) * each.acceleration / PROBE for each in (whole, reduced)]
    return float(np.abs(apart[0] - apart[1]).max()) / max(whole.acceleration, 1e-6)


def main(out: Path, *, quick: bool = False) -> Result:
    """Run the study, write its figure and table, and return its numbers.

    Parameters
    ----------
    out : Path
        Folder of `reduction.png` and `reduction.md`.
    quick : bool
        Two arches of 20 voussoirs in `direct` and pymunk, and 8 random ones.
    """
    engines = ("direct", "pymunk") if quick else tuple(TOLERANCES)
    asked = [
        (engine, *arch, weight, voussoirs)
        for engine in engines
        for voussoirs in ((20,) if quick else SIZES[engine])
        for arch in (ARCHES[:2] if quick else ARCHES)
        for weight in (WEIGHTS[:1] if quick else WEIGHTS)
    ]
    rows: list[Row] = []
    for each in asked:
        row = ask(each)
        if row:
            rows.append(row)
            if not quick:
                sys.stderr.write(f"{_line(row)}\n")
    drawn = (
        draw
        for draw in draws(SEED, degrees=(30, 155), counts=(5, 101), near=0.5)
        if draw.eta < 2 / RATIOS[-1]
    )
    pairs = [
        pair(draw, ratio)
        for draw, ratio in zip(islice(drawn, 8 if quick else RANDOM), cycle(RATIOS))
    ]
    out.mkdir(parents=True, exist_ok=True)
    (out / "reduction.md").write_text("\n".join([*HEAD, *map(_line, rows), ""]))
    _figure(rows, out / "reduction.png")
    ratios: dict[tuple[str, int], list[float]] = defaultdict(list)
    for row in rows:
        if row.whole:
            ratios[row.engine, row.voussoirs].append(row.whole_s / row.reduced_s)
    return Result(
        gain={key: float(np.median(found)) for key, found in ratios.items()},
        worst_error={
            engine: max(abs(row.error) for row in rows if row.engine == engine)
            for engine in engines
        },
        arches=len(rows),
        compared=sum(row.whole is not None for row in rows),
        same=sum(row.same for row in rows),
        confirmed=sum(bool(row.reduced.confirmed) for row in rows),
        same_mode=sum(row.reduced.arch.mode is row.reduced.arch.mode_limit for row in rows),
        random=len(pairs),
        false=sum(whole.verdict is not reduced.verdict for _, whole, reduced in pairs),
        most_splits=max(reduced.splits for *_, reduced in pairs),
        worst_difference=max(
            difference(arch, whole.onset, reduced.onset) for arch, whole, reduced in pairs
        ),
    )


HEAD = (
    "| engine | n | alpha | mu | weight | mode | blocks | split again | all [s] | reduced [s] "
    "| centre over exact, all | reduced | confirmed |",
    "|---|---|---|---|---|---|---|---|---|---|---|---|---|",
)


def _line(row: Row) -> str:
    mode: Mode | None = row.reduced.arch.mode
    centre = row.whole.arch.centre if row.whole else None
    whole = (
        "-"
        if centre is None
        else f"{centre / (row.reduced.arch.eta_limit or math.nan) - 1:.1e}"
    )
    cells = (
        row.engine,
        row.voussoirs,
        row.half_angle_deg,
        row.mu,
        row.weight,
        mode.value if mode else "-",
        row.reduced.blocks,
        row.reduced.splits,
        f"{row.whole_s:.2f}" if row.whole else "-",
        f"{row.reduced_s:.2f}",
        whole,
        f"{row.error:.1e}",
        "yes" if row.reduced.confirmed else "no",
    )
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _figure(rows: list[Row], path: Path) -> None:
    """Draw the time of a bracket over the number of voussoirs, a panel for each engine."""
    engines = list(dict.fromkeys(row.engine for row in rows))
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(3.2 * len(engines) + 0.8, 3.8), layout="constrained")
        panels = figure.subplots(1, len(engines), sharey=True, squeeze=False)[0]
        for axes, engine in zip(panels, engines, strict=True):
            style = METHODS[engine]
            own = [row for row in rows if row.engine == engine]
            for face, line, times in (
                ("white", "-", [row.whole_s for row in own]),
                (style.colour, "--", [row.reduced_s for row in own]),
            ):
                sizes = sorted({row.voussoirs for row in own})
                count = np.array([row.voussoirs for row in own])
                taken = np.array(times)
                axes.loglog(
                    count, taken, style.marker, mfc=face, mec=style.colour, ms=5, alpha=0.7
                )
                middle = [float(np.median(taken[count == size])) for size in sizes]
                axes.loglog(sizes, middle, line, color=style.colour, lw=1.4)
            axes.set_title(f"{engine}, brackets to {TOLERANCES[engine]:g}", fontsize=9.5)
            axes.set_xlabel("voussoirs")
            axes.set_xticks(sizes, [str(size) for size in sizes])
            axes.minorticks_off()
            axes.grid(alpha=0.3)
        panels[0].set_ylabel("processor time of a bracket [s]")
        names = [
            Line2D([], [], marker="o", color=INK, mfc="white", label="all voussoirs"),
            Line2D([], [], marker="o", color=INK, ls="--", label="reduced; lines join medians"),
        ]
        figure.legend(handles=names, frameon=False, ncols=2, loc="outside lower center")
        figure.savefig(path, dpi=150)


if __name__ == "__main__":
    run(main)
