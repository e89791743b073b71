"""What would decide what limit analysis leaves open, and what closed gaps of a drawing do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.closing import closed_gaps, resized
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import bears_road
from blocksim.blocks.rows import column
from blocksim.limit import equilibrium
from blocksim.limit.statics import exists
from blocksim.simulation.verdict import Evidence, Verdict

if TYPE_CHECKING:
    from blocksim.ask.families import Family

CHANGES = (1e-12, 1e-9, 1e-6, 1e-4, 1e-2)
"""Shares of friction and live loads, and angles [rad], that are tried, the least first."""


def undecided_words(problem: Problem) -> str:
    """Say the least change of friction, tilt or live loads of which the verdict is proved."""
    for by in CHANGES:
        for words, changed in _changes(problem, by):
            proof = equilibrium(changed).proof
            if proof is not None:
                return (
                    f"neither that it stands nor that it falls is proved; with {words} "
                    f"it {proof.claim.replace('collapses', 'falls')}, proved"
                )
    return (
        "neither that it stands nor that it falls is proved, nor with friction, tilt or live "
        f"loads changed by up to {CHANGES[-1]:g}: the last digits of its corners decide"
    )


def _changes(problem: Problem, by: float) -> Iterator[tuple[str, Problem]]:
    """Return problems that differ a little, and in what."""
    for sign, more in ((1, "more"), (-1, "less")):
        if np.isfinite(problem.friction).any():
            yield f"{by:g} {more} of the friction", _rubbed(problem, 1 + sign * by)
        if not bears_road(problem):
            yield f"gravity turned by {sign * by:+g} rad", problem.tilted(sign * by)
        if problem.live:
            loaded = problem.with_load(problem.load * (1 + sign * by))
            yield f"{by:g} {more} of the live loads", loaded


def _rubbed(problem: Problem, share: float) -> Problem:
    """Return the same with a share of the friction of every joint."""
    own = column(problem.assembly.joints, "friction")
    joints = tuple(
        joint if mu is None else replace(joint, friction=share * mu)
        for joint, mu in zip(problem.assembly.joints, own, strict=True)
    )
    assembly = replace(problem.assembly, joints=joints)
    return replace(problem, assembly=assembly, mu=share * problem.mu)


WAYS = ((1, "grown"), (-1, "shrunk"))
SAME = 5e-7
"""Relative difference up to which six digits of values are the same."""


def closing_of_verdict(problem: Problem, *, stands: bool) -> tuple[Evidence, ...]:
    """Say whether blocks stand as well with them grown and shrunk; nothing without gaps.

    `stands`: Whether forces of equilibrium exist, as it is.
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
