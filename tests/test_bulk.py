"""Many structures at once: margins by statics alone, streams, folders, what is broken."""

import json
import math
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from running import answered, inside, ran, refused
from space_cases import box, is_over, problem_of, tower

import blocksim
from blocksim import (
    Case,
    CircularArch,
    Factors,
    InputError,
    Load,
    Problem,
    Solid,
    Verdict,
    check,
    check_cases,
    check_many,
    equilibrium,
    structure_of,
)
from blocksim.ask.bulk import Structure
from blocksim.blocks.road import with_soil
from blocksim.blocks.soil import Soil
from blocksim.cli.app import app
from blocksim.limit.determinate import margin_of_tower, statics_of_stack
from blocksim.limit.exact import Exact
from blocksim.limit.proof import proof_of_parting, proof_record
from blocksim.limit.space import can_rest
from blocksim.verify import verify

FLOOR: dict[str, Any] = {
    "id": "floor",
    "fixed": True,
    "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]],
}
COLUMN = {"kind": "column", "drums": 3, "drum_height": 1, "width": 1, "friction": 1}


def stack(
    widths: list[float], shifts: list[float], mu: float = 0.6, **said: object
) -> dict[str, Any]:
    """Boxes upon each other, each half as high as wide, shifted from the one below."""
    blocks: list[dict[str, Any]] = [FLOOR]
    at, height = 0.0, 0.0
    for index, (width, shift) in enumerate(zip(widths, shifts, strict=True)):
        at += shift
        left, right, top = at - width / 2, at + width / 2, height + width / 2
        corners = [[left, height], [right, height], [right, top], [left, top]]
        blocks.append({"id": index, "vertices": corners})
        height = top
    return {"friction": mu, "density": 2e4, "blocks": blocks, **said}


sizes = st.floats(0.1, 2.0)


@given(
    st.lists(st.tuples(sizes, st.floats(-0.3, 0.3)), min_size=1, max_size=7),
    st.floats(0.02, 3.0),
    st.floats(-0.6, 0.6),
    st.floats(-0.5, 0.5),
)
@settings(max_examples=40)
def test_margin_of_a_stack_is_that_of_the_programme(
    boxes: list[tuple[float, float]], mu: float, tilt: float, push: float
) -> None:
    widths, shifts = [each for each, _ in boxes], [each for _, each in boxes]
    # Each box touches the one below along a part of its face.
    shifts = [
        shift * min(pair)
        for shift, pair in zip(shifts, zip(widths, [9.0, *widths], strict=False), strict=True)
    ]
    loads = [{"body": [0, -1]}, {"block": 0, "force": [push * 1e4, 0]}]
    problem = blocksim.structure_of(stack(widths, shifts, mu, dead=loads)).tilted(tilt)
    found, asked = statics_of_stack(problem), equilibrium(problem)
    if math.isinf(asked.margin):
        assert found.margin < -900
    else:
        assert found.margin == pytest.approx(asked.margin, abs=1e-8, rel=1e-7)
    if -100 < found.margin < -1e-6:
        proof = proof_of_parting(Exact(problem), found.weakest, found.above, found.way)
        assert proof is not None
        assert verify(proof_record(proof)).startswith("proved: collapses")


def test_margins_in_closed_form() -> None:
    # Both ends of a box's face press by half the weight, along two edges of friction each; the
    # unit is twice the weight.
    assert statics_of_stack(blocksim.structure_of(stack([1], [0]))).margin == pytest.approx(
        1 / 8
    )
    # On a slope friction is used by tan(tilt)/mu of it, up to where it slides.
    for slope in (0.1, 0.3, 0.59, 0.61, 0.9):
        low = blocksim.structure_of(stack([1], [0])).tilted(math.atan(slope))
        share = (1 - slope / 0.6) / 2 * math.cos(math.atan(slope)) / 4
        # The centre is a quarter of the width high: it turns at a slope of 2.
        lifts = (1 - slope / 2) / 2 * math.cos(math.atan(slope)) / 4
        assert statics_of_stack(low).margin == pytest.approx(min(share, lifts))
    # A cube each of whose corners presses by its share; on the rim by none.
    ground = Solid(parts=(box((-3, -3, -1), (3, 3, 0)),), fixed=True)
    cube = Solid(parts=(box((0, 0, 0), (1, 1, 1)),))
    assert margin_of_tower(problem_of([ground, cube])) == 1.0
    high = Solid(parts=(box((0.25, 0, 1), (1.25, 1, 2)),))
    # Its weight acts a quarter from the middle of a face 3/4 wide: 2/3 of the way to the rim
    # would leave a third; it is 1/8 off, a third of 3/8.
    assert margin_of_tower(problem_of([ground, cube, high])) == pytest.approx(2 / 3)


@pytest.mark.parametrize("seed", range(12))
def test_towers_stand_where_what_is_above_lies_over_each_face(seed: int) -> None:
    solids = tower(seed, blocks=2 + seed % 4)
    over = is_over(solids)
    problem = problem_of(solids)
    margin = margin_of_tower(problem)
    assert (margin > 0) == over
    assert margin == pytest.approx(can_rest(problem).margin, abs=1e-7)


def test_what_is_no_tower_is_left_to_the_programme() -> None:
    ground = Solid(parts=(box((-3, -3, -1), (3, 3, 0)),), fixed=True)
    legs = [Solid(parts=(box((x, 0, 0), (x + 0.5, 1, 1)),)) for x in (0, 2)]
    beam = Solid(parts=(box((0, 0, 1), (2.5, 1, 1.5)),))
    assert margin_of_tower(problem_of([ground, *legs, beam])) is None
    pushed: Problem[Any] = problem_of([ground, legs[0]]).tilted(0.1)
    assert margin_of_tower(pushed) is None
    wall = blocksim.Wall(
        length=3, courses=3, block_length=1, block_height=0.5, friction=0.6
    ).problem()
    assert statics_of_stack(wall) is None


def test_stacks_that_crush_or_lean_on_soil_are_answered_as_by_check() -> None:
    """By its joints alone the one would stand, and the other be pressed over."""
    column = blocksim.Column(drums=3, drum_height=1, width=1, friction=0.5, density=2e4)
    crushed = replace(column.problem(), strength=0.99 * 3 * 2e4)
    soil = Soil(unit_weight=18e3, height=0.5, pressure=(0.9, 0.0), passive=(0.0, 3.0))
    leaning = with_soil(column.problem(), soil)
    told = [each.verdict for each in check_many([crushed, leaning], workers=1)]
    assert told == ["collapses", "stands"]
    asked = [blocksim.check(each, method="limit") for each in (crushed, leaning)]
    assert told == [each.verdict for each in asked]


def test_each_has_its_answer_in_order_and_what_is_broken_is_one() -> None:
    fine = stack([1, 1], [0, 0.2])
    given: list[Structure] = [
        fine, json.dumps(stack([1, 1], [0, 0.6])), "{", b"\xff", "[1]", "{}", "[" * 100_000,
        '{"friction": 0.5, "friction": 0.5}', json.dumps({**fine, "friction": -1}),
        COLUMN, Path("/nowhere.json"),
        blocksim.structure_of(fine),
    ]  # fmt: skip
    told = list(blocksim.check_many(given, workers=1))
    assert len(told) == len(given)
    assert [each.verdict for each in told] == [
        "stands", "collapses", *[None] * 7, "stands", None, "stands"
    ]  # fmt: skip
    for each in told:
        assert (each.error is None) == (each.verdict is not None)
        assert "\n" not in (each.error or "")
    assert told[0].margin == told[-1].margin


def test_the_same_as_the_ordinary_check() -> None:
    draw = np.random.default_rng(7)

    def drawn(low: float, high: float, count: int) -> list[float]:
        return [float(draw.uniform(low, high)) for _ in range(count)]

    made = [stack(drawn(0.4, 1.2, n), drawn(-0.3, 0.3, n)) for n in (2, 3, 4, 5, 6, 7) * 3]
    for table, told in zip(made, check_many(made, workers=1), strict=True):
        usual = blocksim.check(blocksim.structure_of(table), method="limit")
        assert told.verdict == usual.verdict.value
        assert told.proved
        assert usual.proved
        assert told.margin == pytest.approx(usual.static.margin, abs=1e-9)


class _Ends(dict[str, object]):
    """Ends the process that reads it."""

    def __reduce__(self) -> tuple[object, ...]:
        return os._exit, (1,)


@pytest.mark.long
def test_a_structure_that_ends_its_process_is_told_and_the_others_are_answered() -> None:
    fine = stack([1, 1], [0, 0.2])
    given: list[Structure] = [*[fine] * 60, _Ends(fine), *[fine] * 20]
    told = list(check_many(given, workers=2))
    assert [each.verdict for each in told] == [*["stands"] * 60, None, *["stands"] * 20]
    assert "died" in (told[60].error or "")


def test_a_stream_and_a_folder_are_answered_by_line_and_by_file(tmp_path: Path) -> None:
    fine, falls = stack([1, 1], [0, 0.2]), stack([1, 1], [0, 0.6])
    lines = [json.dumps(fine), "{", "", json.dumps(falls)]
    done = CliRunner().invoke(app, ["check", "-"], input="\n".join(lines))
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [each["line"] for each in told] == [1, 2, 3, 4]
    assert [each.get("verdict") for each in told] == ["stands", None, None, "collapses"]
    assert done.exit_code == 0
    (tmp_path / "a.json").write_text(json.dumps(fine))
    (tmp_path / "b.json").write_text("{")
    (tmp_path / "notes.md").write_text("no structure")
    done = CliRunner().invoke(app, ["check", str(tmp_path)])
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [each["file"] for each in told] == ["a.json", "b.json"]
    assert told[0]["margin"] > 0
    assert told[0]["proved"] is True
    assert "error" in told[1]
    # A coefficient is for those without one; what is for one structure is refused.
    del fine["friction"]
    done = CliRunner().invoke(app, ["check", "-", "--mu", "0.6"], input=json.dumps(fine))
    assert json.loads(done.stdout)["verdict"] == "stands"
    for option in (["--tilt", "3"], ["--method", "direct"], ["--must-rest"], ["--eta", "0.2"]):
        done = CliRunner().invoke(app, ["check", "-", *option], input=json.dumps(fine))
        assert isinstance(done.exception, blocksim.InputError)


BOX = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def test_meshes_of_a_folder_have_a_unit_and_a_tolerance(tmp_path: Path) -> None:
    """It was asked for by each file, and refused where it was given."""
    for name, aside in (("a.obj", 400), ("b.obj", 600)):
        lines: list[str] = []
        for at, (who, shift) in enumerate((("floor", 0), ("low", 0), ("high", aside))):
            # Each 2 mm above the one below.
            lines.append(f"o {who}")
            lines += [
                f"v {1000 * x + shift} {1000 * y} {1000 * z + 1002 * at}" for x, y, z in BOX
            ]
            lines += ["f " + " ".join(str(8 * at + k) for k in side) for side in SIDES]
        (tmp_path / name).write_text("\n".join(lines))
    asked = ("check", str(tmp_path), "--mu", "0.6", "--unit", "mm", "--layer", "supports=floor")
    told = [json.loads(line) for line in ran(*asked, "--tolerance", "0.005").splitlines()]
    assert [each["verdict"] for each in told] == ["stands", "collapses"]
    for line in ran(*asked).splitlines():
        assert "touches nothing" in json.loads(line)["error"]
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "d.json").write_text(json.dumps(stack([1], [0])))
    assert "--unit" in refused("check", tmp_path / "c", "--unit", "mm")


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


@settings(max_examples=12)
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
    told = answered("check", subject, "--cases", path)
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
    said = inside("check", subject, "--cases", path).stdout.splitlines()
    assert said[0].startswith("STANDS  (governed by wind, of 3 cases")
    assert said[2].split()[:1] == [f"{wind:.1%}"]
    page = folder / "page.html"
    ran("report", subject, "--cases", path, "--out", page)
    text = page.read_text(encoding="utf-8")
    assert text.index("wind (permanent 0.9, variable 1.5, friction 1.25)") < text.index(
        "crane ("
    )
    assert "Verdict of the case: wind" in text


SPATIAL = """
[[case]]
name = "upright"
[[case]]
name = "pushed"
push = 0.1
"""


def test_no_case_governs_where_none_tells_how_near_it_is_to_falling(tmp_path: Path) -> None:
    """In space there is neither a share that is used nor a thrust; one that falls governs."""
    path = tmp_path / "cases.toml"
    path.write_text(SPATIAL)
    said = ran("check", "tower", "--mu", "0.7", "--cases", path)
    assert said.startswith("STANDS  (none of 2 cases is known to be nearest to falling, ")
    assert len(said.splitlines()) == 4
    path.write_text(SPATIAL.replace("0.1", "0.5"))
    said = ran("check", "tower", "--mu", "0.7", "--cases", path, code=1)
    assert said.startswith("COLLAPSES  (governed by pushed, of 2 cases, ")


def test_no_case_at_all_is_refused() -> None:
    with pytest.raises(InputError, match="at least one"):
        check_cases([])
