"""Loads along a width, held against point loads, integrals and what they come to as forces."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from structure_cases import case, scenes

from blocksim import Problem, collapse, structure_of

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


@settings(deadline=None, max_examples=12)
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


def test_two_halves_of_a_patch_are_the_whole() -> None:
    whole = structure_of({**ARCH, "live": [{"patch": [-0.5, 0.7], "force": [0, -1.2]}]})
    parts = [
        {"patch": [-0.5, 0.1], "force": [0, -0.6]},
        {"patch": [0.1, 0.7], "force": [0, -0.6]},
    ]
    halves = structure_of({**ARCH, "live": parts})
    factors = [collapse(each).load_factor for each in (whole, halves)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-9)
    moved = (
        replace(whole, load=1.0).applied_forces() - replace(halves, load=1.0).applied_forces()
    )
    assert np.abs(moved).max() < 1e-12


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
