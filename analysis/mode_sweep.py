"""The whole map by simulation, resumable.

Question: do arches collapse in the mode that limit analysis finds for their voussoirs, and the
closed form publishes, and at its thickness, all over the map? Which arches are asked about is
in `mode_draws.py`.

What is compared. The least thickness is bracketed by the onset test alone, to 0.1 % (`direct`:
1e-8). The mode is that of the mechanism the arch starts with at the lower end of that bracket,
or, where friction is critical, with 0.5 % less of it. Limit analysis of the same voussoirs
comes first, the map, which is of the continuous arch, second. Runs 0.5 % to both sides confirm
the bracket (at its ends they would take most of the time) and tell the mode in motion, which is
counted aside: by then a joint that slides may turn as well, and more than the weakest mode be
overcome. An arch is called near a line if its published mode changes as mu or alpha changes
by 0.3 %: no more, in 99 of 100, does the least thickness of the voussoirs differ from the
map's, if that is counted in alpha.

Expected: the mode of limit analysis, and away from the lines the published one, too; brackets
centred within 0.2 % of limit analysis by pymunk, 1e-8 by `direct`; all fall below and stand
above.

Run: python -m analysis.mode_sweep OUT [--arches N] [--engines NAME ...]. Rows are kept in
OUT/rows; the same command goes on after an interruption, which reports the arches that are
done. Thin ones of many voussoirs, which take pymunk most of the time, come last.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.command import run
from analysis.mode_draws import MOST_FRICTION, Drawn, Draws, divide, draw
from blocksim.arch.circular import Arch
from blocksim.arch.limit import least_thickness
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode
from blocksim.arch.theory.regions import first_sliding
from blocksim.simulation.verdict import Verdict
from blocksim.sweeps import read_rows, sweep
from blocksim.sweeps.answers import version_of
from blocksim.view.mapregions import draw_regions
from blocksim.view.style import FONT, INK, MISS, MODES, UNNAMED

ARCHES = 2300
ENGINES = ("pymunk", "direct")
NO_MODE = "none"


@dataclass(frozen=True)
class Seen:
    """An arch as an engine saw it.

    Verdicts `below` and `above` what is critical; the mode it starts with, that in motion, and
    that of limit analysis; the bracket's centre and its error, nan where there is none.
    """

    drawn: Drawn
    below: Verdict
    above: Verdict
    observed: str
    in_motion: str
    built: str
    eta: float
    error: float

    @property
    def as_published(self) -> bool:
        """Whether the mode is the published one."""
        return self.observed == self.drawn.published

    @property
    def as_built(self) -> bool:
        """Whether the mode is that of limit analysis of the same voussoirs."""
        return self.observed == self.built


@dataclass(frozen=True)
class Result:
    """Headline numbers of one engine.

    `false` counts wrong verdicts below and above, `unsure` undecided ones. Of the modes arches
    start with, `as_built` are those of limit analysis of the same voussoirs, `as_published`
    those of the map; `clear_` counts arches that are not near a line. `in_motion` counts modes
    in motion that are those of limit analysis.
    """

    engine: str
    arches: int
    false: int
    unsure: int
    as_built: int
    as_published: int
    in_motion: int
    clear: int
    clear_built: int
    clear_published: int
    worst_error: float
    median_error: float
    confusion: dict[tuple[str, str], int]


def _seen(drawn: Drawn, rows: Sequence[dict[str, object]]) -> Seen:
    """Read what an engine said of an arch: less, more, and perhaps a bracket."""
    below, above, *brackets = rows
    alpha, mu = math.radians(drawn.alpha_deg), float(str(below["mu"]))
    built = least_thickness(alpha, mu, drawn.voussoirs)
    eta, error, observed, said = drawn.eta or math.nan, math.nan, below["mode"], built.mode
    if drawn.eta is not None:
        said = mechanism(Arch(half_angle=alpha, eta=eta, voussoirs=drawn.voussoirs), mu).mode
    for row in brackets:
        observed = row["mode"]
        low, high = row["eta_low"], row["eta_high"]
        if low is not None and high is not None and built.eta is not None:
            eta = (float(str(low)) + float(str(high))) / 2
            error = eta / built.eta - 1
    return Seen(
        drawn=drawn,
        below=Verdict(str(below["verdict"])),
        above=Verdict(str(above["verdict"])),
        observed=str(observed or NO_MODE),
        in_motion=str(below["mode_in_motion"] or NO_MODE),
        built=str(said or NO_MODE),
        eta=eta,
        error=error,
    )


def main(
    out: Path,
    *,
    quick: bool = False,
    arches: int = ARCHES,
    engines: list[str] | None = None,
) -> tuple[Result, ...]:
    """Run the study or go on with it, write a figure an engine and return their numbers."""
    draws = Draws(10, ("direct",)) if quick else Draws(arches, tuple(engines or ENGINES))
    folder = out / "rows"
    if quick:
        with ThreadPoolExecutor(1) as executor:
            sweep(draws, folder, executor=executor)
    else:
        with suppress(KeyboardInterrupt):
            sweep(draws, folder, workers=2, progress=_tell)
    rows = {row["id"]: row for row in read_rows(folder)}
    return tuple(_result(engine, draws.arches, rows, out) for engine in draws.method)


def _result(
    engine: str, arches: int, rows: dict[object, dict[str, object]], out: Path
) -> Result:
    version = version_of(engine)
    every: list[Seen] = []
    for drawn in itertools.islice(draw(), arches):
        ids = [case.identity(version).hex() for case in drawn.cases(engine)]
        if all(each in rows for each in ids):
            every.append(_seen(drawn, [rows[each] for each in ids]))
    errors = np.abs([each.error for each in every if not math.isnan(each.error)])
    clear = [each for each in every if not each.drawn.near]
    _figure(every, out / f"mode_sweep_{engine}.png", engine)
    return Result(
        engine=engine,
        arches=len(every),
        false=sum(
            (each.below is Verdict.STANDS) + (each.above is Verdict.COLLAPSES) for each in every
        ),
        unsure=sum((e.below, e.above).count(Verdict.UNDECIDED) for e in every),
        as_built=sum(each.as_built for each in every),
        as_published=sum(each.as_published for each in every),
        in_motion=sum(each.in_motion == each.built for each in every),
        clear=len(clear),
        clear_built=sum(each.as_built for each in clear),
        clear_published=sum(each.as_published for each in clear),
        worst_error=float(errors.max()),
        median_error=float(np.median(errors)),
        confusion=dict(_counts(every)),
    )


def _counts(every: Sequence[Seen]) -> Counter[tuple[str, str]]:
    return Counter((each.built, each.observed) for each in every)


def _tell(share: float, what: str) -> None:
    sys.stderr.write(f"{share:6.1%}  {what}\n")


def _figure(every: Sequence[Seen], path: Path, engine: str) -> None:
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(15, 7.6), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1))
        _over_map(figure.add_subplot(grid[:, 0]), every, engine)
        _confusion(figure.add_subplot(grid[0, 1]), every)
        _errors(figure, figure.add_subplot(grid[1, 1]), every)
        figure.savefig(path, dpi=150)


def _over_map(axes: Axes, every: Sequence[Seen], engine: str) -> None:
    """Draw the modes observed over those published (Fig. 9)."""
    draw_regions(axes)
    handles: list[Line2D] = []
    for mode in (*Mode, None):
        style = MODES[mode] if mode else UNNAMED
        own = [each for each in every if each.observed == (mode or NO_MODE)]
        look = {"marker": style.marker, "mfc": style.colour, "mec": "white", "mew": 0.4}
        for each in own:
            axes.plot(each.drawn.mu, each.eta, ms=4.5, zorder=5, **look)
        if own:
            words = f"{mode.value if mode else 'none of the seven'}  {len(own)}"
            handles.append(Line2D([], [], ls="", ms=7, label=words, **look))
    for marked, colour, words in (
        (
            [e for e in every if e.as_built and not e.as_published],
            INK,
            "as limit says,\nnot as published",
        ),
        ([e for e in every if not e.as_built], MISS, "not as limit says"),
    ):
        ring = {"marker": "o", "mfc": "none", "mec": colour, "mew": 0.9, "ls": ""}
        axes.plot([e.drawn.mu for e in marked], [e.eta for e in marked], ms=9, zorder=6, **ring)
        if marked:
            label = f"{words}  {len(marked)}"
            handles.append(Line2D([], [], ms=9, label=label, **ring))
    axes.legend(handles=handles, loc="upper left", title="starts with", fontsize=8)
    axes.set_title(f"{len(every)} arches by {engine}, over the published modes")


def _confusion(axes: Axes, every: Sequence[Seen]) -> None:
    """Draw how often each mode is seen where limit says each, in brackets off lines."""
    counts, clear = _counts(every), _counts([e for e in every if not e.drawn.near])
    names = [*(mode.value for mode in Mode), NO_MODE]
    built = [name for name in names if any(row == name for row, _ in counts)]
    observed = [name for name in names if any(column == name for _, column in counts)]
    table = np.array([[counts[row, column] for column in observed] for row in built])
    axes.imshow(
        table / table.sum(axis=1, keepdims=True), cmap="Blues", vmin=0, vmax=1.6, aspect="auto"
    )
    for (row, column), count in np.ndenumerate(table):
        if count:
            off = clear[built[row], observed[column]]
            axes.text(column, row, f"{count} ({off})", ha="center", va="center")
    axes.set_xticks(range(len(observed)), observed)
    axes.set_yticks(range(len(built)), built)
    axes.set_xlabel("mode it starts with")
    axes.set_ylabel("mode by limit analysis")
    axes.spines[:].set_visible(False)
    axes.set_title("Modes: all arches (those away from lines of the map)")


def _errors(figure: Figure, axes: Axes, every: Sequence[Seen]) -> None:
    """Draw the error over half-angle and friction, where thin arches have room."""
    known = [each for each in every if not math.isnan(each.error)]
    sizes = np.maximum(np.abs([each.error for each in known]), 1e-12)
    points = axes.scatter(
        [each.drawn.alpha_deg for each in known],
        [each.drawn.mu for each in known],
        c=100 * sizes,
        norm=LogNorm(),
        cmap="viridis",
        s=9,
    )
    angles, least = divide()
    first = first_sliding(np.radians(angles[angles < 151]))
    axes.plot(angles, least, color=INK, lw=1.1)
    axes.plot(angles[angles < 151], first.mu, color=INK, lw=1.1)
    axes.set_yscale("log")
    axes.set_ylim(0.8 * least[0], 1.1 * MOST_FRICTION)
    axes.set_yticks((0.03, 0.1, 0.3, 1, 3), ("0.03", "0.1", "0.3", "1", "3"))
    axes.minorticks_off()
    axes.set_xlabel("half-angle of embrace [deg]")
    axes.set_ylabel(r"friction coefficient $\mu$")
    axes.set_title("Error of least thickness")
    figure.colorbar(points, ax=axes, label="bracket's centre off limit analysis [%]")


if __name__ == "__main__":
    run(main, lambda results: "\n".join(map(str, results)))
