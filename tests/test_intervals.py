"""All values of a parameter at which blocks stand: closed forms, and both ends by engines."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from hypothesis import given, settings
from hypothesis import strategies as st
from running import inside as blocksim

from blocksim import Problem, structure_of
from blocksim.limit.intervals import over_factor, over_tilt

REACH, HIGH = 1.0, 0.3
"""Of the centre of mass of a beam, from the edge that bears it."""
BACK = 2 * math.degrees(math.atan(HIGH / REACH))
"""Sum of the angles at which it falls and stands again."""


def cantilever(first: float) -> dict[str, Any]:
    """A beam 4 m long, 1 m of it on a wall, held down at its tail: from an angle on it falls.

    The moment of its weight about the edge, W (cos t + 0.3 sin t), grows to its most at
    atan 0.3 and falls again; that of the dead load stays what it is.
    """
    weight = 4 * 2 * HIGH
    tail = weight * (REACH * math.cos(first) + HIGH * math.sin(first))
    return {
        "friction": 2.0,
        "density": 1.0,
        "blocks": [
            {"id": "wall", "vertices": [[-2, 0], [1, 0], [1, 1], [-2, 1]], "fixed": True},
            {"id": "beam", "vertices": [[0, 1], [4, 1], [4, 1.6], [0, 1.6]]},
        ],
        "dead": [{"body": [0, -1]}, {"block": "beam", "point": [0, 1.6], "force": [0, -tail]}],
    }


def seesaw(low: float, high: float) -> dict[str, Any]:
    """A block 12 m long on a post 1 m wide, too far to the left for it without a live load.

    About the post's edges, at 0 and 1 m, its weight and the live load at 4 m balance at the
    two factors.
    """
    ratio = 3 * high / (4 * low)  # of (c + 1) and c, the centre's distance from 0
    centre = -1 / (ratio - 1)
    live = 12 * -centre / (4 * low)
    left, right = centre - 6, centre + 6
    return {
        "friction": 2.0,
        "density": 1.0,
        "blocks": [
            {"id": "post", "vertices": [[0, -1], [1, -1], [1, 0], [0, 0]], "fixed": True},
            {"id": "block", "vertices": [[left, 0], [right, 0], [right, 1], [left, 1]]},
        ],
        "live": [{"block": "block", "point": [4, 1], "force": [0, -live]}],
    }


def asked(table: dict[str, Any], over: str, tmp_path: Path, *more: str) -> Any:
    path = written(tmp_path / "asked.json", table)
    return blocksim("bracket", path, "--over", over, *more)


@pytest.mark.parametrize("first", [5.93, 1e-3, 16.69])
def test_a_dead_load_that_does_not_turn_lets_it_fall_and_stand_again(
    first: float, tmp_path: Path
) -> None:
    done = asked(cantilever(math.radians(first)), "tilt", tmp_path, "--json")
    told = json.loads(done.stdout)
    assert told["stands"] == "low"
    assert told["limit"] == pytest.approx(first, abs=1e-9)
    below, above = told["intervals"]
    assert below["low"] is None
    assert above["high"] is None
    assert above["low"]["limit"] == pytest.approx(BACK - first, abs=1e-9)
    if first == 5.93:  # the others are too near each other, or to 0, to be asked again
        assert below["high"]["confirmed"]
        assert above["low"]["confirmed"]
    assert above["low"]["falls"] < above["low"]["limit"] < above["low"]["stands"]


def test_checks_agree_with_the_ends_of_the_tilt(tmp_path: Path) -> None:
    path = written(tmp_path / "cantilever.json", cantilever(math.radians(5.93)))
    codes = [
        blocksim("check", path, "--tilt", tilt).returncode
        for tilt in (5, 5.92, 5.94, 7, 20, BACK - 5.94, BACK - 5.92, 35)
    ]
    assert codes == [0, 0, 1, 1, 1, 1, 0, 0]
    words = asked(cantilever(math.radians(5.93)), "tilt", tmp_path).stdout
    assert "  stands  up to 5.93 deg, and from 27.4684885 deg on\n" in words


@pytest.mark.parametrize("method", ["limit", "direct", "pymunk"])
def test_a_load_that_is_needed_has_two_ends(method: str, tmp_path: Path) -> None:
    table = seesaw(0.32, 0.64)
    told = json.loads(asked(table, "load", tmp_path, "--method", method, "--json").stdout)
    assert told["limit"] == pytest.approx(0.64, rel=1e-9)
    (found,) = told["intervals"]
    for end, value in (("low", 0.32), ("high", 0.64)):
        assert found[end]["limit"] == pytest.approx(value, rel=1e-9)
        tried = sorted([found[end]["falls"], found[end]["stands"]])
        assert tried[0] < value < tried[1]
        assert tried[1] - tried[0] < 0.0051 * value
        assert found[end]["confirmed"]
    assert found["low"]["falls"] < found["low"]["stands"]
    assert found["high"]["stands"] < found["high"]["falls"]
    assert (told["low"], told["high"]) == (found["high"]["stands"], found["high"]["falls"])


@pytest.mark.usefixtures("wide_window")
def test_both_ends_are_told_in_words(tmp_path: Path) -> None:
    words = asked(seesaw(0.32, 0.64), "load", tmp_path).stdout
    assert "  stands  from 0.32 up to 0.64\n" in words
    words = asked(cantilever(math.radians(5.93)), "tilt", tmp_path, "--method", "direct").stdout
    assert "and from 27.4684885 deg (stands at 27." in words


@pytest.mark.parametrize(
    ("centre", "said"),
    [(-0.5, "LOAD: falls at all values"), (0.5, "LOAD: stands at all values")],
)
def test_where_nothing_changes_it_is_told_what_holds(
    centre: float, said: str, tmp_path: Path
) -> None:
    """A block whose centre is beside its support, or over it; the load changes nothing."""
    table = seesaw(0.32, 0.64)
    for corner, x in zip(table["blocks"][1]["vertices"], (-6, 6, 6, -6), strict=True):
        corner[0] = centre + x
    # Straight down, through the centre of the block.
    table["live"] = [{"block": "block", "point": [centre, 1], "force": [0, -1]}]
    path = written(tmp_path / "a.json", table)
    told = blocksim("bracket", path, "--over", "load").stdout
    assert told.startswith(said)


def test_what_leans_stands_between_two_tilts(tmp_path: Path) -> None:
    """A column whose base is 1 m wide and whose centre, 5 m up, is 1 m to the left of it."""
    table = {
        "friction": 2.0,
        "blocks": [
            {"id": "bed", "vertices": [[-3, -1], [3, -1], [3, 0], [-3, 0]], "fixed": True},
            {"id": "mast", "vertices": [[0, 0], [1, 0], [-1, 10], [-2, 10]]},
        ],
    }
    told = json.loads(asked(table, "tilt", tmp_path, "--json").stdout)
    (found,) = told["intervals"]
    assert found["low"]["limit"] == pytest.approx(math.degrees(math.atan(0.5 / 5)), rel=1e-9)
    assert found["high"]["limit"] == pytest.approx(math.degrees(math.atan(1.5 / 5)), rel=1e-9)
    assert told["limit"] == found["high"]["limit"]


def on_bed(
    dead: list[tuple[float, float, float]], mu: float, live: Sequence[dict[str, Any]] = ()
) -> Problem:
    """A block of 1 m by 0.5 m on level ground, under forces at places along its top."""
    loads = [{"block": "block", "point": [x, 0.5], "force": [h, v]} for x, h, v in dead]
    return structure_of(
        {
            "friction": mu,
            "density": 1.0,
            "blocks": [
                {"id": "bed", "vertices": [[-3, -1], [3, -1], [3, 0], [-3, 0]], "fixed": True},
                {"id": "block", "vertices": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]},
            ],
            "dead": [{"body": [0, -1]}, *loads],
            "live": live,
        }
    )


def margin(dead: list[tuple[float, float, float]], mu: float, turn: float) -> float:
    """How far a resultant is inside of its joint and of its cone, by hand."""
    x, y = 0.5 * math.sin(turn), -0.5 * math.cos(turn)
    turning = 0.5 * y - 0.25 * x + sum(at * v - 0.5 * h for at, h, v in dead)
    x += sum(h for _, h, _ in dead)
    y += sum(v for _, _, v in dead)
    return min(-y, -mu * y - abs(x), -turning, turning - y)


FORCE = st.floats(-1, 1)


@settings(max_examples=40)
@given(
    dead=st.lists(st.tuples(st.floats(0, 1), FORCE, FORCE), min_size=1, max_size=3),
    mu=st.floats(0, 4),
)
def test_a_block_under_forces_stands_where_its_resultant_says(
    dead: list[tuple[float, float, float]], mu: float
) -> None:
    found = over_tilt(on_bed(dead, mu), 0.0, math.pi / 2)
    for turn in np.linspace(0, math.pi / 2, 181).tolist():
        left = margin(dead, mu, turn)
        if abs(left) > 1e-7:
            assert any(each.low <= turn <= each.high for each in found) == (left > 0)
    for each in found:
        for end in (each.low, each.high):
            if math.isfinite(end):
                assert margin(dead, mu, end) == pytest.approx(0, abs=1e-7)


@settings(max_examples=30)
@given(low=st.floats(-3, 3), wide=st.floats(1e-3, 4))
def test_factors_of_a_load_are_two_of_a_moment(low: float, wide: float) -> None:
    """A horizontal live force at the top of a block: overturning to either side."""
    high = low + wide
    unit = 0.5 / wide  # of the force, so that 0.5 (0.5 unit) wide = 0.5 * 0.5
    steady = -unit * (low + high) / 2
    live = [{"block": "block", "point": [0.5, 0.5], "force": [unit, 0.0]}]
    problem = on_bed([(0.5, steady, 0.0)], 4.0, live)
    # About an edge: 0.5 of weight at 0.5 m against the force at 0.5 m.
    (found,) = over_factor(problem)
    reach = 0.5 / unit
    middle = -steady / unit
    assert found.low == pytest.approx(middle - reach, abs=1e-8 * (1 + abs(middle) + reach))
    assert found.high == pytest.approx(middle + reach, abs=1e-8 * (1 + abs(middle) + reach))
