"""The command fragility."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import read_table
from blocksim.cli.acting import Loading
from blocksim.cli.arguments import option
from blocksim.cli.built import Given
from blocksim.cli.curves import KINDS as CURVES
from blocksim.cli.options import JSON, METHOD, SCENE, SET, named_options, settings_of
from blocksim.cli.output import answer_with, picture_kind, progress, write_files
from blocksim.cli.subject import anything_asked
from blocksim.common.checks import Range, require
from blocksim.common.sheets import write_sheet
from blocksim.common.words import counted
from blocksim.report.problems import problem_record
from blocksim.simulation.verdict import Verdict
from blocksim.sweeps.fragility import fragility as find

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_AMPLITUDES = 1000


def fragility(
    given: Given,
    loading: Loading,
    scene: str | None = SCENE,
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
    problem = anything_asked(
        scene, given, loading, thick=True, record=record, amplitudes=amplitudes
    )
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
    shares = [found.share(each).tolist() for each in (Verdict.COLLAPSES, Verdict.UNDECIDED)]
    table = list(zip(found.amplitudes.tolist(), *shares, strict=True))
    headings = ["amplitude_g", "falls", "undecided"]
    words = (f"{each[0]:13.4g}  {each[1]:5.0%}  {each[2]:9.0%}" for each in table)
    answer_with(
        lambda: {
            "problem": problem_record(problem),
            "rows": [dict(zip(headings, row, strict=True)) for row in table],
            "verdicts": dict(zip(found.records, found.verdicts, strict=True)),
        },
        lambda: [
            f"Share of {counted(len(names), 'record')} that brings it down, by amplitude:",
            "amplitude [g]  falls  undecided",
            *words,
        ],
        as_json=as_json,
    )
    tables = {"csv": partial(write_sheet, names=headings, rows=table)}
    write_files(out or (), tables, lambda: _figure(problem, len(names), table), silent=as_json)


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
    title = f"{title_of(problem)}: share of {records} records that brings it down"
    figure = curve_figure(title, "amplitude of the record [g]", "share", lines)
    figure.axes[0].set_ylim(0, 1.02)
    return figure
