"""The whole map by simulation, resumable.

Question: do arches in motion collapse in the mode that the closed form publishes for them,
and at its thickness, all over the map? Arches are drawn over half-angle and friction, half
of them with little more friction than the least with which any thickness stands, where the
mixed modes are. Each is bracketed by an engine; its mode is the one observed at the lower end.
The map is of the continuous arch, simulated are 20 to 40 voussoirs: where the modes differ,
limit analysis of those voussoirs tells whether that is the reason.

Far below the friction with which anything stands, several modes are overcome at once at
eta = 2, and what is observed may be none of the seven: it is counted as none.

Run `python -m analysis.mode_sweep FOLDER [ARCHES [ENGINE]]`; rows are kept in FOLDER/ENGINE,
and the same command goes on after an interruption.

Expected: the mode of the map, or that of limit analysis of the same voussoirs; brackets
centred within 0.2 % of limit analysis.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from blocksim.limit import least_thickness
from blocksim.modes import Mode
from blocksim.sweep import Case, read_rows, sweep
from blocksim.theory.critical import thrust_interval
from blocksim.view.mapfigure import draw_regions
from blocksim.view.style import FONT, MODES

SEED = 2024
ARCHES = 2000
ENGINE = "pymunk"
TOL = 0.001
UNNAMED = "none"


@dataclass(frozen=True)
class Draws:
    """Arches all over the map; more of them begin with the same."""

    size: int
    engine: str

    @property
    def method(self) -> tuple[str, ...]:
        """The engine alone."""
        return (self.engine,)

    def cases(self) -> Iterator[Case]:
        """Draw the arches."""
        random = np.random.default_rng(SEED)
        for _ in range(self.size):
            alpha_deg = random.uniform(30, 155)
            mu = math.exp(random.uniform(math.log(0.35), math.log(3)))
            above = random.uniform(1.0, 1.15)
            if random.random() < 0.5:
                alpha_deg = random.uniform(90, 155)
                mu = _divide(math.radians(alpha_deg)) * above
            voussoirs = int(random.integers(20, 41))
            yield Case(
                alpha_deg, mu, voussoirs, "centreline", None, None, self.engine, 0.0, TOL
            )


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    `as_published` and `as_built` count the modes observed that are those of the map, and of
    the others those that limit analysis gives the same voussoirs; `never` the arches that
    neither stand at any thickness by limit analysis nor in motion; `failed` those that have
    no bracket for another reason.
    """

    arches: int
    as_published: int
    as_built: int
    confirmed: int
    never: int
    failed: int
    worst_error: float
    median_error: float
    confusion: dict[tuple[str, str], int]


@dataclass(frozen=True)
class Seen:
    """One row: the arch, its modes, the centre of its bracket and the error of that."""

    alpha_deg: float
    mu: float
    published: str
    observed: str
    built: str
    confirmed: bool
    never: bool
    eta: float
    error: float


def _divide(half_angle: float) -> float:
    """Friction below which no thickness stands."""
    low, high = 0.01, 100.0
    for _ in range(40):
        middle = (low + high) / 2
        least, most = thrust_interval(half_angle, middle)
        low, high = (middle, high) if least > most else (low, middle)
    return high


def _seen(case: Case, row: dict[str, object]) -> Seen:
    built = least_thickness(math.radians(case.alpha_deg), case.mu, case.voussoirs)
    low, high = row["eta_low"], row["eta_high"]
    eta = math.nan if low is None or high is None else (float(str(low)) + float(str(high))) / 2
    return Seen(
        alpha_deg=case.alpha_deg,
        mu=case.mu,
        published=str(row["mode_theory"]),
        observed=str(row["mode"] or UNNAMED),
        built=str(built.mode or UNNAMED),
        confirmed=row["confirmed"] is True,
        never=built.eta is None and low is not None and high is None,
        eta=eta,
        error=math.nan if built.eta is None else eta / built.eta - 1,
    )


def main(
    out: Path, *, quick: bool = False, arches: int = ARCHES, engine: str = ENGINE
) -> Result:
    """Run the study or go on with it, write its figure and return its numbers."""
    draws = Draws(6 if quick else arches, "direct" if quick else engine)
    folder = out / draws.engine
    if quick:
        with ThreadPoolExecutor(1) as executor:
            sweep(draws, folder, executor=executor)
    else:
        sweep(draws, folder, workers=2, progress=_tell)
    rows = {(row["alpha_deg"], row["mu"]): row for row in read_rows(folder)}
    asked = [(case, rows[case.alpha_deg, case.mu]) for case in draws.cases()]
    every = [_seen(case, row) for case, row in asked if row["error"] is None]
    errors = np.abs([each.error for each in every if not math.isnan(each.error)])
    _figure(every, out / "mode_sweep.png", draws.engine)
    return Result(
        arches=draws.size,
        as_published=sum(each.observed == each.published for each in every),
        as_built=sum(each.published != each.observed == each.built for each in every),
        confirmed=sum(each.confirmed for each in every),
        never=sum(each.never for each in every),
        failed=draws.size - errors.size - sum(each.never for each in every),
        worst_error=float(errors.max()),
        median_error=float(np.median(errors)),
        confusion=dict(Counter((each.published, each.observed) for each in every)),
    )


def _tell(share: float, what: str) -> None:
    print(f"{share:6.1%}  {what}", file=sys.stderr)  # noqa: T201


def _figure(every: list[Seen], path: Path, engine: str) -> None:
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(14, 4.6), layout="constrained")
        over_map, matrix, errors = figure.subplots(1, 3, width_ratios=(1.3, 1, 1.2))
        draw_regions(over_map)
        for mode in Mode:
            own = [each for each in every if each.observed == mode]
            over_map.plot(
                [each.mu for each in own],
                [each.eta for each in own],
                MODES[mode].marker,
                mfc=MODES[mode].colour,
                mec="white",
                mew=0.5,
                ms=6,
                ls="none",
                label=mode.value if own else "",
            )
        over_map.legend(loc="upper left", title="observed")
        over_map.set_title(f"Least thickness and mode by {engine}")
        _confusion(matrix, every)
        points = errors.scatter(
            [each.alpha_deg for each in every],
            [each.mu for each in every],
            c=[max(abs(each.error), 1e-6) for each in every],
            norm=LogNorm(1e-6, 1e-2),
            s=16,
        )
        errors.set_yscale("log")
        errors.set_xlabel("half-angle of embrace [deg]")
        errors.set_ylabel(r"friction coefficient $\mu$")
        errors.set_title("Error of least thickness")
        figure.colorbar(points, ax=errors, label="centre of bracket over exact, less 1")
        figure.savefig(path, dpi=150)


def _confusion(axes: Axes, every: list[Seen]) -> None:
    """Draw how often each mode is observed where each is published."""
    counts = Counter((each.published, each.observed) for each in every)
    published = [mode.value for mode in Mode if any(row == mode for row, _ in counts)]
    names = [*(mode.value for mode in Mode), UNNAMED]
    observed = [name for name in names if any(column == name for _, column in counts)]
    table = np.array([[counts[row, column] for column in observed] for row in published])
    axes.imshow(table / table.sum(axis=1, keepdims=True), cmap="Blues", vmin=0, vmax=1.6)
    for (row, column), count in np.ndenumerate(table):
        if count:
            axes.text(column, row, str(count), ha="center", va="center")
    axes.set_xticks(range(len(observed)), observed)
    axes.set_yticks(range(len(published)), published)
    axes.set_xlabel("mode observed")
    axes.set_ylabel("mode published")
    axes.set_title("Modes")


if __name__ == "__main__":
    chosen = Path(sys.argv[1])
    number = int(sys.argv[2]) if len(sys.argv) > 2 else ARCHES
    name = sys.argv[3] if len(sys.argv) > 3 else ENGINE
    print(main(chosen, arches=number, engine=name))  # noqa: T201
