"""Where Coulomb's law has two answers, rest and motion, and what the onset test says there.

An equilibrium exists above the least thickness: that is exact, by limit analysis and by
`direct`. A motion found there by an impulse engine must not be believed.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from arches import arch_at
from hypothesis import given
from hypothesis import strategies as st

from blocksim import bracket
from blocksim.assembly import SUPPORT, Assembly, Block, Joint
from blocksim.engines import get_engine
from blocksim.onset import JAMMED, jamming
from blocksim.trial import hold, trial
from blocksim.verdict import Verdict

TWO_ANSWERS = {
    # Impulses that begin with nothing rest, those of blocks that cannot slide do not.
    "from nothing": (135.17461504158692, 1.1369509535597662, 19),
    # The other way round, and slow.
    "from blocks that cannot slide": (125.023, 0.8594, 10),
}


@pytest.mark.parametrize(("ratio", "right"), [(0.999, "collapses"), (1.002, "stands")])
@pytest.mark.parametrize("case", TWO_ANSWERS)
def test_rest_is_found_from_one_of_two_beginnings(case: str, ratio: float, right: str) -> None:
    angle, mu, count = TWO_ANSWERS[case]
    assert trial(arch_at(ratio, angle, mu, count), mu, "pymunk").verdict == right


@pytest.mark.parametrize("case", TWO_ANSWERS)
def test_both_answers_are_there(case: str) -> None:
    """Begun on the other side only, pymunk finds a motion 0.2 % above the least thickness."""
    angle, mu, count = TWO_ANSWERS[case]
    assembly = arch_at(1.002, angle, mu, count).assembly()
    engine = get_engine("pymunk")
    world = engine.build(assembly, mu, engine.settings(assembly))
    if case == "from nothing":
        world.stick(20_000)
    assert np.abs(world.hold(20_000)).max() > 1e-5


@pytest.mark.parametrize(
    ("count", "ratio", "right"),
    [
        (7, 0.99, Verdict.UNDECIDED),
        (7, 1.05, Verdict.UNDECIDED),
        (9, 0.99, Verdict.UNDECIDED),
        (11, 0.99, Verdict.COLLAPSES),
        (11, 1.01, Verdict.STANDS),
    ],
)
@pytest.mark.parametrize("engine", ["pymunk", "pybullet"])
def test_few_thick_voussoirs_may_jam(
    engine: str, count: int, ratio: float, right: Verdict
) -> None:
    """Both sides of the bound: 1.30, 1.00 and 0.81 at 7, 9 and 11 voussoirs."""
    if engine == "pybullet":
        pytest.importorskip("pybullet", exc_type=ImportError)
    arch = arch_at(ratio, 155, 3.0, count)
    assert (jamming(arch.assembly(), 3.0) > JAMMED) == (count < 11)
    seen = hold(arch, 3.0, engine).onset
    assert seen.verdict is right
    assert ("jam" in seen.reason) == (right is Verdict.UNDECIDED)


def test_direct_tells_where_others_cannot() -> None:
    for ratio, right in ((0.999, Verdict.COLLAPSES), (1.001, Verdict.STANDS)):
        assert hold(arch_at(ratio, 155, 3.0, 7), 3.0, "direct").onset.verdict is right


MOVING_FROM_BOTH = [
    (151.66775, 2.150333384, 7),
    (148.65732, 2.0065096596, 12),
    (129.59079, 0.9681690607, 24),
]
"""Half-angle, friction, voussoirs; sector weight. pymunk moves 1 % above the limit."""


@pytest.mark.parametrize("ratio", [0.999, 1.001, 1.01])
@pytest.mark.parametrize("case", MOVING_FROM_BOTH)
def test_direct_tells_where_both_beginnings_move(
    case: tuple[float, float, int], ratio: float
) -> None:
    angle, mu, count = case
    arch = arch_at(ratio, angle, mu, count, "sector")
    right = Verdict.STANDS if ratio > 1 else Verdict.COLLAPSES
    assert hold(arch, mu, "direct").onset.verdict is right
    assert jamming(arch.assembly(), mu) < JAMMED


@pytest.mark.parametrize(
    ("confirm", "words"),
    [(True, "ends not confirmed; acc"), (False, "ends not tried by moving runs; acc")],
)
@pytest.mark.parametrize("case", MOVING_FROM_BOTH)
def test_a_bracket_notices_where_both_beginnings_move(
    case: tuple[float, float, int], confirm: bool, words: str
) -> None:
    """Accelerations of a collapse vanish where it ends; of a motion beside rest they do not."""
    angle, mu, count = case
    found = bracket(
        half_angle=math.radians(angle),
        mu=mu,
        voussoirs=count,
        weight="sector",
        method="pymunk",
        tol=1e-3,
        confirm=confirm,
    )
    assert found.confirmed is (False if confirm else None)
    assert words in found.reason
    assert "do not vanish" in found.reason


@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(0.1, 5.0), st.floats(0.1, 100.0))
def test_jamming_of_one_block(width: float, height: float, mu: float, mass: float) -> None:
    """A box on the ground: mu a b / (rho^2 + a^2) at its corner (a, b), rho its gyration."""
    a, b = width / 2, height / 2
    corners = [(-a, 0.0), (a, 0.0), (a, height), (-a, height)]
    block = Block(
        vertices=np.array(corners),
        centre=np.array([0.0, b]),
        mass=mass,
        inertia=mass * (width**2 + height**2) / 12,
        depth=1.0,
    )
    joint = Joint(before=SUPPORT, after=0, inner=np.array([a, 0.0]), outer=np.array([-a, 0.0]))
    assembly = Assembly(blocks=(block,), joints=(joint,), size=max(width, height))
    exact = mu * a * b / ((width**2 + height**2) / 12 + a**2)
    assert jamming(assembly, mu) == pytest.approx(exact, rel=1e-12)
