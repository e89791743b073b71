"""Pushes sideways, in the plane both ways: what is borne, and how that falls as it moves."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.acting import azimuth_words, push_on_all, sideways, with_push
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import bears_road
from blocksim.common.checks import PUSH, require
from blocksim.limit import collapse
from blocksim.limit.displaced import Displaced

if TYPE_CHECKING:
    from blocksim.ask.bracket import Bracket

WAYS = {"right": 1.0, "left": -1.0}
"""Names and signs of the two ways of the plane."""
WAY = 5e-3
"""Way of the fastest corner in one step of a curve [size]."""
DIGITS = 9
"""Of pushes in g, to which two ways are alike."""
STEPS = 400
"""Most points of a curve."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """How much of its weight pushes blocks sideways in equilibrium, as they move.

    `moved`: How far the centre of mass of all blocks has moved that way [m].
    `pushes`: Over the weight of each block [g]; the first is what is borne as built.
    `ends`: `none` where nothing is borne any more; `slides`, `parts` or `closes` where a joint
        does what is not followed; `range` where no end came; `never` where any push is borne.
    """

    way: str
    moved: tuple[float, ...]
    pushes: tuple[float, ...]
    ends: str


def ways_of(problem: Problem[Any]) -> dict[str, float]:
    """Return names and signs of the ways: both in the plane, in space that of the azimuth."""
    if not problem.in_space:
        return {f"to the {way}": sign for way, sign in WAYS.items()}
    return {azimuth_words(problem): 1.0}


def asked(problem: Problem[Any], way: str) -> Problem[Any]:
    """Return a problem of which the live load is a push by the weight of each block.

    What acts on it, live loads times their factor too, stays.

    `way`: One of `ways_of`.
    """
    live = tuple(replace(load, force=problem.load * load.force) for load in problem.live)
    return replace(
        problem,
        dead=(*problem.dead, *(live if problem.load else ())),
        live=(push_on_all(problem, ways_of(problem)[way] * sideways(problem)),),
        load=1.0,
        road=(),
    )


def borne(problem: Problem[Any]) -> dict[str, float]:
    """Return the push that is borne each way, by name [g]; below 0 where it falls without."""
    allowed = "left out where gravity leans or the ground shakes"
    require(problem.has_statics, "push", "given", allowed)
    found = {way: collapse(asked(problem, way)).load_factor for way in ways_of(problem)}
    return {way: -np.inf if each is None else float(each) for way, each in found.items()}


def worse(both: Mapping[str, float]) -> str:
    """Return the way in which less is borne; of two alike the right."""
    return min(both, key=lambda way: round(both[way], DIGITS))


def borne_words(both: Mapping[str, float]) -> str:
    """Say what is borne both ways."""
    if max(both.values()) == -np.inf:
        return f"it bears no push {'either way' if len(both) > 1 else next(iter(both))}"
    if len(both) > len({round(each, DIGITS) for each in both.values()}):
        return f"it bears {min(both.values()):.6g} g either way"
    said = ", ".join(f"{each:.6g} g {way}" for way, each in both.items())
    return f"it bears {said}"


def without_mass(problem: Problem) -> str:
    """Say what lies on it and is not pushed."""
    return "; fill and loads on the road are not pushed" if bears_road(problem) else ""


def pushed_each_way(problem: Problem[Any], share: float) -> tuple[Problem[Any], ...]:
    """Return a problem pushed each of its ways; see `pushed`."""
    ways = ways_of(problem)
    why = ", where it falls first" if len(ways) > 1 else ""
    return tuple(_pushed(problem, way, share, why) for way in ways)


def _pushed(problem: Problem[Any], way: str, share: float, why: str) -> Problem[Any]:
    """Return a problem that is pushed one way, and says so."""
    PUSH.require("push", share)
    note = f"pushed by {share:g} g {way}{why}{without_mass(problem)}"
    across = ways_of(problem)[way] * share
    return replace(with_push(problem, across), notes=(*problem.notes, note))


def first_to_fall(answers: Sequence[Bracket[Any]]) -> Bracket[Any]:
    """Return the bracket of pushes each way in which it falls first; of two alike the first.

    Raises `InputError`: Where it stands between two values, or again beyond one.
    """

    def stands(answer: Bracket[Any]) -> float:
        low, high = answer.low, answer.high
        if answer.stands == "low":
            return -math.inf if low is None else math.inf if high is None else high
        return -math.inf if high is None else math.inf if low is None else -low

    for answer in answers:
        many = [each for one in answer.intervals or () for each in (one.low, one.high) if each]
        allowed = "left out: it stands between several values, of which each way has its own"
        require(len(many) < 2, "push", "given", allowed)
    return min(answers, key=lambda answer: round(stands(answer), DIGITS))


def pushed(problem: Problem[Any], share: float) -> Problem[Any]:
    """Return a problem that is pushed sideways by a share of the weight of each block.

    To the side to which it bears less, in space towards its azimuth; a note says what it bears.

    `problem`: On ground at rest; of the plane in it.
    `share`: [g]
    """
    both = borne(problem)
    return _pushed(problem, worse(both), share, f": {borne_words(both)}")


def curve(problem: Problem, way: str) -> Curve:
    """Follow the mechanism of blocks that are pushed as hard as they bear, until none is borne.

    The blocks turn about the hinges with which they begin to fall, however far, and by virtual
    work the push that balances them is known at each place. Other hinges might ask for less.
    """
    given = asked(problem, f"to the {way}")
    displaced, found = Displaced(given), collapse(given)
    factor, rates = found.load_factor, found.mechanism
    if factor is None or not np.isfinite(factor) or factor <= 0 or rates is None:
        return Curve(way=way, moved=(), pushes=(), ends="never" if factor else "none")
    masses = np.array([block.mass for block in problem.assembly.blocks])
    share = WAYS[way] * problem.assembly.size * masses / masses.sum()
    now, lost = displaced.opened(displaced.start, rates, 0.0)
    moved, pushes, gone = [0.0], [factor], 0.0
    live = given.live_forces
    while lost is None and len(moved) < STEPS:
        step = WAY / displaced.fastest(rates)
        ahead = displaced.carried(now, 0.0, now.poses + step * rates)
        rates = ahead.poses - now.poses
        middle = displaced.problem(replace(now, poses=(now.poses + ahead.poses) / 2))
        push = -float((middle.with_load(0.0).applied_forces() * rates).sum()) / float(
            (live * rates).sum()
        )
        far = float(share @ rates[:, 0])
        moved.append(gone + far / 2)
        pushes.append(push)
        gone, now = gone + far, ahead
        if push <= 0:
            # The last place is where the push vanishes, along a straight line.
            (one, other), (start, end) = moved[-2:], pushes[-2:]
            moved[-1] = one + (other - one) * start / (start - end)
            pushes[-1], lost = 0.0, "none"
            break
        if displaced.closing(now) < 0:
            lost = "closes"
    return Curve(way=way, moved=tuple(moved), pushes=tuple(pushes), ends=lost or "range")
