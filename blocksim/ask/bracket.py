"""From which value on does it fall? An interval of one parameter, both ends tried."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

from blocksim.ask.ends import Ask, Stands, Within, around, tried_ends
from blocksim.ask.families import Family, families_of, family_of
from blocksim.ask.methods import choose, chosen_words, engine_of, merges, reduces
from blocksim.ask.options import Asked, Options, Taken, problem_of, taken
from blocksim.ask.search import Answer, Bisection
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import Shown
from blocksim.evidence.simulation import Overrides, given_words
from blocksim.evidence.verdict import Evidence, Verdict, aside, reason_of
from blocksim.kinds.offers import Threshold, offers_of
from blocksim.limit import equilibrium

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchBracket
    from blocksim.ask.spread import Happening, Spreading
    from blocksim.engines.base import Engine, Method
    from blocksim.evidence.observation import Held, Observation
    from blocksim.evidence.simulation import Reduced

USUAL = "thickness"
"""What is bracketed over where nothing is said."""
SURE = (1e-8, 1e-7, 1e-6)
"""How far to both sides of its value limit analysis is asked again, the first that tells,
relative."""
LEAST = 1e-12
"""Least upper end of where to search."""
FARTHEST = 1e3
"""How far from its first value a search goes, as a ratio."""
FINEST_SPREAD = 1e-4
"""Narrowest bracket over the motion of supports by `direct`, relative."""
ALIKE = 0.005
"""How far beyond the ends that `direct` finds limit analysis still agrees with it, relative."""
GUESS = 0.1
"""Share of the range at which a search begins where limit analysis gives no value."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Search:
    """What a search for the change from standing to falling came to.

    Parameters
    ----------
    falls, stands : float or None
        The nearest values that collapsed and that stood; None where there were none.
    confirmed : bool or None
        Whether moving runs, or a second linear programme, agree at the ends found; None
        where none were made.
    runs, undecided : int
        Values tried, and those without an answer.
    reason : str
        What the answer rests on.
    blocks, splits : int or None
        Most blocks simulated at any value, and how many joints in all a reduction merged
        and had to split again; None for static methods.
    collapse : Observation or None
        By an engine, what was seen at the value that collapsed.
    """

    falls: float | None = None
    stands: float | None = None
    confirmed: bool | None = None
    runs: int = 0
    undecided: int = 0
    reason: str = ""
    blocks: int | None = None
    splits: int | None = None
    collapse: Observation | None = None


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

    @property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

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
    asked: Asked | Family,
    *,
    over: str | None = None,
    within: tuple[float, float] | None = None,
    **options: Unpack[Options],
) -> Bracket:
    """Find the value of a parameter at which blocks change from standing to falling.

    Engines search with the onset test and let the blocks go at both ends. Where limit analysis
    knows the value, the search begins there, and takes nothing else from it.

    Parameters
    ----------
    asked : Problem, Maker or Family
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
        reduced = reduces(chosen, given.reduce, is_planar=problem.is_planar)
        found = by_engine(
            _Reduced(threshold, engine_of(chosen), given.settings, reduce=reduced).held_at,
            threshold.start,
            (threshold.low, threshold.high),
            given.tol,
            name=threshold.name,
            more_is_safer=True,
            confirm=given.confirm,
            progress=given.progress,
        )
        evidence = (Evidence("search", found.reason),)
        if reduced and found.blocks is not None and found.splits is not None:
            from blocksim.evidence.observation import reduced_words

            by, most = threshold.reduced_by, threshold.blocks
            words = reduced_words(by, found.blocks, most, found.splits)
            evidence += (Evidence("reduction", words),)
        facts = threshold.facts(
            low=found.falls, high=found.stands, method=chosen.name, seen=found.collapse
        )
    return Bracket(
        method=chosen.name,
        over=over,
        unit=threshold.unit,
        low=threshold.value(found.falls),
        high=threshold.value(found.stands),
        stands="high",
        limit=threshold.value(threshold.exact),
        confirmed=found.confirmed,
        runs=found.runs,
        undecided=found.undecided,
        evidence=evidence + _asides(given, chosen),
        problem=problem,
        tol=given.tol,
        blocks=found.blocks,
        splits=found.splits,
        wall_s=time.perf_counter() - started,
        arch=facts,
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
        from blocksim.evidence.observation import hold

        reduction = self._threshold.reduction(value, self._last) if self._reduce else None
        problem = self._threshold.problem(value)
        held = hold(problem, self._engine, settings=self._settings, reduction=reduction)
        # An engine may have split it, or given it up.
        self._last = held.simulation.reduction
        return held


def _asides(given: Taken, chosen: Method) -> tuple[Evidence, ...]:
    """Say which settings were given, and what `auto` took."""
    settings = aside("settings", given_words(given.settings))
    return settings + aside("method", chosen_words(given.method, chosen))


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
    rises = family.stands == "high"

    def by_limit(start: float, within: Within, rises: bool) -> Search:  # noqa: ARG001
        return _by_limit(family, start, rises=rises)

    ask: Ask = by_limit
    reduced = False
    if family.spreading is not None:
        if chosen.is_static:
            found = _followed(family, family.spreading, exact)
        else:
            found = _slowly(family.spreading, given.tol, high, exact, given.progress)
    elif chosen.is_static:
        found = _by_limit(family, exact, rises=rises)
    elif probe.shaking is not None:
        start = min(max(family.start or low + GUESS * (high - low), low), high)
        found = _shaken(family, engine_of(chosen), start, (low, high), given)
    else:
        known = exact and math.isfinite(exact) and low <= exact <= high
        start = exact if exact and known else low + GUESS * (high - low)
        reduced = merges(chosen, given.reduce, probe)
        ask = _asking(family, engine_of(chosen), given, (low, high), merged=reduced)
        found = ask(start, around(family, start) if known else (low, high), rises)
    evidence = (Evidence("search", found.reason), *aside("limit analysis", remark))
    most = len(probe.assembly.blocks)
    if reduced and found.blocks is not None and found.blocks < most:
        from blocksim.evidence.merging import Merging
        from blocksim.evidence.observation import reduced_words

        words = reduced_words(Merging.by, found.blocks, most, found.splits or 0)
        evidence += (Evidence("reduction", words),)
    ends = (found.falls, found.stands)
    lower, upper = ends if rises else ends[::-1]
    return Bracket(
        method=chosen.name,
        over=family.name,
        unit=family.unit,
        low=lower,
        high=upper,
        stands=family.stands,
        limit=exact,
        confirmed=found.confirmed,
        runs=found.runs,
        undecided=found.undecided,
        evidence=evidence + _asides(given, chosen),
        problem=probe,
        tol=given.tol,
        blocks=found.blocks,
        splits=found.splits,
        wall_s=time.perf_counter() - started,
        events=None if family.spreading is None else family.spreading.events,
        intervals=tried_ends(family, found, ask) if static else None,
    )


def _asking(
    family: Family, engine: Engine, given: Taken, within: Within, *, merged: bool
) -> Ask:
    """Return what asks an engine around a value of limit analysis."""
    # What moves blocks is loaded where it is asked for.
    from blocksim.evidence.merging import Merging
    from blocksim.evidence.observation import hold

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


def _followed(family: Family, spreading: Spreading, exact: float | None) -> Search:
    """Follow the blocks until they fall, or as far as they can be followed."""
    if exact is not None and math.isfinite(exact) and exact > 0:
        return _by_limit(family, exact, rises=False)
    if spreading.path.ends == "collapse":
        return Search(falls=0.0, runs=1, reason="no forces of equilibrium exist as built")
    return Search(
        stands=spreading.path.value,
        runs=1,
        reason=f"followed on the displaced blocks up to {spreading.path.value:.6g} m",
    )


def _slowly(
    spreading: Spreading, tol: float, highest: float, exact: float | None, progress: Progress
) -> Search:
    """Move the supports slowly in `direct`, and stop them."""
    seen = spreading.slowly(max(tol, FINEST_SPREAD), highest, progress)
    way = "" if seen.solved else "; a step was not solved"
    low, high = seen.low or 0.0, math.inf if seen.high is None else seen.high
    agree = exact is None or (1 - ALIKE) * low <= exact <= (1 + ALIKE) * high
    if not agree:
        way += f"; limit analysis says {exact:.6g}: which of both is right is open"
    return Search(
        falls=seen.high,
        stands=seen.low,
        confirmed=seen.solved and agree,
        runs=seen.runs,
        reason=f"supports moved slowly and stopped {seen.runs} times: up to one value blocks "
        "stay, from the other on they move by themselves (whether something catches them "
        f"again was not asked){way}",
    )


def _shaken(
    family: Family,
    engine: Engine,
    start: float,
    within: Within,
    given: Taken,
) -> Search:
    """Search for the change by shaking the blocks, each time until they lie still."""
    from blocksim.evidence.shaken import shake

    least, most = max(within[0], start / FARTHEST), min(within[1], start * FARTHEST)

    def judge(value: float) -> Answer:
        # Nothing leads from how it falls to where it stands: the bracket is halved.
        return Answer(shake(family.at(value), engine, settings=given.settings).verdict, 0.0)

    search, falls, stands = _sought(
        judge,
        start,
        (least, most),
        given.tol,
        name=family.name,
        more_is_safer=family.stands == "high",
        progress=given.progress,
    )
    return Search(
        falls=falls,
        stands=stands,
        runs=search.runs,
        undecided=search.undecided,
        reason=f"shaken at {search.runs} values, each time until all lay still; this is one "
        "change from standing to falling, and beyond it blocks may stand again",
    )


def _by_limit(family: Family, exact: float | None, *, rises: bool) -> Search:
    """Ask a linear programme a little to both sides of its own value."""
    if exact is None:
        return Search(reason="no forces of equilibrium exist at any value")
    if math.isinf(exact):
        return Search(reason="forces of equilibrium exist at all values")
    if exact < family.low:
        least = family.low
        reason = f"forces of equilibrium exist down to {least:.6g}"
        return Search(stands=least, runs=1, reason=reason)
    falls = stands = exact
    confirmed, runs = False, 0
    for sure in SURE:
        ends = exact * (1 - sure), exact * (1 + sure)
        falls, stands = ends if rises else ends[::-1]
        runs += 2
        confirmed = (
            equilibrium(family.at(stands)).exists and not equilibrium(family.at(falls)).exists
        )
        if confirmed:
            break
    words = "confirmed" if confirmed else "not confirmed"
    return Search(
        falls=falls,
        stands=stands,
        confirmed=confirmed,
        runs=runs,
        reason=f"limit analysis: a linear programme, {words} by two others at the ends",
    )


def by_engine(
    held_at: Callable[[float], Held],
    start: float,
    within: tuple[float, float],
    tol: float,
    *,
    name: str,
    more_is_safer: bool,
    confirm: bool = True,
    progress: Progress = silent,
) -> Search:
    """Search with the onset test, then, if asked for, let the blocks go at both ends.

    Parameters
    ----------
    held_at : callable
        Value to blocks after the onset test.
    start : float
        Where to begin.
    within : tuple of float
        Values beyond which the search is given up.
    tol : float
        Relative width at which to end.
    name : str
        What the value is.
    more_is_safer : bool
        Whether it stands above the change.
    confirm : bool
        Let the blocks go at both ends.
    progress : Progress, optional
    """
    from blocksim.evidence.observation import conclude

    ends: dict[Verdict, tuple[float, Held]] = {}
    blocks = splits = both = 0

    def judge(value: float) -> Answer:
        nonlocal blocks, splits, both
        held = held_at(value)
        blocks, splits = max(blocks, held.simulation.blocks), splits + held.splits
        both += held.onset.may_rest
        # Every answer narrows the bracket: the last of each kind is that of its end.
        ends[held.onset.verdict] = value, held
        return Answer(held.onset.verdict, held.onset.acceleration)

    search, falls, stands = _sought(
        judge,
        start,
        within,
        tol,
        name=name,
        more_is_safer=more_is_safer,
        progress=progress,
    )
    agreed: list[bool] = []
    collapse = None
    for expected in (Verdict.COLLAPSES, Verdict.STANDS):
        # The end that falls tells how it falls, too.
        if expected in ends and (confirm or expected is Verdict.COLLAPSES):
            value, held = ends[expected]
            if confirm:
                progress(0.95, f"moving run at {name} {value:.6g}")
            ended = conclude(held, moving=confirm)
            agreed.append(ended.verdict is expected)
            if ended.verdict is Verdict.COLLAPSES:
                collapse = ended
    confirmed = all(agreed) if confirm and agreed else None
    words = {True: "confirmed", False: "not confirmed", None: "not tried"}[confirmed]
    reason = f"onset test at {search.runs} values, ends {words} by moving runs"
    if both:
        reason += f"; friction allows both rest and motion at {both} of them"
    return Search(
        falls=falls,
        stands=stands,
        confirmed=confirmed,
        runs=search.runs,
        undecided=search.undecided,
        reason=reason,
        blocks=blocks,
        splits=splits,
        collapse=collapse,
    )


def _sought(
    judge: Callable[[float], Answer],
    start: float,
    within: tuple[float, float],
    tol: float,
    *,
    name: str,
    more_is_safer: bool,
    progress: Progress,
) -> tuple[Bisection, float | None, float | None]:
    """Search, and return the nearest values that fell and that stood.

    A bisection knows values only of which more is safer: of others it is given the inverse.
    """
    low, high = within

    def turned(value: float) -> float:
        # The inverse of an inverse is rounded, and no value beyond the range is asked.
        return value if more_is_safer else min(max(1 / value, low), high)

    floor, ceiling = (low, high) if more_is_safer else (1 / high, 1 / low)
    search = Bisection(
        lambda strength: judge(turned(strength)),
        progress,
        floor=floor,
        ceiling=ceiling,
        name=name,
    )
    search.expand(start if more_is_safer else 1 / start)
    search.bisect(tol)
    falls, stands = (None if end is None else turned(end) for end in (search.low, search.high))
    return search, falls, stands
