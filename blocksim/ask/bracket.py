"""From which value on does it fall? An interval of one parameter, both ends tried."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, Unpack, cast

from blocksim.ask.ends import Change, Stands, Within
from blocksim.ask.families import Family, Over, families_of, family_of
from blocksim.ask.found import Found, by_family, by_threshold
from blocksim.ask.methods import chosen_words
from blocksim.ask.options import Asked, Options, Taken, problem_of, taken
from blocksim.ask.searches import proofs_beside
from blocksim.ask.statics import flat_evidence
from blocksim.blocks.assembly import Blocks
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.shown import Shown
from blocksim.kinds.offers import offers_of
from blocksim.simulation.simulated import given_words
from blocksim.simulation.verdict import Evidence, aside, reason_of

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchBracket
    from blocksim.ask.answer import Event
    from blocksim.limit.proof import Proof

USUAL = "thickness"
"""What is bracketed over where nothing is said."""


@dataclass(frozen=True, kw_only=True)
class Bracket(Shown, Generic[Blocks]):
    """Where a family of problems changes from standing to falling, between two values tried.

    Parameters
    ----------
    method, over, unit : str
    low, high : float or None
        The two values tried, low below high; None where the search came to the end of the
        range without an answer of that kind.
    stands : {"low", "high"}
        At which end it stands.
    limit : float or None
        The exact value, where limit analysis knows it; inf where it stands at all values, and 0
        where it stands down to none.
    confirmed : bool or None
        As of `Search`.
    runs, undecided : int
        Values tried, and those without an answer.
    evidence : tuple of Evidence
        What was seen, by which test.
    problem : Problem
        One of the family: what was asked about.
    tol : float
        Relative width asked for.
    blocks, splits : int or None
        The most blocks simulated, and the number of joints that a reduction had merged and had
        to split again. None for static methods.
    wall_s : float
    events : tuple of Event or None
        Over the motion of supports, what happens on the way, by limit analysis.
    intervals : tuple of Stands or None
        All intervals of the range in which it stands, in order, each end tried; None where
        limit analysis does not know them.
    arch : ArchBracket or None
        Over the thickness of a symmetric circular arch under its own weight: ratios and modes.
    changes : tuple of Change
        By limit analysis, what `proofs` prove.
    """

    method: str
    over: str
    unit: str
    low: float | None
    high: float | None
    stands: str
    limit: float | None
    confirmed: bool | None
    runs: int
    undecided: int
    evidence: tuple[Evidence, ...]
    problem: Problem[Blocks]
    tol: float
    blocks: int | None = None
    splits: int | None = None
    wall_s: float
    events: tuple[Event, ...] | None = None
    intervals: tuple[Stands, ...] | None = None
    arch: ArchBracket | None = None
    changes: tuple[Change, ...] = ()

    @property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        """Of each change, that it falls to one side and stands to the other, by limit analysis.

        Nearer than 1e-6 of its value; empty where one of them is not proved.
        """
        found = [proofs_beside(change) for change in self.changes]
        return tuple(proof for each in found for proof in each) if all(found) else ()

    @property
    def proved(self) -> bool:
        """Whether all changes are proved from both sides (`blocksim.verify`)."""
        return bool(self.proofs)

    def __repr__(self) -> str:
        low, high = (
            "none" if each is None else f"{each:.9g}" for each in (self.low, self.high)
        )
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"Bracket({self.over} {low} to {high}{unit}, stands at {self.stands}, "
            f"by {self.method})"
        )


def bracket(
    asked: Asked[Blocks] | Family[Blocks],
    *,
    over: Over | str | None = None,
    within: Within | None = None,
    **options: Unpack[Options],
) -> Bracket[Blocks]:
    """Find the value of a parameter at which blocks change from standing to falling.

    Engines search with the onset test and let the blocks go at both ends. Where limit analysis
    knows the value, the search begins there, and takes nothing else from it.

    Parameters
    ----------
    asked : Problem, a maker of one, or Family
    over : str, optional
        One of `blocksim.ask.families.families_of`; by default the thickness, where there is
        one.
    within : tuple of float, optional
        Where an engine searches; by default where limit analysis says, within the family's
        range. Other methods search nowhere and take none.
    **options
        `method`, `settings`, `reduce`, `progress`, `tol`, `confirm`
        (`blocksim.ask.options.Options`).

    Returns
    -------
    Bracket

    Raises
    ------
    InputError
        If a value is out of range, or the method cannot do what is asked for.
    MissingPart
        If the engine's library is not installed.

    Examples
    --------
    >>> from blocksim.kinds.circular import CircularArch
    >>> found = bracket(CircularArch(half_angle_deg=90, friction=0.7), method="theory")
    >>> round(found.arch.eta_high, 4)
    0.1075
    """
    started = time.perf_counter()
    given = taken(options)
    if isinstance(asked, Family):
        require(over is None, "over", over, "left out: the family says it")
        return _answer(by_family(asked, within, given), given, started)
    problem = cast("Problem[Any]", problem_of(asked))
    if over is None:
        known = families_of(problem)
        over = USUAL if USUAL in known else None
        if over is None:
            raise InputError("over", MISSING, f"one of {', '.join(known)}")
    if within is None and not problem.in_space:
        offered = offers_of(problem)
        threshold = None if offered is None else offered.threshold(over)
        if threshold is not None:
            return _answer(by_threshold(problem, over, threshold, given), given, started)
    return _answer(by_family(family_of(problem, over), within, given), given, started)


def _answer(found: Found, given: Taken, started: float) -> Bracket[Any]:
    """Return what a search came to, and add which settings were given and what `auto` took."""
    search, chosen = found.search, found.chosen
    settings = aside("settings", given_words(given.settings))
    method = aside("method", chosen_words(given.method, chosen))
    problem = found.told["problem"]
    flat = flat_evidence(problem)
    notes = tuple(Evidence("note", each) for each in problem.notes)
    return Bracket(
        method=chosen.name,
        tol=given.tol,
        confirmed=search.confirmed,
        runs=search.runs,
        undecided=search.undecided,
        evidence=found.evidence + flat + settings + method + notes,
        blocks=search.blocks,
        splits=search.splits,
        wall_s=time.perf_counter() - started,
        **found.told,
    )
