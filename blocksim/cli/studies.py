"""The studies: published arches and structures held against their sources, and the chart."""

from __future__ import annotations

import math
from pathlib import Path

import click

from blocksim.cli.arguments import option
from blocksim.cli.output import progress, say
from blocksim.cli.terminal import Table, show
from blocksim.common.checks import Range
from blocksim.common.files import make_folder
from blocksim.common.words import counted
from blocksim.engines import NAMES, engine_named
from blocksim.report.answerwords import ratio, signed
from blocksim.report.structurepart import found_of, question_of, summary_of_structures
from blocksim.studies.agreement import Validation, disagreements, numbered
from blocksim.studies.chart import Point, cases, measure, on_front
from blocksim.studies.questions import StructureRow
from blocksim.studies.validate import parted, structures, unasked
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
    arches, others = parted(found)
    show(validation_table(arches))
    say(*validation_lines(arches))
    show(structure_table(others))
    say(*structure_lines(others), *(f"not asked of {each.words}" for each in left_out))
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


def validation_table(rows: list[Validation]) -> Table:
    """Lay out validation rows for a terminal: a line an arch, a column an engine."""
    engines = list(dict.fromkeys(row.engine for row in rows))
    headings = ("#", "scenario", "alpha", "mu", "n", "mode", "published", "limit", *engines)
    words = {"scenario", "mode", *engines}
    table = Table(*headings, right={*headings} - words, wrap=False, below=len(engines))
    for name, number in numbered(rows).items():
        answers = {row.engine: row for row in rows if row.scenario == name}
        row = next(iter(answers.values()))
        table.add_row(
            str(number),
            name,
            f"{math.degrees(row.half_angle):.1f}",
            f"{row.mu:.4g}",
            str(row.voussoirs),
            "/".join(row.modes_published),
            ratio(row.eta_published),
            ratio(row.eta_limit),
            *(_answer(answers.get(engine)) for engine in engines),
        )
    return table


def validation_lines(rows: list[Validation]) -> list[str]:
    """Return how many rows agree, what does not, and where engines differ, in words."""
    misses = [row for row in rows if row.miss]
    right = f"{len(rows) - len(misses)} of {len(rows)}"
    lines = [
        "mode, published: of the continuous arch, the thickness as a share of the radius",
        "limit: least thickness of the voussoirs as built",
        "engines: the mode that is seen, and how far their least thickness is from limit's",
        f"{right} answers of engines agree with limit: thickness, mode and verdict",
    ]
    lines += [f"  {row.scenario}, {row.engine}: {row.miss} ({row.note})" for row in misses]
    if len({row.engine for row in rows}) > 1:
        apart = disagreements(rows)
        places = counted(len(apart), "place") if apart else "no place"
        lines.append(f"engines contradict each other in {places}")
        lines += [f"  {each}" for each in apart]
    return lines


def structure_table(rows: list[StructureRow]) -> Table:
    """Lay out rows on structures for a terminal: a line a question, a column a method."""
    methods = list(dict.fromkeys(row.method for row in rows))
    headings = ("structure", "over", "known", "published", *methods)
    table = Table(*headings, right={"known", "published"}, wrap=False, below=len(methods))
    asked: dict[tuple[str, ...], dict[str, str]] = {}
    for row in rows:
        wanted = "" if row.expected is None else f"{row.expected:.8g}"
        known = row.expected_verdict.value if row.expected_verdict else wanted
        question = (row.structure, row.question, known, row.published or "-")
        answer = f"{found_of(row)}{' !' if row.miss else ''}"
        asked.setdefault(question, {})[row.method] = answer
    for question, answers in asked.items():
        table.add_row(*question, *(answers.get(method, "") for method in methods))
    return table


def structure_lines(rows: list[StructureRow]) -> list[str]:
    """Return how many answers on structures agree, and what does not, in words."""
    return [
        summary_of_structures(rows).removesuffix("."),
        *(
            f"  {row.structure}, {question_of(row)}, {row.method}: {row.miss} ({row.note})"
            for row in rows
            if row.miss
        ),
    ]


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


def _answer(row: Validation | None) -> str:
    """Return what one engine saw, and the error of its bracket."""
    if row is None:
        return "-"
    error = "" if row.error is None else f" {signed(100 * row.error, 3)}%"
    return f"{row.mode_observed or '-'}{error}{' !' if row.miss else ''}"
