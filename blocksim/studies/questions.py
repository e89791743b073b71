"""Questions about a structure whose answer is known, answered by one method at a time.

Limit analysis gives the value; engines are asked a little to both sides of the one expected,
supports that spread are followed by `direct`, and arches whose modes are known are asked how
thin they can be.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from blocksim.ask.bracket import bracket
from blocksim.ask.check import Check, check
from blocksim.ask.families import Family, family_of
from blocksim.blocks.entries import ExpectEntry
from blocksim.blocks.joints import JointState
from blocksim.engines import engine_named
from blocksim.kinds.loading import Known
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Drawn, Row
from blocksim.studies.thickness import thinnest

SHAKEN = 0.01
"""How far inside and beyond the value expected any engine is asked where ground shakes."""
NEAR = 1e-6
"""A value of limit analysis farther than this from the one expected is a miss, relative."""
SLOWLY = 0.005
"""Relative width of the brackets over the motion of supports; a bracket whose centre is
farther from the value expected is a miss."""
BEYOND = 1e-6
"""How far beyond its value limit analysis shows how a structure falls, relative."""


def answer(known: Known, expected: ExpectEntry, method: str) -> Row:
    """Answer one question by one method, and compare."""
    started = time.perf_counter()
    problem = known.problem
    row = Row(
        structure=known.name,
        title=problem.title,
        source=problem.source,
        blocks=len(problem.assembly.blocks),
        mu=problem.mu,
        published=expected.published or "",
        expected_hinges=expected.hinges,
        method=method,
    )
    ask = next(ask for key, ask in QUESTIONS.items() if getattr(expected, key) is not None)
    row = ask(row, known, expected)
    return replace(row, wall_s=time.perf_counter() - started)


def _judged(row: Row, known: Known, expected: ExpectEntry) -> Row:
    """Ask whether it stands as it is."""
    wanted = Verdict(expected.verdict)
    # Engines as they are, as arches are asked.
    seen = check(known.problem, method=row.method, reduce=False)
    right = seen.verdict is wanted
    return replace(
        row,
        question="stands",
        expected_verdict=wanted,
        verdict=seen.verdict,
        hinges=_opening(seen),
        miss="" if right else f"{seen.verdict}, expected is {wanted}",
        note="" if right else seen.reason,
        drawn=_drawn(seen),
    )


def _valued(row: Row, known: Known, expected: ExpectEntry) -> Row:
    """Ask for the value of a parameter at which it changes from standing to falling."""
    family = family_of(known.problem, expected.over or "")
    value, still = expected.value or 0.0, known.problem.shaking is None
    row = replace(row, question=family.name, unit=family.unit, expected=value)
    if row.method == "limit":
        return _exactly(row, family, value)
    if family.spreading is not None:
        return _slowly(row, family, value)
    return _aside(row, family, value, engine_named(row.method).aside if still else SHAKEN)


QUESTIONS: dict[str, Callable[[Row, Known, ExpectEntry], Row]] = {
    "verdict": _judged,
    "over": _valued,
    "modes": thinnest,
}
"""Answers by the key of an expectation. Another question is one more of them."""


def _exactly(row: Row, family: Family, value: float) -> Row:
    """Take the value from limit analysis, and how it falls just beyond it."""
    found = family.exact()
    error = None if found is None else found / value - 1 if value else found
    sense = 1 if family.stands == "low" else -1
    beyond = value * (1 + sense * BEYOND) if value else family.low
    seen = check(family.at(beyond), method="limit")
    drawn, hinges = _drawn(seen), _opening(seen)
    if family.spreading is not None:
        # On blocks that have moved, the joints that are open already are those that matter.
        states = family.spreading.path.frames[-1].states
        drawn, hinges = replace(drawn, states=states), _open(states)
    digits = None
    misses: list[str] = []
    if error is None or not abs(error) <= NEAR:
        misses.append("no value" if error is None else f"value off by {error:+.1e}")
    if row.published and found is not None:
        places = len(row.published.partition(".")[2])
        digits = f"{found:.{places}f}" == row.published
        if not digits:
            misses.append(f"published is {row.published}")
    misses += _other_hinges(row, hinges)
    return replace(
        row,
        value=found,
        error=error,
        digits=digits,
        hinges=hinges,
        miss="; ".join(misses),
        drawn=drawn,
    )


def _aside(row: Row, family: Family, value: float, aside: float) -> Row:
    """Ask an engine a little to both sides of the value expected."""
    # Where it stands down to nothing there is one side only: the smallest that can be built.
    low, high = (value * (1 - aside), value * (1 + aside)) if value else (None, family.low)
    inside, beyond = (low, high) if family.stands == "low" else (high, low)
    seen = {
        at: check(family.at(at), method=row.method, reduce=False)
        for at in (inside, beyond)
        if at is not None
    }
    misses = [
        f"{seen[at].verdict} at {at:.9g}"
        for at, wanted in ((inside, Verdict.STANDS), (beyond, Verdict.COLLAPSES))
        if at is not None and seen[at].verdict is not wanted
    ]
    notes = [seen[at].reason for at in seen if f"{seen[at].verdict} at {at:.9g}" in misses]
    last = seen[beyond if beyond is not None else high]
    hinges = _opening(last)
    misses += _other_hinges(row, hinges)
    if inside is not None and seen[inside].rest == "can":
        notes.append("where it stands friction allows it to move as well")
    return replace(
        row,
        low=low,
        high=high,
        at_low=None if low is None else seen[low].verdict,
        at_high=seen[high].verdict,
        hinges=hinges,
        miss="; ".join(misses),
        note="; ".join(notes),
        drawn=_drawn(last),
    )


def _slowly(row: Row, family: Family, value: float) -> Row:
    """Move the supports slowly."""
    seen = bracket(family, method=row.method, tol=SLOWLY)
    low, high = seen.low, seen.high
    middle = None if low is None or high is None else (low + high) / 2
    error = None if middle is None else middle / value - 1
    right = error is not None and abs(error) <= SLOWLY and seen.confirmed
    off = "no bracket" if error is None else f"off by {error:+.2%}"
    return replace(
        row,
        value=middle,
        error=error,
        low=low,
        high=high,
        at_low=None if low is None else Verdict.STANDS,
        at_high=None if high is None else Verdict.COLLAPSES,
        miss="" if right else off,
        note="" if right else seen.reason,
    )


def _opening(seen: Check) -> tuple[int, ...]:
    """Return the numbers of the joints that take part as it falls."""
    if seen.verdict is not Verdict.COLLAPSES:
        return ()
    return _open([joint.state for joint in seen.joints])


def _open(states: Sequence[JointState]) -> tuple[int, ...]:
    return tuple(at for at, state in enumerate(states) if state is not JointState.CLOSED)


def _other_hinges(row: Row, hinges: tuple[int, ...]) -> list[str]:
    if not row.expected_hinges or hinges == row.expected_hinges:
        return []
    return [f"opens at joints {', '.join(map(str, hinges)) or 'none'}"]


def _drawn(seen: Check) -> Drawn:
    falls = seen.verdict is Verdict.COLLAPSES
    return Drawn(
        problem=seen.problem,
        rates=seen.mechanism if falls else None,
        states=tuple(joint.state for joint in seen.joints),
    )
