"""Searches for the change from standing to falling: by statics, motion, the onset test."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from blocksim.ask.ends import Change, Within
from blocksim.ask.families import Family
from blocksim.ask.options import Taken
from blocksim.ask.search import Answer, Bisection
from blocksim.ask.statics import fewer
from blocksim.common.progress import Progress
from blocksim.limit import equilibrium
from blocksim.limit.statics import exists
from blocksim.simulation.verdict import Verdict

if TYPE_CHECKING:
    from blocksim.ask.spread import Spreading
    from blocksim.engines.base import Engine
    from blocksim.limit.proof import Proof
    from blocksim.simulation.observation import Held, Observation

SURE = (1e-8, 1e-7, 1e-6)
"""How far to both sides of its value limit analysis is asked again, the first that tells,
relative."""
ROUGH = (1e-5, 1e-4, 1e-3)
"""The same in space, where numbers are floating-point ones alone."""
FARTHEST = 1e3
"""How far from its first value a search goes, as a ratio."""
FINEST_SPREAD = 1e-4
"""Narrowest bracket over the motion of supports by `direct`, relative."""
ALIKE = 0.005
"""How far beyond the ends that `direct` finds limit analysis still agrees with it, relative."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Search:
    """What a search for the change from standing to falling came to.

    `falls`, `stands`: The nearest values that collapsed and that stood; None where there were
        none.
    `confirmed`: Whether moving runs, or a second linear programme, agree at the ends found;
        None where none were made.
    `runs`, `undecided`: Values tried, and those without an answer.
    `reason`: What the answer rests on.
    `blocks`, `splits`: Most blocks simulated at any value, and how many joints in all a
        reduction merged and had to split again; None for static methods, but for blocks that
        planes of symmetry left.
    `collapse`: By an engine, what was seen at the value that collapsed.
    `beside`: In space, equilibria by limit analysis at the ends, that which falls first.
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
    beside: tuple[Any, ...] = field(default=(), repr=False)


@dataclass(frozen=True, kw_only=True)
class Sought:
    """The change from standing to falling that an engine is to find.

    `name`: What the value is.
    `start`: Where to begin.
    `within`: Values beyond which the search is given up.
    `more_is_safer`: Whether it stands above the change.
    `given`: How finely, and whether both ends are to be confirmed.
    """

    name: str
    start: float
    within: Within
    more_is_safer: bool
    given: Taken

    def by(self, judge: Callable[[float], Answer]) -> Search:
        """Search, as a judge of values says.

        A bisection knows values only of which more is safer: of others it is given the inverse.
        """
        low, high = self.within

        def turned(value: float) -> float:
            # The inverse of an inverse is rounded, and no value beyond the range is asked.
            return value if self.more_is_safer else min(max(1 / value, low), high)

        floor, ceiling = (low, high) if self.more_is_safer else (1 / high, 1 / low)
        search = Bisection(
            lambda strength: judge(turned(strength)),
            self.given.progress,
            floor=floor,
            ceiling=ceiling,
            name=self.name,
        )
        search.expand(self.start if self.more_is_safer else 1 / self.start)
        search.bisect(self.given.tol)
        ends = (search.low, search.high)
        falls, stands = (None if end is None else turned(end) for end in ends)
        return Search(falls=falls, stands=stands, runs=search.runs, undecided=search.undecided)


def followed(
    family: Family[Any], spreading: Spreading, exact: float | None, tol: float
) -> Search:
    """Follow the blocks until they fall, or as far as they can be followed."""
    if exact is not None and math.isfinite(exact) and exact > 0:
        return by_programmes(family, exact, rises=False, tol=tol)
    if spreading.path.ends == "collapse":
        return Search(falls=0.0, runs=1, reason="no forces of equilibrium exist as built")
    return Search(
        stands=spreading.path.value,
        runs=1,
        reason=f"followed on the displaced blocks up to {spreading.path.value:.6g} m",
    )


def slowly(
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


def shaken(family: Family[Any], engine: Engine, sought: Sought) -> Search:
    """Search for the change by shaking the blocks, each time until they lie still."""
    from blocksim.simulation.shaken import shake

    given, (low, high) = sought.given, sought.within
    near = max(low, sought.start / FARTHEST), min(high, sought.start * FARTHEST)

    def judge(value: float) -> Answer:
        # Nothing leads from how it falls to where it stands: the bracket is halved.
        seen = shake(family.at(value), engine, repeat=False, settings=given.settings)
        return Answer(seen.verdict, 0.0)

    found = replace(sought, within=near).by(judge)
    falls, stands, confirmed, words = found.falls, found.stands, None, ""
    if given.confirm and falls is not None and stands is not None:
        confirmed = all(
            shake(family.at(value), engine, settings=given.settings).verdict is verdict
            for value, verdict in ((falls, Verdict.COLLAPSES), (stands, Verdict.STANDS))
        )
        words = f"; at both ends {'' if confirmed else 'not '}the same at another step"
    return replace(
        found,
        confirmed=confirmed,
        reason=f"shaken at {found.runs} values, each time until all lay still; this is one "
        f"change from standing to falling, and beyond it blocks may stand again{words}",
    )


def proofs_beside(change: Change) -> tuple[Proof, ...]:
    """Prove that it falls and stands a little to both sides of a value; empty if not proved."""
    for beside in _beside(change):
        proofs = tuple(each.proof for each in beside if each.proof is not None)
        if [each.claim for each in proofs] == ["collapses", "stands"]:
            return proofs
    return ()


def _beside(change: Change) -> Iterator[Sequence[Any]]:
    """Go through equilibria to both sides of a change, those that are known first."""
    at, value, rises, beside = change
    if beside:
        yield beside
    for sure in SURE:
        ends = value * (1 - sure), value * (1 + sure)
        yield [equilibrium(at(end)) for end in (ends if rises else ends[::-1])]


def by_programmes(
    family: Family[Any],
    exact: float | None,
    *,
    rises: bool,
    tol: float,
    reduce: bool = True,
) -> Search:
    """Ask limit analysis a little to both sides of its own value."""
    if exact is None:
        return Search(reason="no forces of equilibrium exist at any value")
    if math.isinf(exact):
        return Search(reason="forces of equilibrium exist at all values")
    if exact < family.low or (rises and exact == family.low):
        least = family.low
        reason = f"forces of equilibrium exist down to {least:.6g}"
        return Search(stands=least, runs=1, reason=reason)
    spatial = family.at(exact).in_space
    told: list[bool | None] = []
    falls = stands = exact
    runs, blocks = 0, None
    beside: tuple[Any, ...] = ()
    for sure in (*SURE, *(by for by in ROUGH if spatial and by <= tol)):
        ends = exact * (1 - sure), exact * (1 + sure)
        falls, stands = ends if rises else ends[::-1]
        runs += 2
        if spatial:
            beside = tuple(
                equilibrium(family.at(end), reduce=reduce) for end in (falls, stands)
            )
            told, blocks = [each.exists for each in beside], fewer(family.problem, beside[1])
        else:
            told = [exists(family.at(end)) for end in (falls, stands)]
        if told == [False, True]:
            break
    confirmed = told == [False, True]
    programmes = f"two more {'cone' if spatial else 'linear'} programmes at the ends"
    said = f"{programmes} confirm it" if confirmed else f"{programmes} do not confirm it"
    return Search(
        falls=falls,
        stands=stands,
        confirmed=confirmed,
        runs=runs,
        reason=f"limit analysis; {said}",
        blocks=blocks,
        beside=beside,
    )


def by_engine(held_at: Callable[[float], Held[Any]], sought: Sought) -> Search:
    """Search with the onset test, then, if asked for, let the blocks go at both ends.

    `held_at`: Value to blocks after the onset test.
    """
    ends: dict[Verdict, tuple[float, Held[Any]]] = {}
    blocks = splits = both = 0

    def judge(value: float) -> Answer:
        nonlocal blocks, splits, both
        held = held_at(value)
        blocks, splits = max(blocks, held.blocks), splits + held.splits
        both += held.onset.may_rest
        # Every answer narrows the bracket: the last of each kind is that of its end.
        ends[held.onset.verdict] = value, held
        return Answer(held.onset.verdict, held.onset.acceleration)

    found = sought.by(judge)
    confirmed, collapse = _let_go(ends, sought)
    words = {True: "confirmed", False: "not confirmed", None: "not tried"}[confirmed]
    reason = f"onset test at {found.runs} values, ends {words} by moving runs"
    if both:
        reason += f"; friction allows both rest and motion at {both} of them"
    return replace(
        found,
        confirmed=confirmed,
        reason=reason,
        blocks=blocks,
        splits=splits,
        collapse=collapse,
    )


def _let_go(
    ends: Mapping[Verdict, tuple[float, Held[Any]]], sought: Sought
) -> tuple[bool | None, Observation | None]:
    """Let blocks go at both ends of a bracket, or tell of the one that falls how it does."""
    from blocksim.simulation.observation import conclude

    confirm, agreed = sought.given.confirm, list[bool]()
    collapse = None
    for expected in (Verdict.COLLAPSES, Verdict.STANDS):
        if expected in ends and (confirm or expected is Verdict.COLLAPSES):
            value, held = ends[expected]
            if confirm:
                sought.given.progress(0.95, f"moving run at {sought.name} {value:.6g}")
            ended = conclude(held, moving=confirm)
            agreed.append(ended.verdict is expected)
            if ended.verdict is Verdict.COLLAPSES:
                collapse = ended
    return (all(agreed) if confirm and agreed else None), collapse
