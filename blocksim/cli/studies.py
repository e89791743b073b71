"""The studies: published arches and structures held against their sources, and the chart."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click

from blocksim.cli.arguments import Option
from blocksim.cli.output import progress, say
from blocksim.cli.tables import (
    chart_table,
    structure_lines,
    structure_table,
    validation_lines,
    validation_table,
)
from blocksim.cli.terminal import show
from blocksim.common.checks import Range
from blocksim.common.files import make_folder
from blocksim.engines import NAMES, engine_named
from blocksim.studies.chart import cases, measure
from blocksim.studies.structures import (
    structures,
    unasked_structures,
    validate_structures,
)
from blocksim.studies.validate import scenarios, unasked
from blocksim.studies.validate import validate as run_validation


def validate(
    quick: Annotated[
        bool, Option(name="--quick/--full", about="Scenarios marked quick, or all of them.")
    ] = False,
    out: Annotated[Path, Option(about="Folder for the results.", folder=True)] = Path(
        "out/validate"
    ),
    methods: Annotated[
        str | None,
        Option(
            about=f"Engines, with commas: {', '.join(NAMES)}, or your own as module:ENGINE; "
            "those usual if left out."
        ),
    ] = None,
    workers: Annotated[
        int, Option(range=Range(low=1, high=64, whole=True), about="Processes.")
    ] = 2,
) -> None:
    """Simulate published arches and structures; compare with the map and their sources.

    Exit code 0 where all agrees, 1 where something does not.
    """
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.tables import write_results

    engines = None if methods is None else [each.strip() for each in methods.split(",")]
    for each in engines or ():
        engine_named(each, "--methods")
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
    say(*validation_lines(rows, left_out))
    show(structure_table(answers))
    say(*structure_lines(answers, built_left_out))
    say("wrote " + ", ".join(str(path) for path in paths))
    raise click.exceptions.Exit(int(any(row.miss for row in (*rows, *answers))))


def chart(
    quick: Annotated[
        bool, Option(name="--quick/--full", about="Two small arches, or five.")
    ] = False,
    out: Annotated[Path, Option(about="Folder for the results.", folder=True)] = Path(
        "out/chart"
    ),
    beside: Annotated[
        Path | None, Option(about="Points of another program: JSON like chart.json.")
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
