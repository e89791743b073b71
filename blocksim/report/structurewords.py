"""Answers on structures of `validate` in words, for the page and for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from blocksim.engines import engine_named
from blocksim.simulation.verdict import Verdict
from blocksim.studies.questions import StructureRow

QUESTIONS = {
    "stands": "does it stand?",
    "load": "load factor at collapse",
    "mu": "least friction",
    "thickness": "least thickness",
    "tilt": "tilt at collapse",
    "spread": "motion of supports at collapse",
    "overhang": "largest overhang",
    "pier_width": "least width of piers",
}
"""What is asked, by the parameter asked over."""
EXACT = 1e-12
"""Relative differences below this are round-off, and said to be none."""


def summary_of_structures(rows: Sequence[StructureRow]) -> str:
    """Say in a sentence how many answers agree with what is known."""
    count = len({row.structure for row in rows})
    agree = sum(not row.miss for row in rows)
    share = f"All {len(rows)}" if agree == len(rows) else f"{agree} of {len(rows)}"
    return f"{share} answers on {count} other structures agree with their sources."


def question_of(row: StructureRow) -> str:
    """Say what is asked, with its unit."""
    words = QUESTIONS.get(row.question, row.question.replace("_", " "))
    return f"{words} [{row.unit}]" if row.unit else words


def found_of(row: StructureRow) -> str:
    """Say what a method answered."""
    if row.verdict is not None:
        return row.verdict.value
    if row.value is not None and row.low is None:
        return "stands at any" if row.expected == 0 == row.value else f"{row.value:.8g}"
    ends = ((row.low, row.at_low), (row.high, row.at_high))
    return ", ".join(
        f"{DOES[said]} at {value:.6g}"
        for value, said in ends
        if value is not None and said is not None
    )


DOES = {
    Verdict.STANDS: "stands",
    Verdict.COLLAPSES: "falls",
    Verdict.UNDECIDED: "undecided",
}


def error_of(row: StructureRow) -> str:
    """Say how far an answer is from what is known, or how near it was asked."""
    if row.error is not None:
        return "none" if abs(row.error) < EXACT else f"{row.error:+.1e}"
    if row.low is not None and row.high is not None:
        return f"±{engine_named(row.method).aside * 100:g}\N{NO-BREAK SPACE}%"
    return "-"
