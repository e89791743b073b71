"""Answers on structures of `validate`: as the page shows them, and in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from blocksim.engines import engine_named
from blocksim.report.motion import mechanism_drawing
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Row

QUANTITIES = {"load": "load factor", "mu": "friction", "pier_width": "pier width"}
"""Parameters in words, where their names are none."""


def shown_structures(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Gather rows by structure and question."""
    names = dict.fromkeys(row.structure for row in rows)
    return [
        _shown(number, [row for row in rows if row.structure == name])
        for number, name in enumerate(names, start=1)
    ]


def _shown(number: int, rows: list[Row]) -> dict[str, Any]:
    """Return a structure with all that was asked about it, and how it falls."""
    questions = dict.fromkeys(row.question for row in rows)
    falls = [row for row in rows if row.drawn is not None and row.drawn.rates is not None]
    seen = [row for row in falls if row.method != "limit"]
    # As an engine showed it fall; else as limit analysis says; else as it stands.
    still = [row for row in rows[::-1] if row.drawn is not None]
    best = (seen or falls or still or [None])[0]
    drawn = best.drawn if best else None
    # Blocks in space are not drawn here yet.
    drawing = None
    if drawn is not None and not drawn.problem.in_space:
        drawing = mechanism_drawing(drawn.problem, drawn.rates, drawn.states)
    caption, words = _told(best) if best else ("", "")
    asked = [_asked([row for row in rows if row.question == each]) for each in questions]
    return {
        "number": number,
        "anchor": f"structure-{number}",
        "row": rows[0],
        "asked": asked,
        "lines": len(rows),
        "drawing": drawing,
        "caption": caption,
        "words": words,
    }


def _asked(rows: list[Row]) -> dict[str, Any]:
    """Return a question about a structure, and every method's answer."""
    first = rows[0]
    known = "stands at any" if first.expected == 0 else f"{first.expected or 0:.8g}"
    if first.expected_verdict is not None:
        known = first.expected_verdict.value
    return {
        "question": question_of(first),
        "known": known,
        "published": first.published or "-",
        "hinges": ", ".join(map(str, first.expected_hinges)),
        "answers": rows,
    }


def _told(row: Row) -> tuple[str, str]:
    """Say what is drawn: a caption, and words for those who do not see it."""
    # The end of what was asked at which it falls, or stands if it does not.
    at = row.low if row.at_low is Verdict.COLLAPSES else row.high
    unit = f" {row.unit}" if row.unit else ""
    place = (
        "" if at is None else f" at {QUANTITIES.get(row.question, row.question)} {at:.6g}{unit}"
    )
    if row.drawn is None or row.drawn.rates is None:
        return f"at rest{place}, by {row.method}", "Nothing moves."
    if row.question == "spread":
        place = " on supports that have moved"
    joints = ", ".join(map(str, row.hinges))
    caption = f"how it starts to fall{place}, by {row.method}, enlarged"
    return caption, f"Joints that take part, numbered from 0: {joints}."


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


def summary_of_structures(rows: Sequence[Row]) -> str:
    """Say in a sentence how many answers agree with what is known."""
    count = len({row.structure for row in rows})
    agree = sum(not row.miss for row in rows)
    share = f"All {len(rows)}" if agree == len(rows) else f"{agree} of {len(rows)}"
    return f"{share} answers on {count} other structures agree with their sources."


def question_of(row: Row) -> str:
    """Say what is asked, with its unit."""
    words = QUESTIONS.get(row.question, row.question.replace("_", " "))
    return f"{words} [{row.unit}]" if row.unit else words


def found_of(row: Row) -> str:
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


def error_of(row: Row) -> str:
    """Say how far an answer is from what is known, or how near it was asked."""
    if row.error is not None:
        return "none" if abs(row.error) < EXACT else f"{row.error:+.1e}"
    if row.low is not None and row.high is not None:
        return f"±{engine_named(row.method).aside * 100:g}\N{NO-BREAK SPACE}%"
    return "-"
