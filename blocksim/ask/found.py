"""A bracket found: by what the maker knows of a threshold, or over the values of a family."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from blocksim.ask.ends import Ask, Change, Within, changes_of, neighbourhood, tried_ends
from blocksim.ask.families import Family
from blocksim.ask.methods import choose, merged, reduces
from blocksim.ask.options import Taken
from blocksim.ask.searches import (
    FARTHEST,
    Search,
    Sought,
    by_engine,
    by_programmes,
    followed,
    shaken,
    slowly,
)
from blocksim.ask.statics import halved
from blocksim.ask.undecided import closing_of_value
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.engines import get_engine
from blocksim.simulation.verdict import Evidence, aside

if TYPE_CHECKING:
    from blocksim.engines.base import Method
    from blocksim.kinds.archoffers import Thinning
    from blocksim.simulation.observation import Held
    from blocksim.simulation.simulated import Reduced

LEAST = 1e-12
"""Least upper end of where to search."""
GUESS = 0.1
"""Share of the range at which a search begins where limit analysis gives no value."""


class Found(NamedTuple):
    """What a search came to, by which method, and what else the answer says of it."""

    search: Search
    chosen: Method
    evidence: tuple[Evidence, ...]
    told: dict[str, Any]


def by_threshold(problem: Problem, over: str, threshold: Thinning, given: Taken) -> Found:
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
        from blocksim.simulation.observation import hold

        reduced = reduces(chosen, given.reduce, problem, by_maker=True)
        engine = get_engine(chosen)
        last: Reduced | None = None

        def held_at(value: float) -> Held:
            nonlocal last
            reduction = threshold.reduction(value, last) if reduced else None
            made = threshold.problem(value)
            held = hold(made, engine, settings=given.settings, reduction=reduction)
            # An engine may have split it, or given it up.
            last = held.simulation.reduction
            return held

        found = by_engine(
            held_at,
            Sought(
                name=threshold.name,
                start=threshold.start,
                within=(threshold.low, threshold.high),
                more_is_safer=True,
                given=given,
            ),
        )
        evidence = (Evidence("search", found.reason),)
        if reduced:
            evidence += _reduction(found, threshold.reduced_by, threshold.blocks)
        facts = threshold.facts(
            low=found.falls, high=found.stands, method=chosen.name, seen=found.collapse
        )
    exact = threshold.exact if chosen.name == "limit" else None
    return Found(
        found,
        chosen,
        evidence,
        {
            "over": over,
            "unit": threshold.unit,
            "low": threshold.value(found.falls),
            "high": threshold.value(found.stands),
            "stands": "high",
            "limit": threshold.value(threshold.exact),
            "problem": problem,
            "arch": facts,
            "changes": (Change(threshold.problem, exact, True),) if exact else (),
        },
    )


def _reduction(found: Search, by: str, most: int) -> tuple[Evidence, ...]:
    """Tell what reductions came to; nothing where all blocks were simulated."""
    if found.blocks is None or found.splits is None:
        return ()
    from blocksim.simulation.observation import reduced_words

    return (Evidence("reduction", reduced_words(by, found.blocks, most, found.splits)),)


def by_family(family: Family[Any], within: Within | None, given: Taken) -> Found:
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
    known = probe.has_statics
    exact = family.exact() if known else None
    found, ask = _sought(family, probe, chosen, given, (low, high), exact)
    remark = family.remark() if known else ""
    closing = closing_of_value(family) if known and not probe.in_space else ()
    evidence = (Evidence("search", found.reason), *aside("limit analysis", remark), *closing)
    most = len(probe.assembly.blocks)
    if (
        reduces(chosen, given.reduce, probe)
        and found.blocks is not None
        and found.blocks < most
    ):
        from blocksim.simulation.merging import Merging

        evidence += _reduction(found, Merging.by, most)
    elif chosen.is_static and found.blocks is not None:
        evidence += (halved(probe, found.blocks),)
    ends = (found.falls, found.stands)
    lower, upper = ends if family.stands == "high" else ends[::-1]
    intervals = tried_ends(family, found, ask) if known else None
    # Proofs are of rigid blocks.
    proves = chosen.name == "limit" and probe.strength is None
    return Found(
        found,
        chosen,
        evidence,
        {
            "over": family.name,
            "unit": family.unit,
            "low": lower,
            "high": upper,
            "stands": family.stands,
            "limit": exact,
            "problem": probe,
            "events": None if family.spreading is None else family.spreading.events,
            "intervals": intervals,
            "changes": changes_of(family, intervals or (), found) if proves else (),
        },
    )


def _sought(
    family: Family[Any],
    probe: Problem[Any],
    chosen: Method,
    given: Taken,
    within: Within,
    exact: float | None,
) -> tuple[Search, Ask]:
    """Search for the first change, and return what is asked of the others."""
    (low, high), rises = within, family.stands == "high"

    def by_limit(value: float | None, rises: bool) -> Search:
        reduce = given.reduce is not False
        return by_programmes(family, value, rises=rises, tol=given.tol, reduce=reduce)

    if family.spreading is not None:
        if chosen.is_static:
            return followed(family, family.spreading, exact, given.tol), by_limit
        found = slowly(family.spreading, given.tol, high, exact, given.progress)
        return found, by_limit
    if chosen.is_static:
        return by_limit(exact, rises), by_limit
    if probe.is_moving:
        start = min(max(family.start or low + GUESS * (high - low), low), high)
        sought = Sought(
            name=family.name, start=start, within=within, more_is_safer=rises, given=given
        )
        return shaken(family, get_engine(chosen), sought), by_limit
    search = _searching(family, chosen, given, within)

    def ask(value: float, rises: bool) -> Search:
        return search(value, neighbourhood(family, value), rises)

    if exact and math.isfinite(exact) and low <= exact <= high:
        return ask(exact, rises), ask
    return search(low + GUESS * (high - low), within, rises), ask


def _searching(
    family: Family[Any], chosen: Method, given: Taken, within: Within
) -> Callable[[float, Within, bool], Search]:
    """Return what searches by an engine from a value on, and whether it stands above it."""
    from blocksim.simulation.observation import hold

    (low, high), engine = within, get_engine(chosen)

    def held_at(value: float) -> Held[Any]:
        problem = family.at(value)
        reduction = merged(chosen, given.reduce, problem)
        return hold(problem, engine, settings=given.settings, reduction=reduction)

    def search(start: float, within: Within, rises: bool) -> Search:
        least, most = max(low, within[0], start / FARTHEST), min(high, within[1])
        if not least <= start <= most:
            return Search()
        sought = Sought(
            name=family.name,
            start=start,
            within=(least, most),
            more_is_safer=rises,
            given=given,
        )
        return by_engine(held_at, sought)

    return search
