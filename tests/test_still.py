"""No engine moves what statics holds: pushed, loaded or tilted to 0.98 and 1.02 of its limit.

Truth: the load factor of limit analysis under forces across, in units of the weights.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from rocking import on_pulse

from blocksim import Problem, Verdict, check, collapse, simulate, structure_of

MOVES, FAR, SECONDS = 1e-4, 0.1, 3.0
SIDES = ((0.98, 1.0), (1.02, 0.5))
"""Shares of the limit, and of the seconds: what goes has gone far by half of them."""
LONG = pytest.mark.long
SHAKE, OTHERS = ("direct", "pymunk"), ("pybullet", "mujoco")
"""Engines that know ground that shakes, and those that refuse it."""
PUSHED = ("elliptic-arch", "portal", "wall", "rubble")
"""Of hinges, of piers, of courses that slide, of stones that are alike nowhere."""
QUICK = {("elliptic-arch", "direct")}
SMALLER = {"rubble": {"stones": 18, "seed": 2}, "wall": {"courses": 4}}
"""Kinds that take minutes as they come. With the forces of before the push pymunk lets these
stones slide at 0.98 of what they bear."""


def bearing(kind: str, **more: object) -> tuple[Problem, float]:
    """A structure of a kind under forces across, and how much of its weights it bears."""
    smaller = SMALLER.get(kind, {})
    table = {"kind": kind, "friction": 0.6, "live": [{"body": [-1, 0]}], **smaller, **more}
    problem = structure_of(table)
    most = collapse(problem).load_factor
    assert most is not None
    return problem, most


def pushed(kind: str, share: float) -> Problem:
    """A structure of a kind on ground that pushes with a share of what it bears."""
    problem, most = bearing(kind)
    return on_pulse(replace(problem, live=()), "constant", most * share, SECONDS)


@pytest.mark.parametrize(
    ("kind", "engine"),
    [
        pytest.param(kind, engine, marks=[] if (kind, engine) in QUICK else LONG)
        for kind in PUSHED
        for engine in SHAKE
    ],
)
def test_a_push_moves_only_what_statics_lets_go(kind: str, engine: str) -> None:
    """What goes goes far; blocks that only slide may find rest after it."""
    below, above = (
        simulate(asked, method=engine, duration=part * SECONDS / asked.seconds)
        for asked, part in ((pushed(kind, share), part) for share, part in SIDES)
    )
    assert below.displacement.max() < MOVES
    assert above.displacement.max() > FAR


def test_a_fall_that_statics_does_not_ask_for_is_undecided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever the engine says: here of a column that is pushed by 0.98 of what it bears."""
    monkeypatch.setattr(
        "blocksim.simulation.shaken.outcome", lambda _: (Verdict.COLLAPSES, "a block fell")
    )
    for share, verdict in ((0.98, Verdict.UNDECIDED), (1.02, Verdict.COLLAPSES)):
        seen = check(pushed("column", share), method="direct")
        assert seen.verdict is verdict
        assert ("can rest" in seen.reason) is (share < 1)


@LONG
def test_a_pile_that_can_rest_is_not_said_to_fall() -> None:
    assert check(pushed("rubble", 0.98), method="pymunk").verdict is not Verdict.COLLAPSES


def loaded(problem: Problem, force: float) -> Problem:
    return problem.with_load(force)


def tilted(problem: Problem, force: float) -> Problem:
    """Gravity turned until it has as much across as the force is of what is left down."""
    return replace(problem, live=()).tilted(-math.atan(force))


VARIED = [("column", {}), ("wall", {}), ("rubble", {}), ("circular-arch", {"voussoirs": 21})]
"""Engines that take minutes for a motion are asked about the first."""


@pytest.mark.parametrize(
    ("kind", "more", "engine", "way"),
    [
        pytest.param(
            kind,
            more,
            engine,
            way,
            marks=[] if (kind, engine, way) == ("column", "direct", loaded) else LONG,
            id=f"{kind}{more.get('voussoirs', '')}-{engine}-{way.__name__}",
        )
        for kind, more in VARIED
        for engine in (*SHAKE, *OTHERS)
        if engine in SHAKE or kind == "column"
        for way in (loaded, tilted)
    ],
)
def test_a_load_and_a_tilt_move_only_what_statics_lets_go(
    kind: str, more: dict[str, int], engine: str, way: Callable[[Problem, float], Problem]
) -> None:
    problem, most = bearing(kind, **more)
    duration = (2 if kind == "column" else 1) * SECONDS / problem.seconds
    below, above = (
        simulate(way(problem, share * most), method=engine, duration=part * duration)
        for share, part in SIDES
    )
    assert below.displacement.max() < MOVES
    assert above.displacement.max() > FAR
