"""The MuJoCo engine: both sides of the least thickness, closed forms, what cannot matter.

Contacts are soft, and so are the bounds: arches are asked
0.5 % aside of their least thickness.
"""

from typing import cast

import numpy as np
import pytest
from arches import problem_at
from worlds import Simulation, get_engine, hold, least_motion, observe

from analysis.structure_cases import answered, questions
from blocksim import (
    InputError,
    MissingPart,
    Problem,
    Verdict,
    assembly_of_polygons,
    equilibrium,
)
from blocksim.ask.doctor import examine
from blocksim.engines.base import TakesForces
from blocksim.engines.mujocoblocks import library
from blocksim.engines.mujocostep import coulomb_step

pytest.importorskip("mujoco", exc_type=ImportError)

SIDES = [(0.995, Verdict.COLLAPSES), (1.005, Verdict.STANDS)]


def test_a_block_too_light_for_it_is_refused() -> None:
    """A pebble of 1e-7 m on a block of 1 m: MuJoCo's own error was a traceback."""
    large, pebble = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), 1e-7
    bed = np.array([[-9, -1], [9, -1], [9, 0], [-9, 0]])
    small = pebble * large + [2, 0]
    stack = assembly_of_polygons([bed, large, small], fixed=[0])
    with pytest.raises(InputError, match="lightest block"):
        observe(Problem(assembly=stack, mu=0.5), "mujoco", moving=False)


@pytest.mark.parametrize(
    ("ratio", "expected"), [SIDES[0], pytest.param(*SIDES[1], marks=pytest.mark.long)]
)
def test_let_go_it_does_what_the_onset_test_says(ratio: float, expected: Verdict) -> None:
    seen = observe(problem_at(ratio, 90, 0.7, 7), "mujoco")
    assert seen.verdict is expected
    assert seen.motion.verdict is expected


@pytest.mark.long
@pytest.mark.parametrize(("ratio", "expected"), [(0.99, "collapses"), (1.01, "stands")])
def test_a_thin_shallow_arch_is_begun_with_forces(ratio: float, expected: str) -> None:
    """The same arch: the exact limit of its voussoirs is the truth."""
    seen = observe(problem_at(ratio, 30, 0.7, 27), "mujoco", moving=False)
    assert seen.verdict.value == expected


def test_doctor_tells_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("blocksim.engines.base.find_spec", lambda _name: None)
    remedy = next(each.remedy for each in examine() if each.method == "mujoco")
    assert "mujoco-core" in remedy
    with pytest.raises(MissingPart, match="pip install"):
        get_engine("mujoco")


def test_where_friction_allows_both_it_keeps_the_forces_it_is_given() -> None:
    """Begun from blocks that fall, it slides up to 5 % above the limit, and rests at 10 %.

    Where both are possible the last bit of the thickness decides what MuJoCo finds.
    """
    ratios = (1.01, 1.02, 1.03, 1.05, 1.1)
    seen = [hold(problem_at(each, 155, 4.0, 9), "mujoco").onset for each in ratios]
    assert {each.verdict for each in seen} == {Verdict.STANDS}
    assert any(each.may_slide for each in seen)


@pytest.mark.parametrize(
    ("name", "number", "inside", "outside"),
    [
        ("compas_cra_A", 1, "stands", "collapses"),
        ("compas_cra_shelf", 0, "stands", ""),
        pytest.param("compas_cra_shelf", 1, "stands", "collapses", marks=pytest.mark.long),
        ("grid_wall_6", 0, "stands", "collapses"),
        pytest.param("ferris_tinloi_4", 0, "stands", "collapses", marks=pytest.mark.long),
    ],
)
def test_what_slides_from_nothing_is_begun_with_forces(
    name: str, number: int, inside: str, outside: str
) -> None:
    """Values of the literature: a block between two walls, a shelf on its brackets, walls."""
    line = answered(name, list(questions(name))[number], moving=False, engine="mujoco")
    assert (line["inside"], line["outside"]) == (inside, outside)


def test_let_go_it_keeps_the_forces_it_is_given() -> None:
    """A block that hangs between two walls by friction, 1 % more than it takes."""
    question = list(questions("compas_cra_A"))[1]
    seen = observe(question.at(1.01 * question.expected), "mujoco")
    assert seen.verdict is Verdict.STANDS
    assert seen.onset.may_slide


@pytest.mark.parametrize(("ratio", "rests"), [(1.001, True), (0.999, False)])
def test_contacts_press_as_they_are_told_and_prove_it(ratio: float, *, rests: bool) -> None:
    """Forces that balance leave no acceleration; what is nearest to it leaves that it must.

    The latter is the least motion, found without MuJoCo: here nothing slides.
    """
    problem = problem_at(ratio, 90, 0.7, 10)
    world = cast("TakesForces", Simulation.of(problem, "mujoco").world())
    least = least_motion(problem)
    forces = equilibrium(problem).forces if rests else least.forces
    assert forces is not None
    world.begin(forces)
    found = world.hold(1000)
    if rests:
        assert np.abs(found).max() < 1e-7
    else:
        assert found == pytest.approx(least.accelerations, abs=1e-5)
        assert np.abs(found).max() > 2e-4


def test_forces_of_another_structure_are_not_kept() -> None:
    """Those of an arch 1 % above its least thickness, in one 1 % below."""
    stands, falls = (problem_at(ratio, 90, 0.7, 10) for ratio in (1.01, 0.99))
    forces = equilibrium(stands).forces
    assert forces is not None
    world = cast("TakesForces", Simulation.of(falls, "mujoco").world())
    world.begin(forces)
    assert np.abs(world.hold(1000)).max() > 1e-3


@pytest.mark.parametrize("mu", [0.2, 0.7])
def test_a_block_that_slides_is_not_lifted(mu: float) -> None:
    """Closed form: it slows down by mu g, and stays on the floor. MuJoCo's own lifts it."""
    heights: list[float] = []
    for step in (coulomb_step, library.mj_step):
        model = library.MjModel.from_xml_string(
            f"""<mujoco><option gravity="0 -1 0" timestep="5e-4" cone="elliptic"/><worldbody>
            <geom type="plane" size="0 0 1" quat="0.7071067811865476 -0.7071067811865476 0 0"
             friction="{mu}" condim="3" solref="1e-3 1" solimp="0.999 0.999 1 0.5 2"/>
            <body pos="0 0.1 0"><joint type="slide" axis="1 0 0"/>
            <joint type="slide" axis="0 1 0"/><joint type="hinge" axis="0 0 1"/>
            <geom type="box" size="0.5 0.1 0.5" mass="1" condim="3" friction="{mu}"
             solref="1e-3 1" solimp="0.999 0.999 1 0.5 2"/></body></worldbody></mujoco>"""
        )
        state = library.MjData(model)
        for _ in range(200):
            step(model, state)
        state.qvel[0] = 1.0
        rise = 0.0
        for _ in range(200):
            step(model, state)
            rise = max(rise, float(state.qpos[1]))
        heights.append(rise)
        if step is coulomb_step:
            assert state.qvel[0] == pytest.approx(1.0 - mu * 0.1, rel=1e-3)
    assert heights[0] < 1e-6
    assert heights[1] > 1e-5
