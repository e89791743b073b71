"""Verdicts of limit analysis at any ratio of sizes and weights, and rounding; their proofs."""

import copy
import json
import math
import re
import subprocess
import sys
import warnings
from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import box, bricks, rounded
from hypothesis import given, settings
from hypothesis import strategies as st
from running import PROGRAM, answered, ran, refused
from space_cases import NAMES as IN_SPACE
from space_cases import asked as known_in_space
from structure_cases import some_of

from analysis import random_proofs, random_space
from blocksim import (
    Arch,
    CircularArch,
    Problem,
    Verdict,
    bracket,
    check,
    collapse,
    structure_of,
)
from blocksim import verify as verify_module
from blocksim.limit.proof import proof_record
from blocksim.verify import checked, seal, verify
from tests.random_problems import Case, drawn

Table = dict[str, Any]
BED = {"id": "bed", "fixed": True, "vertices": [[6, -1], [9, -1], [9, 0], [6, 0]]}


def on_a_ramp(size: float, rise: float, friction: float, weight: float | None = None) -> Table:
    """A square block on a ramp of 1 : 1 / rise, beside one of 1 m on level ground."""
    along = np.array([1, rise]) / math.hypot(1, rise)
    across = np.array([-along[1], along[0]])
    foot = np.array([1, rise])
    corners = [foot, foot + size * along, foot + size * (along + across), foot + size * across]
    pebble: Table = {"id": "pebble", "vertices": [each.tolist() for each in corners]}
    large: Table = box("large", 7, 0, 8, 1)
    if weight is not None:
        pebble["weight"], large["weight"] = weight, 1.0
    ramp = {"id": "ramp", "fixed": True, "vertices": [[0, 0], [4, 0], [4, 4 * rise]]}
    return {
        "friction": friction,
        "blocks": [ramp, pebble, BED, large],
        "joints": [
            {"a": "ramp", "b": "pebble", "ends": [each.tolist() for each in corners[:2]]},
            {"a": "bed", "b": "large", "ends": [[7, 0], [8, 0]]},
        ],
    }


def verdict(table: Table) -> Verdict:
    return check(structure_of(table), method="limit").verdict


@pytest.mark.parametrize("size", [1.0, 1e-2, 1e-3, 1e-4, 1e-5])
def test_a_pebble_on_a_ramp_needs_the_same_friction_beside_any_block(size: float) -> None:
    found = bracket(structure_of(on_a_ramp(size, 0.5, 0.5)), over="mu", method="limit")
    assert found.limit == pytest.approx(0.5, rel=1e-9)
    assert found.confirmed
    for aside in (-1e-6, 1e-6):
        assert verdict(on_a_ramp(size, 0.5, 0.5 * (1 + aside))) == (
            Verdict.STANDS if aside > 0 else Verdict.COLLAPSES
        )


@pytest.mark.parametrize("weight", [1e-6, 1e-9, 1e-12])
def test_a_light_block_slides_beside_a_heavy_one(weight: float) -> None:
    assert verdict(on_a_ramp(1.0, 1.0, 0.5, weight)) == Verdict.COLLAPSES
    assert verdict(on_a_ramp(1.0, 1.0, 1.1, weight)) == Verdict.STANDS


@given(st.floats(-4.5, 0.0), st.sampled_from([-0.05, -1e-6, 1e-6, 0.05]), st.floats(0.5, 2.0))
def test_a_pebble_overhangs_by_half_its_width(size: float, aside: float, height: float) -> None:
    """On the edge of a block of 1 m; it tips beyond the middle of its base."""
    width = 10**size
    out = width * (0.5 + aside)
    bed = {"id": "bed", "fixed": True, "vertices": [[-1, -1], [2, -1], [2, 0], [-1, 0]]}
    pebble = box("pebble", 1 - width + out, 1, 1 + out, 1 + width * height)
    table = {
        "friction": 0.5,
        "blocks": [bed, box("large", 0, 0, 1, 1), pebble],
        "joints": [
            {"a": "bed", "b": "large", "ends": [[0, 0], [1, 0]]},
            {"a": "large", "b": "pebble", "ends": [[1 - width + out, 1], [1, 1]]},
        ],
    }
    assert verdict(table) == (Verdict.COLLAPSES if aside > 0 else Verdict.STANDS)


@given(
    st.lists(st.floats(-1.5, 1.5), min_size=2, max_size=6),
    st.sampled_from([-1e-6, 1e-6]),
    st.floats(0.1, 2.0),
)
def test_a_column_of_unlike_drums_tips_where_it_must(
    sizes: list[float], aside: float, slender: float
) -> None:
    """Square drums 30 times smaller to 30 times larger than 1 m, one upon the other."""
    blocks: list[Table] = [
        {"id": "bed", "fixed": True, "vertices": [[-99, -9], [99, -9], [99, 0], [-99, 0]]}
    ]
    joints: list[Table] = []
    low, last, least = 0.0, math.inf, math.inf
    widths = [10**each for each in sizes]
    heights = [width * slender for width in widths]
    for at, (width, height) in enumerate(zip(widths, heights, strict=True)):
        blocks.append(box(str(at), -width / 2, low, width / 2, low + height))
        half = min(width, last) / 2
        joints.append(
            {
                "a": "bed" if at == 0 else str(at - 1),
                "b": str(at),
                "ends": [[-half, low], [half, low]],
            }
        )
        above = [
            (widths[k] * heights[k], sum(heights[at:k]) + heights[k] / 2)
            for k in range(at, len(widths))
        ]
        arm = sum(w * y for w, y in above) / sum(w for w, _ in above)
        least = min(least, half / arm)
        low, last = low + height, width
    table = {"friction": "inf", "blocks": blocks, "joints": joints}
    tilted = structure_of(table).tilted(math.atan(least * (1 + aside)))
    found = check(tilted, method="limit").verdict
    assert found == (Verdict.COLLAPSES if aside > 0 else Verdict.STANDS)


@pytest.mark.parametrize("wall", some_of(product((4, 5, 6), (8, 9, 10)), every=4))
def test_walls_of_rounded_corners_are_answered(wall: tuple[int, int]) -> None:
    """All that is told of them, too. As for any rounding the friction has to be tan 10 deg."""
    courses, decimals = wall
    table = rounded(bricks(courses, 6, 1.0, 0.5), 10, decimals, 0.7)
    found = check(structure_of(table), method="limit")
    assert found.verdict is Verdict.STANDS
    carried = found.carried
    # Half a brick overhangs at the ends of each other course: the least strength is of tipping.
    assert 0.2 < carried.strength_used < 1


@pytest.mark.parametrize("degrees", [20, 90, 150])
@pytest.mark.parametrize("eta", [0.05, 0.5])
def test_three_voussoirs_without_bound_on_friction(degrees: float, eta: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        arch = Arch(half_angle=math.radians(degrees), eta=eta, voussoirs=3)
        found = check(CircularArch.of(arch, friction=math.inf), method="limit")
        assert found.verdict is Verdict.STANDS
        assert found.carried.strength_used == 0
        assert found.carried.resultants is not None


def proof_of(problem: Problem[Any]) -> Table:
    """The file that `check --proof` writes."""
    found = check(problem, method="limit")
    assert found.proof is not None
    assert found.proved
    return json.loads(json.dumps(proof_record(found.proof)))


def proofs() -> Iterator[Table]:
    """Of arches, walls, kinds, corners and loads; half of them of collapse."""
    for mu in (0.7, math.inf):
        for eta in (0.09, 0.15):
            yield proof_of(
                CircularArch.of(
                    Arch(half_angle=math.pi / 2, eta=eta, voussoirs=7), mu
                ).problem()
            )
    wall = structure_of(rounded(bricks(2, 2, 1.0, 0.5), 10, 8))
    for tilt in (0, 50):
        yield proof_of(wall.tilted(math.radians(tilt)))
    for friction in (0.2, 0.6):
        yield proof_of(structure_of(on_a_ramp(1e-3, 0.5, friction)))
    for index in range(20, 30):
        yield proof_of(drawn(Case(index, 16)).problem)
    for name in ("dome_8_5_loaded", "arch_15_skew_30_aslant", "tower_102_pushed"):
        for problem, _ in known_in_space(name, 0.01):
            yield proof_of(problem)


@pytest.fixture(scope="module")
def written() -> list[Table]:
    return list(proofs())


def test_proofs_are_accepted(written: list[Table]) -> None:
    claims = {each["claim"] for each in written}
    assert claims == {"stands", "collapses"}
    for table in written:
        assert verify(table).startswith(f"proved: {table['claim']}")


@pytest.mark.parametrize("below", [1e-9, 1e-5, 0.3])
@pytest.mark.parametrize(
    ("half_angle", "mu"), [(75, 0.8), (90, 0.35), (120, 0.9), (75, math.inf)]
)
@pytest.mark.parametrize("voussoirs", [8, 27])
def test_arches_that_fall_are_proved(
    half_angle: float, mu: float, voussoirs: int, below: float
) -> None:
    """By their own mechanism; next to the limit, or without slip, by the general programme."""
    arch = CircularArch(
        half_angle_deg=half_angle, ratio=1 - below, friction=mu, voussoirs=voussoirs
    )
    assert verify(proof_of(arch.problem())).startswith("proved: collapses")


def spoilt(table: Table, random: np.random.Generator) -> Table:
    """Change a force, a rate, a corner, a sign, or leave out a block; sealed anew."""
    made = copy.deepcopy(table)
    problem = made["problem"]
    free = [each for each in problem["blocks"] if not each.get("fixed")]
    joint = problem["joints"][random.integers(len(problem["joints"]))]
    what = random.choice(["value", "sign", "corner", "block", "joint"])
    if what == "corner":
        points = joint["points" if "points" in joint else "ends"]
        end = points[random.integers(len(points))]
        end[random.integers(len(end))] += 10.0 ** random.uniform(-1, 1)
    elif what == "block":
        problem["blocks"].remove(free[random.integers(len(free))])
    elif what == "joint":
        problem["joints"].remove(joint)
    elif made["claim"] == "collapses":
        # All of them the other way, or none.
        times = -1 if what == "sign" else 0
        made["rates"] = {
            name: [[str(times * Fraction(each)) for each in half] for half in rate]
            for name, rate in made["rates"].items()
        }
    else:
        pressed = [end for joint in made["forces"] for end in joint if {*end} != {"0"}]
        end = pressed[random.integers(len(pressed))]
        at = random.choice([at for at, part in enumerate(end) if part != "0"])
        share = -1 if what == "sign" else 1 + Fraction(1, 10**6)
        end[at] = str(share * Fraction(end[at]))
    if made["claim"] == "collapses" and what in {"corner", "joint"}:
        # It may be a proof of the other problem: the seal tells that it is not the same.
        return made
    return {**made, "sha256": seal(made)}


@pytest.mark.parametrize("count", [100, pytest.param(1000, marks=pytest.mark.long)])
def test_spoilt_proofs_are_refused(written: list[Table], count: int) -> None:
    """As if somebody had sealed them."""
    random = np.random.default_rng(35)
    for at in range(count):
        with pytest.raises(ValueError, match="not proved"):
            checked(json.dumps(spoilt(written[at % len(written)], random)))


def unlawful(table: Table) -> Iterator[Table]:
    """Change the law of joints alone: forces balance as before, motions do the same work."""
    stands = table["claim"] == "stands"
    less = copy.deepcopy(table)
    for each in (less["problem"], *less["problem"]["joints"]):
        if "friction" in each:
            # Where something slides; without, what hinges is as good a proof.
            each["friction"] = 0 if stands else "inf"
    yield less
    turned = copy.deepcopy(table)
    for at, joint in enumerate(turned["problem"]["joints"]):
        if "normal" in joint:
            joint["normal"] = [-each for each in joint["normal"]]
        else:
            joint["ends"].reverse()
            if stands:
                turned["forces"][at].reverse()
    yield turned


def objection(table: Table) -> str:
    """Seal a table anew, and return why it is refused; nothing where it is not."""
    try:
        verify({**table, "sha256": seal(table)})
    except ValueError as error:
        return str(error)
    return ""


def test_a_proof_needs_the_law_of_each_joint(written: list[Table]) -> None:
    """Friction that is not there, and joints that would pull: nothing but the law says no."""
    said = [[objection(each) for each in unlawful(table)] for table in written]
    rubs, pulls = zip(*said, strict=True)
    assert all("it pulls, closes, or" in each for each in pulls)
    assert all("exceeds friction" in each for each in rubs if each)
    assert sum(map(bool, rubs)) > len(written) / 2


# Of blocks of very unlike weights, held shut or by corners: nine of 17 of 10,000 problems that
# doubles could not prove.
RATIONAL = (1238, 2098, 3151, 4653, 4991, 5198, 6614, 7055, 8158)


@pytest.mark.parametrize("index", [*range(15), *RATIONAL])
def test_verdicts_at_the_edges_are_proved(index: int) -> None:
    """Unlike sizes and weights, rounding, friction of each joint, loads off centre."""
    row = random_proofs.asked(index)
    assert row.verified, row


@pytest.mark.parametrize(
    "index", [5703, 8725, *(pytest.param(each, marks=pytest.mark.long) for each in (417, 2529))]
)
def test_what_rounding_alone_would_hold_is_undecided(index: int) -> None:
    """Forces of 1e13 times the weight would balance: the last digits of corners decide."""
    _, problem = random_proofs.edge(index)
    found = check(problem, method="limit")
    assert found.verdict is Verdict.UNDECIDED
    assert not found.proved
    assert found.reason.startswith("neither that it stands nor that it falls is proved")


@given(st.integers(10**6, 10**9))
@settings(max_examples=10)
def test_no_proof_at_the_edges_is_refused(index: int) -> None:
    """What is not proved is undecided; every proof holds."""
    row = random_proofs.asked(index)
    assert row.verified or row.verdict == "undecided", row


@pytest.mark.parametrize("name", some_of(IN_SPACE))
def test_verdicts_in_space_are_proved(name: str) -> None:
    """Of published cases, 0.1 % to either side of the limit."""
    for problem, verdict in known_in_space(name, 1e-3):
        found = verify(proof_of(problem))
        assert found.startswith(f"proved: {verdict.value}")


def test_one_block_is_not_blocks() -> None:
    """On level ground, by one joint."""
    ((problem, verdict), _) = known_in_space("block_topples_20", 1e-3)
    assert verify(proof_of(problem)) == f"proved: {verdict.value}, 1 block and 1 joint"


@given(st.integers(0, 10**6))
@settings(max_examples=6)
def test_no_proof_in_space_is_refused(seed: int) -> None:
    """Solids cut by planes, stacks that lean, vaults: 1e-5 to either side of the limit.

    Without bound on friction the last digits of corners wedge what falls.
    """
    problem, _, _ = random_space.drawn(seed)
    factor = collapse(problem).load_factor
    known = factor is not None and math.isfinite(factor)
    loads = [factor * (1 + share) for share in (-1e-5, 1e-5)] if known else [0.0]
    for load in loads:
        found = check(problem.with_load(load), method="limit")
        if found.proof is not None:
            assert verify(proof_of(found.problem)).startswith(f"proved: {found.verdict.value}")
        elif found.verdict is not Verdict.UNDECIDED:
            assert found.verdict is Verdict.COLLAPSES
            assert np.isinf(problem.friction).any()


def test_a_proof_in_space_by_command(tmp_path: Path) -> None:
    """Both sides of the tilt at which a tower falls."""
    proof = tmp_path / "proof.json"
    asked = ("bracket", "tower", "--mu", "0.7", "--over", "tilt", "--proof", str(proof))
    assert answered(*asked)["proved"] is True
    assert ran("verify", proof).splitlines() == [
        f"proved: {each}, 6 blocks and 6 joints" for each in ("collapses", "stands")
    ]
    assert structure_of(json.loads(proof.read_text())[0]["problem"]).in_space


def test_the_commands(tmp_path: Path) -> None:
    """A proof is written, checked by the command and by the file alone, refused if spoilt."""
    file, proof = tmp_path / "pebble.json", tmp_path / "proof.json"
    file.write_text(json.dumps(on_a_ramp(1e-3, 0.5, 0.6)))
    assert answered("check", file, "--proof", proof)["proved"] is True
    alone = [sys.executable, "-I", verify_module.__file__, str(proof)]
    for command in ([*PROGRAM, "verify", str(proof)], alone):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.stdout == "proved: stands, 2 blocks and 2 joints\n", done.stderr
    proof.write_text(proof.read_text().replace("pebble", "people"))
    assert "the file was changed" in refused("verify", proof)
    direct = refused("check", file, "--method", "direct", "--proof", proof)
    assert "limit proves" in direct


@pytest.mark.parametrize(
    ("over", "loads"),
    [
        ("tilt", []),
        ("mu", []),
        ("load", [{"force": [1e3, 0], "block": "large", "point": [7, 0.9]}]),
    ],
)
def test_both_sides_of_a_change_are_proved(
    tmp_path: Path, over: str, loads: list[Table]
) -> None:
    file, proof = tmp_path / "pebble.json", tmp_path / "proof.json"
    table = on_a_ramp(1e-3, 0.5, 0.6)
    file.write_text(json.dumps(table | {"live": loads}))
    asked = ("bracket", str(file), "--over", over, "--proof", str(proof))
    assert answered(*asked)["proved"] is True
    claims = [line.split(",")[0] for line in ran("verify", proof).splitlines()]
    assert claims == ["proved: collapses", "proved: stands"]
    falls, stands = json.loads(proof.read_text())
    spoilt_one = {**stands, "problem": falls["problem"]}
    proof.write_text(json.dumps([falls, {**spoilt_one, "sha256": seal(spoilt_one)}]))
    refused("verify", proof)
    proof.write_text("[]")
    refused("verify", proof)


@pytest.mark.parametrize("voussoirs", [7, 27])
def test_both_sides_of_the_least_thickness_are_proved(voussoirs: int) -> None:
    arch = CircularArch(half_angle_deg=90, eta=0.12, friction=0.7, voussoirs=voussoirs)
    found = bracket(arch, method="limit")
    assert [verify(json.loads(json.dumps(proof_record(each)))).split(",")[0]
            for each in found.proofs] == ["proved: collapses", "proved: stands"]  # fmt: skip


def test_the_checker_shares_no_code() -> None:
    source = Path(str(verify_module.__file__)).read_text(encoding="utf-8")
    assert len(source.splitlines()) <= 150
    taken = set(re.findall(r"^(?:from|import) (\w+)", source, re.MULTILINE))
    assert taken - {"__future__"} <= sys.stdlib_module_names


def test_a_file_that_was_changed_is_refused(written: list[Table]) -> None:
    for table in written:
        with pytest.raises(ValueError, match="changed after"):
            verify({**table, "version": "0"})
