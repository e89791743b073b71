"""Load factors of blocks that crush, against a block's closed form and the rigid value."""

from dataclasses import replace

import pytest
from kind_cases import KINDS, PLANAR
from own_bridge import SPARED, Bridge
from running import answered, ran

import blocksim

WIDE, HIGH, DEEP, HEAVY = 0.6, 1.0, 0.5, 20e3


def _pushed(force: tuple[float, float], place: tuple[float, float]) -> blocksim.Problem:
    """One block on the ground, pushed at a place of it."""

    def rectangle(low: float, high: float) -> list[list[float]]:
        return [[0.0, low], [WIDE, low], [WIDE, high], [0.0, high]]

    return blocksim.structure_of(
        {
            "blocks": [
                {"id": "ground", "vertices": rectangle(-1.0, 0.0), "fixed": True},
                {"id": "block", "vertices": rectangle(0.0, HIGH), "depth": DEEP},
            ],
            "friction": 5.0,
            "density": HEAVY,
            "live": [{"block": "block", "force": list(force), "point": list(place)}],
        }
    )


def _factor(problem: blocksim.Problem, strength: float) -> float:
    """Load factor of joints of that strength."""
    found = blocksim.collapse(replace(problem, strength=strength)).load_factor
    assert found is not None
    return found


@pytest.mark.parametrize("strength", [3e4, 1e5, 1e6, 1e8])
def test_a_pushed_block_rocks_about_the_middle_of_what_is_crushed(strength: float) -> None:
    """The lever of its weight is half its width less half of W / (strength depth)."""
    weight = HEAVY * WIDE * HIGH * DEEP
    lever = (WIDE - weight / (strength * DEEP)) / 2
    found = _factor(_pushed((1.0, 0.0), (0.0, HIGH)), strength)
    assert found == pytest.approx(weight * lever / HIGH, rel=1e-7)


def test_a_load_that_is_none_is_borne_at_any_factor() -> None:
    assert _factor(_pushed((0.0, 0.0), (0.0, HIGH)), 1e6) == float("inf")


def test_a_block_pressed_in_its_middle_bears_its_strength() -> None:
    """Strength times area, less its own weight."""
    found = _factor(_pushed((0.0, -1.0), (WIDE / 2, HIGH)), 1e6)
    most = 1e6 * WIDE * DEEP - HEAVY * WIDE * HIGH * DEEP
    assert found == pytest.approx(most, rel=1e-9)


def test_factors_grow_with_strength_to_that_of_rigid_blocks() -> None:
    """What lacks falls in proportion to the inverse of the strength."""
    pushed = _pushed((1.0, 0.0), (0.0, HIGH))
    rigid = blocksim.collapse(pushed).load_factor
    factors = [rigid - _factor(pushed, strength) for strength in (1e5, 1e6, 1e7)]
    assert factors[0] / factors[1] == pytest.approx(10, rel=1e-4)
    assert factors[1] / factors[2] == pytest.approx(10, rel=1e-3)


BRIDGE = Bridge(span=8.0, rise=3.0, thick=0.45, count=31, fill=0.5, heavy=22.0)
LOADED = [*BRIDGE.options(), "--point-load", "2.01", "50"]


@pytest.mark.parametrize("strength", [0.7, 1.0, 5.0])
def test_an_arch_crushes_as_an_own_programme_says(strength: float) -> None:
    """Tangents of the law of strength, in a bridge put together apart, from both sides."""
    live = 50 * BRIDGE.wheel(2.01)
    most = BRIDGE.factor(live, strength=1e3 * strength)
    least = BRIDGE.factor(live, strength=1e3 * strength * SPARED)
    assert most - least < 1e-3
    found = answered("bracket", *LOADED, "--strength", strength, "--over", "load")
    assert least - 1e-6 < found["limit"] < most + 1e-6


def test_the_strength_that_is_needed_is_that_at_which_it_falls() -> None:
    """Of a load factor, and the load factor of that strength; stresses are at most it."""
    found = answered("check", *LOADED, "--load", "0.9", "--strength", "5")
    needed = found["needed_strength_MPa"]
    assert found["verdict"] == "stands"
    assert not found["proved"]
    stress = [joint["stress_MPa"] for joint in found["joints"]]
    assert max(stress) == pytest.approx(needed, rel=1e-6)
    again = answered("bracket", *LOADED, "--strength", needed, "--over", "load")
    assert again["limit"] == pytest.approx(0.9, rel=1e-6)
    less = answered("check", *LOADED, "--load", "0.9", "--strength", 0.999 * needed, code=1)
    assert less["verdict"] == "collapses"
    assert less["mechanism"] is not None


def test_what_crushes_under_its_dead_load_is_told() -> None:
    done = ran("check", *LOADED, "--strength", "0.05", code=1)
    assert "all forces of equilibrium crush a joint" in done
    assert "no factor at collapse: at none joints bear what they carry" in done
    squeezed = replace(_pushed((0.0, -1.0), (WIDE / 2, HIGH)), strength=1e4)
    said = blocksim.check(squeezed)._repr_html_()
    assert "factor at collapse -3000: it crushes under its dead load" in said


def test_the_thrust_of_joints_that_crush_has_a_smaller_range() -> None:
    rigid = answered("check", *BRIDGE.options())
    found = answered("check", *BRIDGE.options(), "--strength", "0.5")
    strong = answered("check", *BRIDGE.options(), "--strength", "500")
    ends = [[each[f"thrust_{end}_kN"] for end in ("min", "max")] for each in (rigid, found)]
    assert ends[0][0] < ends[1][0] < ends[1][1] < ends[0][1]
    for end, exact in zip(("min", "max"), ends[0], strict=True):
        assert strong[f"thrust_{end}_kN"] == pytest.approx(exact, rel=1e-3)


def test_a_block_bears_evenly_beside_its_edge() -> None:
    """A block that is pushed stands on a width of which the middle is its reaction's place."""
    pushed = replace(_pushed((1.0, 0.0), (0.0, HIGH)), strength=1e6, load=100.0)
    found = blocksim.check(pushed)
    weight = HEAVY * WIDE * HIGH * DEEP
    arm = WIDE / 2 - 100.0 * HIGH / weight
    needed = weight / (2 * arm * DEEP)
    assert found.needed.low <= needed <= found.needed.high * (1 + 1e-12)
    assert found.needed.high == pytest.approx(needed, rel=1e-7)
    assert found.carried.resultants.stress == pytest.approx([needed], rel=1e-6)


@pytest.mark.parametrize("kind", PLANAR)
def test_every_kind_needs_what_a_smaller_strength_lacks(kind: str) -> None:
    """Whatever is built: a little more than is needed stands, a little less crushes."""
    problem = KINDS[kind](friction=0.7, density=2e4).problem()
    needed = blocksim.check(replace(problem, strength=1e9)).needed
    assert needed.low == pytest.approx(needed.high, rel=1e-6)
    for share, stands in ((1.001, True), (0.999, False)):
        found = blocksim.check(replace(problem, strength=share * needed.high))
        assert (found.verdict.value == "stands") is stands


@pytest.mark.parametrize("heavy", [1.0, 2e4, 1e8])
def test_the_strength_that_is_needed_is_of_any_size(heavy: float) -> None:
    """Of a column unit weight times height, also beyond what may be given as a strength."""
    column = blocksim.Column(drums=10, drum_height=1.5, width=1, friction=0.5, density=heavy)
    needed = blocksim.check(replace(column.problem(), strength=1e9)).needed
    assert needed.high == pytest.approx(15 * heavy, rel=1e-6)


PASSIVE = ("--fill-passive", "0.33", "--fill-friction-angle", "30")
BRIDGES = [
    ("18.65", "6.417", "2.104", "18", "0.9263", "-3.501", "273.4"),
    ("4.41", "1.32", "0.4835", "19", "0.9", "1.337", "25.18"),
    ("10.02", "3.71", "0.8083", "15", "0.6391", "-1.15", "190.9", *PASSIVE),
    ("18.02", "7.764", "1.407", "26", "0.917", "1.295", "215.7", *PASSIVE),
]


@pytest.mark.parametrize(
    ("bridge", "mu"),
    [
        pytest.param(bridge, mu, marks=[pytest.mark.long] if (at + rough) % 2 else [])
        for at, bridge in enumerate(BRIDGES)
        for rough, mu in enumerate(("0.7", "inf"))
    ],
)
def test_what_falls_is_told_whatever_the_friction(bridge: tuple[str, ...], mu: str) -> None:
    """It falls at any load if its strength is too small for none, and at twice the largest."""
    span, rise, thick, count, fill, x, live, *soil = bridge
    asked = ("--span", span, "--rise", rise, "--thickness", thick, "--voussoirs", count)
    asked = (*asked, "--mu", mu, "--fill", fill, "--unit-weight", "21", *soil)
    asked = (*asked, "--point-load", x, live)
    alone = answered("check", *asked, "--strength", "5", "--load", "0")
    needed = alone["needed_strength_MPa"]
    for share in (0.5, 0.999):
        weak = answered("bracket", *asked, "--over", "load", "--strength", share * needed)
        assert (weak["low"], weak["high"]) == (None, None)
    strong = (*asked, "--strength", repr(3 * needed))
    most = answered("bracket", *strong, "--over", "load")["limit"]
    for share, code in ((0.999, 0), (1.001, 1), (2, 1)):
        ran("check", *strong, "--load", share * most, code=code)


def test_what_rigid_blocks_bear_at_any_load_crushes_under_twice_the_most() -> None:
    arch = ("--span", "12.21", "--rise", "2.347", "--thickness", "1.29", "--voussoirs", "14")
    fill = ("--unit-weight", "25.76", "--fill", "0.06309", "--dispersal", "boussinesq")
    fill = (*fill, "--fill-pressure", "0.3", "--fill-friction-angle", "30")
    asked = (*arch, *fill, "--mu", "inf", "--point-load", "-2.838", "156.4")
    ran("check", *asked, "--load", "1000")
    crushes = (*asked, "--strength", "28.44")
    most = answered("bracket", *crushes, "--over", "load")["limit"]
    for share, code in ((0.999, 0), (1.001, 1), (2, 1), (10, 1)):
        ran("check", *crushes, "--load", share * most, code=code)


@pytest.mark.parametrize("mu", ["inf", pytest.param("0.6", marks=pytest.mark.long)])
def test_stone_that_is_strong_for_its_size_crushes_little(mu: str) -> None:
    """A bench model of stone: its strength is 1e5 of what its joints bear."""
    arch = ("--span", "0.12459", "--rise", "0.0484", "--voussoirs", "13", "--mu", mu)
    heavy = ("--thickness", "0.028598", "--unit-weight", "16.231")
    rigid, strong = (
        answered("bracket", *arch, *heavy, *more, "--over", "thickness")["limit"]
        for more in ((), ("--strength", "24.727"))
    )
    assert rigid < strong < 1.01 * rigid
