"""The commands that are no question: studies, sweeps, the map, what is there, references."""

from __future__ import annotations

import math
import platform
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from blocksim import __version__
from blocksim.arch.scenario import load_scenario, shipped
from blocksim.ask.doctor import examine, libraries
from blocksim.ask.methods import METHODS
from blocksim.cli.app import app
from blocksim.cli.console import (
    chart_table,
    progress,
    say,
    show,
    structure_lines,
    structure_table,
    validation_lines,
    validation_table,
)
from blocksim.cli.drawing import write_map
from blocksim.cli.options import (
    Json,
    require_given,
)
from blocksim.cli.sweeping import run_sweep
from blocksim.common.checks import require
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.common.files import make_folder
from blocksim.common.references import references
from blocksim.engines import ENGINES
from blocksim.kinds import KINDS
from blocksim.kinds.base import parameters_of
from blocksim.studies.chart import cases, measure
from blocksim.studies.structures import (
    structures,
    unasked_structures,
    validate_structures,
)
from blocksim.studies.validate import USUAL, scenarios, unasked
from blocksim.studies.validate import validate as run_validation

NUMBERS = {"alpha", "mu", "n", "eta"}
"""Columns of numbers."""


@app.command()
def validate(
    quick: Annotated[
        bool, typer.Option("--quick/--full", help="Scenarios marked quick, or all of them.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/validate"),
    methods: Annotated[
        str | None,
        typer.Option(
            help=f"Engines, with commas: {', '.join(ENGINES)}; "
            f"{' and '.join(USUAL)} if left out."
        ),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Processes.")] = 2,
) -> None:
    """Simulate published arches and structures; compare with the map and their sources.

    Exit code 0 where all agrees, 1 where something does not.
    """
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.tables import write_results

    engines = None if methods is None else [each.strip() for each in methods.split(",")]
    for each in engines or ():
        require(each in ENGINES, "--methods", each, f"one or more of {', '.join(ENGINES)}")
    make_folder(out)
    chosen = scenarios(quick=quick)
    left_out = unasked(chosen, engines)
    built = structures(quick=quick)
    built_left_out = unasked_structures(built, engines)
    with progress() as report:
        rows = run_validation(chosen, engines, workers=workers, progress=report)
        answers = validate_structures(built, engines, workers=workers, progress=report)
    paths = write_results(rows, out, left_out, answers, built_left_out)
    show(validation_table(rows))
    say("\n".join(validation_lines(rows, left_out)))
    show(structure_table(answers))
    say("\n".join(structure_lines(answers, built_left_out)))
    say("wrote " + ", ".join(str(path) for path in paths))
    raise typer.Exit(int(any(row.miss for row in (*rows, *answers))))


@app.command()
def chart(
    quick: Annotated[
        bool, typer.Option("--quick/--full", help="Two small arches, or five.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/chart"),
    beside: Annotated[
        Path | None, typer.Option(help="Points of another program: JSON like chart.json.")
    ] = None,
) -> None:
    """Chart the error of every method, from coarse to fine, against time and work."""
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.chart import read_points, write_chart

    foreign = read_points(beside) if beside else []
    make_folder(out)
    with progress() as report:
        points = measure(cases(quick=quick), quick=quick, progress=report) + foreign
    paths = write_chart(points, out)
    show(chart_table(points))
    say("wrote " + ", ".join(str(path) for path in paths))


@app.command()
def sweep(
    design: Annotated[
        Path | None, typer.Argument(help="Which arches to ask about: a .toml file; required.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for the rows; one that has some is resumed; required."),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Processes.")] = 2,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a dask scheduler, instead of processes.")
    ] = None,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="Write all rows as a table, too: rows.parquet.")
    ] = False,
    csv: Annotated[
        bool, typer.Option("--csv", help="Write all rows as CSV, too: rows.csv.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Ask about many arches. A run that was killed goes on where it was."""
    if design is None:
        extra = " and --out" if out is None else ""
        raise InputError(f"DESIGN{extra}", ALL_MISSING if extra else MISSING, "given")
    require_given(out=out)
    run_sweep(
        design, out or Path(), workers, scheduler, parquet=parquet, csv=csv, as_json=as_json
    )


@app.command(name="map")
def draw_map(
    out: Annotated[
        Path | None,
        typer.Option(help="Picture, .svg, .png or .pdf, or a page, .html; required."),
    ] = None,
    lines: Annotated[
        bool, typer.Option("--lines", help="Dividing lines and lines of equal alpha instead.")
    ] = False,
    zoom: Annotated[
        str, typer.Option(help="whole, central; with --lines: whole, lower, upper.")
    ] = "whole",
    results: Annotated[
        Path | None, typer.Option(help="validate.json of a `validate` run, shown on the page.")
    ] = None,
) -> None:
    """Draw the analytical map of least thickness and collapse modes.

    As a page (.html) it can be explored: any point's arch, its lines of thrust and
    friction, and its collapse.
    """
    require_given(out=out)
    write_map(out or Path(), zoom, results, lines=lines)


@app.command(name="scenarios")
def list_scenarios() -> None:
    """List the scenarios and structures that come with blocksim."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("name", "alpha", "mu", "n", "eta", "title", "source"):
        table.add_column(heading, justify="right" if heading in NUMBERS else "left")
    for name in shipped():
        each = load_scenario(name)
        eta = "-" if each.eta is None else f"{each.eta:g}"
        numbers = f"{math.degrees(each.half_angle):g}", f"{each.mu:.4g}", str(each.voussoirs)
        table.add_row(name, *numbers, eta, each.title, each.source)
    show(table)
    say("")
    built = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("structure", "blocks", "mu", "known", "title", "source"):
        built.add_column(heading, justify="right" if heading in {"blocks", "mu"} else "left")
    for known in structures(quick=False):
        told = [
            f"{one.verdict}" if one.verdict else f"--over {one.over} {one.value:.6g}"
            for one in known.expect
        ]
        problem = known.problem
        size = str(len(problem.assembly.blocks)), f"{problem.mu:.4g}"
        built.add_row(known.name, *size, ", ".join(told), problem.title, problem.source)
    show(built)


@app.command(name="kinds")
def list_kinds(
    name: Annotated[
        str | None, typer.Argument(help="One of them, whose parameters are to be listed.")
    ] = None,
) -> None:
    """List the kinds of structures, or the parameters of one."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    if name is None:
        for heading in ("kind", "what it is", "parameters"):
            table.add_column(heading)
        for kind in KINDS.values():
            table.add_row(kind.name, kind.about, ", ".join(parameters_of(kind)))
        show(table)
        return
    require(name in KINDS, "kind", name, f"one of {', '.join(KINDS)}")
    for heading in ("parameter", "if left out", "may be", "what it is", "--over"):
        table.add_column(heading)
    usual = KINDS[name]()
    for each, known in parameters_of(KINDS[name]).items():
        over = ", ".join(over for over in usual.bracketed if over.partition(".")[0] == each)
        table.add_row(each, *known.words(getattr(usual, each)), known.about, over)
    show(table)


@app.command()
def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("method", "version", "here", "finest bracket", "sees"):
        table.add_column(heading)
    for finding in examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:g}"
        here = finding.remedy or "ready"
        table.add_row(finding.method, finding.version or "-", here, finest, finding.sees)
    show(table)
    say(f"blocksim {__version__}, Python {platform.python_version()}")
    say(", ".join(f"{name} {found or '-'}" for name, found in libraries().items()))


@app.command()
def cite(
    methods: Annotated[
        list[str] | None,
        typer.Option("--method", help=f"Repeatable, or all: {', '.join(METHODS)}."),
    ] = None,
) -> None:
    """Print BibTeX of blocksim, of the paper, and of what methods rest on."""
    asked = list(METHODS) if methods == ["all"] else methods or []
    for each in asked:
        require(each in METHODS, "--method", each, f"all, or one of {', '.join(METHODS)}")
    say("\n\n".join(references(asked)))
