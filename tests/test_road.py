"""Fill and loads on the road: weights by hand, statics, and what is refused."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from hypothesis import given, settings
from hypothesis import strategies as st
from running import answered, inside, ran
from scipy.integrate import quad
from structure_cases import case, scenes

from blocksim import Problem, collapse, load_recording, structure_of

HEAVY, FILL = 22_000.0, 18_000.0
RADIUS, THICK, DEPTH, HEIGHT = 25 / 6 + 0.225, 0.45, 2.0, 0.5
"""Of an arch of 8 by 3 by 0.45 m, 2 m deep, under half a metre of fill."""
ALPHA = math.acos(7 / 25)
OPTIONS = (
    *("--span", "8", "--rise", "3", "--thickness", "0.45", "--voussoirs", "31"),
    *("--depth", "2", "--friction-angle", "35", "--unit-weight", "22"),
)
UNDER = (*OPTIONS, "--fill", "0.5", "--fill-unit-weight", "18")


def above(outer: float, half_angle: float, height: float) -> float:
    """Area between an extrados and the road, by quadrature [m^2]."""
    reach = outer * math.sin(half_angle)
    return quad(
        lambda x: outer + height - math.sqrt(outer**2 - x**2), -reach, reach, epsabs=1e-13
    )[0]


@pytest.mark.usefixtures("wide_window")
def test_what_lies_on_the_road_is_told() -> None:
    loads = ("--point-load", "2", "50", "--patch-load", "-1.5", "-0.3", "30")
    told = answered("check", *UNDER, *loads)
    problem = told["problem"]
    ring = ALPHA * ((RADIUS + THICK / 2) ** 2 - (RADIUS - THICK / 2) ** 2)
    wanted = {
        "span_m": 8.0,
        "rise_m": 3.0,
        "thickness_m": 0.45,
        "depth_m": 2.0,
        "unit_weight_kN_per_m3": 22.0,
        "weight_kN": HEAVY * DEPTH * ring / 1000,
        "fill_m": 0.5,
        "fill_weight_kN": FILL * DEPTH * above(RADIUS + THICK / 2, ALPHA, HEIGHT) / 1000,
        "live_weight_kN": 80.0,
        "load": 1.0,
    }
    assert {key: problem[key] for key in wanted} == pytest.approx(wanted, rel=1e-9)
    said = inside("check", *UNDER, "--point-load", "2", "50", "--load", "0.5").stdout
    assert f"fill 0.5 m over the crown, {wanted['fill_weight_kN']:.6g} kN" in said
    assert "live loads 50 kN times 0.5, straight down to the blocks below" in said


@pytest.mark.parametrize(("share", "code"), [(0.999, 0), (1.001, 1)])
def test_an_engine_falls_where_the_load_factor_says(share: float, code: int) -> None:
    load = ("--point-load", "2", "50")
    factor = answered("check", *UNDER, *load)["load_factor"]
    asked = (*UNDER, *load, "--load", str(share * factor), "--method", "direct")
    ran("check", *asked, code=code)


def let_go(folder: Path, *options: str) -> Problem:
    """What is simulated by command."""
    run = folder / "run.npz"
    ran("simulate", *options, "--seconds", "0.01", "--out", run)
    return load_recording(run).problem


def test_a_weight_on_a_joint_is_shared_by_both_sides(tmp_path: Path) -> None:
    arch = ("--alpha", "60", "--eta", "0.2", "--mu", "0.7", "--voussoirs", "8")
    arch = (*arch, "--unit-weight", "20")
    loads = let_go(tmp_path, *arch, "--point-load", "0", "10").live
    assert [load.blocks for load in loads] == [(3,), (4,)]
    assert [load.force[1] for load in loads] == [-5000.0, -5000.0]
    (load,) = let_go(tmp_path, *arch, "--point-load", "0.1", "10").live
    assert load.blocks == (4,)
    # On the chord of the extrados, from (0, 1.1) to the next joint.
    end = 1.1 * np.array([math.sin(math.pi / 12), math.cos(math.pi / 12)])
    height = 1.1 + 0.1 / end[0] * (end[1] - 1.1)
    assert load.point == pytest.approx([0.1, height], abs=1e-12)


def test_loads_in_a_file_of_blocks_stand_where_its_own_x_says(tmp_path: Path) -> None:
    blocks = [
        {"id": "floor", "vertices": [[9, -1], [15, -1], [15, 0], [9, 0]], "fixed": True},
        {"id": "low", "vertices": [[10, 0], [12, 0], [12, 1], [10, 1]]},
        {"id": "top", "vertices": [[11.5, 1], [13.5, 1], [13.5, 2], [11.5, 2]], "depth": 1},
    ]
    table = {"friction": 0.6, "blocks": blocks, "density": 20_000}
    path = written(tmp_path / "step.json", table)
    # The upper block, 40 kN at 0.5 m beyond its edge, needs a weight on its tail.
    ran("check", path, code=1)
    # About the edge at x = 12: 40 kN times 0.5 m against F times 0.5 m.
    told = answered("check", path, "--point-load", "11.5", "45")
    assert told["problem"]["live_weight_kN"] == pytest.approx(45)
    ran("check", path, "--point-load", "11.5", "39", code=1)
    ran("check", path, "--point-load", "11", "45", code=1)


SPANNED = (*OPTIONS[:8], "--friction-angle", "35", "--fill", "0.5")


def test_two_patches_are_both_on_the_road() -> None:
    halves = ("--patch-load", "1", "1.5", "6", "--patch-load", "1.5", "2", "6")
    whole = ("--patch-load", "1", "2", "12")
    said = [answered("bracket", *SPANNED, *each, "--over", "load") for each in (halves, whole)]
    assert said[0]["limit"] == pytest.approx(said[1]["limit"], rel=1e-9)


def test_what_is_on_the_road_is_let_go_drawn_and_bracketed(tmp_path: Path) -> None:
    load = ("--point-load", "2", "300")
    run, picture = tmp_path / "run.npz", tmp_path / "arch.svg"
    ran("simulate", *UNDER, *load, "--seconds", "0.05", "--out", run)
    problem = load_recording(run).problem
    assert problem.load == 1
    assert [each.force[1] for each in problem.live] == [-300_000]
    assert problem.road == ((2, 2, 300_000),)
    ran("render", *UNDER, *load, "--out", picture)
    drawn = picture.read_text()
    assert len(re.findall('id="live-', drawn)) == 1
    # Fill is drawn as an area, and its weight not once more as arrows.
    assert len(re.findall('id="fill-', drawn)) == 1
    assert not re.findall('id="dead-', drawn)
    assert "collapses, by limit" in drawn
    told = answered("bracket", *UNDER, *load, "--over", "load")
    assert told["low"] < collapse(problem).load_factor < told["high"]  # type: ignore[operator]
    thin = answered("bracket", *UNDER)
    assert (thin["over"], thin["unit"]) == ("thickness", "m")
    assert thin["low"] < 0.45


ARCH = {"kind": "circular-arch", "friction": 0.8, "thickness": 0.2, "voussoirs": 9}


def totals(problem: Problem) -> tuple[float, float]:
    """Force of the live loads, and moment about the origin."""
    force = sum(load.force[1] for load in problem.live)
    moment = sum(
        load.point[0] * load.force[1] - load.point[1] * load.force[0]
        for load in problem.live
        if load.point is not None
    )
    return float(force), float(moment)


@pytest.mark.parametrize("name", ["semicircle_point_crown", "semicircle_point_30"])
def test_a_narrow_patch_is_a_point_load(name: str) -> None:
    """Corpus: a force at a point of a voussoir is what lies on it evenly to both sides."""
    (scene,) = scenes(name)
    (load,) = scene["live"]
    x, _ = load["point"]
    live = [{"patch": [x - 1e-3, x + 1e-3], "force": load["force"]}]
    found = collapse(structure_of({**scene, "live": live})).load_factor
    assert found == pytest.approx(case(name)["expected"]["value"], rel=1e-9)


@pytest.mark.parametrize("on", [{"block": "5"}, {"patch": [-0.1, 0.1]}])
def test_an_arch_in_radii_is_loaded_by_name_and_by_place(on: dict[str, Any]) -> None:
    table = {**ARCH, "half_angle_deg": 60, "live": [{**on, "force": [0, -2]}]}
    (load,) = structure_of(table).live
    assert load.blocks == (4,)
    assert load.force == pytest.approx([0, -2])


@settings(max_examples=12)
@given(st.floats(-0.9, 0.8), st.floats(0.05, 0.9), st.floats(-2, 2), st.floats(-5, -0.1))
def test_a_patch_comes_to_its_force_at_its_middle(
    low: float, width: float, across: float, down: float
) -> None:
    high = min(low + width, 1.0)
    table = {**ARCH, "live": [{"patch": [low, high], "force": [across, down]}]}
    problem = structure_of(table)
    force, moment = totals(problem)
    assert force == pytest.approx(down)
    # The extrados is made of straight chords; the push acts at its mean height.
    xs = np.linspace(low, high, 20_001)
    corners = np.array(
        [
            (1.1 * math.sin(t), 1.1 * math.cos(t))
            for t in np.linspace(-math.pi / 2, math.pi / 2, 10)
        ]
    )
    height = np.interp(xs, corners[:, 0], corners[:, 1]).mean()
    assert moment == pytest.approx((low + high) / 2 * down - height * across, abs=2e-4)


def test_what_lies_uppermost_bears_it_and_supports_bear_their_own() -> None:
    floor = {"id": "floor", "vertices": [[-5, -1], [5, -1], [5, 0], [-5, 0]], "fixed": True}
    low = {"id": "low", "vertices": [[0, 0], [2, 0], [2, 1], [0, 1]]}
    top = {"id": "top", "vertices": [[0.5, 1], [1, 1], [1, 2], [0.5, 2]]}
    live = [{"patch": [-1, 2], "force": [0, -3]}]
    table = {"friction": 0.5, "blocks": [floor, low, top], "live": live}
    borne = [0.0, 0.0]
    for load in structure_of(table).live:
        borne[load.blocks[0]] += float(load.force[1])
    # One metre of three lies on the floor.
    assert borne == pytest.approx([-1.5, -0.5])


FULL = "--fill", "0.5", "--fill-unit-weight", "20", "--fill-friction-angle", "30"
AXLE = "--point-load", "-1.35", "20"
SOIL = (
    *("--fill-layer", "0.1", "24", "--backing", "0.5", "23"),
    *("--fill-pressure", "0.3,0.4"),
)


@pytest.mark.parametrize(
    "more",
    [
        ("--fill", "0.5", *AXLE),
        (*FULL, *SOIL, *AXLE),
        *(pytest.param(each, marks=pytest.mark.long) for each in (("--fill", "0.5"), AXLE)),
    ],
)
def test_the_line_that_was_measured_stays_under_a_road(more: tuple[str, ...]) -> None:
    """The least thickness under fill and loads is where a check of that thickness changes."""
    line = "--span", "8", "--rise", "2.5", "--mu", "0.6", *more
    thick = "--thickness", "0.5"
    least = answered("bracket", *line, *thick)["limit"]
    for share, code in ((0.9999, 1), (1.0001, 0)):
        ran("check", *line, "--thickness", share * least, code=code)


@pytest.mark.usefixtures("wide_window")
def test_what_has_no_mass_is_said_to_be_neither_pushed_nor_shaken() -> None:
    line = "check", "--span", "8", "--rise", "2.5", "--thickness", "0.5", "--mu", "0.7"
    push = *line, "--push", "0.1"
    words = "fill and loads on the road are not pushed"
    assert words in inside(*push, "--fill", "0.5").stdout
    assert words not in inside(*push).stdout
