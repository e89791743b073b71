"""The mode an arch starts with, over the whole map and where modes are narrow.

Question: does an engine see, close to the least thickness, the mechanism that limit analysis
finds for the same voussoirs, in all seven modes? Of ten arches of 20 to 40 voussoirs five lie
anywhere on the map: half-angle even from 30 to 159 deg, friction log-uniform from what lets any
thickness stand to 4. Four have one of the mixed modes each (srr, rrs, rsr, rs), which have
little room: they are drawn in the same way until one comes that has it. The tenth lies on the
line where purely sliding arches are published, and is 1.1 to 3 times as thick as the least
there: not its thickness is critical but its friction. Purely overturning arches (r) need
boundless friction, of which engines take 1000: they are left out. A voussoir of these spans the
band of rsr, so that limit analysis itself calls most draws of rsr another mode: the same half-
angles and frictions are asked again with 120 to 200 voussoirs, and others within 0.2 % of those
of S and J, where rsr meets other modes.

The mode is that of the mechanism an arch starts with, by the onset test: `direct` 1e-5 below
the least thickness of the voussoirs (or the friction they need, where that is critical), pymunk
5e-4 below. It is compared first with the mechanism of limit analysis (eqs 15 and 16) for the
same voussoirs at the same thickness, then with theory.

Run: python -m analysis.onset_modes OUT [--engine pymunk] [--sweep N] [--rsr N] [--about N]
[--most N] [--processes N]. Rows are kept in OUT/onset_modes_ENGINE.jsonl, the same command goes
on after an interruption; they are written as OUT/onset_modes_ENGINE.csv, too.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.command import run
from analysis.rows import FIGURES, read_kept, write_rows
from analysis.saved_answers import Row, answers
from blocksim import Arch, CircularArch, Mode
from blocksim.arch.circular import ETA_MAX
from blocksim.arch.limit import least_thickness
from blocksim.arch.limit.bulk import which_stand
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import observed_mode
from blocksim.arch.theory import least_thickness as theory_of
from blocksim.arch.theory.arrays import least_thicknesses
from blocksim.arch.theory.map import divide_friction
from blocksim.arch.theory.regions import at_inner_sliding, landmarks
from blocksim.blocks.assembly import Array
from blocksim.simulation.observation import observe
from blocksim.sweeps.answers import version_of
from blocksim.view.mapregions import draw_regions
from blocksim.view.style import FONT, INK, MISS, MODES, UNNAMED

SEED, OF_MODES = 14, 2024
ARCHES = 2300
FINEST = 200
FEWEST = 120
BELOW = {"direct": 1e-5, "pymunk": 5e-4}
AROUND = 0.002
"""Share of half-angle and friction within which arches are drawn about S and J."""
NONE = "none"
ANYWHERE = None
TURNS = (ANYWHERE, Mode.SRR, ANYWHERE, Mode.RRS, ANYWHERE, Mode.RSR, ANYWHERE, Mode.RS)
TURNS += (ANYWHERE, Mode.SS)
"""What ten arches in a row are drawn from."""
NARROWEST, WIDEST, MOST_FRICTION = 30.0, 159.0, 4.0
BLOCK = 4096
"""Arches drawn together."""


@dataclass(frozen=True)
class Fine:
    """An arch: where it was drawn (map, rsr, S or J), half-angle [deg], friction, voussoirs.

    `eta` where friction is critical, not thickness, with that friction in `mu`.
    """

    where: str
    alpha_deg: float
    mu: float
    voussoirs: int
    eta: float | None = None


def drawn(sweep: int, rsr: int, about: int, most: int) -> list[Fine]:
    """Draw the arches: over the map, its rsr with more voussoirs, about S and J."""
    counts = np.random.default_rng(SEED)
    every = list(itertools.islice(draw(), sweep))
    every += [
        replace(each, where=Mode.RSR.value, voussoirs=int(counts.integers(FEWEST, most + 1)))
        for each in itertools.islice(critical_draws(Mode.RSR), rsr)
    ]
    for name in ("S", "J"):
        every += itertools.islice(_near(name, most), about)
    return every


def draw() -> Iterator[Fine]:
    """Draw arches, without end."""
    streams = {turn: critical_draws(turn) for turn in TURNS}
    for turn in itertools.cycle(TURNS):
        yield next(streams[turn])


def critical_draws(turn: Mode | None) -> Iterator[Fine]:
    """Draw arches of one kind, independently of the others."""
    random = np.random.default_rng([OF_MODES, TURNS.index(turn)])
    while True:
        alpha_deg = random.uniform(NARROWEST, WIDEST, BLOCK)
        least = np.interp(alpha_deg, *divide())
        mu = least * (MOST_FRICTION / least) ** random.random(BLOCK)
        voussoirs = random.integers(20, 41, BLOCK)
        thicker = random.uniform(1.1, 3.0, BLOCK)
        if turn is Mode.SS:
            yield from map(_on_divide, alpha_deg, voussoirs, thicker)
        else:
            yield from _critical(turn, alpha_deg, mu, voussoirs)


@cache
def divide() -> tuple[Array, Array]:
    """Half-angles [deg] and the friction below which no thickness stands."""
    angles = np.linspace(NARROWEST, WIDEST, 200)
    return angles, np.array([divide_friction(math.radians(angle)) for angle in angles])


def _critical(
    turn: Mode | None, alpha_deg: Array, mu: Array, voussoirs: Array
) -> Iterator[Fine]:
    """Those that stand at some thickness and have the mode asked for."""
    there = least_thicknesses(np.radians(alpha_deg), mu)
    wanted = (there.eta < ETA_MAX / 1.005) & ((there.mode == turn) | (turn is ANYWHERE))
    for k in np.flatnonzero(wanted):
        yield Fine("map", float(alpha_deg[k]), float(mu[k]), int(voussoirs[k]))


def _on_divide(alpha_deg: float, voussoirs: int, thicker: float) -> Fine:
    """Draw an arch on the line of purely sliding ones, and the friction its voussoirs need."""
    half_angle, count = math.radians(alpha_deg), int(voussoirs)
    mu = divide_friction(half_angle)
    least, _ = at_inner_sliding(mu, half_angle, "centreline")
    eta = float(min(thicker * least, ETA_MAX))
    low, high = mu / 2, mu * 2
    for _ in range(40):
        middle = (low + high) / 2
        stands = bool(which_stand(half_angle, eta, middle, count))
        low, high = (low, middle) if stands else (middle, high)
    return Fine("map", float(alpha_deg), high, count, eta)


def _near(name: str, most: int) -> Iterator[Fine]:
    """Draw arches about a point of the map that stand at some thickness."""
    random = np.random.default_rng([SEED, ord(name)])
    mark = landmarks()[name]
    while True:
        alpha, mu = np.array([mark.half_angle, mark.mu]) * random.uniform(
            1 - AROUND, 1 + AROUND, 2
        )
        voussoirs = int(random.integers(FEWEST, most + 1))
        if least_thickness(alpha, mu, voussoirs).eta and theory_of(alpha, mu).eta:
            yield Fine(name, math.degrees(alpha), float(mu), voussoirs)


def ask(fine: Fine, engine: str) -> Row:
    """Ask an engine what the arch starts with, and limit analysis and theory likewise."""
    alpha = math.radians(fine.alpha_deg)
    least = least_thickness(alpha, fine.mu, fine.voussoirs)
    mu, eta, below = fine.mu, fine.eta, 1 - BELOW[engine]
    if eta is None:
        eta = (ETA_MAX if least.eta is None else least.eta) * below
    else:
        mu *= below
    arch = Arch(half_angle=alpha, eta=eta, voussoirs=fine.voussoirs)
    seen = observe(CircularArch.of(arch, mu).problem(), engine, moving=False)
    mode = observed_mode(seen.joints, arch)
    there = mechanism(arch, mu).mode
    return {
        "drawn": fine.where,
        "alpha_deg": fine.alpha_deg,
        "mu": mu,
        "voussoirs": fine.voussoirs,
        "eta": eta,
        "verdict": seen.verdict.value,
        "mode": NONE if mode is None else mode.value,
        "mode_limit": NONE if there is None else there.value,
        "mode_theory": theory_of(alpha, mu).mode.value,
        "engine": engine,
        "engine_version": version_of(engine),
    }


def main(
    out: Path,
    *,
    quick: bool = False,
    engine: str = "direct",
    sweep: int = ARCHES,
    rsr: int = 230,
    about: int = 40,
    most: int = FINEST,
    processes: int = 2,
) -> list[Row]:
    """Run the study or go on with it; write rows and figure."""
    cases = drawn(10, 2, 1, FEWEST) if quick else drawn(sweep, rsr, about, most)
    path = out / f"onset_modes_{engine}.jsonl"
    rows = answers(path, cases, partial(ask, engine=engine), 1 if quick else processes)
    write_rows(path.with_suffix(".csv"), rows)
    _figure(rows, path.with_suffix(".png"), engine)
    return rows


def drawn_again(path: Path) -> None:
    """Draw what the rows that are kept say."""
    _figure(read_kept(FIGURES / "onset_modes_direct.csv.gz"), path, "direct")


def _figure(rows: list[Row], path: Path, engine: str) -> None:
    """Draw what arches start with over the map, and count it against limit analysis."""
    parts = (
        ("the arches of the sweep", [r for r in rows if r["drawn"] == "map"]),
        ("rsr, about S and J", [r for r in rows if r["drawn"] != "map"]),
    )
    parts = tuple((title, own) for title, own in parts if own)
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(14, 6.6 * len(parts)), layout="constrained")
        grid = figure.subplots(len(parts), 2, width_ratios=(1.5, 1), squeeze=False)
        for (title, own), (over, table) in zip(parts, grid, strict=True):
            counts = sorted(int(str(r["voussoirs"])) for r in own)
            span = f"{counts[0]} to {counts[-1]} voussoirs"
            _over_map(over, own, zoomed=own[0]["drawn"] != "map")
            over.set_title(f"{title}: {len(own)} of {span}, {BELOW[engine]:g} below the limit")
            _table(table, own, engine)
        figure.savefig(path, dpi=110)


def _over_map(axes: Axes, rows: list[Row], *, zoomed: bool) -> None:
    """Draw the modes seen over those published (Fig. 9)."""
    draw_regions(axes)
    # What lies beyond a zoom is no part of the picture.
    for drawn in (*axes.texts, *axes.lines, *axes.collections, *axes.patches):
        drawn.set(clip_on=True, in_layout=False)
    handles: list[Line2D] = []
    for mode in (*Mode, None):
        name, style = (mode.value, MODES[mode]) if mode else (NONE, UNNAMED)
        own = [row for row in rows if row["mode"] == name]
        look = {"marker": style.marker, "mfc": style.colour, "mec": "white", "mew": 0.4}
        axes.plot(*_places(own), ls="", ms=7 if zoomed else 4.5, zorder=5, **look)
        if own:
            handles.append(Line2D([], [], ls="", ms=8, label=f"{name}  {len(own)}", **look))
    rings = (
        ("as limit analysis,\nnot as published", INK, False),
        ("not as limit analysis", MISS, True),
    )
    for words, colour, missed in rings:
        own = [
            row
            for row in rows
            if (row["mode"] != row["mode_limit"]) is missed
            and (missed or row["mode"] != row["mode_theory"])
        ]
        ring = {"marker": "o", "mfc": "none", "mec": colour, "mew": 0.8, "ls": ""}
        axes.plot(*_places(own), ms=11 if zoomed else 8, zorder=6, **ring)
        handles.append(Line2D([], [], ms=10, label=f"{words}  {len(own)}", **ring))
    if zoomed:
        mus, etas = np.array(_places(rows))
        axes.set_xlim(mus.min() - 0.02, mus.max() + 0.02)
        axes.set_ylim(etas.min() - 0.005, etas.max() + 0.005)
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        for text in list(axes.texts):
            mu, eta = getattr(text, "xy", text.get_position())
            arrow = getattr(text, "arrow_patch", None)
            if arrow or not (left <= mu <= right and low <= eta <= high):
                text.remove()  # a name that lies beyond
    axes.legend(handles=handles, loc="best", title="starts with", fontsize=9)


def _table(axes: Axes, rows: list[Row], engine: str) -> None:
    """Draw how often each mode is seen where limit analysis says each."""
    counts = Counter((str(row["mode_limit"]), str(row["mode"])) for row in rows)
    names = [m for m in (*Mode, NONE) if any(m in pair for pair in counts)]
    grid = np.array([[counts[limit, seen] for seen in names] for limit in names])
    axes.imshow(grid > 0, cmap="Blues", vmin=0, vmax=2.5)
    for (down, across), count in np.ndenumerate(grid):
        axes.text(across, down, str(count or ""), ha="center", va="center", fontsize=12)
    axes.set_xticks(range(len(names)), names)
    axes.set_yticks(range(len(names)), names)
    axes.set_xlabel(f"starts with, by {engine}")
    axes.set_ylabel("limit analysis of the same voussoirs")
    axes.spines[:].set_visible(False)


def _places(rows: list[Row]) -> tuple[list[float], list[float]]:
    return [float(str(r["mu"])) for r in rows], [float(str(r["eta"])) for r in rows]


if __name__ == "__main__":
    run(main, lambda rows: str(Counter((row["mode_limit"], row["mode"]) for row in rows)))
