"""Cases of one structure: what acts in each, with partial factors, and the one that governs."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Unpack

from blocksim.ask.check import Check, check
from blocksim.ask.options import Options
from blocksim.blocks.problem import Problem
from blocksim.common.checks import Range, require
from blocksim.common.progress import silent
from blocksim.common.shown import Shown
from blocksim.simulation.verdict import Verdict

PARTIAL = Range(low=0, high=100)
"""Of partial factors."""
SERIOUS = (Verdict.COLLAPSES, Verdict.UNDECIDED, Verdict.STANDS)


@dataclass(frozen=True, kw_only=True)
class Factors:
    """Partial factors, each 1 where nothing is said; no code of practice is claimed.

    Parameters
    ----------
    permanent : float
        On the weights of blocks and fill, and on dead loads.
    variable : float
        On live loads.
    friction : float
        Friction coefficients are divided by it.
    strength : float
        The compressive strength of blocks is divided by it.

    Raises
    ------
    InputError
        If one is out of range.
    """

    permanent: float = 1.0
    variable: float = 1.0
    friction: float = 1.0
    strength: float = 1.0

    def __post_init__(self) -> None:
        """Check the ranges: what is divided by must not be 0."""
        for name, value in asdict(self).items():
            known = PARTIAL if name == "variable" else replace(PARTIAL, above=True)
            known.require(f"factors.{name}", value)

    @property
    def words(self) -> str:
        """Those that are not 1."""
        said = [f"{name} {value:g}" for name, value in asdict(self).items() if value != 1]
        return ", ".join(said) or "all factors 1"

    def on(self, problem: Problem[Any]) -> Problem[Any]:
        """Return a problem under factored loads, with factored friction and strength.

        Raises
        ------
        InputError
            If a factor is on what the problem has not.
        """
        shakes = problem.shaking is not None
        left = "left out: the ground shakes"
        require(not shakes or self.permanent == 1, "factors.permanent", self.permanent, left)
        strength, rigid = problem.strength, self.strength == 1
        allowed = "left out, or a strength beside it: blocks are rigid"
        require(rigid or strength is not None, "factors.strength", self.strength, allowed)
        note = f"partial factors: {self.words}; loads, friction, strength and forces are told "
        note += "with them, weights without"
        assembly = problem.assembly
        if self.friction != 1 and any(each.friction is not None for each in assembly.joints):
            own = tuple(
                replace(each, friction=each.friction and each.friction / self.friction)
                for each in assembly.joints
            )
            assembly = replace(assembly, joints=own)
        return replace(
            problem,
            assembly=assembly,
            gravity=self.permanent * problem.gravity,
            dead=tuple(
                replace(load, force=self.permanent * load.force) for load in problem.dead
            ),
            load=self.variable * problem.load,
            mu=problem.mu / self.friction,
            strength=None if strength is None else strength / self.strength,
            notes=problem.notes if self == Factors() else (*problem.notes, note),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """What acts on a structure in one case.

    Parameters
    ----------
    name : str
    problem : Problem
        With all that acts, before partial factors.
    factors : Factors
    """

    name: str
    problem: Problem[Any]
    factors: Factors = Factors()


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseAnswer:
    """A case and its answer, which is of the problem with factors on it."""

    case: Case
    answer: Check[Any]

    @property
    def used(self) -> float | None:
        """Share of what it could bear that it needs: 1 where it is about to fall.

        The share of width and of friction, the same in every joint, that the safest state of
        equilibrium needs; or the strength needed over that of the blocks where that is more.
        inf where nothing suffices, None where it is not known.
        """
        carried, problem = self.answer.carried, self.answer.problem
        if carried is None:
            return None
        used = math.inf if carried.strength_used is None else carried.strength_used
        needed = self.answer.needed
        if problem.strength is None or needed is None:
            return used
        return max(used, needed.high / problem.strength)

    @property
    def reserve(self) -> float | None:
        """The load factor over that at which it was asked; None without live loads."""
        most, asked = self.answer.load_factor, self.answer.problem.load
        return most / asked if most is not None and asked else None

    @property
    def order(self) -> tuple[int, float, float]:
        """What cases are sorted by, the governing one first."""
        reserve = math.inf if self.reserve is None else self.reserve
        return SERIOUS.index(self.answer.verdict), -(self.used or 0.0), reserve


@dataclass(frozen=True, kw_only=True, eq=False)
class Cases(Shown):
    """Cases of a structure, compared.

    Parameters
    ----------
    title : str
    answers : tuple of CaseAnswer
        The governing one first: what falls, what is undecided, then what uses most.
    wall_s : float
    """

    title: str
    answers: tuple[CaseAnswer, ...]
    wall_s: float

    @property
    def governing(self) -> CaseAnswer:
        """The case that falls first."""
        return self.answers[0]

    def __repr__(self) -> str:
        first = self.governing
        return (
            f"Cases({len(self.answers)}, {first.case.name!r} governs: {first.answer.verdict})"
        )


def check_cases(cases: Sequence[Case], title: str = "", **options: Unpack[Options]) -> Cases:
    """Ask of each case whether the structure stands, and compare them.

    Parameters
    ----------
    cases : sequence of Case
        One or more, each with a name of its own.
    title : str
    **options
        As of `check`.

    Raises
    ------
    InputError
        If there is none, or a factor is on what a problem has not.

    Examples
    --------
    >>> import blocksim
    >>> arch = blocksim.CircularArch(half_angle_deg=60, eta=0.2, friction=0.7).problem()
    >>> slippery = Factors(friction=2.0)
    >>> found = check_cases(
    ...     [Case(name="rough", problem=arch), Case(name="wet", problem=arch, factors=slippery)]
    ... )
    >>> found.governing.case.name
    'wet'
    """
    started = time.perf_counter()
    require(bool(cases), "cases", len(cases), "at least one")
    report = options.pop("progress", silent)
    answers: list[CaseAnswer] = []
    for at, case in enumerate(cases):
        report(at / len(cases), f"case {case.name}")
        answer = check(case.factors.on(case.problem), **options)
        answers.append(CaseAnswer(case=case, answer=answer))
    answers.sort(key=lambda each: each.order)
    return Cases(title=title, answers=tuple(answers), wall_s=time.perf_counter() - started)
