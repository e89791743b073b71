"""No engine moves what statics holds: a constant push at 0.98 and 1.02 of the static limit.

Truth: the load factor of limit analysis under forces across, in units of the weights.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from blocksim.ask.check import check
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import Shaking
from blocksim.common.errors import InputError
from blocksim.engines import ENGINES
from blocksim.evidence.shaken import shake
from blocksim.kinds import KINDS
from blocksim.kinds.files import structure_of
from blocksim.limit import collapse

MOVES, FAR, SECONDS = 1e-4, 0.1, 3.0
LONG = pytest.mark.long
SHAKE = [name for name, engine in ENGINES.items() if engine.shakes]
PUSHED = [name for name in KINDS if name != "flat-arch"]
"""The flat arch between fixed skewbacks bears any push."""
QUICK = {("elliptic-arch", "direct"), ("column", "pymunk")}


def pushed(kind: str, share: float) -> Problem:
    """A structure of a kind on ground that pushes with a share of what it bears."""
    problem = structure_of({"kind": kind, "friction": 0.6, "live": [{"body": [-1, 0]}]})
    most = collapse(problem).load_factor
    assert most is not None
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
    assert shake(below, engine, until=until).recording.displacement.max() < MOVES
    assert shake(above, engine, until=until).recording.displacement.max() > FAR


@pytest.mark.parametrize("engine", [name for name in ENGINES if name not in SHAKE])
def test_the_others_refuse_ground_that_shakes_by_name(engine: str) -> None:
    with pytest.raises(InputError, match=f"{engine} knows no ground that shakes"):
        check(pushed("column", 0.5), method=engine)
