"""Rows of `validate` in words: what was asked, what is known, and what methods said."""

from __future__ import annotations

from collections.abc import Sequence

from blocksim.common.words import percent
from blocksim.engines import engine_named
from blocksim.report.answerwords import ratio
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Row, parted
from blocksim.studies.thickness import ASIDE

QUANTITIES = {"load": "load factor", "mu": "friction", "pier_width": "pier width"}
"""Parameters in words, where their names are none."""
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
"""Questions in words, by the parameter asked over."""
EXACT = 1e-12
"""Relative differences below this are round-off, and said to be none."""
DOES = {
    Verdict.STANDS: "stands",
    Verdict.COLLAPSES: "falls",
    Verdict.UNDECIDED: "undecided",
}


def summary(found: Sequence[Row]) -> str:
    """Say in a sentence or two how many answers agree with what is known."""
    arches, others = parted(found)
    said = [_of_arches(arches)] if arches else []
    if others:
        names = {row.structure for row in others}
        many = f"{_share(others)} answers on {len(names)} other structures"
        said.append(f"{many} agree with their sources.")
    return " ".join(said)


def _share(rows: Sequence[Row]) -> str:
    agree = sum(not row.miss for row in rows)
    return f"All {len(rows)}" if agree == len(rows) else f"{agree} of {len(rows)}"


def _of_arches(rows: Sequence[Row]) -> str:
    """Say how simulation and limit analysis agree."""
    parts = [f"{_share(rows)} simulated arches agree with the exact answer in every respect"]
    errors = [abs(row.error) for row in rows if row.error is not None]
    if errors:
        worst = percent(max(errors), ".3f")
        parts.append(f"the least thickness found is off by {worst} at most")
    ends = [(row.at_low, row.at_high) for row in rows]
    false = sum(low is Verdict.STANDS or high is Verdict.COLLAPSES for low, high in ends)
    undecided = sum(Verdict.UNDECIDED in each for each in ends)
    asked = sum(said is not None for each in ends for said in each)
    parts.append(
        f"of {asked} verdicts {percent(ASIDE)} to either side of it "
        f"{false or 'none'} {'is' if false <= 1 else 'are'} false and "
        f"{undecided or 'none'} {'is' if undecided <= 1 else 'are'} undecided"
    )
    return "; ".join(parts) + "."


def question_of(row: Row) -> str:
    """Say what is asked, with its unit."""
    words = QUESTIONS.get(row.question, row.question.replace("_", " "))
    return f"{words} [{row.unit}]" if row.unit else words


def known_of(row: Row) -> str:
    """Say what is known of the answer."""
    if row.modes_published:
        return ratio(row.expected)
    if row.expected_verdict is not None:
        return row.expected_verdict.value
    return "stands at any" if row.expected == 0 else f"{row.expected or 0:.8g}"


def found_of(row: Row) -> str:
    """Say what a method answered."""
    if row.modes_published:
        return _bracket(row)
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


def _bracket(row: Row) -> str:
    """Say between which thicknesses an arch changes from falling to standing."""
    if row.high is None:
        return "none up to 2"
    return f"below {ratio(row.high)}" if row.low is None else f"{row.low:.6g} to {row.high:.6g}"


def error_of(row: Row) -> str:
    """Say how far an answer is from what is known, or how near it was asked."""
    if row.error is not None and row.modes_published:
        return percent(row.error, "+.3f")
    if row.error is not None:
        return "none" if abs(row.error) < EXACT else f"{row.error:+.1e}"
    if row.low is not None and row.high is not None:
        return f"±{percent(engine_named(row.method).aside)}"
    return "-"
