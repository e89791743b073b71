"""The commands sweep and fragility: many questions, and what became of them in words."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import read_table
from blocksim.cli.arguments import argument, option
from blocksim.cli.options import JSON, METHOD, SET, named_options, require_given, settings_of
from blocksim.cli.output import CURVES, answer_with, picture_kind, progress, write_files
from blocksim.cli.subject import Subject, anything_asked
from blocksim.common.checks import Range, require
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.common.fields import same
from blocksim.common.sheets import write_sheet
from blocksim.common.words import counted, lasting
from blocksim.report.problems import problem_record
from blocksim.simulation.verdict import Verdict
from blocksim.sweeps.cluster import cluster
from blocksim.sweeps.fragility import Fragility
from blocksim.sweeps.fragility import fragility as find
from blocksim.sweeps.load import load_design
from blocksim.sweeps.run import Summary
from blocksim.sweeps.run import sweep as ask_sweep
from blocksim.sweeps.table import require_parquet, write_csv, write_parquet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_AMPLITUDES = 1000


def sweep(
    design: Path | None = argument("Which arches to ask about: a .toml file; required."),
    out: Path | None = option(
        "Folder for the rows; one that has some is resumed; required.", folder=True
    ),
    workers: int = option("Processes.", default=2, range=Range(low=1, high=256, whole=True)),
    scheduler: str | None = option("Address of a dask scheduler, instead of processes."),
    parquet: bool = option(
        "Write all rows as a table, too: rows.parquet.", default=False, name="--parquet"
    ),
    csv: bool = option("Write all rows as CSV, too: rows.csv.", default=False, name="--csv"),
    as_json: bool = JSON,
) -> None:
    """Ask about many arches. A run that was killed goes on where it was."""
    if design is None:
        extra = " and --out" if out is None else ""
        raise InputError(f"DESIGN{extra}", ALL_MISSING if extra else MISSING, "given")
    require_given(out=out)
    out = out or Path()
    asked = load_design(design)
    if parquet:
        require_parquet()
    with ExitStack() as stack:
        executor = None
        if scheduler is not None:
            executor, workers = stack.enter_context(cluster(scheduler))
        report = stack.enter_context(progress())
        done = ask_sweep(asked, out, executor=executor, workers=workers, progress=report)
        if parquet:
            write_parquet(out, out / "rows.parquet")
        if csv:
            write_csv(out, out / "rows.csv")
    answer_with(lambda: summary_record(done), lambda: summary_lines(done, out), as_json=as_json)


def summary_record(done: Summary) -> dict[str, object]:
    """Return a summary as `sweep --json` prints it."""
    counts, times = same(done, "cases", "found"), same(done, "saved_s", "wall_s")
    return {**counts, **asdict(done.tally), **times}


def summary_lines(done: Summary, out: Path) -> list[str]:
    """Return a summary in words."""
    tally = done.tally
    before = f"; {done.found} were there before" if done.found else ""
    lines = [f"{out} has a row for each of {done.cases} cases{before}"]
    if tally.rows:
        pace = tally.rows / done.wall_s
        lines.append(f"  new     {tally.rows}, in {done.wall_s:.3g} s ({pace:.3g} a second)")
    if tally.simulated:
        mean = tally.simulated_s / tally.simulated
        lines.append(f"  moved   {tally.simulated} were simulated, in {lasting(mean)} each")
    if tally.spared:
        saved = "" if done.saved_s is None else f", which saved about {done.saved_s:.3g} s"
        lines.append(f"  exact   {tally.spared} were answered by limit analysis{saved}")
        lines.append("          (they are too far from their limit to be worth simulating)")
    if tally.failed:
        lines.append(f"  failed  {tally.failed} could not be answered: their rows say why")
    return lines


def fragility(
    asked: Subject,
    record: list[Path] | None = option(
        "Record of the ground, a .csv file as of --shake; repeatable; required."
    ),
    amplitudes: tuple[float, float, int] | None = option(
        "Amplitudes in g to which each record is scaled, evenly spaced; required.",
        metavar="LOW HIGH COUNT",
    ),
    out: list[Path] | None = option(
        "File to write: .csv with a row an amplitude, or a curve, .pdf, .svg, .png; repeatable."
    ),
    rows: Path | None = option(
        "Folder for the answers; one that has some is resumed.", folder=True
    ),
    workers: int = option("Processes.", default=1, range=Range(low=1, high=256, whole=True)),
    method: str = METHOD,
    settings: list[str] | None = SET,
    as_json: bool = JSON,
) -> None:
    """Find which share of records of the ground brings it down, by their amplitude."""
    problem = anything_asked(asked, thick=True, record=record, amplitudes=amplitudes)
    allowed = "x and y: in space there are check, bracket, simulate, render and report"
    require(not problem.in_space, "blocks", "three coordinates", allowed)
    for path in out or ():
        picture_kind(path, CURVES)
    names = [str(path) for path in record or ()]
    require(len(set(names)) == len(names), "--record", names[-1:], "each file once")
    require(problem.shaking is None, "--shake", "given", "left out beside --record")
    spaced = _spaced(*(amplitudes or (0.0, 0.0, 0)))
    with named_options(), progress() as report:
        found = find(
            problem,
            {name: read_table(name) for name in names},
            spaced,
            folder=rows,
            workers=workers,
            method=method,
            settings=settings_of(settings),
            progress=report,
        )
    _tell(found, out or (), as_json=as_json)


def _tell(found: Fragility, out: Sequence[Path], *, as_json: bool) -> None:
    """Print and write the share of records that brings it down."""
    count = len(found.records)
    shares = [found.share(each).tolist() for each in (Verdict.COLLAPSES, Verdict.UNDECIDED)]
    table = list(zip(found.amplitudes.tolist(), *shares, strict=True))
    headings = ["amplitude_g", "falls", "undecided"]
    words = (f"{each[0]:13.4g}  {each[1]:5.0%}  {each[2]:9.0%}" for each in table)
    answer_with(
        lambda: {
            "problem": problem_record(found.problem),
            "rows": [dict(zip(headings, row, strict=True)) for row in table],
            "verdicts": dict(zip(found.records, found.verdicts, strict=True)),
        },
        lambda: [
            f"Share of {counted(count, 'record')} that brings it down, by amplitude:",
            "amplitude [g]  falls  undecided",
            *words,
        ],
        as_json=as_json,
    )
    tables = {"csv": partial(write_sheet, names=headings, rows=table)}
    write_files(out, tables, lambda: _figure(found.problem, count, table), silent=as_json)


def _spaced(low: float, high: float, count: int) -> list[float]:
    known = 1 <= count <= MOST_AMPLITUDES and (low < high or count == 1)
    allowed = f"LOW below HIGH, and 1 to {MOST_AMPLITUDES} of them"
    require(known, "--amplitudes", f"{low:g} {high:g} {count}", allowed)
    return np.linspace(low, high, count).tolist()


def _figure(
    problem: Problem, records: int, rows: Sequence[tuple[float, float, float]]
) -> Figure:
    from blocksim.view.curvefigure import Line, curve_figure
    from blocksim.view.sheet import title_of
    from blocksim.view.style import VERDICTS

    across, falling, unknown = (list(each) for each in zip(*rows, strict=True))
    lines = [Line("falls", across, falling, VERDICTS[Verdict.COLLAPSES])]
    if any(unknown):
        both = [falls + open for falls, open in zip(falling, unknown, strict=True)]
        tone = VERDICTS[Verdict.UNDECIDED]
        lines.append(Line("falls, or undecided", across, both, tone))
    title = f"{title_of(problem)}: share of {counted(records, 'record')} that brings it down"
    figure = curve_figure(title, "amplitude of the record [g]", "share", lines)
    figure.axes[0].set_ylim(0, 1.02)
    return figure
