"""From which value on does it fall? An interval of one parameter, both ends tried."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Unpack, overload

from blocksim.ask.closed import closing_of_value
from blocksim.ask.ends import (
    Ask,
    Change,
    Stands,
    Within,
    around,
    changes_of,
    tried_ends,
)
from blocksim.ask.families import Family, families_of, family_of
from blocksim.ask.methods import choose, chosen_words, reduces
from blocksim.ask.options import Asked, Options, Taken, problem_of, taken
from blocksim.ask.searches import (
    FARTHEST,
    Search,
    by_engine,
    by_programmes,
    followed,
    proofs_beside,
    shaken,
    slowly,
)
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.shown import Shown
from blocksim.engines import get_engine
from blocksim.kinds.offers import Threshold, offers_of
from blocksim.simulation.simulated import Overrides, given_words
from blocksim.simulation.verdict import Evidence, aside, reason_of

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchBracket
    from blocksim.ask.space import SpatialBracket
    from blocksim.ask.spread import Happening
    from blocksim.engines.base import Engine, Method
    from blocksim.limit.proof import Proof
    from blocksim.simulation.observation import Held
    from blocksim.simulation.simulated import Reduced

USUAL = "thickness"
"""What is bracketed over where nothing is said."""
LEAST = 1e-12
"""Least upper end of where to search."""
GUESS = 0.1
"""Share of the range at which a search begins where limit analysis gives no value."""


@dataclass(frozen=True, kw_only=True)
class Bracket(Shown):
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
    events : tuple of Happening or None
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
    problem: Problem
    tol: float
    blocks: int | None = None
    splits: int | None = None
    wall_s: float
    events: tuple[Happening, ...] | None = None
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
        found = [proofs_beside(at, value, rises=rises) for at, value, rises in self.changes]
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


@overload
def bracket(
    asked: SpatialProblem,
    *,
    over: str | None = None,
    within: Within | None = None,
    **options: Unpack[Options],
) -> SpatialBracket: ...
@overload
def bracket(
    asked: Asked | Family,
    *,
    over: str | None = None,
    within: Within | None = None,
    **options: Unpack[Options],
) -> Bracket: ...
def bracket(
    asked: Asked | Family | SpatialProblem,
    *,
    over: str | None = None,
    within: Within | None = None,
    **options: Unpack[Options],
) -> Bracket | SpatialBracket:
    """Find the value of a parameter at which blocks change from standing to falling.

    Engines search with the onset test and let the blocks go at both ends. Where limit analysis
    knows the value, the search begins there, and takes nothing else from it.

    Parameters
    ----------
    asked : Problem, Maker, Family or SpatialProblem
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
    Bracket or SpatialBracket

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
    if isinstance(asked, SpatialProblem):
        # What is asked in space is loaded where it is asked for.
        from blocksim.ask.space import bracket_in_space

        return bracket_in_space(asked, over, within, given)
    if isinstance(asked, Family):
        require(over is None, "over", over, "left out: the family says it")
        return _of_family(asked, within, given, started)
    problem = problem_of(asked)
    if over is None:
        known = families_of(problem)
        over = USUAL if USUAL in known else None
        if over is None:
            raise InputError("over", MISSING, f"one of {', '.join(known)}")
    offered = offers_of(problem) if within is None else None
    threshold = None if offered is None else offered.threshold(over)
    if threshold is not None:
        return _thinned(problem, over, threshold, given, started)
    return _of_family(family_of(problem, over), within, given, started)


def _thinned(
    problem: Problem, over: str, threshold: Threshold, given: Taken, started: float
) -> Bracket:
    """Search over a ratio of which the maker knows more."""
    chosen = choose(
        given.method, given.tol, problem=problem, settings=given.settings, reduce=given.reduce
    )
    if chosen.is_static:
        falls, stands, said = threshold.static(chosen.name)
        test = "closed form" if chosen.name == "theory" else "limit analysis"
        found, evidence = Search(falls=falls, stands=stands), (Evidence(test, said),)
        facts = threshold.facts(low=falls, high=stands, method=chosen.name)
    else:
        reduced = reduces(chosen, given.reduce, problem, by_maker=True)
        found = by_engine(
            _Reduced(threshold, get_engine(chosen), given.settings, reduce=reduced).held_at,
            threshold.start,
            (threshold.low, threshold.high),
            given.tol,
            name=threshold.name,
            more_is_safer=True,
            confirm=given.confirm,
            progress=given.progress,
        )
        evidence = (Evidence("search", found.reason),)
        if reduced:
            evidence += _reduced(found, threshold.reduced_by, threshold.blocks)
        facts = threshold.facts(
            low=found.falls, high=found.stands, method=chosen.name, seen=found.collapse
        )
    return _answer(
        found,
        chosen,
        given,
        started,
        over=over,
        unit=threshold.unit,
        low=threshold.value(found.falls),
        high=threshold.value(found.stands),
        stands="high",
        limit=threshold.value(threshold.exact),
        evidence=evidence,
        problem=problem,
        arch=facts,
        changes=((threshold.problem, threshold.exact, True),)
        if chosen.name == "limit" and threshold.exact
        else (),
    )


class _Reduced:
    """One problem at one value after the other, reduced alike where that is asked for."""

    def __init__(
        self, threshold: Threshold, engine: Engine, settings: Overrides, *, reduce: bool
    ) -> None:
        self._threshold, self._engine, self._settings = threshold, engine, settings
        self._reduce = reduce
        self._last: Reduced | None = None

    def held_at(self, value: float) -> Held:
        """Ask the onset test at a value."""
        from blocksim.simulation.observation import hold

        reduction = self._threshold.reduction(value, self._last) if self._reduce else None
        problem = self._threshold.problem(value)
        held = hold(problem, self._engine, settings=self._settings, reduction=reduction)
        # An engine may have split it, or given it up.
        self._last = held.simulation.reduction
        return held


def _answer(
    found: Search,
    chosen: Method,
    given: Taken,
    started: float,
    *,
    evidence: tuple[Evidence, ...],
    **told: Any,
) -> Bracket:
    """Return what a search came to, and add which settings were given and what `auto` took."""
    settings = aside("settings", given_words(given.settings))
    return Bracket(
        method=chosen.name,
        tol=given.tol,
        confirmed=found.confirmed,
        runs=found.runs,
        undecided=found.undecided,
        evidence=evidence + settings + aside("method", chosen_words(given.method, chosen)),
        blocks=found.blocks,
        splits=found.splits,
        wall_s=time.perf_counter() - started,
        **told,
    )


def _reduced(found: Search, by: str, most: int) -> tuple[Evidence, ...]:
    """Tell what reductions came to; nothing where all blocks were simulated."""
    if found.blocks is None or found.splits is None:
        return ()
    from blocksim.simulation.observation import reduced_words

    return (Evidence("reduction", reduced_words(by, found.blocks, most, found.splits)),)


def _of_family(
    family: Family, within: tuple[float, float] | None, given: Taken, started: float
) -> Bracket:
    """Search over the values of a family."""
    low, high = within or (family.low, family.high)
    ranged = family.low <= low < high <= family.high and high >= LEAST
    allowed = f"two values, the lower first, from {family.low:g} to {family.high:g}"
    require(ranged, "within", f"{low:g} {high:g}", allowed)
    probe = family.at(low + GUESS * (high - low))
    chosen = choose(
        given.method, given.tol, problem=probe, settings=given.settings, reduce=given.reduce
    )
    allowed = f"left out by {chosen.name}, which searches no range; engines do"
    require(within is None or not chosen.is_static, "within", f"{low:g} {high:g}", allowed)
    if family.spreading is not None:
        allowed = "limit or direct: others move no supports"
        require(chosen.moves_supports, "method", chosen.name, allowed)
        require(not given.reduce, "reduce", given.reduce, "left out where supports move")
    # What limit analysis says is of ground at rest.
    static = probe.is_planar and probe.shaking is None
    exact = family.exact() if static else None
    remark = family.remark() if static else ""
    closing = closing_of_value(family) if static else ()
    rises = family.stands == "high"

    def by_limit(start: float, within: Within, rises: bool) -> Search:  # noqa: ARG001
        return by_programmes(family, start, rises=rises)

    ask: Ask = by_limit
    reduced = False
    if family.spreading is not None:
        if chosen.is_static:
            found = followed(family, family.spreading, exact)
        else:
            found = slowly(family.spreading, given.tol, high, exact, given.progress)
    elif chosen.is_static:
        found = by_programmes(family, exact, rises=rises)
    elif probe.shaking is not None:
        start = min(max(family.start or low + GUESS * (high - low), low), high)
        found = shaken(family, get_engine(chosen), start, (low, high), given)
    else:
        known = exact and math.isfinite(exact) and low <= exact <= high
        start = exact if exact and known else low + GUESS * (high - low)
        reduced = reduces(chosen, given.reduce, probe)
        ask = _asking(family, get_engine(chosen), given, (low, high), merged=reduced)
        found = ask(start, around(family, start) if known else (low, high), rises)
    evidence = (Evidence("search", found.reason), *aside("limit analysis", remark), *closing)
    most = len(probe.assembly.blocks)
    if reduced and found.blocks is not None and found.blocks < most:
        from blocksim.simulation.merging import Merging

        evidence += _reduced(found, Merging.by, most)
    ends = (found.falls, found.stands)
    lower, upper = ends if rises else ends[::-1]
    intervals = tried_ends(family, found, ask) if static else None
    return _answer(
        found,
        chosen,
        given,
        started,
        over=family.name,
        unit=family.unit,
        low=lower,
        high=upper,
        stands=family.stands,
        limit=exact,
        evidence=evidence,
        problem=probe,
        events=None if family.spreading is None else family.spreading.events,
        intervals=intervals,
        # Proofs are of rigid blocks.
        changes=changes_of(family, intervals or ())
        if chosen.name == "limit" and probe.strength is None
        else (),
    )


def _asking(
    family: Family, engine: Engine, given: Taken, within: Within, *, merged: bool
) -> Ask:
    """Return what asks an engine around a value of limit analysis."""
    # What moves blocks is loaded where it is asked for.
    from blocksim.simulation.merging import Merging
    from blocksim.simulation.observation import hold

    low, high = within

    def held_at(value: float) -> Held:
        problem = family.at(value)
        merging = Merging.of(problem) if merged else None
        return hold(problem, engine, settings=given.settings, reduction=merging)

    def ask(start: float, within: Within, rises: bool) -> Search:
        least, most = max(low, within[0], start / FARTHEST), min(high, within[1])
        if not least <= start <= most:
            return Search()
        return by_engine(
            held_at,
            start,
            (least, most),
            given.tol,
            name=family.name,
            more_is_safer=rises,
            confirm=given.confirm,
            progress=given.progress,
        )

    return ask
