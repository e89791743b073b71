"""Least thickness, and other values at which a kind of structure begins to stand."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from kind_cases import CATENARY, KINDS, LEAST, PIERS
from own_bridge import Bridge
from running import answered, inside, ran
from scipy.integrate import quad
from scipy.optimize import linprog
from structure_cases import case

from blocksim import Problem, Verdict, bracket, check, structure_of


def exact(problem: Problem, over: str) -> float | None:
    return bracket(problem, over=over, method="limit").limit


def test_vertical_joints_and_the_catenary() -> None:
    """0.1095 (as published), and nothing at all."""
    vertical = structure_of({**LEAST["semicircle_vertical_joints"], "friction": "inf"})
    assert exact(vertical, "thickness") == pytest.approx(0.1095, abs=5e-5)
    chain = bracket(structure_of({**CATENARY, "friction": "inf"}), over="thickness")
    assert chain.limit == 0
    assert chain.low is None
    assert chain.high < 1e-2


def test_other_parameters() -> None:
    """Piers, an overhang (half of the harmonic sum), a column's width on a slope."""
    piers = structure_of({**PIERS["piers_h1_c1"], "friction": 0.7})
    want = case("piers_h1_c1")["expected"]["value"]
    assert exact(piers, "pier_width") == pytest.approx(want, rel=1e-6)
    stack = structure_of({"kind": "stack", "friction": 0.5, "rows": 4, "length": 0.8})
    assert exact(stack, "overhang") == pytest.approx(
        0.4 * (1 + 1 / 2 + 1 / 3 + 1 / 4), rel=1e-9
    )
    assert bracket(stack, over="overhang").stands == "low"
    column = structure_of({"kind": "column", "friction": 0.7}).tilted(math.radians(10))
    assert exact(column, "width") == pytest.approx(3.6 * math.tan(math.radians(10)), rel=1e-9)
    ring = {"kind": "circular-arch", "voussoirs": 9}
    portal = structure_of({"kind": "portal", "friction": 0.7, "pier_width": 1.0, "arch": ring})
    thin = exact(portal, "arch.thickness")
    for share, verdict in ((0.9999, Verdict.COLLAPSES), (1.0001, Verdict.STANDS)):
        built = portal.but(**{"arch.thickness": share * thin})
        assert check(built, method="limit").verdict is verdict


def test_an_island_is_told() -> None:
    """On slender piers a thin arch falls, a thicker one stands, the next pushes them over."""
    arch = {"kind": "circular-arch", "voussoirs": 12}
    piers = {"pier_width": 0.38, "pier_height": 4.0}
    portal = structure_of({"kind": "portal", "friction": 0.7, "arch": arch, **piers})
    stood = [
        check(portal.but(**{"arch.thickness": value}), method="limit").verdict is Verdict.STANDS
        for value in (0.1, 0.15, 0.25, 0.33)
    ]
    assert stood == [False, True, False, True]
    found = bracket(portal, over="arch.thickness")
    assert 0.1 < found.limit < 0.13  # type: ignore[operator]
    assert found.confirmed
    assert "3 changes, as far as 20 values" in found.reason
    assert found.intervals is not None
    first, second = found.intervals
    assert second.high is None
    assert 0.1 < first.low.limit < 0.15 < first.high.limit < 0.25 < second.low.limit < 0.33
    assert first.low.limit == found.limit
    assert first.high.confirmed
    assert second.low.confirmed
    alone = structure_of({"kind": "pointed-arch", "friction": 0.7, "voussoirs": 12})
    assert "the only change, as far as" in bracket(alone, over="thickness").reason


@pytest.mark.parametrize(
    ("name", "joints"),
    [("circular", "normal"), ("pointed", "vertical"), ("basket-handle", "vertical")],
)
def test_direct_finds_it_again(name: str, joints: str) -> None:
    """On both sides of 0.1 %, by letting them go."""
    table = {"kind": f"{name}-arch", "friction": 1.2, "voussoirs": 12, "joints": joints}
    arch = structure_of(table)
    least = exact(arch, "thickness")
    assert least
    for share, verdict in ((0.999, Verdict.COLLAPSES), (1.001, Verdict.STANDS)):
        built = arch.but(thickness=share * least)
        assert check(built, method="direct").verdict is verdict


def test_what_slips_may_come_to_rest_again() -> None:
    """A semicircle's upright joints slip first: its middle settles, and that is no collapse."""
    table = {"kind": "circular-arch", "friction": 1.2, "voussoirs": 12, "joints": "vertical"}
    arch = structure_of(table)
    least = exact(arch, "thickness")
    assert least
    seen = check(arch.but(thickness=0.999 * least), method="direct")
    assert seen.verdict is Verdict.UNDECIDED
    assert "gave way and came to rest again" in seen.reason
    thicker = arch.but(thickness=1.001 * least)
    assert check(thicker, method="direct").verdict is Verdict.STANDS


def test_a_kind_by_its_name() -> None:
    """The same as the file that says so; parameters of a file can be changed."""
    sizes = ("--with", "voussoirs=60", "--with", "radius=1.25")
    found = answered("bracket", "pointed-arch", "--mu", "inf", *sizes)
    want = case("pointed_e0_25")["expected"]["value"]
    assert found["limit"] == pytest.approx(want, rel=1e-7)
    thin = ("portal", "--mu", "0.7", "--with", "pier_width=1", "--with", "arch.thickness=0.1")
    ran("check", *thin, code=1)
    ran("check", *thin[:-1], "arch.thickness=0.12")
    pushed = ("column", "--mu", "0.9", "--with", 'live=[{"body": [1, 0]}]')
    factor = answered("check", *pushed)["load_factor"]
    assert factor == pytest.approx(1 / 3.6, rel=1e-9)


def test_kinds_are_listed() -> None:
    """With what they are; and of one its parameters, their defaults and ranges."""
    listed = inside("kinds").stdout
    assert all(name in listed for name in KINDS)
    rows = inside("kinds", "portal").stdout.splitlines()
    at, width = next(each for each in enumerate(rows) if each[1].startswith("pier_width"))
    assert "0.6" in width
    # Of 80 characters, the unit stands below.
    assert "1e-06 to 1e+06" in width
    assert rows[at + 1].split()[0] == "m"
    assert width.count("pier_width") == 2, "it may be bracketed over"
    courses = next(row for row in rows if row.startswith("pier_courses"))
    assert courses.count("pier_courses") == 1


BIG = Bridge(span=6.0, rise=3.0, thick=0.5, count=20, fill=0.5)
SMALL = Bridge(span=4.0, rise=2.0, thick=0.4, count=14, fill=0.5 + 3.5 - 2.4)
"""Half circles: level springings on a pier without a saddle; one road over both."""
WIDE, HIGH = 1.4, 2.5
VIADUCT = f"""
kind = "arcade"
friction = 0.6
density = 20e3
spans = 2
pier_width = {WIDE}
pier_height = {HIGH}

[arch]
kind = "circular-arch"
span = 6.0
rise = 3.0
thickness = 0.5
voussoirs = 20
fill = 0.5

[[each_span]]

[[each_span]]
span = 4.0
rise = 2.0
thickness = 0.4
voussoirs = 14
"""


def turned(loads: np.ndarray, shift: float) -> np.ndarray:
    """Forces of an arch that is moved to the right: moments about the same origin."""
    moved = loads.copy()
    moved[:, 2] += shift * loads[:, 1]
    return moved


def own_factor(place: float, weight: float) -> float:
    """Load factor of a wheel on the left span: both arches and the pier in one programme."""
    # About the middle of the pier's head, which is right of that of the whole.
    shifts, centre = (-WIDE / 2 - 3.0, WIDE / 2 + 2.0), 6.0 + WIDE / 2 - (10.0 + WIDE) / 2
    blocks: list[np.ndarray] = []
    columns: list[np.ndarray] = []
    for bridge, shift, end in ((BIG, shifts[0], 1), (SMALL, shifts[1], 0)):
        mine = bridge.columns().T.reshape(-1, bridge.count, 3)
        moved = np.array([turned(each, shift) for each in mine])
        # What its springing on the pier does to the pier is the reaction to what it does here.
        on_pier = np.zeros((len(moved), 3))
        at = slice(-4, None) if end else slice(0, 4)
        on_pier[at] = -moved[at].sum(axis=1)
        blocks.append(moved)
        columns.append(on_pier)
    count = BIG.count + SMALL.count + 1
    parts: list[np.ndarray] = []
    for which, (moved, on_pier) in enumerate(zip(blocks, columns, strict=True)):
        for one, other in zip(moved, on_pier, strict=True):
            column = np.zeros((count, 3))
            start = 0 if which == 0 else BIG.count
            column[start : start + len(one)] = one
            column[-1] = other
            parts.append(column.ravel())
    for x in (-WIDE / 2, WIDE / 2):
        for side in (0.6, -0.6):
            column = np.zeros((count, 3))
            column[-1] = side, 1.0, x * 1.0 + HIGH * side
            parts.append(column.ravel())
    dead = np.zeros((count, 3))
    dead[: BIG.count] = turned(BIG.dead(), shifts[0])
    dead[BIG.count : -1] = turned(SMALL.dead(), shifts[1])
    edges = -WIDE / 2 + 0.5, WIDE / 2 - 0.4
    over = 20.0 * (BIG.road - 0.0) * (edges[1] - edges[0])
    dead[-1] = 0.0, -20.0 * WIDE * HIGH - over, -over * sum(edges) / 2
    live = np.zeros((count, 3))
    live[: BIG.count] = weight * turned(BIG.wheel(place - centre - shifts[0]), shifts[0])
    matrix = np.hstack([np.array(parts).T, live.reshape(-1, 1)])
    cost = np.append(np.zeros(len(parts)), -1.0)
    found: Any = linprog(cost, A_eq=matrix, b_eq=-dead.ravel(), bounds=(0, None))
    assert found.status == 0
    return float(-found.fun)


@pytest.mark.parametrize("place", [-3.1, -4.3])
def test_two_unequal_spans_on_a_pier(tmp_path: Path, place: float) -> None:
    path = written(tmp_path / "viaduct.toml", VIADUCT)
    wheel = ("--point-load", str(place), "50")
    found = answered("bracket", path, *wheel, "--over", "load")["limit"]
    assert found == pytest.approx(own_factor(place, 50.0), rel=1e-6)


ALIKE = {
    "kind": "arcade",
    "arch": {"kind": "circular-arch", "span": 6, "rise": 2, "thickness": 0.4, "fill": 0.3},
    "spans": 3,
    "pier_width": 1.0,
    "friction": 0.7,
    "density": 2e4,
}
"""Three spans that are alike."""


def test_equal_tables_are_the_arcade_without_them() -> None:
    plain = structure_of(ALIKE)
    spans, piers = [{}, {"span": 6.0, "rise": 2.0}], [{"width": 1.0}, {"height": 3.0}]
    told = structure_of({**ALIKE, "each_span": spans, "each_pier": piers})
    assert len(told.assembly.joints) == len(plain.assembly.joints)
    assert told.applied_forces() == pytest.approx(plain.applied_forces(), rel=1e-9, abs=1e-12)


def test_piers_and_fill_of_their_own() -> None:
    """Weights by hand: piers, fill of another density over one span up to the same road."""
    spans = [{"fill_density": 0.5}, {}, {"span": 4.0, "rise": 1.5}]
    piers = [{"width": 1.0, "height": 2.0}, {"width": 1.5, "height": 4.0}]
    problem = structure_of({**ALIKE, "each_span": spans, "each_pier": piers})
    weights = {block.name: block.mass * 9.81 / 1e3 for block in problem.assembly.blocks}
    assert weights["pier 1 1"] == pytest.approx(20 * 1.0 * 2.0)
    assert weights["pier 2 1"] == pytest.approx(20 * 1.5 * 4.0)
    down = np.zeros(len(problem.assembly.blocks))
    for load in problem.dead:
        down[load.blocks[0]] -= load.force[1] / 1e3
    names = [block.name or "" for block in problem.assembly.blocks]
    halves = [
        sum(each for each, name in zip(down, names, strict=True) if name.startswith(f"{k}."))
        for k in (1, 2, 3)
    ]
    assert halves[0] == pytest.approx(halves[1] / 2)
    # The extrados of the third: a circle through its crown, 0.8 m lower than the road's.
    inner = (2.0**2 + 1.5**2) / 3.0
    outer, angle = inner + 0.4, math.atan2(2.0, inner - 1.5)
    road = inner - 1.5 + 2.0 + 0.4 + 0.3

    def depth(x: float) -> float:
        return road - math.sqrt(outer**2 - x * x)

    reach = outer * math.sin(angle)
    assert halves[2] == pytest.approx(20 * quad(depth, -reach, reach)[0], rel=1e-7)
