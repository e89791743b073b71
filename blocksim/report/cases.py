"""Cases of a structure, compared: as text, JSON and rows of a page."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING

from blocksim.common.version import __version__
from blocksim.common.words import lasting
from blocksim.report.answers import check_record

if TYPE_CHECKING:
    from blocksim.ask.cases import CaseAnswer, Cases
    from blocksim.report.schema import CaseRecord, CasesRecord

HEADINGS = ("used", "load factor", "thrust", "verdict", "case")


def case_row(told: CaseAnswer) -> tuple[str, str, str, str, str]:
    """Return a case as cells of a table below `HEADINGS`. A dash means that nothing is known.

    Thrust is the least and the greatest, in kN/m, or kN where blocks differ in depth.
    """
    answer, carried = told.answer, told.answer.carried
    thrust = None if carried is None else carried.thrust
    ends = "-"
    if carried is not None and thrust is not None and carried.problem.weighed:
        over = 1e3 * (carried.depth or 1.0)
        ends = " to ".join(_number(each / over) for each in thrust)
    factor = answer.load_factor
    return (
        "-" if told.used is None else "inf" if math.isinf(told.used) else f"{told.used:.1%}",
        "-" if factor is None else _number(factor),
        ends,
        answer.verdict.value,
        f"{told.case.name} ({told.case.factors.words})",
    )


def _number(value: float) -> str:
    return "any" if math.isinf(value) else f"{value:.4g}"


def cases_lines(answer: Cases) -> list[str]:
    """Return cases in words, the governing one first."""
    first = answer.governing
    rows = [HEADINGS, *map(case_row, answer.answers)]
    wide = [max(len(row[at]) for row in rows) for at in range(len(HEADINGS) - 1)]
    count = len(answer.answers)
    alike = count > 1 and answer.answers[1].order == first.order
    which = (
        f"none of {count} cases is known to be nearest to falling"
        if alike
        else f"governed by {first.case.name}, of {count} cases"
    )
    lines = [f"{first.answer.verdict.value.upper()}  ({which}, {lasting(answer.wall_s)})"]
    for row in rows:
        cells = [f"{cell:>{most}}" for cell, most in zip(row[:3], wide, strict=False)]
        lines.append(f"  {'  '.join(cells)}  {row[3]:<{wide[3]}}  {row[4]}")
    told = (
        (
            0,
            "  used    least share of width and friction that suffices, or of strength if more",
        ),
        (2, "  thrust  least to greatest, in kN/m, or kN where blocks differ in depth"),
    )
    return lines + [words for at, words in told if any(row[at] != "-" for row in rows[1:])]


def cases_record(answer: Cases) -> CasesRecord:
    """Return cases as `check --cases --json` prints them, the governing one first."""
    return {
        "version": __version__,
        "title": answer.title,
        "governing": answer.governing.case.name,
        "verdict": answer.governing.answer.verdict.value,
        "cases": [_record(each) for each in answer.answers],
        "wall_s": answer.wall_s,
    }


def _record(told: CaseAnswer) -> CaseRecord:
    return {
        "name": told.case.name,
        "factors": asdict(told.case.factors),
        "used": told.used,
        "reserve": told.reserve,
        "answer": check_record(told.answer),
    }
