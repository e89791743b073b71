"""What gaps of a drawing, closed at its joints, can do to an answer, by limit analysis."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from blocksim.blocks.closing import closed_gaps, resized
from blocksim.blocks.problem import Problem
from blocksim.limit.crushing import exists
from blocksim.simulation.verdict import Evidence, Verdict

if TYPE_CHECKING:
    from blocksim.ask.families import Family

WAYS = ((1, "grown"), (-1, "shrunk"))
SAME = 5e-7
"""Relative difference up to which six digits of values are the same."""


def closing_of_verdict(problem: Problem, *, stands: bool) -> tuple[Evidence, ...]:
    """Say whether blocks stand as well with them grown and shrunk; nothing without gaps.

    Parameters
    ----------
    problem : Problem
        In its plane.
    stands : bool
        Whether forces of equilibrium exist, as it is.
    """
    if not closed_gaps(problem.assembly):
        return ()
    for sign, words in WAYS:
        if exists(_resized(problem, sign)) != stands:
            other = Verdict.COLLAPSES if stands else Verdict.STANDS
            return _said(problem, f"the drawing leaves it open: {other} with blocks {words}")
    return _said(problem, "the verdict is the same with blocks grown and shrunk")


def closing_of_value(family: Family) -> tuple[Evidence, ...]:
    """Say between which values a change lies with blocks grown and shrunk.

    Nothing where limit analysis does not know the family, or without gaps.
    """
    problem, value = family.problem, family.exact()
    if value is None or not closed_gaps(problem.assembly):
        return ()
    others = [family.of(_resized(problem, sign)).exact() for sign, _ in WAYS]
    if all(each is not None and abs(each - value) <= SAME * abs(value) for each in others):
        return _said(
            problem, "the value is the same to six digits with blocks grown and shrunk"
        )
    told = (
        f"{'none' if each is None else f'{each:.6g}'} with blocks {words}"
        for each, (_, words) in zip(others, WAYS, strict=True)
    )
    return _said(problem, f"the drawing leaves {value:.6g} open: {', '.join(told)}")


def _resized(problem: Problem, sign: int) -> Problem:
    return replace(problem, assembly=resized(problem.assembly, sign))


def _said(problem: Problem, words: str) -> tuple[Evidence, ...]:
    most = 1000 * max(map(abs, closed_gaps(problem.assembly).values()))
    words = f"{words} by what was closed at joints, {most:.3g} mm at most"
    return (Evidence("gaps closed", words),)
