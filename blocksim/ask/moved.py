"""Structures whose supports have moved: how they lie, and what they push as they go."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from blocksim.ask.spread import Spreading, event_words
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.limit.margins import crown, thrust_range


def spread_by(problem: Problem, value: float) -> Problem:
    """Return a problem as it lies where its supports have moved so far [m].

    They move under all that acts. A note says what happened on the way, and how much farther
    they can move. Where blocks fall for good before that it is the problem as it begins to.

    Raises `InputError`: If what moves is not said, or it is not followed so far.
    """
    spreading = Spreading(problem)
    try:
        _ = spreading.problem
    except InputError as error:
        if error.field != "--over":
            raise
        allowed = "left out, or `move` in the file: which of its supports moves has to be said"
        raise InputError("spread", value, allowed) from None
    path, exact = spreading.path, spreading.exact
    followed = value <= path.value or path.falls_for_good
    require(followed, "spread", value, f"at most {path.value:.6g} m: farther is not followed")
    require(value <= spreading.farthest, "spread", value, f"at most {spreading.farthest:.6g} m")
    said = [event_words(each) for each in spreading.events if each.value <= value]
    left = math.inf if exact is None else exact - value
    if exact is None:
        said.append(f"it is followed up to {path.value:.6g} m")
    elif math.isfinite(left):
        said.append(f"it {'falls' if left >= 0 else 'fell'} at {exact:.6g} m")
    lies = spreading.at(value)
    note = (
        f"supports moved by {value:g} m, before any push and under all else: {'; '.join(said)}"
    )
    return replace(lies, moves=(), notes=(*lies.notes, note))


def thrusts_over(problem: Problem, points: int = 40) -> tuple[tuple[float, float, float], ...]:
    """Return how far supports have moved [m], and least and greatest thrust there [N].

    Evenly up to where blocks first fall, or as far as they are followed; at the crown. nan
    where there is none.
    """
    spreading = Spreading(problem)
    exact = spreading.exact
    most = exact if exact is not None and math.isfinite(exact) else spreading.path.value
    found: list[tuple[float, float, float]] = []
    for value in np.linspace(0.0, most, points).tolist():
        lies = spreading.at(value)
        joint = crown(lies)
        ends = None if joint is None else thrust_range(lies, joint)
        unit = lies.unit_force
        low, high = (
            (math.nan, math.nan) if ends is None else (each.thrust * unit for each in ends)
        )
        found.append((value, low, high))
    return tuple(found)
