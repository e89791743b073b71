"""Structures on the command line: asked, bracketed, let go, and refused in one line."""

import math
from pathlib import Path

import numpy as np
import pytest
from drawn import written
from running import answered, ran

from blocksim import load_recording

STACK = {
    "title": "Three blocks",
    "friction": 0.6,
    "blocks": [
        {"id": "floor", "vertices": [[-2, -1], [4, -1], [4, 0], [-2, 0]], "fixed": True},
        {"id": "low", "vertices": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]},
        {"id": "middle", "vertices": [[0.2, 0.5], [1.2, 0.5], [1.2, 1], [0.2, 1]]},
        {"id": "top", "vertices": [[0.4, 1], [1.4, 1], [1.4, 1.5], [0.4, 1.5]]},
    ],
    "live": [{"body": [1, 0]}],
}
"""Topples about the corner at x = 1: weights at 0.5, 0.7, 0.9 m, heights 0.25 to 1.25 m."""
FACTOR = (0.5 + 0.3 + 0.1) / (0.25 + 0.75 + 1.25)


@pytest.fixture
def stack(tmp_path: Path) -> str:
    path = written(tmp_path / "stack.json", STACK)
    return str(path)


def test_a_stack_is_checked_with_its_load_factor(stack: str) -> None:
    answer = answered("check", stack)
    assert answer["verdict"] == "stands"
    assert answer["load_factor"] == pytest.approx(FACTOR, rel=1e-9)
    assert answer["problem"]["blocks"] == 3
    assert answer["problem"]["mu"] == 0.6
    assert answer["mechanism"] is None
    base = answer["joints"][0]
    assert {base["a"], base["b"]} == {"floor", "low"}
    # Nothing pushes it sideways, and the base carries all three weights.
    assert base["normal_force"] == pytest.approx(1.5, rel=1e-9)
    assert base["friction_force"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", ["limit", "direct"])
@pytest.mark.parametrize(("share", "code"), [(0.999, 0), (1.001, 1)])
def test_both_sides_of_its_load_factor(
    stack: str, method: str, share: float, code: int
) -> None:
    answer = answered("check", stack, "--load", share * FACTOR, "--method", method, code=code)
    states = [joint["state"] for joint in answer["joints"]]
    if code:
        # All three turn as one about the lower right corner.
        assert states.count("closed") == 2
        assert sum(state.startswith("hinge") for state in states) == 1
        assert all(each["rotation"] < 0 for each in answer["mechanism"])
    else:
        assert set(states) == {"closed"}


@pytest.mark.parametrize(
    ("over", "given", "exact", "stands"),
    [
        ("load", (), FACTOR, "low"),
        ("tilt", ("--load", "0"), math.degrees(math.atan(FACTOR)), "low"),
        ("mu", ("--load", "0.2"), 0.2, "high"),
    ],
)
def test_brackets_over_load_tilt_and_friction(
    stack: str, over: str, given: tuple[str, ...], exact: float, stands: str
) -> None:
    answer = answered("bracket", stack, "--over", over, *given)
    assert answer["limit"] == pytest.approx(exact, rel=1e-7)
    assert answer["low"] < exact < answer["high"]
    assert answer["stands"] == stands
    assert answer["confirmed"] is True


@pytest.mark.parametrize("method", ["direct", "pymunk"])
@pytest.mark.parametrize(
    ("over", "within", "ends"),
    [
        ("load", (0, 1e-9), {"low": 1e-9, "high": None}),
        ("load", (0.1, 0.2), {"low": 0.2, "high": None}),
        ("load", (0.5, 0.9), {"low": None, "high": 0.5}),
        ("mu", (0.03, 0.07), {"low": 0.07, "high": None}),
        ("mu", (0.3, 0.7), {"low": None, "high": 0.3}),
    ],
)
def test_no_answer_is_beyond_the_range_given(
    stack: str, method: str, over: str, within: tuple[float, float], ends: dict[str, float]
) -> None:
    """It changes at 0.4, over friction at 0.2 under half of that load."""
    load = ("--load", "0.2") if over == "mu" else ()
    words = ["--over", over, "--within", *map(str, within), "--method", method, *load]
    answer = answered("bracket", stack, *words)
    assert {end: answer[end] for end in ends} == ends


def test_a_structure_is_let_go_and_read_back(stack: str, tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    ran("simulate", stack, "--tilt", "25", "--seconds", "0.3", "--out", out)
    found = load_recording(out)
    assert found.problem.title == "Three blocks"
    assert len(found.assembly.blocks) == 3
    assert found.problem.gravity == pytest.approx(
        [math.sin(math.radians(25)), -math.cos(math.radians(25)), 0.0]
    )
    # Table tilted to the right: the stack topples to the right, as one.
    turns = found.poses[-1, :, 2]
    assert (turns < 0).all()
    assert np.ptp(turns) < 1e-3 * abs(turns.min())


def test_least_friction_of_a_wedge_beside_a_block_on_a_slope(tmp_path: Path) -> None:
    """A plug in a gap that widens by 10 deg to each side downwards is held from tan 10 deg on.

    There the margin jumps to that of the other block, on a slope of 5 deg, and grows with it.
    """
    wide, rise = math.tan(math.radians(10)), math.tan(math.radians(5))
    left = [[-3, 0], [-0.5 - wide, 0], [-0.5, 1], [-3, 1]]
    blocks = [
        {"id": "left", "vertices": left, "fixed": True},
        {"id": "right", "vertices": [[-x, y] for x, y in left], "fixed": True},
        {"id": "plug", "vertices": [[-0.5 - wide, 0], [0.5 + wide, 0], [0.5, 1], [-0.5, 1]]},
        {"id": "slope", "vertices": [[9, -1], [11, -1], [11, 2 * rise], [9, 0]], "fixed": True},
        {"id": "rider", "vertices": [[9.5, 0.5 * rise], [10.5, 1.5 * rise], [10.5, 1]]},
    ]
    path = written(tmp_path / "wedge.json", {"friction": 0.9, "blocks": blocks})
    answer = answered("bracket", path, "--over", "mu")
    assert answer["limit"] == pytest.approx(wide, rel=1e-8)
    assert answer["low"] < wide < answer["high"]


@pytest.mark.parametrize(
    ("options", "alike"),
    [
        (["--alpha", "90", "--eta", "0.1"], ["half_angle_deg=90", "eta=0.1"]),
        (
            ["--span", "8", "--rise", "3", "--thickness", "0.4"],
            ["span=8", "rise=3", "thickness=0.4"],
        ),
    ],
)
def test_options_of_an_arch_are_parameters_of_its_kind(
    options: list[str], alike: list[str]
) -> None:
    by_name = [word for each in alike for word in ("--with", each)]
    ours, theirs = (
        answered("check", "circular-arch", "--mu", "0.7", *asked, code=None)
        for asked in (options, by_name)
    )
    for name in ("verdict", "arch", "joints"):
        assert ours[name] == theirs[name]
