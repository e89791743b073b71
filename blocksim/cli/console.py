"""What a terminal shows: lines, tables, a bar while something goes on, pictures saved."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from blocksim.common.checks import require
from blocksim.common.files import json_text, require_place, write_whole
from blocksim.common.progress import Progress as Report
from blocksim.report.answers import ratio, signed
from blocksim.report.structurewords import found_of, question_of, summary_of_structures
from blocksim.studies.agreement import Unasked, Validation, disagreements, numbered
from blocksim.studies.chart import Point, on_front
from blocksim.studies.questions import StructureRow

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDE = 128
"""Characters in a line of the widest table."""


@contextmanager
def progress() -> Generator[Report]:
    """Show a bar on standard error while something goes on."""
    columns = (TextColumn("{task.description:34}"), BarColumn(), TimeElapsedColumn())
    console = Console(stderr=True)
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("", total=1.0)

        def report(share: float, what: str) -> None:
            bar.update(task, completed=share, description=what)

        yield report


def validation_table(rows: list[Validation]) -> Table:
    """Lay out validation rows for a terminal: a line an arch, a column an engine."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    engines = list(dict.fromkeys(row.engine for row in rows))
    words = {"scenario", "mode", *engines}
    for heading in (
        "#",
        "scenario",
        "alpha",
        "mu",
        "n",
        "mode",
        "published",
        "limit",
        *engines,
    ):
        table.add_column(heading, justify="left" if heading in words else "right", no_wrap=True)
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


def validation_lines(rows: list[Validation], unasked: Sequence[Unasked] = ()) -> list[str]:
    """Return how many rows agree, what does not, and where engines differ, in words."""
    misses = [row for row in rows if row.miss]
    right = f"{len(rows) - len(misses)} of {len(rows)}"
    lines = [f"{right} agree with the exact answer in every respect"]
    lines += [f"  {row.scenario}, {row.engine}: {row.miss} ({row.note})" for row in misses]
    if len({row.engine for row in rows}) > 1:
        apart = disagreements(rows)
        lines.append(f"the engines disagree in {len(apart)} places")
        lines += [f"  {each}" for each in apart]
    return lines + [f"not asked of {each.words}" for each in unasked]


def structure_table(rows: list[StructureRow]) -> Table:
    """Lay out rows on structures for a terminal: a line an answer."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("structure", "over", "known", "published", "method", "answer", ""):
        side = "right" if heading in {"known", "published"} else "left"
        table.add_column(heading, justify=side, no_wrap=True)
    for row in rows:
        wanted = "" if row.expected is None else f"{row.expected:.8g}"
        known = row.expected_verdict.value if row.expected_verdict else wanted
        first = row.method == "limit"
        asked = (row.structure, row.question, known, row.published or "-")
        said = (row.method, found_of(row), "!" if row.miss else "")
        table.add_row(*(asked if first else ("", "", "", "")), *said)
    return table


def structure_lines(rows: list[StructureRow], unasked: Sequence[Unasked] = ()) -> list[str]:
    """Return how many answers on structures agree, and what does not, in words."""
    lines = [summary_of_structures(rows).removesuffix(".")]
    lines += [
        f"  {row.structure}, {question_of(row)}, {row.method}: {row.miss} ({row.note})"
        for row in rows
        if row.miss
    ]
    return lines + [f"not asked of {each.words}" for each in unasked]


def chart_table(points: list[Point]) -> Table:
    """Lay out what was measured for the chart, one line a bracket."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in (
        "arch",
        "method",
        "knob",
        "value",
        "error",
        "s",
        "contact solves",
        "",
    ):
        side = "left" if heading in {"arch", "method", "knob", ""} else "right"
        table.add_column(heading, justify=side, no_wrap=True)
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
    return f"{row.mode_observed or row.verdict or '-'}{error}{' !' if row.miss else ''}"


def picture_kind(out: Path, kinds: tuple[str, ...]) -> str:
    """Return the kind of a picture, by the ending of a file that can be written."""
    kind = out.suffix.removeprefix(".")
    *most, last = (f".{each}" for each in kinds)
    allowed = f"a file name ending in {', '.join(most)} or {last}"
    require(kind in kinds, "--out", str(out), allowed)
    require_place(out)
    return kind


def save_picture(figure: Figure, out: Path, kind: str, height: int | None = None) -> None:
    """Write a picture whole, so many pixels high if it is a png, and say so."""
    from blocksim.view.drawing import save_figure

    write_whole(out, lambda file: save_figure(figure, file, kind, height=height))
    say(f"wrote {out}")


def answer_with(record: dict[str, object], lines: list[str], *, as_json: bool) -> None:
    """Print an answer, as one JSON object or as lines for people."""
    say(json_text(record) if as_json else "\n".join(lines))


def show(table: Table) -> None:
    """Print a table; a narrow window wraps its lines rather than losing columns."""
    Console(width=max(Console().width, WIDE)).print(table)


def say(text: str) -> None:
    """Print a line on standard output."""
    typer.echo(text)
