"""Cases: each is the factored problem of hand statics, and the one that falls first governs."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from running import inside

from blocksim import (
    Case,
    CircularArch,
    Factors,
    InputError,
    Load,
    Problem,
    Verdict,
    check,
    check_cases,
    structure_of,
)

WIDE, TALL, WEIGHT, ROUGH = 1.0, 3.0, 60_000.0, 0.5


def column(push: float, **more: Any) -> dict[str, Any]:
    """One block on the ground, pushed to the right at its top [N]."""
    return {
        "friction": ROUGH,
        "blocks": [
            {"id": "ground", "vertices": [[-3, -1], [3, -1], [3, 0], [-3, 0]], "fixed": True},
            {"id": "c", "vertices": [[0, 0], [WIDE, 0], [WIDE, TALL], [0, TALL]],
             "weight": WEIGHT},
        ],
        "live": [{"block": "c", "point": [0, TALL], "force": [push, 0]}],
        **more,
    }  # fmt: skip


def pushed(push: float, **more: Any) -> Problem:
    return structure_of(column(push, **more)).with_load(1.0)


factor = st.floats(0.5, 2.0)


@settings(deadline=None, max_examples=12)
@given(permanent=factor, variable=factor, friction=factor, push=st.floats(500, 30_000))
def test_a_pushed_block_uses_what_hand_statics_say(
    permanent: float, variable: float, friction: float, push: float
) -> None:
    """It turns about its toe, or slides: shares of arm and of friction, whichever is more."""
    factors = Factors(permanent=permanent, variable=variable, friction=friction)
    found = check_cases([Case(name="only", problem=pushed(push), factors=factors)])
    down, across = permanent * WEIGHT, variable * push
    turns = across * TALL / (down * WIDE / 2)
    slides = across * friction / (ROUGH * down)
    told = found.governing
    assert told.used == pytest.approx(max(turns, slides), rel=1e-6)
    assert told.reserve == pytest.approx(1 / max(turns, slides), rel=1e-6)
    if abs(max(turns, slides) - 1) > 1e-6:
        falls = max(turns, slides) > 1
        assert told.answer.verdict is (Verdict.COLLAPSES if falls else Verdict.STANDS)


def test_a_joint_crushes_by_the_factored_strength() -> None:
    """A rectangular block of stress on what is left of the base beside the eccentricity."""
    problem = replace(pushed(3_000), strength=200e3)
    factors = Factors(permanent=1.2, variable=1.5, strength=1.5)
    (told,) = check_cases([Case(name="crush", problem=problem, factors=factors)]).answers
    down = 1.2 * WEIGHT
    off = 1.5 * 3_000 * TALL / down
    stress = down / (WIDE - 2 * off)
    assert told.answer.problem.strength == pytest.approx(200e3 / 1.5)
    assert told.used == pytest.approx(stress / (200e3 / 1.5), rel=1e-5)


def test_the_case_that_falls_first_comes_first() -> None:
    pushes = {"light": 1_000.0, "heavy": 9_000.0, "falls": 12_000.0, "worse": 11_000.0}
    cases = [Case(name=name, problem=pushed(push)) for name, push in pushes.items()]
    cases[3] = Case(name="worse", problem=pushed(11_000), factors=Factors(variable=1.2))
    found = check_cases(cases)
    assert [each.case.name for each in found.answers] == ["worse", "falls", "heavy", "light"]
    used = [each.used for each in found.answers]
    assert used == pytest.approx([1.32, 1.2, 0.9, 0.1], rel=1e-6)
    assert found.governing.answer.verdict is Verdict.COLLAPSES


def test_heavier_stone_bears_as_much_more() -> None:
    """Of rigid blocks the load factor grows with all that is permanent, fill as well."""
    arch = CircularArch(span=8.0, rise=3.0, thickness=0.45, voussoirs=15, friction=0.6,
                        density=2.2e4, fill=0.5)  # fmt: skip
    push = Load(force=(0.0, -10e3), blocks=(10,))
    problem = replace(arch.problem(), live=(push,)).with_load(1.0)
    plain = check(problem, method="limit").load_factor
    (told,) = check_cases(
        [Case(name="heavy", problem=problem, factors=Factors(permanent=1.35))]
    ).answers
    assert told.answer.load_factor == pytest.approx(1.35 * plain, rel=1e-7)
    assert any(
        note.startswith("partial factors: permanent") for note in told.answer.problem.notes
    )


def test_friction_of_single_joints_is_factored_too() -> None:
    joints = [{"a": "ground", "b": "c", "friction": 0.2}]
    problem = pushed(1_000, joints=[{**joints[0], "ends": [[0, 0], [WIDE, 0]]}])
    factored = Factors(friction=1.25).on(problem)
    assert factored.friction.tolist() == pytest.approx([0.16])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "column.json").write_text(json.dumps(column(5_000)))
    return tmp_path


CASES = """
title = "Column"
factors = { friction = 1.25 }
[[case]]
name = "wind"
factors = { permanent = 0.9, variable = 1.5 }
load = 1.0
[[case]]
name = "crane"
live = [{ block = "c", point = [0, 1.5], force = [4000, 0] }]
dead = [{ block = "c", point = [0.5, 3.0], force = [0, -20000] }]
factors = { friction = 1.0 }
[[case]]
name = "table"
tilt = 4.0
load = 0.0
"""


def test_a_file_of_cases_is_one_table_one_page_and_json(folder: Path) -> None:
    path, subject = folder / "cases.toml", str(folder / "column.json")
    path.write_text(CASES)
    done = inside("check", subject, "--cases", str(path), "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    wind = 1.5 * 5_000 * TALL / (0.9 * WEIGHT * WIDE / 2)
    crane = 4_000 * 1.5 / ((WEIGHT + 20_000) * WIDE / 2)
    # On a table that tilts, weight turns about the toe, and slides.
    table = max(math.tan(math.radians(4)) * TALL / WIDE,
                math.tan(math.radians(4)) * 1.25 / ROUGH)  # fmt: skip
    expected = {"wind": wind, "table": table, "crane": crane}
    assert {each["name"]: each["used"] for each in told["cases"]} == pytest.approx(expected)
    order = sorted(expected, key=lambda name: -expected[name])
    assert [each["name"] for each in told["cases"]] == order
    assert told["governing"] == "wind"
    said = inside("check", subject, "--cases", str(path)).stdout.splitlines()
    assert said[0].startswith("STANDS  (governed by wind, of 3 cases")
    assert said[2].split()[:1] == [f"{wind:.1%}"]
    page = folder / "page.html"
    assert inside("report", subject, "--cases", str(path), "--out", str(page)).returncode == 0
    text = page.read_text(encoding="utf-8")
    assert text.index("wind (permanent 0.9, variable 1.5, friction 1.25)") < text.index(
        "crane ("
    )
    assert "Verdict of the case: wind" in text


def test_no_case_at_all_is_refused() -> None:
    with pytest.raises(InputError, match="at least one"):
        check_cases([])
