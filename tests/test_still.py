"""No engine moves what statics holds: pushed, loaded or tilted to 0.98 and 1.02 of its limit.

Truth: the load factor of limit analysis under forces across, in units of the weights.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from blocksim.ask.check import check
from blocksim.ask.simulate import simulate
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import Shaking
from blocksim.common.errors import InputError
from blocksim.engines import ENGINES
from blocksim.kinds import KINDS
from blocksim.kinds.files import structure_of
from blocksim.limit import collapse
from blocksim.simulation.shaken import shake

MOVES, FAR, SECONDS = 1e-4, 0.1, 3.0
LONG = pytest.mark.long
SHAKE = [name for name, engine in ENGINES.items() if engine.shakes]
PUSHED = [name for name in KINDS if name != "flat-arch"]
"""The flat arch between fixed skewbacks bears any push."""
QUICK = {("elliptic-arch", "direct"), ("column", "pymunk")}


def bearing(kind: str, **more: object) -> tuple[Problem, float]:
    """A structure of a kind under forces across, and how much of its weights it bears."""
    table = {"kind": kind, "friction": 0.6, "live": [{"body": [-1, 0]}], **more}
    problem = structure_of(table)
    most = collapse(problem).load_factor
    assert most is not None
    return problem, most


def pushed(kind: str, share: float) -> Problem:
    """A structure of a kind on ground that pushes with a share of what it bears."""
    problem, most = bearing(kind)
    shaking = Shaking(shape="constant", amplitude=most * share, duration=SECONDS)
    return replace(problem, live=(), shaking=shaking)


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
    below, above = (pushed(kind, share) for share in (0.98, 1.02))
    until = SECONDS / below.seconds
    assert shake(below, engine, until=until, repeat=False).recording.displacement.max() < MOVES
    assert shake(above, engine, until=until, repeat=False).recording.displacement.max() > FAR


@pytest.mark.parametrize("engine", [name for name in ENGINES if name not in SHAKE])
def test_the_others_refuse_ground_that_shakes_by_name(engine: str) -> None:
    with pytest.raises(InputError, match=f"{engine} knows no ground that shakes"):
        check(pushed("column", 0.5), method=engine)


def loaded(problem: Problem, force: float) -> Problem:
    return problem.with_load(force)


def tilted(problem: Problem, force: float) -> Problem:
    """Gravity turned until it has as much across as the force is of what is left down."""
    return replace(problem, live=()).tilted(-math.atan(force))


VOUSSOIRS = [("circular-arch", {"voussoirs": count}) for count in (7, 12, 27, 45)]


@pytest.mark.parametrize(
    ("kind", "more", "engine", "way"),
    [
        pytest.param(
            kind,
            more,
            engine,
            way,
            marks=[] if (kind, engine) == ("column", "direct") else LONG,
            id=f"{kind}{more.get('voussoirs', '')}-{engine}-{way.__name__}",
        )
        for kind, more in [*((kind, {}) for kind in PUSHED), *VOUSSOIRS]
        for engine in ENGINES
        for way in (loaded, tilted)
    ],
)
def test_a_load_and_a_tilt_move_only_what_statics_lets_go(
    kind: str, more: dict[str, int], engine: str, way: Callable[[Problem, float], Problem]
) -> None:
    problem, most = bearing(kind, **more)
    duration = SECONDS / problem.seconds
    below, above = (
        simulate(way(problem, share * most), method=engine, duration=duration)
        for share in (0.98, 1.02)
    )
    assert below.displacement.max() < MOVES
    assert above.displacement.max() > FAR
