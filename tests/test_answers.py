"""Answers as JSON: the same keys for every subject, as the published schema says."""

import json
import math
import re
import runpy
from pathlib import Path
from typing import Any

import pytest
from arches import least
from hypothesis import assume, given
from hypothesis import strategies as st
from running import answered, inside

from blocksim import Arch, CircularArch, JointState, Mode, Verdict, bracket, check, simulate

DOCS = Path(__file__).parent.parent / "docs"
GLOSSARY = (DOCS / "glossary.md").read_text(encoding="utf-8")
OF_THE_ANSWER = {
    "version", "method", "problem", "title", "runs", "undecided", "confirmed", "splits", "tol",
    "simulated_s", "state_hash", "wall_s", "over", "unit", "low", "high", "limit", "stands",
    "events", "intervals", "falls", "proved", "evidence", "test", "found", "arch", "x", "y",
    "rotation", "block", "angle_deg", "what", "value",
}  # fmt: skip
"""What tells of the asking, not of the structure; coordinates."""
PLACE = DOCS / "schema" / "answers.json"
SCHEMA = json.loads(PLACE.read_text(encoding="utf-8"))
TYPES: dict[str, tuple[type, ...]] = {
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
    "null": (type(None),),
    "object": (dict,),
    "array": (list,),
}
ARCH = "--alpha 90 --eta 0.12 --mu 0.7"
PULSE = "--shake half-sine --amplitude 0.3 --duration 0.2 --method pymunk"
CHECKS = (
    f"{ARCH} --method theory",
    f"{ARCH} --method limit --must-rest --voussoirs 5",
    "--alpha 90 --eta 0.1 --mu 0.7 --method direct",
    "--span 8 --rise 3 --thickness 0.45 --mu inf",
    f"{ARCH} --lean 3 --method pybullet --voussoirs 5",
    f"{ARCH} --tilt 20",
    f"{ARCH} --fill 0.3 --point-load 0.2 1",
    "portal --mu 0.6 --unit-weight 20 --fill 0.4 --point-load 0.3 5",
    "pointed-arch --mu 0.7 --tilt 4",
    "oppenheim_7 --load 0.4 --method direct",
    f"column --mu 0.7 {PULSE}",
    "tower --mu 0.7 --with blocks=2",
)
BRACKETS = (
    "--alpha 90 --mu 0.7 --method theory",
    "--alpha 90 --mu 0.3",
    "--span 8 --rise 3 --mu 0.7 --method direct --tol 0.01",
    f"{ARCH} --over tilt",
    f"{ARCH} --over mu",
    "pointed-arch --mu 0.7",
    "pointed-arch --mu 0.7 --over tilt --method direct",
    "oppenheim_7 --over load",
    "spread_90_12_20 --over spread",
    "tower --mu 0.7 --with blocks=2 --over offset",
)


def wrong(value: Any, schema: dict[str, Any], where: str = "$") -> list[str]:
    """What of a value is not as a schema says, for the words of JSON Schema it uses."""
    if "$ref" in schema:
        return wrong(value, SCHEMA["$defs"][schema["$ref"].removeprefix("#/$defs/")], where)
    if "anyOf" in schema:
        found = [wrong(value, each, where) for each in schema["anyOf"]]
        return min(found, key=len)
    if "enum" in schema:
        return [] if value in schema["enum"] else [f"{where}: {value!r}"]
    kind = schema["type"]
    if not isinstance(value, TYPES[kind]) or (isinstance(value, bool) and kind != "boolean"):
        return [f"{where}: {value!r} is no {kind}"]
    if kind == "array":
        pairs = enumerate(value)
        return [
            each for k, item in pairs for each in wrong(item, schema["items"], f"{where}.{k}")
        ]
    if kind != "object" or "properties" not in schema:
        return []
    known = schema["properties"]
    keys = [f"{where}: {key}" for key in known.keys() ^ value.keys()]
    both = known.keys() & value.keys()
    return keys + [each for k in both for each in wrong(value[k], known[k], f"{where}.{k}")]


def told(key: str) -> bool:
    """Whether a key stands in the last column of the glossary, `...` for ends of a bracket."""
    ends = re.sub(r"_(low|high|limit|theory)(?=_|$)", "_...", key)
    return f"`{key}`" in GLOSSARY or f"`{ends}`" in GLOSSARY


def keys(record: Any) -> set[str]:
    """All keys of a record, those of its parts included."""
    if isinstance(record, list):
        return set().union(*(keys(each) for each in record)) if record else set()
    if not isinstance(record, dict):
        return set()
    return set(record) | keys(list(record.values()))


def test_the_published_schema_is_that_of_the_code() -> None:
    assert runpy.run_path(str(DOCS / "schema.py"))["text"]() == PLACE.read_text("utf-8")


def test_what_is_not_as_the_schema_says_is_seen() -> None:
    answer = answered("check", *ARCH.split())
    check = SCHEMA["$defs"]["Check"]
    assert wrong(answer, check) == []
    joint = {**answer["joints"][0], "ends": [["left", 0.0]]}
    for change in (
        {"verdict": "falls"},
        {"wall_s": None},
        {"more": 1},
        {"joints": [joint]},
        {"arch": {**answer["arch"], "eta": True}},
    ):
        assert len(wrong({**answer, **change}, check)) == 1


@pytest.mark.parametrize(
    ("command", "asked"),
    [("check", each) for each in CHECKS] + [("bracket", each) for each in BRACKETS],
)
def test_answers_of_all_subjects_have_the_same_keys(command: str, asked: str) -> None:
    done = inside(command, *asked.split(), "--json")
    assert done.returncode in {0, 1, 3}, done.stderr
    record = json.loads(done.stdout, parse_constant=pytest.fail)
    assert wrong(record, SCHEMA["$defs"][command.capitalize()]) == []
    assert [each["found"] for each in record["evidence"]]
    # What is told of a symmetric circular arch is told of it under its own weight alone.
    besides = {"--tilt", "--fill", "--over", "--lean"}
    assert (record["arch"] is not None) == (
        asked.startswith("--") and not besides & {*asked.split()}
    )
    # Every quantity is a word of the glossary, but for those of a motion of the ground.
    if "--shake" not in asked:
        assert [key for key in keys(record) - OF_THE_ANSWER if not told(key)] == []


def test_there_are_the_words_of_an_engineer() -> None:
    rows = re.findall(r"^\| ([^|]+?) \|", GLOSSARY, flags=re.MULTILINE)
    words = [word for word in rows if word not in {"word", "---"}]
    assert len(words) == len(set(words)) >= 33


def test_the_sketch_has_the_words_of_what_is_built() -> None:
    drawn = (DOCS / "sketch.svg").read_text(encoding="utf-8")
    shown = [" ".join(text.split()) for text in re.findall(r">([^<>]+)</text>", drawn)]
    for word in (
        "crown", "extrados", "intrados", "centreline", "voussoir", "joint", "springing",
        "support", "span", "rise", "thickness t", "radius r", "half-angle alpha",
        "line of thrust",
    ):  # fmt: skip
        assert shown.count(word) == 1, word


@given(
    st.floats(20, 155),
    st.floats(0.2, 5.0),
    st.integers(4, 50),
    st.sampled_from(["centreline", "sector"]),
    st.sampled_from(["theory", "limit"]),
    st.sampled_from([0.5, 0.99, 1 - 1e-9, 1 + 1e-9, 1.01, 1.5]),
)
def test_static_methods_on_both_sides(
    degrees: float, mu: float, count: int, weight: str, method: str, ratio: float
) -> None:
    alpha = math.radians(degrees)
    known = least(alpha, mu, count, weight)
    exact = {"theory": known.eta_theory, "limit": known.eta_limit}[method]
    eta = (exact or 1.0) * ratio
    assume(eta <= 2)
    arch = Arch(half_angle=alpha, eta=eta, voussoirs=count, weight=weight)
    seen = check(CircularArch.of(arch, friction=mu), method=method)
    stands = exact is not None and ratio > 1
    assert seen.verdict is (Verdict.STANDS if stands else Verdict.COLLAPSES)
    assert len(seen.joints) == count + 1
    assert [joint.angle for joint in seen.joints] == pytest.approx(list(arch.joint_angles))
    if stands:
        assert seen.arch.mode is None
        assert {joint.state for joint in seen.joints} == {JointState.CLOSED}
    assert seen.simulated is None
    assert seen.state_hash is None
    assert "\n" not in seen.reason


def test_joints_of_the_limit_mechanism() -> None:
    arch = Arch(half_angle=math.pi / 2, eta=0.1, voussoirs=20)
    seen = check(CircularArch.of(arch, friction=0.7), method="limit")
    found = [(i, joint.state) for i, joint in enumerate(seen.joints)]
    active = [(i, state) for i, state in found if state is not JointState.CLOSED]
    outside, inside = JointState.HINGE_EXTRADOS, JointState.HINGE_INTRADOS
    # beta_r = 54.5 deg: six joint spacings of 9 deg from the crown.
    assert active == [(0, outside), (4, inside), (10, outside), (16, inside), (20, outside)]
    assert seen.arch.mode is Mode.RRR


def test_auto_takes_the_cheapest_that_can_answer() -> None:
    """Nothing is simulated to be told; a motion is, in space where it leaves its plane."""
    arch = CircularArch(half_angle=1.0, eta=0.2, voussoirs=9, friction=0.7)
    why = "no cheaper method sees the blocks as built and is exact"
    for found in (check(arch), bracket(arch, tol=1e-9)):
        assert found.method == "limit"
        assert why in found.reason
    assert why not in check(arch, method="limit").reason
    assert simulate(arch, duration=0.01).engine == "direct"
    leaning = arch.problem().leaning(0.1)
    assert check(leaning).method == "limit"
    let_go = simulate(leaning, duration=0.01)
    assert (let_go.engine, let_go.problem.in_space) == ("direct", True)
