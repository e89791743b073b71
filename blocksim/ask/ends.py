"""All ends of the intervals in which a family stands, each tried to both sides."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from blocksim.ask.families import Family
from blocksim.blocks.problem import Problem

if TYPE_CHECKING:
    from blocksim.ask.searches import Search

Within = tuple[float, float]
Ask = Callable[[float, bool], "Search"]
"""From a value of limit analysis, and whether it stands above it."""


class Change(NamedTuple):
    """A change from standing to falling that limit analysis knows.

    `at`: Value to problem.
    `value`: The value of the change.
    `rises`: Whether it stands above it.
    `beside`: Equilibria that were asked for to both sides, that which falls first; empty where
        they are still to be asked for.
    """

    at: Callable[[float], Problem[Any]]
    value: float
    rises: bool
    beside: tuple[Any, ...] = ()


@dataclass(frozen=True, kw_only=True)
class End:
    """One end of an interval in which it stands.

    `limit`: The value of limit analysis.
    `falls`, `stands`: The nearest values that collapsed and that stood.
    `confirmed`: As of `blocksim.ask.searches.Search`.
    """

    limit: float
    falls: float | None
    stands: float | None
    confirmed: bool | None


@dataclass(frozen=True, kw_only=True)
class Stands:
    """An interval in which it stands; an end is None where it goes on beyond the range."""

    low: End | None
    high: End | None


def tried_ends(family: Family[Any], first: Search, ask: Ask) -> tuple[Stands, ...] | None:
    """Try all ends of the intervals that limit analysis knows; None where it knows none.

    `first`: What came of `family.exact()`.
    `ask`: What is asked at the other ends.
    """
    if family.intervals is None:
        return None

    def end(value: float, *, stands_above: bool) -> End | None:
        if math.isinf(value):
            return None
        same = stands_above == (family.stands == "high") and value == family.exact()
        found = first if same else ask(value, stands_above)
        return End(
            limit=value,
            falls=found.falls,
            stands=found.stands,
            confirmed=found.confirmed,
        )

    return tuple(
        Stands(low=end(each.low, stands_above=True), high=end(each.high, stands_above=False))
        for each in family.intervals
    )


def neighbourhood(family: Family[Any], value: float) -> Within:
    """Return where there is no change but this one: half of the way to the next, both ways."""
    ends = [end for each in family.intervals or () for end in (each.low, each.high)]
    below = [end for end in ends if end < value and math.isfinite(end)]
    above = [end for end in ends if end > value and math.isfinite(end)]
    return (
        (max(below) + value) / 2 if below else family.low,
        (min(above) + value) / 2 if above else family.high,
    )


def changes_of(
    family: Family[Any], intervals: tuple[Stands, ...], first: Search
) -> tuple[Change, ...]:
    """Return all changes that limit analysis knows; what came of the first goes with it."""
    ends = (
        (end, above)
        for each in intervals
        for end, above in ((each.low, True), (each.high, False))
    )
    found: list[Change] = []
    for end, above in ends:
        if end is not None:
            known = (end.falls, end.stands) == (first.falls, first.stands)
            found.append(Change(family.at, end.limit, above, first.beside if known else ()))
    return tuple(found)
