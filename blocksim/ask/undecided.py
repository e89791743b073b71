"""What would decide a question that limit analysis leaves open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from blocksim.blocks.problem import Problem
from blocksim.blocks.rows import column
from blocksim.limit import equilibrium

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
