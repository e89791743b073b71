"""The studies: published arches and structures held against their sources, and the chart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import click

from blocksim.cli.arguments import option
from blocksim.cli.output import progress, say
from blocksim.cli.terminal import Table, show
from blocksim.common.checks import Range
from blocksim.common.files import make_folder
from blocksim.common.words import counted
from blocksim.engines import NAMES, engine_named
from blocksim.report.answerwords import signed
from blocksim.report.rowwords import found_of, known_of, summary
from blocksim.studies.agreement import Row, disagreements, parted
from blocksim.studies.chart import Point, cases, measure, on_front
from blocksim.studies.validate import LIMIT, structures, unasked
from blocksim.studies.validate import validate as run_validation


def validate(
    quick: bool = option(
        "Structures marked quick, or all of them.", default=False, name="--quick/--full"
    ),
    out: Path = option("Folder for the results.", default=Path("out/validate"), folder=True),
    methods: str | None = option(
        f"Engines, with commas: {', '.join(NAMES)}, or your own as module:ENGINE; "
        "those usual if left out."
    ),
    workers: int = option("Processes.", default=2, range=Range(low=1, high=64, whole=True)),
) -> None:
    """Simulate published arches and structures; compare with the map and their sources.

    Exit code 0 where all agrees, 1 where something does not.
    """
    from blocksim.report.tables import write_results

    engines = None if methods is None else [each.strip() for each in methods.split(",")]
    for each in engines or ():
        engine_named(each, "--methods")
    make_folder(out)
    chosen = structures(quick=quick)
    left_out = unasked(chosen, engines)
    with progress() as report:
        found = run_validation(chosen, engines, workers=workers, progress=report)
    paths = write_results(found, out, left_out)
    show(answer_table(found))
    say(*answer_lines(found), *(f"not asked of {each.words}" for each in left_out))
    say("wrote " + ", ".join(str(path) for path in paths))
    raise click.exceptions.Exit(int(any(row.miss for row in found)))


def chart(
    quick: bool = option("Two small arches, or five.", default=False, name="--quick/--full"),
    out: Path = option("Folder for the results.", default=Path("out/chart"), folder=True),
    beside: Path | None = option("Points of another program: JSON like chart.json."),
) -> None:
    """Chart the error of every method, from coarse to fine, against time and work."""
    from blocksim.report.chart import read_points, write_chart

    foreign = read_points(beside) if beside else []
    make_folder(out)
    with progress() as report:
        points = measure(cases(quick=quick), quick=quick, progress=report) + foreign
    paths = write_chart(points, out)
    show(chart_table(points))
    say("wrote " + ", ".join(str(path) for path in paths))


def answer_table(rows: Sequence[Row]) -> Table:
    """Lay out answers for a terminal: a line a question, a column a method."""
    told = [_told(row) for row in rows]
    # The exact answers come first.
    methods = sorted(dict.fromkeys(method for _, method, _ in told), key=LIMIT.__ne__)
    headings = ("structure", "over", "known", "published", *methods)
    table = Table(*headings, right={"known", "published"}, wrap=False, below=len(methods))
    asked: dict[tuple[str, ...], dict[str, str]] = {}
    for question, method, answer in told:
        asked.setdefault(question, {})[method] = answer
    for question, answers in asked.items():
        table.add_row(*question, *(answers.get(method, "") for method in methods))
    return table


def _told(row: Row) -> tuple[tuple[str, ...], str, str]:
    """Return a question with what is known of it, the method asked, and its answer."""
    known, published, answer = known_of(row), row.published or "-", found_of(row)
    if row.modes_published:
        known = f"{row.mode_limit or ''} {known}".strip()
        published = f"{'/'.join(row.modes_published)} {published}"
        error = "" if row.error is None else f" {signed(100 * row.error, 3)}%"
        answer = f"{row.mode or '-'}{error}"
    question = (row.structure, row.question, known, published)
    return question, row.method, f"{answer} !" if row.miss else answer


def answer_lines(rows: Sequence[Row]) -> list[str]:
    """Return how many answers agree, what does not, and where engines differ, in words."""
    arches, built = parted(rows)
    right = sum(not row.miss for row in arches)
    lines = [
        "thickness of arches: modes, and the least thickness as a share of the radius",
        "  known: of the voussoirs as built, by limit; published: of the continuous arch",
        "  engines: the mode that is seen, and how far their least thickness is from known",
        f"{right} of {len(arches)} answers of engines agree with limit: thickness, mode "
        "and verdict",
        *([summary(built).removesuffix(".")] if built else []),
    ]
    lines += [
        f"  {name}, {over}, {method}: {row.miss} ({row.note})"
        for row in rows
        if row.miss
        for (name, over, *_), method, _ in [_told(row)]
    ]
    if len({row.method for row in arches}) > 1:
        apart = disagreements(arches)
        places = counted(len(apart), "place") if apart else "no place"
        lines.append(f"engines contradict each other in {places}")
        lines += [f"  {each}" for each in apart]
    return lines


def chart_table(points: list[Point]) -> Table:
    """Lay out what was measured for the chart, one line a bracket."""
    numbers = ("value", "error", "s", "contact solves")
    table = Table("arch", "method", "knob", *numbers, "", right=numbers, wrap=False)
    best = on_front(points)
    for point in points:
        error = f"{point.error:.1e}" if math.isfinite(point.error) else "none"
        table.add_row(
            point.case,
            point.method,
            point.knob,
            f"{point.value:.4g}",
            error,
            f"{point.time:.3g}",
            f"{point.work:.1e}",
            "on the front" if point in best else "",
        )
    return table
