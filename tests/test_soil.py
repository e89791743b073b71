"""Fill as soil, held against integrals and linear programmes of a bridge put together apart."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from own_bridge import SPARED, Bridge
from running import answered, ran, refused
from scipy.integrate import quad
from test_crossing import is_as_bad_as_said

BRIDGE = Bridge(span=8.0, rise=3.0, thick=0.45, count=30, fill=0.5, heavy_fill=18.0)
"""A joint at the crown: no voussoir has soil on both of its sides."""
ANGLE = 30.0
ACTIVE, PASSIVE = 1 / 3, 3.0
"""Rankine's numbers of 30 degrees, (1 - 1/2) / (1 + 1/2) and its inverse."""
WHEEL = ("--point-load", "2.01", "50")
LIVE = 50 * BRIDGE.wheel(2.01)


def limit(*options: str) -> float:
    """The load factor by command."""
    return answered("bracket", *BRIDGE.options(), *WHEEL, "--over", "load", *options)["limit"]


def across(bridge: Bridge, left: float, right: float) -> np.ndarray:
    """What soil does from the side, over the weight above: exact integrals over heights."""
    found = np.zeros((bridge.count, 3))
    for k in range(bridge.count):
        low, high = bridge.high[k, 1], bridge.high[k + 1, 1]
        share = left if high > low else right
        force = share * bridge.heavy_fill * quad(lambda y: bridge.road - y, low, high)[0]
        turn = share * bridge.heavy_fill * quad(lambda y: y * (bridge.road - y), low, high)[0]
        found[k] = force, 0.0, -turn
    return found


@pytest.mark.parametrize(
    ("words", "left", "right"),
    [
        ("at-rest", 0.5, 0.5),
        ("active", ACTIVE, ACTIVE),
        ("0.2", 0.2, 0.2),
        ("at-rest,active", 0.5, ACTIVE),
        ("0,0.4", 0.0, 0.4),
    ],
)
def test_fill_presses_from_the_side(words: str, left: float, right: float) -> None:
    dead = BRIDGE.dead() + across(BRIDGE, left, right)
    angle = ("--fill-friction-angle", str(ANGLE)) if "a" in words else ()
    found = limit("--fill-pressure", words, *angle)
    assert found == pytest.approx(BRIDGE.factor(LIVE, dead), rel=1e-7)


@pytest.mark.parametrize("shares", [(0.33, 0.33), (1.0, 0.0), (0.0, 0.5)])
@pytest.mark.parametrize("pressure", [0.0, ACTIVE])
def test_fill_bears_what_the_arch_moves_into(
    shares: tuple[float, float], pressure: float
) -> None:
    """A programme with a share of what each voussoir's soil bears as unknowns of its own."""
    least = across(BRIDGE, pressure, pressure)
    most = [share * PASSIVE for share in shares]
    more = across(BRIDGE, *(each - pressure if each else 0.0 for each in most))
    dead = BRIDGE.dead() + least
    own = BRIDGE.factor(LIVE, dead, soil=more)
    asked = ["--fill-passive", ",".join(map(str, shares)), "--fill-friction-angle", str(ANGLE)]
    if pressure:
        asked += ["--fill-pressure", "active"]
    found = limit(*asked)
    assert found == pytest.approx(own, rel=1e-7)
    # A wheel on the right pushes the arch into the soil on the left.
    assert (found > BRIDGE.factor(LIVE, dead) * (1 + 1e-6)) is (shares[0] > 0)


@pytest.mark.parametrize("strength", [0.7, pytest.param(5.0, marks=pytest.mark.long)])
def test_fill_bears_as_much_as_blocks_that_crush_need(strength: float) -> None:
    """The same programme with tangents of the law of strength, from both sides."""
    soil = across(BRIDGE, 0.33 * PASSIVE, 0.33 * PASSIVE)
    most, least = (
        BRIDGE.factor(LIVE, soil=soil, strength=1e3 * strength * share) for share in (1, SPARED)
    )
    asked = "--fill-passive", "0.33", "--fill-friction-angle", str(ANGLE)
    found = limit(*asked, "--strength", str(strength))
    assert most - least < 1e-3 * most
    assert least - 1e-6 < found < most + 1e-6
    assert found < limit(*asked)
    for share, code in ((0.9999, 0), (1.0001, 1)):
        given = *asked, "--strength", str(strength), "--load", repr(share * found)
        ran("check", *BRIDGE.options(), *WHEEL, *given, code=code)


def test_what_fill_bears_is_told_and_proved() -> None:
    """At the load factor's edge: within it proved to stand, beyond it proved to fall."""
    asked = ("--fill-passive", "0.33", "--fill-friction-angle", "30")
    most = limit(*asked)
    for share, code in ((0.999, 0), (1.001, 1)):
        record = answered(
            "check", *BRIDGE.options(), *WHEEL, *asked, "--load", share * most, code=code
        )
        assert record["proved"]
        assert record["load_factor"] == pytest.approx(most, rel=1e-7)
        assert "the fill bears" in record["reason"]


def chorded(bridge: Bridge, heavy: Any) -> np.ndarray:
    """Weight of soil above the chords of the extrados, of a unit weight of x and y."""
    found = np.zeros((bridge.count, 3))
    for k in range(bridge.count):
        (x0, y0), (x1, y1) = bridge.high[k : k + 2]

        def above(x: float, y: float) -> float:
            steps = np.linspace(y, bridge.road, 1001)
            middle = (steps[1:] + steps[:-1]) / 2
            return float(np.mean([heavy(x, each) for each in middle]) * (bridge.road - y))

        share = (np.arange(40) + 0.5) / 40
        middle, chord = x0 + (x1 - x0) * share, y0 + (y1 - y0) * share
        weights = np.array([*map(above, middle.tolist(), chord.tolist())]) * (x1 - x0) / 40
        down, turn = weights.sum(), weights @ middle
        found[k] = 0.0, -down, -turn
    return found


def test_layers_backing_and_regions_weigh_what_they_are() -> None:
    """Weights summed by brute force, and the reactions of the whole."""
    low = float(BRIDGE.high[:, 1].min())

    def heavy(_: float, y: float) -> float:
        if y > BRIDGE.road - 0.2:
            return 24.0 - 18.0
        return 23.0 - 18.0 if y < low + 1.0 else 0.0

    dead = BRIDGE.dead() + chorded(BRIDGE, heavy)
    layered = limit("--backing", "1", "23", "--fill-layer", "0.2", "24")
    assert layered == pytest.approx(BRIDGE.factor(LIVE, dead), rel=2e-4)
    # A region that ends at a joint is another unit weight of all above the voussoirs there.
    right = chorded(BRIDGE, lambda x, _: -3.0 if x > 0 else 0.0)
    found = limit("--fill-region", "0", "100", "15")
    assert found == pytest.approx(BRIDGE.factor(LIVE, BRIDGE.dead() + right), rel=1e-6)


WEDGE: dict[str, Any] = {
    "blocks": [
        {"id": "ground", "vertices": [[-5, -1], [9, -1], [9, 0], [-5, 0]], "fixed": True},
        {"id": "wedge", "vertices": [[0, 0], [4, 0], [3, 2], [0, 2]], "depth": 0.5},
    ],
    "friction": 5.0,
    "density": 20e3,
}


def test_a_drawn_wall_under_fill_by_hand(tmp_path: Path) -> None:
    """A level top of 3 m and a slope of 1 m across and 2 m down, under a metre of fill."""
    place = written(tmp_path / "wedge.json", WEDGE)
    asked = ("--fill", "1", "--fill-unit-weight", "18", "--fill-pressure", "0,0.4")
    record = answered("check", place, *asked)
    # Weight of fill: 3 m of 1 m, and 1 m of 2 m on average; the side from 1 to 3 m deep.
    fill = 18.0 * 0.5 * (3 * 1 + 1 * 2)
    assert record["problem"]["fill_weight_kN"] == pytest.approx(fill)
    side = 0.4 * 18 * 0.5 * (3**2 - 1**2) / 2
    assert "fill 1 m over the highest point" in ran("check", place, *asked)
    reaction = record["reactions"][0]
    assert reaction["vertical_kN"] == pytest.approx(fill + 20 * 0.5 * 7)
    assert reaction["horizontal_kN"] == pytest.approx(side)
    # The upright side on the left is pressed as deep, by a lever of another height.
    both = answered("check", place, *asked[:4], "--fill-pressure", "0.4")
    reaction = both["reactions"][0]
    assert reaction["horizontal_kN"] == pytest.approx(0.0, abs=1e-9)
    # What spreads a load: less than half the way down the slope on each side.
    wheel = ("--point-load", "1", "10", "--dispersal", "1:2")
    told = answered("check", place, *asked[:4], *wheel)
    assert told["problem"]["live_weight_kN"] == pytest.approx(10.0)


@pytest.mark.long
@pytest.mark.parametrize("dispersal", [(), ("--dispersal", "1:2")], ids=["straight", "spread"])
def test_a_vehicle_crosses_a_drawn_wall_under_fill(
    dispersal: tuple[str, ...], tmp_path: Path
) -> None:
    """Wider at its top than at its bed, over which it may tip."""
    head = {"id": "head", "vertices": [[1, 0], [2, 0], [3, 2], [0, 2]]}
    place = written(tmp_path / "head.json", {**WEDGE, "blocks": [WEDGE["blocks"][0], head]})
    fill = ("--fill", "1", "--fill-unit-weight", "18")
    is_as_bad_as_said(str(place), *fill, *dispersal)


def test_each_course_of_a_wall_bears_the_soil_beside_it(tmp_path: Path) -> None:
    """Four courses of half a metre, a metre thick: shear at a depth h is K gamma h^2 / 2.

    The topmost course bore all of it, and slid off.
    """
    rows = [
        {"id": k, "vertices": [[0, k / 2], [1, k / 2], [1, k / 2 + 0.5], [0, k / 2 + 0.5]]}
        for k in range(4)
    ]
    floor = {"id": "floor", "vertices": [[-5, -1], [5, -1], [5, 0], [-5, 0]], "fixed": True}
    wall = {"blocks": [floor, *rows], "friction": 0.6, "density": 20e3}
    place = written(tmp_path / "wall.json", wall)
    fill = ("--fill", "1e-6", "--fill-unit-weight", "18", "--fill-pressure")
    for sides, sign in (("0.3,0", 1), ("0,0.3", -1)):
        record = answered("check", place, *fill, sides)
        shears = [abs(joint["friction_force"]) for joint in record["joints"]]
        deep = np.array([2.0, 1.5, 1.0, 0.5])
        assert shears == pytest.approx(0.3 * 18e3 * deep**2 / 2, rel=1e-5)
        reaction = record["reactions"][0]
        assert reaction["horizontal_kN"] == pytest.approx(-sign * 10.8, rel=1e-5)
        assert reaction["x_m"] - 0.5 == pytest.approx(sign * 10.8 * 2 / 3 / 40, rel=1e-5)
    # All of it slides where K gamma h^2 / 2 is more than mu times the weight.
    for share, verdict in ((0.66, "stands"), (0.67, "collapses")):
        record = answered("check", place, *fill, f"{share},0", code=None)
        assert record["verdict"] == verdict


BUTTRESS = """
kind = "portal"
friction = 0.7
density = 20e3
pier_width = 1.0
foot_width = 2.0
pier_height = 3.0
pier_courses = 3
arch = { kind = "circular-arch", half_angle_deg = 90, radius = 4, thickness = 0.5, fill = 0.75 }
"""


def test_fill_lies_on_the_backs_of_buttresses(tmp_path: Path) -> None:
    """What was not weighed there was taken off again by a layer, which pulled piers up."""
    place = tmp_path / "buttress.toml"
    place.write_text(BUTTRESS)
    # Road 5 m above the springings: over the ring of 4.25 m, a ledge of 0.5 m, and a slope.
    area = 5 * 8.5 - math.pi * 4.25**2 / 2 + 2 * (0.5 * 5 + 1.0 * (5 + 8) / 2)
    plain = answered("check", str(place))["problem"]["fill_weight_kN"]
    assert plain == pytest.approx(20 * area)
    lighter = answered("check", str(place), "--fill-layer", "100", "10")["problem"]
    # Of the layer surfaces are straight from joint to joint.
    assert lighter["fill_weight_kN"] == pytest.approx(10 * area, rel=0.02)


def test_spans_of_fill_of_their_own_say_it_by_regions(tmp_path: Path) -> None:
    """What a layer or a pressure from the side is of such a span was told of another fill."""
    place = tmp_path / "arcade.toml"
    more = 'kind = "arcade"\neach_span = [{}, { fill_density = 0.5 }]'
    other = BUTTRESS.replace('kind = "portal"', more)
    place.write_text(other.replace("pier_width = 1.0\nfoot_width", "pier_width"))
    said = refused("check", place, "--fill-pressure", "0.3")
    assert "each_span[1].fill_density = 0.5" in said
