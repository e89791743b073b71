"""Tables on a terminal, and what is said below them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from blocksim.cli.terminal import Table
from blocksim.report.answerwords import ratio, signed
from blocksim.report.structurewords import found_of, question_of, summary_of_structures
from blocksim.studies.agreement import Unasked, Validation, disagreements, numbered
from blocksim.studies.chart import Point, on_front
from blocksim.studies.questions import StructureRow


def validation_table(rows: list[Validation]) -> Table:
    """Lay out validation rows for a terminal: a line an arch, a column an engine."""
    engines = list(dict.fromkeys(row.engine for row in rows))
    headings = ("#", "scenario", "alpha", "mu", "n", "mode", "published", "limit", *engines)
    words = {"scenario", "mode", *engines}
    table = Table(*headings, right={*headings} - words, wrap=False)
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
    headings = ("structure", "over", "known", "published", "method", "answer", "")
    table = Table(*headings, right={"known", "published"}, wrap=False)
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
    return f"{row.mode_observed or row.verdict or '-'}{error}{' !' if row.miss else ''}"
