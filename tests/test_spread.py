"""Supports that move slowly: known values, closed forms, and two methods on each other."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from running import inside as blocksim
from structure_cases import case

from blocksim.ask.bracket import bracket
from blocksim.ask.families import family_of
from blocksim.ask.spread import Spreading
from blocksim.blocks.joints import JointState, joint_motion
from blocksim.blocks.structure import structure_record
from blocksim.common.errors import InputError
from blocksim.engines.direct import ENGINE
from blocksim.engines.moving import OnMovingSupports
from blocksim.evidence.recording import read_recording
from blocksim.kinds.files import structure_of
from blocksim.limit.spreading import follow

SPREAD = ("spread_90_12_20", "spread_90_15_20", "spread_90_20_20")
OF_SPAN = (0.01668, 0.05393, 0.15252)


def semicircle(thickness: float, **more: Any) -> dict[str, Any]:
    arch = {"kind": "circular-arch", "friction": "inf", "voussoirs": 20}
    return {**arch, "thickness": thickness, **more}


def apart(name: str) -> dict[str, Any]:
    """The scene of a case, with its supports moving apart alike."""
    scene = case(name)["scene"]
    ends = [block["id"] for block in scene["blocks"] if block.get("fixed")]
    ways = zip(ends, (-0.5, 0.5), strict=True)
    moves = [{"block": end, "direction": [way, 0]} for end, way in ways]
    return {**scene, "move": moves}


@pytest.mark.parametrize(
    ("name", "share"),
    [
        pytest.param(name, share, marks=[] if name == SPREAD[0] else pytest.mark.long)
        for name, share in zip(SPREAD, OF_SPAN, strict=True)
    ],
)
def test_span_at_collapse_by_continuation(name: str, share: float) -> None:
    """As published with the cases: value, of the span, hinges that do not move."""
    path = follow(structure_of(apart(name)), 0.5)
    want = case(name)["expected"]
    assert path.ends == "collapse"
    assert path.value == pytest.approx(want["value"], rel=1e-6)
    assert path.value / 2 == pytest.approx(share, abs=5e-6)
    joint = 6 if name != "spread_90_20_20" else 7
    hinges = {10 - joint: "hinge-intrados", 10: "hinge-extrados", 10 + joint: "hinge-intrados"}
    for frame in path.frames[1:]:
        states = enumerate(frame.states)
        assert {at: state.value for at, state in states if state != "closed"} == hinges
    assert [event.what for event in path.events] == ["hinges", "collapse"]
    fallen = path.events[-1].after.states
    springings = [fallen[0], fallen[-1]]
    assert springings == [JointState.HINGE_EXTRADOS] * 2


@pytest.mark.parametrize(
    "thickness", [0.12, *(pytest.param(each, marks=pytest.mark.long) for each in (0.15, 0.2))]
)
def test_span_at_collapse_by_slow_motion(thickness: float) -> None:
    """`direct` knows nothing of hinges: its supports move slowly, and stop at times."""
    problem = structure_of(semicircle(thickness))
    want = case(f"spread_90_{100 * thickness:.0f}_20")["expected"]["value"]
    seen = Spreading(problem).slowly(0.005, 0.5)
    assert seen.low is not None
    assert seen.high is not None
    assert 0.995 * want < seen.low < seen.high < 1.005 * want
    assert seen.solved


def test_closed_contacts_stay_and_open_ones_do_not_overlap() -> None:
    """Of the displaced blocks, measured as those of any recording."""
    problem = structure_of(semicircle(0.15))
    path = Spreading(problem).path
    frame = path.frames[-1]
    moved = joint_motion(problem.assembly, frame.poses)
    inside = slice(1, -1)  # springings are measured against supports that stay
    gap, closed = moved.gap[inside], frame.closed[inside]
    assert np.abs(gap[closed]).max() < 1e-12
    assert gap[~closed].min() > 1e-2
    assert np.abs(moved.slip[inside][closed.all(axis=1)]).max() < 1e-12
    # The springings have moved with their supports, each by half of the way.
    reach = path.value / 2 / problem.assembly.size
    shift = (
        frame.poses[[0, -1], 0] - problem.assembly.centres[[0, -1], 0] / problem.assembly.size
    )
    assert shift == pytest.approx([-reach, reach], rel=1e-9)


@pytest.mark.parametrize(
    "steps", [None, 8, *(pytest.param(each, marks=pytest.mark.long) for each in (17, 83, 110))]
)
def test_a_three_hinged_arch_of_two_blocks_falls_when_it_is_flat(steps: int | None) -> None:
    """Two slabs lean on each other, on the inner corners of their feet and on their tops.

    As the feet move apart these three hinges come into line: there nothing holds them, from
    wherever the last position on the way happens to be.
    """
    wide, high = 0.2, 1.0
    slabs = [
        {"id": "left", "vertices": [[-1, 0], [-1 + wide, 0], [0, high - wide], [0, high]]},
        {"id": "right", "vertices": [[1 - wide, 0], [1, 0], [0, high], [0, high - wide]]},
    ]
    feet = [
        {"id": "west", "vertices": [[-2, -1], [-0.5, -1], [-0.5, 0], [-2, 0]], "fixed": True},
        {"id": "east", "vertices": [[0.5, -1], [2, -1], [2, 0], [0.5, 0]], "fixed": True},
    ]
    problem = structure_of({"friction": "inf", "blocks": [*feet, *slabs]})
    flat = 2 * (math.hypot(1 - wide, high) - (1 - wide))
    moved = Spreading(problem)
    path = follow(moved.problem, 1.0, steps) if steps else moved.path
    assert JointState.CLOSED not in path.events[0].after.states
    assert path.ends == "collapse"
    assert path.value == pytest.approx(flat, rel=1e-8)


def test_mirrored_and_scaled_supports_move_alike() -> None:
    one = Spreading(structure_of(semicircle(0.13, voussoirs=8))).exact
    large = Spreading(structure_of(semicircle(1.3, voussoirs=8, radius=10.0))).exact
    assert one is not None
    assert large == pytest.approx(10 * one, rel=1e-8)
    table = semicircle(0.13, voussoirs=8)
    ways = [
        [{"block": "left", "direction": [-1, 0]}],
        [{"block": "right", "direction": [1, 0]}],
    ]
    alone = [Spreading(structure_of({**table, "move": move})).exact for move in ways]
    assert alone == [pytest.approx(one, rel=1e-7)] * 2


def test_a_load_at_a_point_acts_while_supports_move() -> None:
    """At the centre of a block that hardly turns it does what a force on the block does."""
    table = semicircle(0.13, voussoirs=8)
    x, y = structure_of(table).assembly.blocks[4].centre
    after = list[Any]()
    for point in ({}, {"point": [x, y]}):
        load = {"block": 5, "force": [0.0, -500.0], **point}
        problem = structure_of({**table, "dead": [load]})
        world = OnMovingSupports(problem, ENGINE.rule(problem.assembly), 1e-3)
        for _ in range(10):
            world.advance_once()
        after.append(world.poses())
    assert np.abs(after[1] - after[0]).max() < 1e-9
    assert np.abs(after[0][:, 2]).max() > 1e-6


def test_supports_that_settle() -> None:
    """On the left as on the right; `direct` agrees, which knows no hinges."""
    table = semicircle(0.11, voussoirs=12)
    down = [[{"block": side, "direction": [0, -1]}] for side in ("left", "right")]
    found = [Spreading(structure_of({**table, "move": move})) for move in down]
    value = found[0].exact
    assert value is not None
    assert found[1].exact == pytest.approx(value, rel=1e-6)
    hinges = [
        [at for at, state in enumerate(each.path.events[0].after.states) if state != "closed"]
        for each in found
    ]
    assert hinges == [[0, 6, 10], [2, 6, 12]]
    seen = found[1].slowly(0.01, 0.5)
    assert seen.low is not None
    assert seen.high is not None
    assert 0.99 * value < seen.low < seen.high < 1.01 * value


def test_hinges_of_a_segment_migrate() -> None:
    """They jump from the springings to the next joints: the arch is caught, and later falls."""
    table = semicircle(0.2, left_deg=60, right_deg=60)
    path = Spreading(structure_of(table)).path
    assert [event.what for event in path.events] == ["hinges", "snaps", "collapse"]
    hinges = [
        [at for at, state in enumerate(event.after.states) if state != "closed"]
        for event in path.events[:2]
    ]
    assert hinges == [[0, 10, 20], [1, 10, 19]]
    first, caught, last = (event.value for event in path.events)
    assert first == 0 < caught < last


def test_what_cannot_be_asked_is_refused() -> None:
    wall = structure_of({"kind": "wall", "friction": 0.7})
    with pytest.raises(InputError, match="what moves has to be said"):
        family_of(wall, "spread")
    arch = structure_of(semicircle(0.15))
    with pytest.raises(InputError, match="limit or direct: others move no supports"):
        bracket(family_of(arch, "spread"), method="pymunk")
    move = {"block": "left", "direction": [0, 1]}
    with pytest.raises(InputError, match="named once in move"):
        structure_of(semicircle(0.15, move=[move, move]))


def test_on_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "arch.json"
    file.write_text(json.dumps(apart("spread_90_12_20")))
    want = case("spread_90_12_20")["expected"]["value"]
    done = blocksim("bracket", str(file), "--over", "spread", "--json")
    found = json.loads(done.stdout)
    assert (found["over"], found["unit"], found["stands"]) == ("spread", "m", "low")
    assert found["limit"] == pytest.approx(want, rel=1e-6)
    assert found["low"] < found["limit"] < found["high"]
    assert found["confirmed"]
    assert "it falls: " in found["reason"]


def test_moves_are_written_back() -> None:
    moves = [{"block": "right", "direction": [0.0, -1.0], "turn_deg": 5.0, "about": [1.0, 0.0]}]
    problem = structure_of(semicircle(0.15, move=moves))
    again = structure_of(structure_record(problem))
    assert again.moves[0].turn == pytest.approx(math.radians(5))
    assert again.moves[0].about == pytest.approx([1, 0])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """An arch as a structure file."""
    table = {"kind": "circular-arch", "voussoirs": 8, "friction": 0.8, "thickness": 0.13}
    path = tmp_path / "arch.json"
    path.write_text(json.dumps(table))
    return path


@pytest.mark.long
def test_supports_that_move_are_recorded_until_all_has_fallen(
    file: Path, tmp_path: Path
) -> None:
    """The supports go on apart, evenly; the arch falls near the way known for it."""
    out = tmp_path / "run.npz"
    done = blocksim("simulate", str(file), "--over", "spread", "--out", str(out))
    assert done.returncode == 0, done.stderr
    recording = read_recording(out)
    assert recording.problem.title == "circular-arch, its supports move"
    assert recording.poses.shape[1] == 8 + 2
    apart = recording.poses[:, 9, 0] - recording.poses[:, 8, 0]
    size = recording.assembly.size
    assert apart[-1] > apart[0]
    assert np.diff(apart) == pytest.approx(apart[1] - apart[0], rel=1e-6)
    crown = recording.poses[:, 3, 1]
    moved = (apart - apart[0]) * size
    falls = moved[int(np.argmax(crown < crown[0] - 0.3))]
    known = Spreading(structure_of(json.loads(file.read_text()))).exact
    assert known is not None
    # It takes a while to fall, in which the supports go on.
    assert known < falls < known + 0.01 * 3


def test_supports_that_move_are_recorded_by_direct_alone(file: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    for options, said in (
        (["--over", "tilt"], "--over = 'tilt': must be spread"),
        (["--over", "spread", "--method", "pymunk"], "--method = 'pymunk': must be direct"),
        (["--over", "spread", "--seconds", "2"], "--seconds = 2.0: must be left out"),
    ):
        ended = blocksim("simulate", str(file), *options, "--out", str(out))
        assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
        assert said in ended.stderr
