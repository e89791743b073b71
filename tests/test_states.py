"""Structures that are pushed, or whose supports have moved, against hand statics."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kind_cases import KINDS, PLANAR
from running import inside
from scipy.optimize import linprog

from blocksim import CircularArch, Column, equilibrium
from blocksim.ask.moved import spread_by, thrusts_over
from blocksim.ask.push import borne, curve, pushed


def asked(*options: str, code: int = 0) -> dict[str, Any]:
    done = inside(*options, "--json")
    assert done.returncode == code, done.stderr
    return json.loads(done.stdout)


SLENDER = ("--with", "width=0.5", "--with", "drums=1", "--with", "drum_height=3")


@pytest.mark.parametrize(("push", "code"), [("0.15", 0), ("0.1666", 0), ("0.1668", 1)])
def test_a_column_tips_at_its_width_over_its_height(push: str, code: int) -> None:
    """0.5 m over 3 m: a sixth of its weight, both ways."""
    told = asked("check", "column", "--mu", "0.7", *SLENDER, "--push", push, code=code)
    assert told["proved"]
    assert "it bears 0.166667 g either way" in told["reason"]


def test_the_worse_way_is_taken() -> None:
    """A tilted column: tan(beta - tilt) downhill, tan(beta + tilt) uphill."""
    column = Column(width=0.5, drums=1, drum_height=3.0, friction=2.0).problem()
    tilt, beta = math.radians(3.0), math.atan(0.5 / 3.0)
    found = borne(column.tilted(tilt))
    # The push goes along the table, gravity leans on it.
    for way, turn in (("right", -1), ("left", 1)):
        exact = math.cos(tilt) * (math.tan(beta) + turn * math.tan(tilt))
        assert found[way] == pytest.approx(exact, rel=1e-9)
    low = pushed(column.tilted(tilt), found["right"] * 1.001)
    assert not equilibrium(low).exists
    assert equilibrium(pushed(column.tilted(tilt), found["right"] * 0.999)).exists
    assert "g to the right: it bears" in low.notes[-1]


@pytest.mark.parametrize("way", ["right", "left"])
def test_the_push_on_a_rocking_block_falls_as_its_angle(way: str) -> None:
    """tan(beta - turn) at R (sin beta - sin(beta - turn)), to nothing over the edge."""
    column = Column(width=0.5, drums=3, drum_height=1.0, friction=2.0).problem()
    seen = curve(column, way)
    beta, reach = math.atan(0.5 / 3.0), math.hypot(0.25, 1.5)
    assert seen.ends == "none"
    assert seen.moved[-1] == pytest.approx(0.25, rel=1e-5)
    for moved, push in zip(seen.moved, seen.pushes, strict=True):
        left = math.asin(max(0.0, math.sin(beta) - moved / reach))
        assert push == pytest.approx(math.tan(left), abs=2e-5)


@pytest.mark.parametrize("kind", PLANAR)
def test_every_kind_is_pushed_both_ways(kind: str) -> None:
    """What is borne is the change from standing to falling, whatever is built."""
    problem = KINDS[kind](friction=0.7).problem()
    found = borne(problem)
    least = min(found.values())
    assert least > 0
    assert equilibrium(pushed(problem, min(5.0, 0.999 * least))).exists
    if least < 5:
        assert not equilibrium(pushed(problem, 1.001 * least)).exists


ARCH = CircularArch(span=8.0, rise=3.0, thickness=0.6, voussoirs=14, friction=0.7, density=2e4)


def test_an_arch_that_is_spread_has_its_least_thrust() -> None:
    """Hinges at crown and haunches: moments of one half, turned as far as its way."""
    problem = ARCH.between_supports().problem()
    spread = 0.02
    lies = spread_by(problem, spread)
    points = thrusts_over(problem, 8)
    assert points[0][1] == pytest.approx(thrust_of(problem, "min"), rel=1e-7)
    rises = [low for _, low, _ in points[1:]]
    assert rises == sorted(rises)
    # The left part between haunch and crown, as it lies: its weight about the haunch.
    joints = lies.assembly.joints
    hinges = [
        (joint.after, joint.inner) for joint in joints if joint.is_corner and joint.before >= 0
    ]
    (first, haunch), (last, crown), *_ = hinges
    part = lies.assembly.blocks[first:last]
    weight = np.array([block.mass * 9.81 for block in part])
    x = np.array([block.centre[0] for block in part])
    # The crown's force is level where the arch is its own mirror image.
    thrust = float((weight * (x - haunch[0])).sum() / (crown[1] - haunch[1]))
    told = asked(
        *("check", "--span", "8", "--rise", "3", "--thickness", "0.6", "--voussoirs", "14"),
        *("--mu", "0.7", "--unit-weight", "20", "--spread", str(spread)),
    )
    assert told["thrust_min_kN"] == pytest.approx(thrust / 1e3, rel=1e-6)
    assert told["thrust_max_kN"] == pytest.approx(told["thrust_min_kN"], rel=1e-6)
    assert "it falls" in told["reason"]


def thrust_of(problem: Any, end: str) -> float:
    """Least thrust of the crown by an own programme over horizontal force and its height."""
    blocks = problem.assembly.blocks
    half = [block for block in blocks if block.centre[0] < 0]
    weights = np.array([block.mass * 9.81 for block in half])
    xs = np.array([block.centre[0] for block in half])
    crown = max(problem.assembly.joints, key=lambda each: each.outer[1])
    rows, right = list[list[float]](), list[float]()
    # By symmetry the crown bears H alone: unknown H and H y; its moment about each end.
    for joint in problem.assembly.joints:
        if joint.inner[0] > 1e-9:
            continue
        above = xs > (joint.inner[0] + joint.outer[0]) / 2
        for point, sign in ((joint.inner, 1.0), (joint.outer, -1.0)):
            # H (y - y_p) less the weights' moments about the end has one sign at each.
            turn = float((weights[above] * (xs[above] - point[0])).sum())
            rows.append([-sign * -point[1], -sign * 1.0])
            right.append(-sign * turn)
    rows += [[crown.inner[1], -1.0], [-crown.outer[1], 1.0]]
    right += [0.0, 0.0]
    sign = 1.0 if end == "min" else -1.0
    found: Any = linprog([sign, 0.0], A_ub=rows, b_ub=right, bounds=(0, None))
    return float(found.x[0])


def test_curves_are_written(tmp_path: Path) -> None:
    arch = ("--span", "8", "--rise", "3", "--thickness", "0.6", "--voussoirs", "9")
    arch = (*arch, "--mu", "0.7")
    for over, name in (("push", "push_g"), ("spread", "thrust_min_kN")):
        table, picture = tmp_path / f"{over}.csv", tmp_path / f"{over}.svg"
        done = inside(
            *("bracket", *arch, "--over", over, "--out", str(table), "--out", str(picture))
        )
        assert done.returncode == 0, done.stderr
        with table.open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) > 10
        assert float(rows[0][name]) > 0
        assert ("to the left" if over == "push" else "least thrust") in picture.read_text()


def test_a_wall_that_leans_tips_at_its_width_over_its_height() -> None:
    """One block wide, 0.4 m over 1.2 m: at atan(1/3) = 18.43 deg."""
    slim = ("--with", "length=0.4", "--with", "block_length=0.4", "--with", "bond=1")
    wall = ("wall", "--mu", "0.7", "--unit-weight", "20", *slim)
    limit = math.degrees(math.atan(0.4 / 1.2))
    found = asked("bracket", *wall, "--over", "tilt")["limit"]
    assert found == pytest.approx(limit, rel=1e-9)
    for tilt, code in ((limit - 0.01, 0), (limit + 0.01, 1)):
        assert asked("check", *wall, "--tilt", repr(tilt), code=code)["proved"]


def test_a_portal_under_fill_stands_on_its_weight() -> None:
    """Weights by hand: two piers, half a ring, and fill up to a level road."""
    told = asked(
        "check",
        "portal",
        "--mu",
        "0.6",
        "--unit-weight",
        "20",
        "--fill",
        "0.4",
        "--joint",
        "13-14",
    )
    # Centreline of 1 m, 0.2 m thick; piers of 0.6 m from the intrados on, 1 m high.
    ring = math.pi / 2 * (1.1**2 - 0.9**2)
    wide = 2 * (0.9 + 0.6)
    fill = wide * 1.5 - math.pi / 2 * 1.1**2
    whole = 20 * (ring + 2 * 0.6 * 1.0 + fill)
    borne = told["reactions"]
    assert sum(each["vertical_kN"] for each in borne) == pytest.approx(whole, rel=1e-9)
    left, right = (each["horizontal_kN"] for each in borne)
    assert left == pytest.approx(-right, rel=1e-6)
    assert told["thrust_min_kN"] <= abs(left) <= told["thrust_max_kN"]
